#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "image/colour.hpp"
#include "image/exr.hpp"
#include "support/error.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

InputError complaint(const fs::path &file, const std::string &message) {
  return InputError(SourcePlace{file.string(), 1, 1}, message);
}

ExrAttributes read_attributes(const Imf::Header &header) {
  ExrAttributes attributes;
  for (auto it = header.begin(); it != header.end(); ++it) {
    const Imf::Attribute &attribute = it.attribute();
    if (const auto *text = dynamic_cast<const Imf::StringAttribute *>(&attribute))
      attributes[it.name()] = text->value();
    else if (const auto *real = dynamic_cast<const Imf::DoubleAttribute *>(&attribute))
      attributes[it.name()] = real->value();
    else if (const auto *single = dynamic_cast<const Imf::FloatAttribute *>(&attribute))
      attributes[it.name()] = static_cast<double>(single->value());
    else if (const auto *whole = dynamic_cast<const Imf::IntAttribute *>(&attribute))
      attributes[it.name()] = static_cast<double>(whole->value());
  }
  return attributes;
}

/// A damaged header can claim any size. No compression of OpenEXR shrinks pixels more than about 1000 times.
void check_claimed_size(const fs::path &path, std::int64_t width, std::int64_t height, std::size_t channels) {
  constexpr std::int64_t most_pixels_per_side = 1 << 17;
  const bool sane = width > 0 && height > 0 && width <= most_pixels_per_side && height <= most_pixels_per_side;
  const double bytes = 2.0 * static_cast<double>(width) * static_cast<double>(height) * static_cast<double>(channels);
  if (!sane || bytes > 2000.0 * static_cast<double>(fs::file_size(path)) + 1e6)
    throw complaint(path,
                    "damaged EXR file: it claims " + std::to_string(width) + "x" + std::to_string(height) + " pixels");
}

ExrPart read_part(const fs::path &path, Imf::MultiPartInputFile &input, int index) {
  const Imf::Header &header = input.header(index);
  if (header.hasType() && Imf::isDeepData(header.type())) throw complaint(path, "deep EXR pictures are not supported");
  if (!input.partComplete(index)) throw complaint(path, "incomplete EXR file: some rows of pixels are missing");
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
  const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
  std::size_t channel_count = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) ++channel_count;
  check_claimed_size(path, width, height, channel_count);

  ExrPart part;
  part.name = header.hasName() ? header.name() : "";
  part.width = static_cast<int>(width);
  part.height = static_cast<int>(height);
  Imf::FrameBuffer frame;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      throw complaint(path, "channel '" + std::string(it.name()) + "' is subsampled, which is not supported");
    std::vector<float> &values = part.channels[it.name()];
    values.resize(static_cast<std::size_t>(width * height));
    frame.insert(it.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), window));
  }
  Imf::InputPart pixels(input, index);
  pixels.setFrameBuffer(frame);
  pixels.readPixels(window.min.y, window.max.y);
  return part;
}

ExrPicture read_whole(const fs::path &path) {
  Imf::MultiPartInputFile input(path.c_str());
  ExrPicture picture;
  picture.file = path.string();
  const Imf::Header &first = input.header(0);
  picture.attributes = read_attributes(first);
  if (Imf::hasWhiteLuminance(first)) picture.white_luminance_cd_m2 = static_cast<double>(Imf::whiteLuminance(first));
  if (Imf::hasChromaticities(first)) {
    const Imf::Chromaticities &c = Imf::chromaticities(first);
    const Imath::V2f xy[4] = {c.red, c.green, c.blue, c.white};
    for (std::size_t i = 0; i < 4; ++i) {
      picture.chromaticities[2 * i] = static_cast<double>(xy[i].x);
      picture.chromaticities[2 * i + 1] = static_cast<double>(xy[i].y);
    }
  }
  for (int i = 0; i < input.parts(); ++i) picture.parts.push_back(read_part(path, input, i));
  return picture;
}

const std::vector<float> *find_channel(const ExrPart &part, const std::string &name) {
  const auto found = part.channels.find(name);
  return found == part.channels.end() ? nullptr : &found->second;
}

/// The three named channels side by side, or an empty picture.
RgbImage interleave(const ExrPart &part, const std::array<std::string, 3> &names) {
  RgbImage image{part.width, part.height, {}};
  const std::vector<float> *channels[3];
  for (std::size_t c = 0; c < 3; ++c)
    if (!(channels[c] = find_channel(part, names[c]))) return image;
  image.rgb.resize(3 * image.pixels());
  for (std::size_t p = 0; p < image.pixels(); ++p)
    for (std::size_t c = 0; c < 3; ++c) image.rgb[3 * p + c] = (*channels[c])[p];
  return image;
}

/// XYZ of RGB with the file's own primaries, white (1,1,1) at Y = 1.
Imath::M44f file_rgb_to_xyz(const std::array<double, 8> &c) {
  const auto xy = [&c](std::size_t i) {
    return Imath::V2f(static_cast<float>(c[2 * i]), static_cast<float>(c[2 * i + 1]));
  };
  return Imf::RGBtoXYZ(Imf::Chromaticities(xy(0), xy(1), xy(2), xy(3)), 1.0F);
}

template <class Change>
void change_pixels(RgbImage &image, Change &&change) {
  for (std::size_t p = 0; p < image.pixels(); ++p) image.set_pixel(p, change(image.pixel(p)));
}

}  // namespace

std::optional<double> spectral_channel_wavelength_nm(const std::string &channel) {
  if (channel.rfind("S0.", 0) != 0) return std::nullopt;
  std::string text = channel.substr(3);
  std::replace(text.begin(), text.end(), ',', '.');
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !(value > 0)) return std::nullopt;
  const std::string unit = text.substr(static_cast<std::size_t>(end - text.data()));
  const std::pair<const char *, double> lengths_nm[] = {{"nm", 1}, {"um", 1e3}, {"mm", 1e6}, {"m", 1e9}};
  for (const auto &[name, scale] : lengths_nm)
    if (unit == name) return value * scale;
  const std::pair<const char *, double> frequencies_Hz[] = {{"Hz", 1}, {"GHz", 1e9}, {"THz", 1e12}, {"PHz", 1e15}};
  for (const auto &[name, scale] : frequencies_Hz)
    if (unit == name) return 299'792'458.0 * 1e9 / (value * scale);
  return std::nullopt;
}

ExrPicture read_exr(const fs::path &path) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw complaint(path, "expected an EXR file, found no such file");
  if (!fs::is_regular_file(status)) throw complaint(path, "expected an EXR file, found a folder or device");
  try {
    return read_whole(path);
  } catch (const Error &) {
    throw;
  } catch (const std::exception &problem) {
    throw complaint(path, std::string("not a readable EXR file (") + problem.what() + ")");
  }
}

bool ExrPicture::has_spectra() const {
  return std::any_of(parts.at(0).channels.begin(), parts.at(0).channels.end(),
                     [](const auto &channel) { return spectral_channel_wavelength_nm(channel.first).has_value(); });
}

SpectralImage ExrPicture::spectral() const {
  const ExrPart &part = parts.at(0);
  std::map<double, const std::vector<float> *> by_wavelength;
  for (const auto &[name, values] : part.channels)
    if (const auto wavelength_nm = spectral_channel_wavelength_nm(name)) by_wavelength[*wavelength_nm] = &values;
  if (by_wavelength.empty()) throw complaint(file, "expected spectral channels such as S0.550,000000nm, found none");
  SpectralImage image;
  image.width = part.width;
  image.height = part.height;
  image.radiance.resize(image.pixels() * by_wavelength.size());
  std::size_t i = 0;
  for (const auto &[wavelength_nm, values] : by_wavelength) {
    image.wavelength_nm.push_back(wavelength_nm);
    for (std::size_t p = 0; p < image.pixels(); ++p) image.radiance[p * by_wavelength.size() + i] = (*values)[p];
    ++i;
  }
  for (std::size_t k = 1; k < parts.size(); ++k)
    if (parts[k].channels.size() == 1 && parts[k].width == image.width && parts[k].height == image.height)
      image.channels[parts[k].name] = parts[k].channels.begin()->second;
  return image;
}

RgbImage ExrPicture::rgb() const {
  const ExrPart &part = parts.at(0);
  const double white = white_luminance_cd_m2.value_or(1.0);
  RgbImage image = interleave(part, {"R", "G", "B"});
  if (!image.rgb.empty()) {
    const std::array<double, 8> rec709 = ExrPicture{}.chromaticities;
    const bool is_rec709 = std::equal(rec709.begin(), rec709.end(), chromaticities.begin(),
                                      [](double a, double b) { return std::abs(a - b) < 1e-5; });
    if (is_rec709 && white == 1.0) return image;  // bit for bit
    const Imath::M44f to_xyz = file_rgb_to_xyz(chromaticities);
    change_pixels(image, [&](Rgb value) {
      for (double &channel : value) channel *= white;
      if (is_rec709) return value;
      const Imath::V3d xyz = Imath::V3d(value[0], value[1], value[2]) * Imath::M44d(to_xyz);
      return rgb_from_xyz({xyz.x, xyz.y, xyz.z});
    });
    return image;
  }
  image = interleave(part, {"X", "Y", "Z"});
  if (!image.rgb.empty()) {
    change_pixels(image, [&](const Xyz &value) {
      return rgb_from_xyz({white * value[0], white * value[1], white * value[2]});
    });
    return image;
  }
  if (has_spectra()) return rgb_from_spectral(spectral());
  image = interleave(part, {"Y", "Y", "Y"});
  if (image.rgb.empty()) throw complaint(file, "expected channels R,G,B or X,Y,Z or spectra, found none of them");
  change_pixels(image, [&](const Rgb &value) { return Rgb{white * value[0], white * value[1], white * value[2]}; });
  return image;
}

}  // namespace greenray
