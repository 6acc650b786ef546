#include "vision/glare_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/fast_math.hpp"

namespace greenray::vision {

namespace {

constexpr int all_pairs_side = 40;
/// Widths of half this to this many pixels belong to a level: narrower ones would show the grid, wider ones cost more.
constexpr double widest_in_level = 2.4;

/// Variance [pixels^2] that going down to a level and back adds: (1 3 3 1)/8 down and straight lines up, as much each.
double pyramid_variance(int level) { return 0.5 * (std::exp2(2.0 * level) - 1); }

/// Every place of a row gives to every place of another: to[x] += sum of from[i] weights[x - i].
GREENRAY_VECTOR_CLONES void add_row_to_row(const float *from, const float *weights, int width, float *to) {
  for (int i = 0; i < width; ++i)
    for (int x = 0; x < width; ++x) to[x] += from[i] * weights[x - i];
}

double radians(double deg) { return deg * std::numbers::pi / 180; }

}  // namespace

GlareFilter::GlareFilter(int width, int height, int levels, double pixel_deg, const Eye &eye)
    : width_(width),
      height_(height),
      levels_(levels),
      pixel_sr_(radians(pixel_deg) * radians(pixel_deg)),
      sum_(glare_as_gaussians(eye, pixel_deg * std::numbers::sqrt2 / 2)),
      pixel_deg_(pixel_deg) {
  for (const GaussianSpread &g : sum_.gaussians)
    if (g.sigma_deg < 0.3 * pixel_deg)
      kept_by_pixels_ += g.per_sr * 2 * std::numbers::pi * std::pow(radians(g.sigma_deg), 2);
  kept_by_cells_ = kept_by_pixels_;
  int reach = 0;
  for (int level = 0; level < levels; ++level)
    for (const Blur &blur : blurs_of_level(level)) {
      kept_by_cells_ += blur.share;
      reach = std::max(reach, (blur_radius(blur.variance) + 2) << level);
    }
  const int cell = 1 << levels;
  halo_rows_ = levels == 0 ? 0 : (reach + cell - 1) / cell * cell;
}

/* Two widths belong to a level, with that blur taken off that the level makes by itself. Level 0 also has the narrower
   ones, below 1.2 pixels two and two together. */
std::vector<GlareFilter::Blur> GlareFilter::blurs_of_level(int level) const {
  std::vector<Blur> blurs;
  const double own = pyramid_variance(level), scale = std::exp2(-2.0 * level);
  Blur narrow{0, 0}, wide{0, 0};
  for (const GaussianSpread &g : sum_.gaussians) {
    const double sigma = g.sigma_deg / pixel_deg_, in_level = sigma * std::exp2(-level);
    const double share = g.per_sr * pixel_sr_ * 2 * std::numbers::pi * sigma * sigma;
    if (in_level > widest_in_level || sigma < 0.3 || (level > 0 && in_level < 0.5 * widest_in_level)) continue;
    if (level > 0 || sigma > 1.2) {
      blurs.push_back({(sigma * sigma - own) * scale, share});
      continue;
    }
    Blur &joined = sigma < 0.6 ? narrow : wide;
    joined = {joined.variance + share * sigma * sigma, joined.share + share};
  }
  for (const Blur &joined : {narrow, wide})
    if (joined.share > 0) blurs.push_back({joined.variance / joined.share, joined.share});
  return blurs;
}

Plane GlareFilter::veil(const Plane &cells) const {
  int top = 0;
  while (((std::max(cells.width, cells.height) - 1) >> top) + 3 > all_pairs_side) ++top;
  // one coarsest point more on each side, so that what is straight between points does not end inside the frame
  const int margin = top == 0 ? 0 : 1 << top;
  std::vector<Plane> lights{Plane(cells.width + 2 * margin, cells.height + 2 * margin)};
  for (int y = 0; y < cells.height; ++y) std::copy_n(cells.row(y), cells.width, lights[0].row(y + margin) + margin);
  for (int step = 0; step < top; ++step) lights.push_back(halved_smoothly(lights.back()));
  Plane veil = all_pairs(lights.back(), levels_ + top);
  for (int step = top - 1; step >= 0; --step) {
    const Plane &light = lights[static_cast<std::size_t>(step)];
    veil = doubled(veil, light.width, light.height);
    for (const Blur &blur : blurs_of_level(levels_ + step)) add_blurred(light, blur.variance, blur.share, veil);
  }
  Plane inside(cells.width, cells.height);
  for (int y = 0; y < cells.height; ++y) std::copy_n(veil.row(y + margin) + margin, cells.width, inside.row(y));
  return inside;
}

Plane GlareFilter::spread(const Plane &band, int first_row, const Plane &veil) const {
  std::vector<Plane> lights{band};
  for (int level = 1; level < levels_; ++level) lights.push_back(halved_smoothly(lights.back()));
  const int cell = 1 << levels_, rows = (band.height + cell - 1) / cell;
  // the veil's rows of this band: first_row is a multiple of the cell
  Plane spread(veil.width, rows);
  for (int y = 0; y < rows; ++y) {
    const std::vector<float> row = row_or_beyond(veil, first_row / cell + y + 1);
    std::copy(row.begin(), row.end(), spread.row(y));
  }
  for (int level = levels_ - 1; level >= 0; --level) {
    const Plane &light = lights[static_cast<std::size_t>(level)];
    spread = doubled(spread, light.width, light.height);
    for (const Blur &blur : blurs_of_level(level)) add_blurred(light, blur.variance, blur.share, spread);
  }
  for (std::size_t i = 0; i < spread.value.size(); ++i)
    spread.value[i] += static_cast<float>(kept_by_pixels_) * band.value[i];
  return spread;
}

/// Everything that no lower level has, pair by pair.
Plane GlareFilter::all_pairs(const Plane &cells, int level) const {
  const int w = cells.width, h = cells.height;
  const double cell_sr = pixel_sr_ * std::exp2(2.0 * level), own = pyramid_variance(level);
  std::vector<float> kernel(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0.0F);
  std::vector<double> sums(kernel.size(), 0.0);
  for (const GaussianSpread &g : sum_.gaussians) {
    const double sigma = g.sigma_deg / pixel_deg_;
    if (sigma < 0.3 || (level > 0 && sigma * std::exp2(-level) < 0.5 * widest_in_level)) continue;
    const double share = g.per_sr * pixel_sr_ * 2 * std::numbers::pi * sigma * sigma;
    const double variance = std::max((sigma * sigma - own) * std::exp2(-2.0 * level), 1e-3);
    double line = 0;  // sum of the sampled Gaussian along one axis: for narrow ones not sqrt(2 pi variance)
    for (int t = -8; t <= 8; ++t) line += std::exp(-0.5 * t * t / variance);
    const double norm = variance < 4 ? line * line : 2 * std::numbers::pi * variance;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x)
        sums[static_cast<std::size_t>(y * w + x)] += share / norm * std::exp(-0.5 * (x * x + y * y) / variance);
  }
  const double cell_deg = pixel_deg_ * std::exp2(level);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const double theta2 = (x * x + y * y) * cell_deg * cell_deg;
      const double flat = sum_.constant_per_sr + sum_.quadratic_per_sr_deg2 * theta2;
      const auto i = static_cast<std::size_t>(y * w + x);
      kernel[i] = static_cast<float>(sums[i] + flat * cell_sr);
    }
  std::vector<float> mirrored(static_cast<std::size_t>(2 * w));  // offsets -(w - 1) .. w - 1
  Plane veil(w, h);
  for (int dy = 0; dy < h; ++dy) {
    for (int dx = 1 - w; dx < w; ++dx)
      mirrored[static_cast<std::size_t>(dx + w - 1)] = kernel[static_cast<std::size_t>(dy * w + std::abs(dx))];
    for (int y = 0; y + dy < h; ++y) {
      add_row_to_row(cells.row(y), mirrored.data() + w - 1, w, veil.row(y + dy));
      if (dy > 0) add_row_to_row(cells.row(y + dy), mirrored.data() + w - 1, w, veil.row(y));
    }
  }
  return veil;
}

}  // namespace greenray::vision
