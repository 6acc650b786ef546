#include "vision/cones.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "image/colour.hpp"
#include "support/csv_table.hpp"
#include "support/cubic_rows.hpp"

namespace greenray::vision {

namespace {

constexpr int first_nm = 390, last_nm = 780;
constexpr double scotopic_efficacy_lm_W = 1700.06;

/// Every whole nanometre from 390 to 780.
struct PigmentTable {
  std::array<std::vector<double>, 3> density;  // D A: of the unbleached pigment
  std::vector<double> passed_nm;               // transmittance of macula and lens x wavelength: energy to quanta
};

std::vector<double> at_whole_nm(const CsvTable &csv, const std::string &column) {
  const double start_nm = csv.column("nm").front(), step_nm = csv.column("nm").at(1) - start_nm;
  std::vector<double> values;
  for (int nm = first_nm; nm <= last_nm; ++nm)
    values.push_back(std::max(0.0, cubic_between_rows(csv.column(column), (nm - start_nm) / step_nm)));
  return values;
}

PigmentTable load_pigments() {
  const CsvTable csv = CsvTable::embedded("host/data/cone_photopigment_cie170_5nm.csv");
  const double field_deg = 2;
  const double bulk = std::exp(-field_deg / 1.333);
  const double peak_density[3] = {0.38 + 0.54 * bulk, 0.38 + 0.54 * bulk, 0.30 + 0.45 * bulk};
  const double macula_density = 0.485 * std::exp(-field_deg / 6.132);
  PigmentTable table;
  const char *names[3] = {"A_L", "A_M", "A_S"};
  for (std::size_t i = 0; i < 3; ++i) {
    table.density[i] = at_whole_nm(csv, names[i]);
    for (double &value : table.density[i]) value *= peak_density[i];
  }
  const std::vector<double> macula = at_whole_nm(csv, "macula_rel"), lens1 = at_whole_nm(csv, "lens1"),
                            lens2 = at_whole_nm(csv, "lens2");
  for (std::size_t k = 0; k < macula.size(); ++k)
    table.passed_nm.push_back(std::pow(10.0, -macula_density * macula[k] - lens1[k] - lens2[k]) *
                              (first_nm + static_cast<double>(k)));
  return table;
}

const PigmentTable &pigments() {
  static const PigmentTable table = load_pigments();
  return table;
}

double between(const std::vector<double> &rows, double position) {
  const auto below = std::min(static_cast<std::size_t>(position), rows.size() - 2);
  const double t = position - static_cast<double>(below);
  return rows[below] + t * (rows[below + 1] - rows[below]);
}

double scotopic_efficiency(double wavelength_nm) {
  static const CsvTable csv = CsvTable::embedded("host/data/cie1951_scotopic_vprime_5nm.csv");
  const std::vector<double> &nm = csv.column("nm");
  if (!(wavelength_nm >= nm.front() && wavelength_nm <= nm.back())) return 0;
  return std::max(0.0, cubic_between_rows(csv.column("Vp"), (wavelength_nm - nm.front()) / (nm[1] - nm[0])));
}

/// Integral of the light's straight lines times a smooth function: Simpson on pieces of at most 1 nm, cut at samples.
double integrate(const Spectrum &light, const std::function<double(double)> &weight) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < light.wavelength_nm.size(); ++i) {
    const double from = light.wavelength_nm[i], width = light.wavelength_nm[i + 1] - from;
    const double slope = (light.radiance[i + 1] - light.radiance[i]) / width;
    const auto pieces = static_cast<int>(std::ceil(width));
    const double step = width / pieces;
    for (int k = 0; k < pieces; ++k) {
      const double left = k * step, right = left + step, middle = 0.5 * (left + right);
      const auto value = [&](double at) { return (light.radiance[i] + slope * at) * weight(from + at); };
      sum += step / 6 * (value(left) + 4 * value(middle) + value(right));
    }
  }
  return sum;
}

double photopic_integral(const Spectrum &light) {
  return integrate(light, [](double nm) { return colour_matching(nm)[1]; });
}

/// (2 c_L(560) + c_M(560)) / (3 V(560))
double reference_catch() {
  static const double value = (2 * cone_sensitivity(0, 560) + cone_sensitivity(1, 560)) / (3 * colour_matching(560)[1]);
  return value;
}

double peak_sensitivity(std::size_t cone) {
  double peak = 0;
  for (int nm = first_nm; nm <= last_nm; ++nm) peak = std::max(peak, cone_sensitivity(cone, nm));
  return peak;
}

constexpr double xyz_of_lms[3][3] = {
    {1.94735469, -1.41445123, 0.36476327}, {0.68990272, 0.34832189, 0.0}, {0.0, 0.0, 1.93485343}};

std::optional<double> wavelength_of_ratio(double l_over_m) {
  constexpr double from_nm = 475, to_nm = 690;
  const auto ratio = [](double nm) { return cone_sensitivity(0, nm) / cone_sensitivity(1, nm); };
  if (!(l_over_m >= ratio(from_nm) && l_over_m <= ratio(to_nm))) return std::nullopt;
  double low = from_nm, high = to_nm;  // the ratio rises all the way
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (ratio(middle) < l_over_m ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

void check_spectrum(const Spectrum &light) {
  const std::vector<double> &nm = light.wavelength_nm;
  if (nm.size() < 2 || nm.size() != light.radiance.size())
    throw std::domain_error("expected a spectrum of two samples or more");
  if (std::adjacent_find(nm.begin(), nm.end(), std::greater_equal<>()) != nm.end())
    throw std::domain_error("expected wavelengths that ascend");
  for (const double value : light.radiance)
    if (!(value >= 0) || std::isinf(value)) throw std::domain_error("expected radiances that are finite and 0 or more");
  if (!(photopic_integral(light) > 0)) throw std::domain_error("expected some light between 390 and 780 nm");
}

double luminance_cd_m2(const Spectrum &light) { return luminous_efficacy_lm_W * photopic_integral(light); }

double scotopic_luminance_cd_m2(const Spectrum &light) {
  return scotopic_efficacy_lm_W * integrate(light, scotopic_efficiency);
}

std::vector<double> scotopic_weights(const std::vector<double> &wavelength_nm) {
  const std::size_t count = wavelength_nm.size();
  std::vector<double> weights(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    Spectrum hat;  // 1 at this sample, 0 at its neighbours
    for (std::size_t k = i == 0 ? 0 : i - 1; k < std::min(count, i + 2); ++k) {
      hat.wavelength_nm.push_back(wavelength_nm[k]);
      hat.radiance.push_back(k == i ? 1.0 : 0.0);
    }
    weights[i] = scotopic_luminance_cd_m2(hat);
  }
  return weights;
}

double cone_sensitivity(std::size_t cone, double wavelength_nm, double unbleached) {
  const double position = wavelength_nm - first_nm;
  if (!(position >= 0 && position <= last_nm - first_nm)) return 0;
  const PigmentTable &table = pigments();
  const double density = unbleached * between(table.density.at(cone), position);
  return -std::expm1(-std::numbers::ln10 * density) * between(table.passed_nm, position);
}

Lms cone_catches(const Spectrum &light, const Lms &unbleached) {
  Lms catches{};
  for (std::size_t i = 0; i < 3; ++i)
    catches[i] = integrate(light, [&](double nm) { return cone_sensitivity(i, nm, unbleached[i]); });
  return catches;
}

Lms cone_trolands(const Spectrum &light, double td) {
  Lms result = cone_catches(light);
  const double scale = td / (photopic_integral(light) * reference_catch());
  for (double &value : result) value *= scale;
  return result;
}

const Lms &cone_troland_factors() {
  static const Lms factors{peak_sensitivity(0) / reference_catch(), peak_sensitivity(1) / reference_catch(),
                           peak_sensitivity(2) / reference_catch()};
  return factors;
}

std::array<double, 3> xyz_from_lms(const Lms &lms) {
  std::array<double, 3> xyz{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) xyz[r] += xyz_of_lms[r][c] * lms[c];
  return xyz;
}

Lms lms_from_xyz(const std::array<double, 3> &xyz) {
  const auto &m = xyz_of_lms;
  const double s = xyz[2] / m[2][2];
  const double x = xyz[0] - m[0][2] * s, determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  return {(m[1][1] * x - m[0][1] * xyz[1]) / determinant, (m[0][0] * xyz[1] - m[1][0] * x) / determinant, s};
}

std::optional<double> equivalent_wavelength_nm(const Lms &response) {
  return response[1] > 0 ? wavelength_of_ratio(response[0] / response[1]) : std::nullopt;
}

std::optional<double> equivalent_wavelength_of_peak_one(const Lms &lms) {
  const Lms &factor = cone_troland_factors();
  return equivalent_wavelength_nm({lms[0] * factor[0], lms[1] * factor[1], lms[2]});
}

}  // namespace greenray::vision
