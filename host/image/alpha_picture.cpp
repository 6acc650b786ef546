#include "image/alpha_picture.hpp"

#include <algorithm>

#include "image/colour.hpp"
#include "image/exr.hpp"
#include "image/png.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

AlphaPicture from_png(const std::filesystem::path &path) {
  std::vector<std::uint16_t> coverage;
  const Raster raster = read_png(path, &coverage);
  const double full = raster.bits == 16 ? 65535 : 255;
  AlphaPicture picture;
  picture.colours.width = raster.width, picture.colours.height = raster.height;
  for (const std::uint16_t level : raster.rgb)
    picture.colours.rgb.push_back(static_cast<float>(srgb_decode(level / full)));
  for (const std::uint16_t level : coverage) picture.alpha.push_back(static_cast<float>(level / full));
  return picture;
}

AlphaPicture from_exr(const std::filesystem::path &path) {
  const ExrPicture file = read_exr(path);
  AlphaPicture picture{file.rgb(), {}};
  const auto channel = file.parts.front().channels.find("A");
  if (channel == file.parts.front().channels.end()) {
    picture.alpha.assign(picture.colours.pixels(), 1.0f);
    return picture;
  }
  for (const float a : channel->second) picture.alpha.push_back(a > 0 ? std::min(a, 1.0f) : 0.0f);  // NaN: none
  for (std::size_t i = 0; i < picture.alpha.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      float &value = picture.colours.rgb[3 * i + c];
      value = picture.alpha[i] > 0 ? value / picture.alpha[i] : 0.0f;
    }
  return picture;
}

}  // namespace

AlphaPicture read_alpha_picture(const std::filesystem::path &path) {
  const std::string extension = path.extension().string();
  if (extension == ".png") return from_png(path);
  if (extension == ".exr") return from_exr(path);
  throw InputError(SourcePlace{path.string(), 1, 1}, "expected a picture that ends in .png or .exr");
}

}  // namespace greenray
