#include "vision/planes.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "support/fast_math.hpp"

namespace greenray::vision {

namespace {

/// Weights of offsets 0 .. r; the other side is the same.
std::vector<float> gaussian_taps(double variance) {
  const int radius = blur_radius(variance);
  std::vector<double> taps;
  double sum = 0;
  for (int t = 0; t <= radius; ++t) {
    // three taps have the right variance themselves; a sampled Gaussian so narrow would not
    taps.push_back(radius == 1 ? (t == 0 ? 1 - variance : 0.5 * variance) : std::exp(-0.5 * t * t / variance));
    sum += (t == 0 ? 1 : 2) * taps.back();
  }
  std::vector<float> result;
  for (const double tap : taps) result.push_back(static_cast<float>(tap / sum));
  return result;
}

constexpr int strip = 128;  // columns in work at once: the rows that a tap reads stay in the nearest cache
constexpr int widest_radius = 8;

/// to[x] (+)= sum over t of taps[|t|] from[x + t Stride], t = -Radius .. Radius
template <int Radius, int Stride, bool Add>
[[gnu::always_inline]] inline void symmetric_sum(const float *from, const float *taps, int count, float *to) {
  for (int x = 0; x < count; ++x) {
    float sum = taps[0] * from[x];
#pragma GCC unroll 8
    for (int t = 1; t <= Radius; ++t) sum += taps[t] * (from[x - t * Stride] + from[x + t * Stride]);
    to[x] = Add ? to[x] + sum : sum;
  }
}

template <int Stride, bool Add>
[[gnu::always_inline]] inline void convolve(const float *from, const float *taps, int radius, int count, float *to) {
  static_assert(widest_radius == 8);
  switch (radius) {
    case 1:
      return symmetric_sum<1, Stride, Add>(from, taps, count, to);
    case 2:
      return symmetric_sum<2, Stride, Add>(from, taps, count, to);
    case 3:
      return symmetric_sum<3, Stride, Add>(from, taps, count, to);
    case 4:
      return symmetric_sum<4, Stride, Add>(from, taps, count, to);
    case 5:
      return symmetric_sum<5, Stride, Add>(from, taps, count, to);
    case 6:
      return symmetric_sum<6, Stride, Add>(from, taps, count, to);
    case 7:
      return symmetric_sum<7, Stride, Add>(from, taps, count, to);
    default:
      return symmetric_sum<8, Stride, Add>(from, taps, count, to);
  }
}

GREENRAY_VECTOR_CLONES void convolve_across(const float *from, const float *taps, int radius, int count, float *to) {
  convolve<1, false>(from, taps, radius, count, to);
}

GREENRAY_VECTOR_CLONES void add_convolved_down(const float *from, const float *taps, int radius, int count, float *to) {
  convolve<strip, true>(from, taps, radius, count, to);
}

/// Sums of pairs, next to each other and above each other.
GREENRAY_VECTOR_CLONES void mean_of_2x2(const float *upper, const float *lower, int pairs, float *to) {
  for (int x = 0; x < pairs; ++x) to[x] = 0.25F * (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1]);
}

/// (1 3 3 1)/8 of four rows.
GREENRAY_VECTOR_CLONES void smooth_down(const float *const rows[4], int width, float *to) {
  const float *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3];
  for (int x = 0; x < width; ++x) to[x] = 0.125F * (a[x] + d[x]) + 0.375F * (b[x] + c[x]);
}

/// The same of four neighbours, every second place.
GREENRAY_VECTOR_CLONES void smooth_across(const float *from, int width, float *to) {
  for (int x = 0; x < width; ++x)
    to[x] = 0.125F * (from[2 * x] + from[2 * x + 3]) + 0.375F * (from[2 * x + 1] + from[2 * x + 2]);
}

/// Pairs around each value: a quarter of the way to either neighbour. from[-1] and from[width] must be there.
GREENRAY_VECTOR_CLONES void double_across(const float *from, int width, float *to) {
  for (int x = 0; x < width; ++x) {
    to[2 * x] = 0.75F * from[x] + 0.25F * from[x - 1];
    to[2 * x + 1] = 0.75F * from[x] + 0.25F * from[x + 1];
  }
}

}  // namespace

GREENRAY_VECTOR_CLONES void mix_rows(const float *a, const float *b, float t, int width, float *to) {
  for (int x = 0; x < width; ++x) to[x] = a[x] + t * (b[x] - a[x]);
}

Plane halved(const Plane &fine, Beyond beyond) {
  Plane coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  const int pairs = fine.width / 2;
  const std::vector<float> nothing(static_cast<std::size_t>(fine.width), 0.0F);
  for (int y = 0; y < coarse.height; ++y) {
    const float *upper = fine.row(2 * y);
    const float *lower = 2 * y + 1 < fine.height  ? fine.row(2 * y + 1)
                         : beyond == Beyond::edge ? upper
                                                  : nothing.data();
    float *to = coarse.row(y);
    mean_of_2x2(upper, lower, pairs, to);
    if (fine.width % 2)
      to[pairs] = (beyond == Beyond::edge ? 0.5F : 0.25F) * (upper[fine.width - 1] + lower[fine.width - 1]);
  }
  return coarse;
}

Plane halved_smoothly(const float *rows, int width, int height, int margin) {
  Plane coarse((width + 1) / 2 + 2 * margin, (height + 1) / 2 + 2 * margin);
  const std::vector<float> nothing(static_cast<std::size_t>(width), 0.0F);
  // one column before the first that is read, three beyond
  std::vector<float> down(static_cast<std::size_t>(width + 4 + 4 * margin), 0.0F);
  for (int y = 0; y < coarse.height; ++y) {
    const float *taps[4];
    for (int t = 0; t < 4; ++t) {
      const int row = 2 * (y - margin) + t - 1;
      taps[t] = row >= 0 && row < height ? rows + static_cast<std::ptrdiff_t>(row) * width : nothing.data();
    }
    smooth_down(taps, width, down.data() + 1 + 2 * margin);
    smooth_across(down.data(), coarse.width, coarse.row(y));
  }
  return coarse;
}

std::vector<float> row_or_beyond(const Plane &plane, int y) {
  const int inside = std::clamp(y, 0, plane.height - 1), step = y < 0 ? -1 : y > inside ? 1 : 0;
  std::vector<float> row(plane.row(inside), plane.row(inside) + plane.width);
  if (step == 0 || plane.height == 1) return row;
  const float *inner = plane.row(inside - step);
  for (std::size_t x = 0; x < row.size(); ++x) row[x] += row[x] - inner[x];
  return row;
}

Plane doubled(const Plane &coarse, int width, int height) {
  Plane fine(width, height);
  const int own = std::min(coarse.width, (width + 1) / 2);
  const auto last = static_cast<std::size_t>(coarse.width);
  std::vector<float> mixed(last + 2), row(static_cast<std::size_t>(2 * own));
  const std::vector<float> before = row_or_beyond(coarse, -1), beyond = row_or_beyond(coarse, coarse.height);
  const auto coarse_row = [&](int y) {
    return y < 0 ? before.data() : y < coarse.height ? coarse.row(y) : beyond.data();
  };
  for (int y = 0; y < height; ++y) {
    const int below = (y + 1) / 2;  // the pair of coarse rows around this fine row
    mix_rows(coarse_row(below - 1), coarse_row(below), y % 2 ? 0.25F : 0.75F, coarse.width, mixed.data() + 1);
    mixed.front() = last > 1 ? 2 * mixed[1] - mixed[2] : mixed[1];
    mixed.back() = last > 1 ? 2 * mixed[last] - mixed[last - 1] : mixed[last];
    const bool fits = width % 2 == 0 && own == width / 2;
    double_across(mixed.data() + 1, own, fits ? fine.row(y) : row.data());
    if (fits) continue;
    for (int x = 0; x < width; ++x) fine.row(y)[x] = x < 2 * own ? row[static_cast<std::size_t>(x)] : mixed.back();
  }
  return fine;
}

int blur_radius(double variance) { return variance < 0.3 ? 1 : static_cast<int>(std::ceil(3.2 * std::sqrt(variance))); }

void add_blurred(const Plane &in, double variance, double weight, Plane &out) {
  std::vector<float> across = gaussian_taps(variance), down = across;
  const int radius = static_cast<int>(across.size()) - 1;
  if (radius > widest_radius) throw std::invalid_argument("a Gaussian too wide for its level");
  for (float &tap : down) tap *= static_cast<float>(weight);
  std::vector<float> columns(static_cast<std::size_t>(strip * (in.height + 2 * radius)), 0.0F);  // blurred across
  std::vector<float> padded(static_cast<std::size_t>(strip + 2 * radius));
  for (int left = 0; left < in.width; left += strip) {
    const int count = std::min(strip, in.width - left);
    const int from = std::max(0, left - radius), to = std::min(in.width, left + count + radius);
    const bool at_an_edge = to - from < count + 2 * radius;
    std::fill(padded.begin(), padded.end(), 0.0F);
    float *middle = columns.data() + static_cast<std::ptrdiff_t>(strip) * radius;
    for (int y = 0; y < in.height; ++y) {
      const float *row = in.row(y) + left;
      if (at_an_edge) {
        std::copy(in.row(y) + from, in.row(y) + to, padded.begin() + (from - left + radius));
        row = padded.data() + radius;
      }
      convolve_across(row, across.data(), radius, count, middle + strip * y);
    }
    for (int y = 0; y < std::min(in.height, out.height); ++y)
      add_convolved_down(middle + strip * y, down.data(), radius, count, out.row(y) + left);
  }
}

}  // namespace greenray::vision
