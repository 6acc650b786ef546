#include "image/contact_sheet.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "image/colour.hpp"

namespace greenray {
namespace {

constexpr int gap = 2, narrowest = 48, widest = 320;  // pixels

/// Light of each level of an 8- or 16-bit picture.
std::vector<float> light_of_levels(int bits) {
  std::vector<float> light(std::size_t{1} << static_cast<unsigned>(bits));
  const double full = static_cast<double>(light.size() - 1);
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] = static_cast<float>(srgb_decode(static_cast<double>(i) / full));
  return light;
}

/// Mean light of the box of pixels that each thumbnail pixel covers, partly covered ones by their share.
class Shrinker {
 public:
  Shrinker(const Raster &picture, int width, int height)
      : picture_(picture), light_(light_of_levels(picture.bits)), width_(width), height_(height) {}

  std::array<float, 3> at(int x, int y) const {
    const double left = edge(x, width_, picture_.width), right = edge(x + 1, width_, picture_.width);
    const double top = edge(y, height_, picture_.height), bottom = edge(y + 1, height_, picture_.height);
    std::array<double, 3> sum{};
    for (int row = static_cast<int>(top); row < std::ceil(bottom); ++row)
      for (int column = static_cast<int>(left); column < std::ceil(right); ++column) {
        const double share = covered(column, left, right) * covered(row, top, bottom);
        const std::size_t at = 3 * (static_cast<std::size_t>(row) * static_cast<std::size_t>(picture_.width) +
                                    static_cast<std::size_t>(column));
        for (std::size_t c = 0; c < 3; ++c) sum[c] += share * static_cast<double>(light_[picture_.rgb[at + c]]);
      }
    const double area = (right - left) * (bottom - top);
    return {static_cast<float>(sum[0] / area), static_cast<float>(sum[1] / area), static_cast<float>(sum[2] / area)};
  }

 private:
  static double edge(int i, int count, int pixels) { return static_cast<double>(i) * pixels / count; }
  static double covered(int pixel, double from, double to) {
    return std::min(to, pixel + 1.0) - std::max(from, static_cast<double>(pixel));
  }
  const Raster &picture_;
  std::vector<float> light_;
  int width_, height_;
};

struct Layout {
  int columns, rows, cell_width, cell_height;
};

/// As many columns as make the sheet about 4:3.
Layout layout_for(std::size_t count, const Raster &first, int width) {
  const double shape = static_cast<double>(first.width) / first.height, n = static_cast<double>(count);
  const int columns = std::clamp(static_cast<int>(std::ceil(std::sqrt(n * 4 / 3 / shape))), 1, static_cast<int>(count));
  const int most = std::max(narrowest, (width + gap) / columns - gap);
  const int cell = std::clamp(std::min(most, first.width), 1, widest);
  return {columns,
          static_cast<int>((count + static_cast<std::size_t>(columns) - 1) / static_cast<std::size_t>(columns)), cell,
          std::max(1, static_cast<int>(std::lround(cell / shape)))};
}

}  // namespace

Raster shrunk(const Raster &picture, int widest_pixels) {
  const int width = std::min(picture.width, widest_pixels);
  const int height =
      std::max(1, static_cast<int>(std::lround(static_cast<double>(picture.height) * width / picture.width)));
  const Shrinker small(picture, width, height);
  RgbImage out{width, height, {}};
  out.rgb.reserve(3 * out.pixels());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::array<float, 3> light = small.at(x, y);
      out.rgb.insert(out.rgb.end(), light.begin(), light.end());
    }
  return quantise(out, 8, false);
}

Raster contact_sheet(const std::vector<std::filesystem::path> &pictures, int width) {
  if (pictures.empty()) throw std::invalid_argument("a contact sheet of no pictures");
  Raster picture = read_png(pictures[0]);
  const Layout layout = layout_for(pictures.size(), picture, width);
  RgbImage sheet;
  sheet.width = layout.columns * (layout.cell_width + gap) - gap;
  sheet.height = layout.rows * (layout.cell_height + gap) - gap;
  sheet.rgb.assign(3 * sheet.pixels(), 0.0F);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (i > 0) picture = read_png(pictures[i]);
    const double scale = std::min({1.0, static_cast<double>(layout.cell_width) / picture.width,
                                   static_cast<double>(layout.cell_height) / picture.height});
    const int w = std::max(1, static_cast<int>(std::lround(picture.width * scale)));
    const int h = std::max(1, static_cast<int>(std::lround(picture.height * scale)));
    const Shrinker small(picture, w, h);
    const int column = static_cast<int>(i) % layout.columns, row = static_cast<int>(i) / layout.columns;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::array<float, 3> light = small.at(x, y);
        const int sheet_x = column * (layout.cell_width + gap) + x, sheet_y = row * (layout.cell_height + gap) + y;
        std::copy(light.begin(), light.end(),
                  sheet.rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(sheet_y) * sheet.width + sheet_x));
      }
  }
  return quantise(sheet, 8, false);
}

}  // namespace greenray
