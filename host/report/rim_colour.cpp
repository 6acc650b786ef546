#include "report/rim_colour.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "atmosphere/diagnosis.hpp"
#include "image/colour.hpp"
#include "vision/bleaching.hpp"
#include "vision/cones.hpp"
#include "vision/pupil.hpp"

namespace greenray {
namespace {

using vision::Lms;
constexpr int above = 8, below = 24;  // rows shown

std::array<double, 2> uv_of(const Xyz &xyz) {
  const double sum = xyz[0] + 15 * xyz[1] + 3 * xyz[2];
  return sum > 0 ? std::array<double, 2>{4 * xyz[0] / sum, 9 * xyz[1] / sum} : std::array<double, 2>{0, 0};
}

Xyz xyz_of(const std::vector<double> &radiance, const SpectralWeights &weights) {
  Xyz xyz{};
  for (std::size_t w = 0; w < radiance.size(); ++w)
    xyz[0] += radiance[w] * weights.x[w], xyz[1] += radiance[w] * weights.y[w], xyz[2] += radiance[w] * weights.z[w];
  return xyz;
}

std::vector<double> spectrum_at(const SpectralImage &image, int column, int row) {
  const std::size_t waves = image.wavelength_nm.size();
  const std::size_t at =
      (static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(column)) *
      waves;
  return {image.radiance.begin() + static_cast<std::ptrdiff_t>(at),
          image.radiance.begin() + static_cast<std::ptrdiff_t>(at + waves)};
}

/// Left after looking at the disk: its own light, through a pupil open to 60 square degrees of it at most.
Lms unbleached_by(const vision::Spectrum &disk, double luminance_cd_m2, double seconds) {
  const double pupil_mm = vision::pupil_diameter_mm(vision::PupilModel::watson_yellott, {luminance_cd_m2, 0.2});
  const Lms td = vision::cone_trolands(disk, vision::trolands(luminance_cd_m2, pupil_mm));
  Lms left{};
  for (std::size_t i = 0; i < 3; ++i)
    left[i] = std::isfinite(seconds) ? vision::unbleached_after(1, td[i], seconds) : vision::steady_unbleached(td[i]);
  return left;
}

RimPoint point_of(const std::vector<double> &radiance, const SpectralWeights &weights, const RimColour &rim) {
  RimPoint p;
  p.radiance = radiance;
  const Xyz xyz = xyz_of(radiance, weights);
  p.luminance_cd_m2 = xyz[1];
  const auto [u, v] = uv_of(xyz);
  p.u = u, p.v = v;
  Lms lms = vision::lms_from_xyz(xyz);
  p.looks_like_nm = vision::equivalent_wavelength_of_peak_one(lms);
  for (std::size_t i = 0; i < 3; ++i) lms[i] *= rim.unbleached[i];
  p.bleached_looks_like_nm = vision::equivalent_wavelength_of_peak_one(lms);
  const auto [bu, bv] = uv_of(vision::xyz_from_lms(lms));
  p.bleached_u = bu, p.bleached_v = bv;
  return p;
}

}  // namespace

std::optional<RimColour> rim_colour(const SpectralImage &image, double pixel_arcsec, double seconds) {
  if (image.wavelength_nm.size() < 2 || image.height < 4) return std::nullopt;
  const std::vector<float> light = luminance_cd_m2(image);
  const auto at = [&](int x, int y) {
    return static_cast<double>(
        light[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)]);
  };
  RimColour rim;
  double most = 0;
  for (int x = 0; x < image.width; ++x) {
    double sum = 0;
    for (int y = 0; y < image.height; ++y) sum += at(x, y);
    if (sum > most) most = sum, rim.column = x;
  }
  int brightest = 0;
  for (int y = 0; y < image.height; ++y)
    if (at(rim.column, y) > at(rim.column, brightest)) brightest = y;
  const double disk = at(rim.column, brightest);
  if (!(disk > 4 * at(rim.column, 0)) || !(disk > 0)) return std::nullopt;
  while (rim.row < brightest && at(rim.column, rim.row) < 0.25 * disk) ++rim.row;
  rim.wavelength_nm = image.wavelength_nm;
  rim.seconds = seconds;
  const std::vector<double> disk_light = spectrum_at(image, rim.column, brightest);
  rim.unbleached = unbleached_by({image.wavelength_nm, disk_light}, disk, seconds);
  const SpectralWeights weights = spectral_weights(image.wavelength_nm);
  for (int y = std::max(0, rim.row - above); y < std::min(image.height, rim.row + below); ++y) {
    RimPoint p = point_of(spectrum_at(image, rim.column, y), weights, rim);
    p.above_rim_arcsec = (rim.row - y) * pixel_arcsec;
    rim.points.push_back(std::move(p));
  }
  return rim;
}

nlohmann::json rim_json(const RimColour &rim) {
  using Json = nlohmann::json;
  const auto optional = [](const std::optional<double> &v) { return v ? Json(*v) : Json(); };
  Json points = Json::array();
  for (const RimPoint &p : rim.points)
    points.push_back({{"above_rim_arcsec", p.above_rim_arcsec},
                      {"luminance_cd_m2", p.luminance_cd_m2},
                      {"u_prime", p.u},
                      {"v_prime", p.v},
                      {"looks_like_nm", optional(p.looks_like_nm)},
                      {"bleached_u_prime", p.bleached_u},
                      {"bleached_v_prime", p.bleached_v},
                      {"bleached_looks_like_nm", optional(p.bleached_looks_like_nm)},
                      {"radiance_W_m2_sr_nm", p.radiance}});
  return {{"column", rim.column},
          {"row", rim.row},
          {"bleaching_seconds", std::isfinite(rim.seconds) ? Json(rim.seconds) : Json()},
          {"unbleached", {{"L", rim.unbleached[0]}, {"M", rim.unbleached[1]}, {"S", rim.unbleached[2]}}},
          {"wavelength_nm", rim.wavelength_nm},
          {"points", points}};
}

std::vector<Plot> rim_figures(const RimColour &rim) {
  PlotPanel spectra{{"wavelength", "nm"}, {"radiance", "W m⁻² sr⁻¹ nm⁻¹", true}, {}, {}, {}};
  const char *const colours[]{"#6a3d9a", "#1b7f3b", "#c98a00", "#b5382a"};
  const std::size_t n = rim.points.size();
  const std::size_t shown[]{std::min<std::size_t>(above / 2, n - 1), std::min<std::size_t>(above, n - 1),
                            std::min<std::size_t>(above + 4, n - 1), n - 1};
  for (std::size_t k = 0; k < 4; ++k) {
    const RimPoint &p = rim.points[shown[k]];
    PlotLine line{plain_number(p.above_rim_arcsec, 3) + "″", colours[k], rim.wavelength_nm, p.radiance};
    if (k == 0 || shown[k] != shown[k - 1]) spectra.lines.push_back(std::move(line));
  }
  PlotPanel colour{{"above the rim", "arcsec"}, {"looks like one wavelength of", "nm"}, {}, {}, {}};
  PlotLine before{"eye at rest", "#b5382a", {}, {}}, after{"bleached by the disk", "#1b7f3b", {}, {}};
  for (const RimPoint &p : rim.points) {
    before.x.push_back(p.above_rim_arcsec), before.y.push_back(p.looks_like_nm.value_or(std::nan("")));
    after.x.push_back(p.above_rim_arcsec), after.y.push_back(p.bleached_looks_like_nm.value_or(std::nan("")));
  }
  colour.lines = {before, after};
  PlotPanel uv{{"u′", ""}, {"v′", ""}, {}, {}, {}};
  PlotLine rest{"eye at rest", "#b5382a", {}, {}, false, 1.0, PlotMarker::disc},
      bleached{"bleached", "#1b7f3b", {}, {}, false, 1.0, PlotMarker::square};
  for (const RimPoint &p : rim.points) {
    rest.x.push_back(p.u), rest.y.push_back(p.v);
    bleached.x.push_back(p.bleached_u), bleached.y.push_back(p.bleached_v);
  }
  PlotLine white{"D65", "#333333", {0.1978}, {0.4683}, false, 0, PlotMarker::diamond, true};
  uv.lines = {rest, bleached, white};
  Plot plot;
  plot.title = "Down through the Sun’s upper rim";
  plot.subtitle = "spectra at four places, hue by the ratio of L to M cones, CIE 1976 chromaticity";
  plot.panels = {spectra, colour, uv};
  plot.panel_width = 232, plot.panel_height = 260;
  return {plot};
}

}  // namespace greenray
