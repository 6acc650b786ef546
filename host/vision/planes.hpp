// Single-channel pictures, and the steps between resolutions that glare and acuity share.
#pragma once
#include <cstddef>
#include <vector>

namespace greenray::vision {

/// Rows from the top, width values each.
struct Plane {
  int width = 0, height = 0;
  std::vector<float> value;

  Plane() = default;
  Plane(int w, int h, float fill = 0)
      : width(w), height(h), value(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), fill) {}
  float *row(int y) { return value.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
  const float *row(int y) const { return value.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width); }
};
using Planes = std::vector<Plane>;

/// Means of 2x2. Where a size is odd, what lies beyond is 0, or the edge once more.
enum class Beyond { nothing, edge };
Plane halved(const Plane &fine, Beyond beyond = Beyond::nothing);

/* Half the size by (1 3 3 1)/8 each way: a point of light keeps its place, which a mean of 2x2 would round to the
   middle of the four. Where a size is odd, and around the picture, there is nothing. */
Plane halved_smoothly(const Plane &fine);

/* Bilinear: fine(x, y) = coarse at ((x + 0.5)/2 - 0.5, ..), ends repeated. first_row: row of `coarse` (may be negative,
   then repeated) whose upper half is the first row of `fine`. */
Plane doubled(const Plane &coarse, int width, int height, int first_row = 0);

/// out += weight x (in convolved with a Gaussian of this variance [pixels^2], normalised); zero beyond the edges.
void add_blurred(const Plane &in, double variance, double weight, Plane &out);
/// Pixels that add_blurred reads on each side.
int blur_radius(double variance);

/// Bilinear value at (x, y), pixel centres on whole numbers; ends repeated.
inline float bilinear(const Plane &plane, float x, float y) {
  const auto limit = [](float v, int size) {
    return v < 0 ? 0.0F : v > static_cast<float>(size - 1) ? static_cast<float>(size - 1) : v;
  };
  const float cx = limit(x, plane.width), cy = limit(y, plane.height);
  const int x0 = static_cast<int>(cx), y0 = static_cast<int>(cy);
  const int x1 = x0 + 1 < plane.width ? x0 + 1 : x0, y1 = y0 + 1 < plane.height ? y0 + 1 : y0;
  const float tx = cx - static_cast<float>(x0), ty = cy - static_cast<float>(y0);
  const float *upper = plane.row(y0), *lower = plane.row(y1);
  const float above = upper[x0] + tx * (upper[x1] - upper[x0]), below = lower[x0] + tx * (lower[x1] - lower[x0]);
  return above + ty * (below - above);
}

}  // namespace greenray::vision
