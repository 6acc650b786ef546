#include "image/colour.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "support/csv_table.hpp"
#include "support/cubic_rows.hpp"

namespace greenray {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

std::array<double, 3> times(const Matrix &m, const std::array<double, 3> &v) {
  std::array<double, 3> result{};
  for (std::size_t r = 0; r < 3; ++r) result[r] = m[r][0] * v[0] + m[r][1] * v[1] + m[r][2] * v[2];
  return result;
}

Matrix inverse(const Matrix &m) {
  Matrix adjugate{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
      adjugate[r][c] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
    }
  const double determinant = m[0][0] * adjugate[0][0] + m[0][1] * adjugate[1][0] + m[0][2] * adjugate[2][0];
  for (auto &row : adjugate)
    for (double &value : row) value /= determinant;
  return adjugate;
}

/// Columns are the XYZ of the primaries, scaled so that they add up to a white of Y = 1.
Matrix rec709_to_xyz() {
  constexpr double x[3] = {0.64, 0.30, 0.15}, y[3] = {0.33, 0.60, 0.06};
  constexpr double white_x = 0.3127, white_y = 0.3290;
  Matrix m{};
  for (std::size_t c = 0; c < 3; ++c) {
    m[0][c] = x[c] / y[c];
    m[1][c] = 1.0;
    m[2][c] = (1.0 - x[c] - y[c]) / y[c];
  }
  const Xyz scale = times(inverse(m), {white_x / white_y, 1.0, (1.0 - white_x - white_y) / white_y});
  for (auto &row : m)
    for (std::size_t c = 0; c < 3; ++c) row[c] *= scale[c];
  return m;
}

const Matrix &xyz_matrix() {
  static const Matrix matrix = rec709_to_xyz();
  return matrix;
}

const Matrix &rgb_matrix() {
  static const Matrix matrix = inverse(xyz_matrix());
  return matrix;
}

/// Colour matching functions at every whole nanometre.
struct MatchingTable {
  int first_nm = 0;
  std::vector<Xyz> xyz;
};

MatchingTable load_matching(ColourMatching observer) {
  const bool is_1931 = observer == ColourMatching::cie1931;
  const CsvTable csv =
      CsvTable::embedded(is_1931 ? "host/data/cie1931_2deg_xyz_5nm.csv" : "host/data/cie2015_2deg_xyz_5nm.csv");
  const std::array<std::string, 3> names =
      is_1931 ? std::array<std::string, 3>{"x", "y", "z"} : std::array<std::string, 3>{"xF", "yF", "zF"};
  const std::vector<double> &nm = csv.column("nm");
  const double step_nm = nm.at(1) - nm.at(0);
  MatchingTable table;
  table.first_nm = static_cast<int>(std::lround(nm.front()));
  const int count = static_cast<int>(std::lround(nm.back())) - table.first_nm + 1;
  for (int i = 0; i < count; ++i) {
    Xyz value{};
    for (std::size_t c = 0; c < 3; ++c) value[c] = std::max(0.0, cubic_between_rows(csv.column(names[c]), i / step_nm));
    table.xyz.push_back(value);
  }
  return table;
}

const MatchingTable &matching(ColourMatching observer) {
  static const MatchingTable cie1931 = load_matching(ColourMatching::cie1931);
  static const MatchingTable cie2015 = load_matching(ColourMatching::cie2015);
  return observer == ColourMatching::cie1931 ? cie1931 : cie2015;
}

Xyz at(const MatchingTable &table, double wavelength_nm) {
  const double position = wavelength_nm - table.first_nm;
  if (!(position >= 0) || position > static_cast<double>(table.xyz.size() - 1)) return {0, 0, 0};
  const auto below = std::min(static_cast<std::size_t>(position), table.xyz.size() - 2);
  const double fraction = position - static_cast<double>(below);
  Xyz value{};
  for (std::size_t c = 0; c < 3; ++c)
    value[c] = (1 - fraction) * table.xyz[below][c] + fraction * table.xyz[below + 1][c];
  return value;
}

/// Adds integral over [a,b] of matching function x each of the two hats that meet there; whole nanometres only inside
/// steps, where the product of two straight lines is a parabola: Simpson's rule is exact.
void add_segment(const MatchingTable &table, double a, double b, Xyz &falling, Xyz &rising) {
  const double table_end = table.first_nm + static_cast<double>(table.xyz.size() - 1);
  const double end = std::min(b, table_end);
  for (double from = std::max(a, static_cast<double>(table.first_nm)); from < end;) {
    const double to = std::min(std::floor(from) + 1.0, end);
    const double middle = 0.5 * (from + to), width = to - from;
    const double at_nm[3] = {from, middle, to}, simpson[3] = {width / 6, 4 * width / 6, width / 6};
    for (int k = 0; k < 3; ++k) {
      const Xyz value = at(table, at_nm[k]);
      const double up = (at_nm[k] - a) / (b - a);
      for (std::size_t c = 0; c < 3; ++c) {
        rising[c] += simpson[k] * up * value[c];
        falling[c] += simpson[k] * (1 - up) * value[c];
      }
    }
    from = to;
  }
}

constexpr Matrix oklab_lms_from_rgb = {{{0.4122214708, 0.5363325363, 0.0514459929},
                                        {0.2119034982, 0.6806995451, 0.1073969566},
                                        {0.0883024619, 0.2817188376, 0.6299787005}}};
constexpr Matrix oklab_from_cone_roots = {{{0.2104542553, 0.7936177850, -0.0040720468},
                                           {1.9779984951, -2.4285922050, 0.4505937099},
                                           {0.0259040371, 0.7827717662, -0.8086757660}}};

}  // namespace

Xyz colour_matching(double wavelength_nm, ColourMatching observer) { return at(matching(observer), wavelength_nm); }

SpectralWeights spectral_weights(const std::vector<double> &wavelength_nm, ColourMatching observer) {
  const std::size_t count = wavelength_nm.size();
  if (count < 2) throw std::domain_error("spectral weights need at least two wavelengths");
  if (std::adjacent_find(wavelength_nm.begin(), wavelength_nm.end(), std::greater_equal<>()) != wavelength_nm.end())
    throw std::domain_error("spectral weights need ascending wavelengths");
  const MatchingTable &table = matching(observer);
  std::vector<Xyz> integrals(count, Xyz{0, 0, 0});
  for (std::size_t i = 0; i + 1 < count; ++i)
    add_segment(table, wavelength_nm[i], wavelength_nm[i + 1], integrals[i], integrals[i + 1]);
  SpectralWeights weights;
  for (const Xyz &integral : integrals) {
    weights.x.push_back(luminous_efficacy_lm_W * integral[0]);
    weights.y.push_back(luminous_efficacy_lm_W * integral[1]);
    weights.z.push_back(luminous_efficacy_lm_W * integral[2]);
  }
  return weights;
}

/// One wavelength has no colour: grey, with the luminance of a band 1 nm wide.
static RgbImage grey_from_single_wavelength(const SpectralImage &image, ColourMatching observer) {
  const double weight = luminous_efficacy_lm_W * colour_matching(image.wavelength_nm.front(), observer)[1];
  RgbImage grey{image.width, image.height, std::vector<float>(3 * image.pixels())};
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const double luminance = weight * static_cast<double>(image.radiance[p]);
    grey.set_pixel(p, {luminance, luminance, luminance});
  }
  return grey;
}

RgbImage rgb_from_spectral(const SpectralImage &image, ColourMatching observer) {
  if (image.wavelength_nm.size() == 1) return grey_from_single_wavelength(image, observer);
  const SpectralWeights weights = spectral_weights(image.wavelength_nm, observer);
  const std::size_t count = image.wavelength_nm.size();
  RgbImage result{image.width, image.height, std::vector<float>(3 * image.pixels())};
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const float *spectrum = image.radiance.data() + p * count;
    Xyz xyz{0, 0, 0};
    for (std::size_t i = 0; i < count; ++i) {
      const auto radiance = static_cast<double>(spectrum[i]);
      xyz[0] += weights.x[i] * radiance;
      xyz[1] += weights.y[i] * radiance;
      xyz[2] += weights.z[i] * radiance;
    }
    result.set_pixel(p, rgb_from_xyz(xyz));
  }
  return result;
}

std::vector<float> luminance_cd_m2(const SpectralImage &image) {
  const std::vector<double> weights = spectral_weights(image.wavelength_nm).y;
  std::vector<float> result(image.pixels());
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i)
      sum += weights[i] * static_cast<double>(image.radiance[p * weights.size() + i]);
    result[p] = static_cast<float>(sum);
  }
  return result;
}

Xyz xyz_from_rgb(const Rgb &rgb) { return times(xyz_matrix(), rgb); }

Rgb rgb_from_xyz(const Xyz &xyz) { return times(rgb_matrix(), xyz); }

double luminance(const Rgb &rgb) { return xyz_from_rgb(rgb)[1]; }

double srgb_encode(double linear) {
  if (linear < 0) return -srgb_encode(-linear);
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double srgb_decode(double encoded) {
  if (encoded < 0) return -srgb_decode(-encoded);
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

std::array<double, 3> ok_cones_from_rgb(const Rgb &rgb) { return times(oklab_lms_from_rgb, rgb); }

Rgb ok_rgb_from_cones(const std::array<double, 3> &cones) {
  static const Matrix rgb_from_lms = inverse(oklab_lms_from_rgb);
  return times(rgb_from_lms, cones);
}

OkLab ok_lab_from_roots(const std::array<double, 3> &roots) { return times(oklab_from_cone_roots, roots); }

std::array<double, 3> ok_roots_from_lab(const OkLab &lab) {
  static const Matrix roots_from_oklab = inverse(oklab_from_cone_roots);
  return times(roots_from_oklab, lab);
}

OkLab oklab_from_rgb(const Rgb &rgb) {
  std::array<double, 3> cones = ok_cones_from_rgb(rgb);
  for (double &cone : cones) cone = std::cbrt(cone);
  return ok_lab_from_roots(cones);
}

Rgb rgb_from_oklab(const OkLab &lab) {
  std::array<double, 3> cones = ok_roots_from_lab(lab);
  for (double &cone : cones) cone = cone * cone * cone;
  return ok_rgb_from_cones(cones);
}

bool map_into_gamut(Rgb &rgb) {
  const auto inside = [](const Rgb &c, double slack) {
    return std::all_of(c.begin(), c.end(), [slack](double v) { return v >= -slack && v <= 1 + slack; });
  };
  const bool moves = !inside(rgb, 1e-6);
  if (moves) {
    const OkLab lab = oklab_from_rgb(rgb);
    const double lightness = std::clamp(lab[0], 0.0, 1.0);
    const auto with_chroma = [&](double scale) { return rgb_from_oklab({lightness, scale * lab[1], scale * lab[2]}); };
    double kept = 0, refused = 1;
    for (int i = 0; i < 30; ++i) {
      const double scale = 0.5 * (kept + refused);
      (inside(with_chroma(scale), 1e-7) ? kept : refused) = scale;
    }
    rgb = with_chroma(kept);
  }
  for (double &channel : rgb) channel = std::clamp(channel, 0.0, 1.0);
  return moves;
}

}  // namespace greenray
