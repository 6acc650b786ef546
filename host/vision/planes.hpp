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
   middle of the four. Where a size is odd, and around the picture, there is nothing.
   margin: coarse rows and columns around that get their share too; rows: [height][width] */
Plane halved_smoothly(const float *rows, int width, int height, int margin);
inline Plane halved_smoothly(const Plane &fine) {
  return halved_smoothly(fine.value.data(), fine.width, fine.height, 0);
}

/// Bilinear: fine(x, y) = coarse at ((x + 0.5)/2 - 0.5, ..); beyond the ends as straight on as before them.
Plane doubled(const Plane &coarse, int width, int height);
/// A row; the one before the first or beyond the last lies as far on as the one before it.
std::vector<float> row_or_beyond(const Plane &plane, int y);

/// out += weight x (in convolved with a Gaussian of this variance [pixels^2], normalised); zero beyond the edges.
/// errors: blur_radius above 8 -> std::invalid_argument
void add_blurred(const Plane &in, double variance, double weight, Plane &out);
/// Pixels that add_blurred reads on each side.
int blur_radius(double variance);

/// to[x] = a[x] + t (b[x] - a[x])
void mix_rows(const float *a, const float *b, float t, int width, float *to);

}  // namespace greenray::vision
