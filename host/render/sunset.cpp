#include "render/sunset.hpp"

#include <algorithm>
#include <cmath>

#include "image/colour.hpp"
#include "render/solver_choice.hpp"
#include "render/sun_place.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

/// One piece of the curve between two entries, both of the sky.
struct Segment {
  double low_rad, high_rad, true_low_rad, true_high_rad;
};

template <class Visit>
void for_sky(const TransferCurve &curve, std::size_t wave, const Visit &visit) {
  for (std::size_t i = 0; i + 1 < curve.elevation_rad.size(); ++i) {
    const Transfer &a = curve.at(i, wave), &b = curve.at(i + 1, wave);
    if (a.outcome != f64::RAY_SPACE || !curve.joined(i, wave)) continue;
    visit(i, Segment{curve.elevation_rad[i], curve.elevation_rad[i + 1], a.true_altitude_rad, b.true_altitude_rad});
  }
}

/// The part of a segment whose true altitudes lie in low .. high; nothing where it is empty.
std::optional<Segment> within(const Segment &s, double low_rad, double high_rad) {
  const double rise = s.true_high_rad - s.true_low_rad;
  if (rise == 0)
    return s.true_low_rad >= low_rad && s.true_low_rad <= high_rad ? std::optional<Segment>(s) : std::nullopt;
  double from = (low_rad - s.true_low_rad) / rise, to = (high_rad - s.true_low_rad) / rise;
  if (from > to) std::swap(from, to);
  from = std::max(from, 0.0), to = std::min(to, 1.0);
  if (from >= to) return std::nullopt;
  const double width = s.high_rad - s.low_rad;
  return Segment{s.low_rad + from * width, s.low_rad + to * width, s.true_low_rad + from * rise,
                 s.true_low_rad + to * rise};
}

/// Appends a span, or lengthens the last one where they touch.
void join(std::vector<ApparentSpan> &spans, const Segment &s) {
  constexpr double touching_deg = 1e-9;
  const ApparentSpan span{to_deg(s.low_rad), to_deg(s.high_rad)};
  if (!spans.empty() && span.low_deg - spans.back().high_deg < touching_deg) spans.back().high_deg = span.high_deg;
  else spans.push_back(span);
}

/// Follows t(a) through one band and notes where it turns back by more than `least`.
class FoldFinder {
 public:
  explicit FoldFinder(double least_rad) : least_(least_rad) {}

  void begin(double a, double t) { lowest_ = highest_ = {to_deg(a), to_deg(t), false}, way_ = 0; }
  void add(double a, double t) {
    const Fold here{to_deg(a), to_deg(t), false};
    if (here.true_deg > highest_.true_deg) highest_ = here;
    if (here.true_deg < lowest_.true_deg) lowest_ = here;
    if (way_ >= 0 && highest_.true_deg - here.true_deg > to_deg(least_)) turn(-1, highest_, here);
    else if (way_ <= 0 && here.true_deg - lowest_.true_deg > to_deg(least_)) turn(1, lowest_, here);
  }
  std::vector<Fold> take() { return std::move(folds_); }

 private:
  void turn(int way, Fold at, const Fold &here) {
    at.lowest = way > 0;
    if (way_ != 0) folds_.push_back(at);
    way_ = way;
    lowest_ = highest_ = here;
  }
  double least_;
  int way_ = 0;  // 1: t rises, -1: it falls, 0: not known yet
  Fold lowest_{}, highest_{};
  std::vector<Fold> folds_;
};

/// Integral of (1 - s^2)^(k/2) over -1 .. 1.
double chord_moment(int k) { return std::sqrt(pi) * std::tgamma(0.5 * k + 1) / std::tgamma(0.5 * k + 1.5); }

/// Integral of I/I(centre) along the row of a disk of radius 1 that stands sin(phi) above its centre.
double row_light(const std::array<double, 6> &limb, double cos_phi) {
  static const std::array<double, 6> moments = [] {
    std::array<double, 6> m{};
    for (int k = 0; k < 6; ++k) m[static_cast<std::size_t>(k)] = chord_moment(k);
    return m;
  }();
  double sum = 0, power = cos_phi;
  for (std::size_t k = 0; k < limb.size(); ++k, power *= cos_phi) sum += limb[k] * moments[k] * power;
  return sum;
}

/// Light of a segment within the disk, over the radiance of its centre [rad^2]. Four Gauss-Legendre points in phi,
/// where t = centre + radius sin(phi): rows are smooth in it up to the limb.
double segment_light(const Segment &s, const std::array<double, 6> &limb, const TrueSun &sun) {
  constexpr double x[4] = {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526};
  constexpr double weight[4] = {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538};
  const auto phi_of = [&](double t) { return std::asin(std::clamp((t - sun.centre_rad) / sun.radius_rad, -1.0, 1.0)); };
  const double from = phi_of(s.true_low_rad), to = phi_of(s.true_high_rad), width = s.high_rad - s.low_rad;
  if (from == to) return width * sun.radius_rad * row_light(limb, std::cos(from));
  const double half = 0.5 * (to - from), slope = width / (s.true_high_rad - s.true_low_rad);  // da/dt
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const double cos_phi = std::cos(0.5 * (from + to) + half * x[k]);
    sum += weight[k] * row_light(limb, cos_phi) * cos_phi;
  }
  return sum * half * slope * sun.radius_rad * sun.radius_rad;
}

struct Seen {
  double lux;
  bool green;
};

Seen seen_light(const std::vector<double> &irradiance, const SpectralWeights &weights) {
  double x = 0, y = 0, z = 0;
  for (std::size_t w = 0; w < irradiance.size(); ++w) {
    x += weights.x[w] * irradiance[w];
    y += weights.y[w] * irradiance[w];
    z += weights.z[w] * irradiance[w];
  }
  return {y, y > 1.25 * x && y > z};
}

std::size_t row_of(const TransferCurve &curve, double wavelength_nm) {
  const auto &all = curve.wavelength_nm;
  return static_cast<std::size_t>(std::distance(all.begin(), std::find(all.begin(), all.end(), wavelength_nm)));
}

TransferCurve curve_of(const Scene &scene, const std::vector<double> &wavelengths_nm,
                       const std::shared_ptr<Device> &device) {
  constexpr double around_deg = 2;
  const AirSection air(spec_for(scene, {}));
  const SolverChoice choice = choose_solver(air.spec(), "auto", {});
  SkyRayOptions options;
  options.height_m = scene.observer.height_m;
  options.flat = scene.atmosphere.surface == Surface::flat;
  options.precision = Precision::double_;
  options.method = choice.method;
  options.error_arcsec = choice.section ? scene.tracing.table_arcsec : 1e-3;
  options.azimuth_rad = azimuth_from_path_rad(scene);
  options.max_steps = scene.tracing.max_steps;
  options.absorbers = {ozone_peak_m, ozone_width_m, scene.atmosphere.aerosol_scale_height_m};
  const double low = to_rad(std::max(scene.observer.altitude_deg - around_deg, -90.0)),
               high = to_rad(std::min(scene.observer.altitude_deg + around_deg, 90.0));
  SkyRays rays = choice.section ? SkyRays(air, wavelengths_nm, options, device)
                                : SkyRays(air.at(0), wavelengths_nm, options, device);
  // Through a duct that varies the curve folds without end: followed to half an arc-second only.
  return choice.section ? trace_transfer_curve(rays, low, high, 0.5, from_arcsec(0.5))
                        : trace_transfer_curve(rays, low, high, 0.02);
}

}  // namespace

std::vector<ApparentSpan> sky_bands(const TransferCurve &curve, std::size_t wave) {
  std::vector<ApparentSpan> bands;
  for_sky(curve, wave, [&](std::size_t, const Segment &s) { join(bands, s); });
  return bands;
}

std::vector<Fold> folds_of(const TransferCurve &curve, std::size_t wave, double least_arcsec) {
  FoldFinder finder(from_arcsec(least_arcsec));
  double reached_rad = -pi;
  for_sky(curve, wave, [&](std::size_t, const Segment &s) {
    if (s.low_rad != reached_rad) finder.begin(s.low_rad, s.true_low_rad);
    finder.add(s.high_rad, s.true_high_rad);
    reached_rad = s.high_rad;
  });
  return finder.take();
}

std::vector<ApparentSpan> pieces_of(const TransferCurve &curve, std::size_t wave, const TrueSun &sun) {
  std::vector<ApparentSpan> pieces;
  for_sky(curve, wave, [&](std::size_t, const Segment &s) {
    if (const auto part = within(s, sun.centre_rad - sun.radius_rad, sun.centre_rad + sun.radius_rad))
      join(pieces, *part);
  });
  return pieces;
}

double widest_row_rad(const TransferCurve &curve, std::size_t wave, const TrueSun &sun) {
  double widest = 0;
  const auto look = [&](double apparent, double true_altitude) {
    const double s =
        std::pow(std::sin(sun.radius_rad / 2), 2) - std::pow(std::sin((true_altitude - sun.centre_rad) / 2), 2);
    if (s <= 0) return;
    const double azimuth = 2 * std::asin(std::sqrt(s / (std::cos(true_altitude) * std::cos(sun.centre_rad))));
    widest = std::max(widest, 2 * azimuth * std::cos(apparent));
  };
  for_sky(curve, wave, [&](std::size_t, const Segment &s) {
    look(s.low_rad, s.true_low_rad), look(s.high_rad, s.true_high_rad);
    const double rise = s.true_high_rad - s.true_low_rad, f = rise != 0 ? (sun.centre_rad - s.true_low_rad) / rise : -1;
    if (f > 0 && f < 1) look(s.low_rad + f * (s.high_rad - s.low_rad), sun.centre_rad);  // the row of the centre
  });
  return widest;
}

std::optional<double> lowest_true_rad(const TransferCurve &curve, std::size_t wave) {
  double lowest = pi;
  bool open = false;
  for (std::size_t i = 0; i < curve.elevation_rad.size(); ++i) {
    open = open || curve.at(i, wave).outcome == f64::RAY_TRAPPED;
    if (curve.at(i, wave).outcome == f64::RAY_SPACE) lowest = std::min(lowest, curve.at(i, wave).true_altitude_rad);
  }
  return open || lowest == pi ? std::nullopt : std::optional<double>(lowest);
}

std::vector<double> disk_irradiance(const TransferCurve &curve, const std::vector<std::size_t> &waves,
                                    const std::vector<SpectralAir> &air, const TrueSun &sun) {
  std::vector<double> all;
  for (std::size_t w = 0; w < waves.size(); ++w) {
    double sum = 0;
    for_sky(curve, waves[w], [&](std::size_t i, const Segment &s) {
      const auto part = within(s, sun.centre_rad - sun.radius_rad, sun.centre_rad + sun.radius_rad);
      if (!part) return;
      const double depth =
          0.5 * (optical_depth(curve.at(i, waves[w]), air[w]) + optical_depth(curve.at(i + 1, waves[w]), air[w]));
      sum += segment_light(*part, air[w].limb, sun) * std::exp(-depth);
    });
    all.push_back(sum * air[w].sun_centre_radiance);
  }
  return all;
}

GreenFlash green_flash(const TransferCurve &curve, const std::vector<std::size_t> &waves,
                       const std::vector<SpectralAir> &air, double radius_rad) {
  std::vector<double> nm;
  for (const std::size_t wave : waves) nm.push_back(curve.wavelength_nm[wave]);
  const SpectralWeights weights = spectral_weights(nm);
  const auto look = [&](double centre_rad) {
    return seen_light(disk_irradiance(curve, waves, air, {centre_rad, radius_rad}), weights);
  };
  const double top_rad = curve.elevation_rad.back(), coarse_rad = from_arcsec(60);
  double most = 0, centre = top_rad - radius_rad;
  for (Seen seen = look(centre); centre > top_rad - to_rad(8); seen = look(centre -= coarse_rad)) {
    most = std::max(most, seen.lux);
    if (most > 0 && seen.lux < 0.05 * most) break;
  }
  constexpr double step_s = 0.05, step_arcsec = step_s * setting_rate_arcsec_s;
  GreenFlash flash;
  for (centre += coarse_rad; centre > top_rad - to_rad(8); centre -= from_arcsec(step_arcsec)) {
    const Seen seen = look(centre);
    if (seen.lux < std::min(least_flash_lux, most)) break;
    if (!seen.green) continue;
    if (flash.seconds == 0) flash.first_deg = to_deg(centre);
    flash.last_deg = to_deg(centre);
    flash.seconds += step_s;
    flash.brightest_lux = std::max(flash.brightest_lux, seen.lux);
  }
  return flash;
}

SunsetFigures sunset_figures(const Scene &scene, const std::shared_ptr<Device> &device) {
  const AirSection air(spec_for(scene, {}));
  const bool section = varies_along_surface(air.spec());
  std::vector<double> picture_nm, all_nm{500, 520, 550, 560, 650};
  if (section) all_nm = {550};
  else picture_nm = wavelengths_even_in_refraction(air.spec().index, scene.spectrum.range_nm, scene.spectrum.samples);
  all_nm.insert(all_nm.end(), picture_nm.begin(), picture_nm.end());
  std::sort(all_nm.begin(), all_nm.end());
  all_nm.erase(std::unique(all_nm.begin(), all_nm.end()), all_nm.end());
  const TransferCurve curve = curve_of(scene, all_nm, device);
  const std::size_t green = row_of(curve, 550);

  SunsetFigures figures;
  figures.curve_arcsec = curve.interpolation_arcsec;
  figures.sky = sky_bands(curve, green);
  figures.folds = folds_of(curve, green);
  const SunPlace place = place_of_sun(scene, reference_ray(scene, air));
  const auto lowest_deg = [&](double nm) {
    const auto rad = lowest_true_rad(curve, row_of(curve, nm));
    return rad ? std::optional<double>(to_deg(*rad)) : std::nullopt;
  };
  figures.last_550_deg = lowest_deg(550);
  if (!place.shines) return figures;
  const TrueSun sun{place.true_altitude_rad, place.radius_rad};
  figures.sun = sun;
  figures.pieces = pieces_of(curve, green, sun);
  figures.images_of_centre = images_of(curve, green, sun.centre_rad);
  if (!figures.pieces.empty())
    figures.vertical_arcsec = 3600 * (figures.pieces.back().high_deg - figures.pieces.front().low_deg);
  figures.horizontal_arcsec = to_arcsec(widest_row_rad(curve, green, sun));
  if (section) return figures;
  figures.last_500_deg = lowest_deg(500), figures.last_560_deg = lowest_deg(560),
  figures.last_650_deg = lowest_deg(650);
  const auto above = pieces_of(curve, row_of(curve, 520), sun), below = pieces_of(curve, row_of(curve, 650), sun);
  if (!above.empty() && !below.empty())
    figures.green_rim_arcsec = 3600 * (above.back().high_deg - below.back().high_deg);
  if (picture_nm.size() < 2) return figures;
  std::vector<std::size_t> rows;
  for (const double nm : picture_nm) rows.push_back(row_of(curve, nm));
  figures.flash = green_flash(curve, rows, spectral_air(scene, picture_nm), sun.radius_rad);
  return figures;
}

}  // namespace greenray
