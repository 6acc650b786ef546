#include "image/picture_source.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "image/colour.hpp"
#include "support/error.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

class RgbSource : public PictureSource {
 public:
  RgbSource(const RgbImage &image, std::optional<double> fov_deg) : image_(image) {
    facts_.name = "picture";
    facts_.width = image.width, facts_.height = image.height;
    facts_.fov_deg = fov_deg;
  }
  void read(int first, int rows, std::vector<float> &planes) override {
    const std::size_t count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(image_.width);
    const std::size_t begin = static_cast<std::size_t>(first) * static_cast<std::size_t>(image_.width);
    planes.resize(3 * count);
    const float *from = image_.rgb.data() + 3 * begin;
    for (std::size_t c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < count; ++i) planes[c * count + i] = from[3 * i + c];
    static const Matrix3 to_xyz = [] {
      Matrix3 m{};
      for (std::size_t c = 0; c < 3; ++c) {
        Rgb unit{0, 0, 0};
        unit[c] = 1;
        for (std::size_t r = 0; r < 3; ++r) m[r][c] = xyz_from_rgb(unit)[r];
      }
      return m;
    }();
    transform_planes(to_xyz, planes);
  }

 private:
  const RgbImage &image_;
};

class SpectralSource : public PictureSource {
 public:
  SpectralSource(const SpectralImage &image, std::optional<double> fov_deg) : image_(image) {
    facts_.name = "picture";
    facts_.width = image.width, facts_.height = image.height;
    facts_.wavelength_nm = image.wavelength_nm;
    facts_.fov_deg = fov_deg;
  }
  void read(int first, int rows, std::vector<float> &planes) override {
    const std::size_t bands = image_.wavelength_nm.size();
    const std::size_t count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(image_.width);
    const float *from =
        image_.radiance.data() + bands * static_cast<std::size_t>(first) * static_cast<std::size_t>(image_.width);
    planes.resize(bands * count);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < bands; ++k) planes[k * count + i] = from[i * bands + k];
  }

 private:
  const SpectralImage &image_;
};

Rgb rgb_of_spectrum(const SpectralWeights &weights, const std::vector<float> &planes, std::size_t count,
                    std::size_t i) {
  Xyz xyz{0, 0, 0};
  for (std::size_t k = 0; k < weights.x.size(); ++k) {
    const auto radiance = static_cast<double>(planes[k * count + i]);
    xyz[0] += weights.x[k] * radiance, xyz[1] += weights.y[k] * radiance, xyz[2] += weights.z[k] * radiance;
  }
  return rgb_from_xyz(xyz);
}

/// More light than a number can tell, in any of three channels; the others are numbers.
bool is_infinite_light(double x, double y, double z) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double least = std::min({x, y, z}), most = std::max({x, y, z});
  return most == infinity && least > -infinity && !std::isnan(x) && !std::isnan(y) && !std::isnan(z);
}

}  // namespace

std::unique_ptr<PictureSource> picture_source(const RgbImage &image, std::optional<double> fov_deg) {
  return std::make_unique<RgbSource>(image, fov_deg);
}

std::unique_ptr<PictureSource> picture_source(const SpectralImage &image, std::optional<double> fov_deg) {
  return std::make_unique<SpectralSource>(image, fov_deg);
}

std::unique_ptr<PictureSource> open_picture(const fs::path &path, const SourceOptions &options) {
  const SourcePlace place{path.string(), 1, 1};
  std::error_code error;
  if (!fs::exists(path, error)) throw InputError(place, "expected a picture, found no such file");
  if (!fs::is_regular_file(path, error)) throw InputError(place, "expected a picture, found a folder or device");
  unsigned char magic[4] = {};
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> stream(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!stream) throw InputError(place, "expected a picture, found a file that cannot be read");
  if (std::fread(magic, 1, 4, stream.get()) != 4)
    throw InputError(place,
                     "expected an EXR or Radiance picture, found " +
                         std::string(fs::file_size(path, error) == 0 ? "an empty file" : "another kind of file"));
  if (magic[0] == 0x76 && magic[1] == 0x2f && magic[2] == 0x31 && magic[3] == 0x01) return open_exr(path, options);
  if (magic[0] == '#' && magic[1] == '?') return open_radiance(path, options);
  throw InputError(place, "not a readable EXR file (nor a Radiance picture): its first bytes are of another kind");
}

std::vector<float> read_rgb_rows(PictureSource &source, int first, int rows) {
  const PictureFacts &facts = source.facts();
  const SpectralWeights weights =
      facts.wavelength_nm.size() > 1 ? spectral_weights(facts.wavelength_nm) : SpectralWeights{};
  std::vector<float> planes;
  source.read(first, rows, planes);
  const std::size_t count = static_cast<std::size_t>(rows) * static_cast<std::size_t>(facts.width);
  std::vector<float> rgb(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    if (facts.rec709) {
      for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = planes[c * count + i];
      continue;
    }
    const Rgb colour = facts.spectral()
                           ? rgb_of_spectrum(weights, planes, count, i)
                           : rgb_from_xyz({static_cast<double>(planes[i]), static_cast<double>(planes[count + i]),
                                           static_cast<double>(planes[2 * count + i])});
    for (std::size_t c = 0; c < 3; ++c) rgb[3 * i + c] = static_cast<float>(colour[c]);
  }
  return rgb;
}

RgbImage read_rgb(PictureSource &source) {
  const PictureFacts &facts = source.facts();
  RgbImage image{facts.width, facts.height, std::vector<float>(3 * facts.pixels())};
  for_pieces(static_cast<std::size_t>(facts.height), 64, host_threads(), [&](std::size_t first, std::size_t last) {
    const std::vector<float> rgb = read_rgb_rows(source, static_cast<int>(first), static_cast<int>(last - first));
    std::copy(rgb.begin(), rgb.end(),
              image.rgb.begin() + static_cast<std::ptrdiff_t>(3 * first * static_cast<std::size_t>(facts.width)));
  });
  return image;
}

Matrix3 xyz_of_primaries(const std::array<double, 8> &c) {
  Matrix3 columns{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = c[2 * i], y = c[2 * i + 1];
    columns[0][i] = x, columns[1][i] = y, columns[2][i] = 1 - x - y;
  }
  const std::array<double, 3> white{c[6] / c[7], 1, (1 - c[6] - c[7]) / c[7]};
  const auto determinant = [](const Matrix3 &m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  };
  const double whole = determinant(columns);
  Matrix3 result = columns;
  for (std::size_t i = 0; i < 3; ++i) {  // Cramer: how much of each primary makes the white
    Matrix3 replaced = columns;
    for (std::size_t r = 0; r < 3; ++r) replaced[r][i] = white[r];
    const double amount = determinant(replaced) / whole;
    for (std::size_t r = 0; r < 3; ++r) result[r][i] *= amount;
  }
  return result;
}

void transform_planes(const Matrix3 &m, std::vector<float> &planes) {
  const std::size_t count = planes.size() / 3;
  float *a = planes.data(), *b = a + count, *c = b + count;
  const bool only_scales = m[0][1] == 0 && m[0][2] == 0 && m[1][0] == 0 && m[1][2] == 0 && m[2][0] == 0 && m[2][1] == 0;
  if (only_scales) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      for (std::size_t i = 0; i < count; ++i) {
        float &value = planes[channel * count + i];
        value = static_cast<float>(m[channel][channel] * static_cast<double>(value));
      }
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double x = static_cast<double>(a[i]), y = static_cast<double>(b[i]), z = static_cast<double>(c[i]);
    if (is_infinite_light(x, y, z)) {  // 0 x infinity would be NaN
      a[i] = b[i] = c[i] = std::numeric_limits<float>::infinity();
      continue;
    }
    a[i] = static_cast<float>(m[0][0] * x + m[0][1] * y + m[0][2] * z);
    b[i] = static_cast<float>(m[1][0] * x + m[1][1] * y + m[1][2] * z);
    c[i] = static_cast<float>(m[2][0] * x + m[2][1] * y + m[2][2] * z);
  }
}

}  // namespace greenray
