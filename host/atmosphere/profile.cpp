#include "atmosphere/profile.hpp"

#include <algorithm>
#include <cmath>

#include "atmosphere/air_section.hpp"
#include "atmosphere/gauss_legendre.hpp"
#include "atmosphere/standard_atmosphere.hpp"

namespace greenray {
namespace {

constexpr double vapour_deficit = 1 - 18.01528 / us76::molar_mass_kg_kmol;  // 0.378: vapour is lighter than air

ProfileSpec checked(const ProfileSpec &spec) {
  if (varies_along_surface(spec))
    throw InputError(
        spec.place,
        "this air varies along the surface (x_m): expected air that depends on height alone here, with one "
        "number for delta_T_K, height_m and diffuseness_m, and no two different [[station]] rows");
  return frozen_at(spec, 0);
}

/// Relative humidity by height; empty for dry air.
LevelCurve humidity_of(const ProfileSpec &spec) {
  std::vector<double> height_m, humidity;
  for (const Level &level : spec.levels)
    if (level.relative_humidity) {
      height_m.push_back(level.height_m);
      humidity.push_back(*level.relative_humidity);
    }
  if (std::none_of(humidity.begin(), humidity.end(), [](double rh) { return rh > 0; })) return {};
  if (humidity.back() > 0 && height_m.back() < us76::air_top_m) {  // dry from a little above the last row
    height_m.push_back(height_m.back() + 1000.0);
    humidity.push_back(0);
  }
  return LevelCurve(height_m, humidity, Interpolation::linear);
}

}  // namespace

Profile::Profile(const ProfileSpec &spec) : spec_(checked(spec)), curve_(spec_) {
  const auto add_humidity = [this](double weight, const ProfileSpec &air) {
    LevelCurve curve = humidity_of(air);
    if (!curve.empty()) humidity_.emplace_back(weight, std::move(curve));
  };
  add_humidity(1, spec_);
  for (const AirShare &share : spec_.blend) add_humidity(share.weight, *share.air);
  if (!is_air()) {
    std::vector<double> rows_m, values;
    for (const IndexLevel &row : spec_.index_levels) {
      rows_m.push_back(row.height_m);
      values.push_back(row.refractivity);
    }
    index_ = LevelCurve(rows_m, values, spec_.interpolation);
  }
  find_kinks();
  if (is_air()) {
    lay_panels();
    integrate_pressure();
  }
}

double Profile::top_m(bool flat) const {
  return !is_air() && flat ? spec_.index_levels.back().height_m : us76::air_top_m;
}

void Profile::find_kinks() {
  kinks_m_ = curve_.kinks_m();
  for (const auto &[weight, curve] : humidity_)
    kinks_m_.insert(kinks_m_.end(), curve.heights_m().begin(), curve.heights_m().end());
  if (!is_air()) kinks_m_ = index_.heights_m();
  std::sort(kinks_m_.begin(), kinks_m_.end());
  kinks_m_.erase(std::unique(kinks_m_.begin(), kinks_m_.end()), kinks_m_.end());
  std::erase_if(kinks_m_, [](double h) { return h <= 0 || h >= us76::air_top_m; });
}

/// Panels end at kinks and features and are never longer than a quarter of the scale height.
void Profile::lay_panels() {
  std::vector<double> edges{0.0, us76::air_top_m};
  edges.insert(edges.end(), kinks_m_.begin(), kinks_m_.end());
  edges.insert(edges.end(), features_m().begin(), features_m().end());
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double width = edges[i + 1] - edges[i];
    if (width <= 0) continue;
    const double longest_m = humidity_.empty() ? 1500.0 : 50.0;
    const int parts = std::max(1, static_cast<int>(std::ceil(width / longest_m)));
    for (int k = 0; k < parts; ++k) panel_m_.push_back(edges[i] + width * k / parts);
  }
  panel_m_.push_back(us76::air_top_m);
}

Dual Profile::temperature_or_throw(double height_m) const {
  const Dual t = curve_(height_m);
  if (!(t.value > 0))
    throw InputError(spec_.place,
                     "the temperature falls to " + std::to_string(t.value) + " K at " + std::to_string(height_m) +
                         " m: expected a profile that stays above 0 K (see delta_T_K of its inversions and layers)");
  return t;
}

double Profile::relative_humidity(double height_m, double &slope) const {
  Dual sum;
  for (const auto &[weight, curve] : humidity_) sum = sum + Dual(weight) * curve(height_m);
  slope = sum.slope;
  return sum.value;
}

/// d(ln P)/dh = -(g0 M0/R*) (r0/(r0+h))^2 / T_virtual.
double Profile::hydrostatic_rate(double height_m, double pressure_Pa) const {
  const Dual t = temperature_or_throw(height_m);
  double slope = 0;
  const double rh = relative_humidity(height_m, slope);
  const double vapour = rh > 0 ? rh * saturation_vapour_Pa(t.value, pressure_Pa).value : 0;
  if (vapour > 0.5 * pressure_Pa)
    throw InputError(spec_.place, "at " + std::to_string(height_m) +
                                      " m the humidity would make most of the air vapour (" + std::to_string(vapour) +
                                      " of " + std::to_string(pressure_Pa) +
                                      " Pa): expected a lower relative_humidity or temperature_K");
  const double virtual_K = t.value / (1 - vapour_deficit * vapour / pressure_Pa);
  const double gravity = us76::earth_radius_m / (us76::earth_radius_m + height_m);
  return -us76::hydrostatic_K_m * gravity * gravity / virtual_K;
}

/// Within a panel the pressure that the vapour term needs is extrapolated from the panel's foot: exact for dry air.
static double barometric(double pressure_Pa, double rate, double dh) { return pressure_Pa * std::exp(rate * dh); }

void Profile::integrate_pressure() {
  panel_ln_pressure_.assign(panel_m_.size(), 0);
  double ln_p = std::log(spec_.surface_pressure_Pa);
  const auto integrate_up = [&] {
    for (std::size_t i = 0; i < panel_m_.size(); ++i) {
      panel_ln_pressure_[i] = ln_p;
      if (i + 1 == panel_m_.size()) break;
      const double foot = panel_m_[i], p = std::exp(ln_p), rate = hydrostatic_rate(foot, p);
      ln_p += integrate_panel(foot, panel_m_[i + 1],
                              [&](double h) { return hydrostatic_rate(h, barometric(p, rate, h - foot)); });
    }
  };
  integrate_up();
  const auto anchor = std::find_if(spec_.levels.begin(), spec_.levels.end(),
                                   [](const Level &level) { return level.pressure_Pa.has_value(); });
  if (anchor == spec_.levels.end()) return;
  // The lowest row with a pressure sets the scale; vapour makes the equation slightly nonlinear, so repeat.
  for (int pass = 0; pass < 3; ++pass) {
    const double there = air(anchor->height_m).pressure_Pa.value;
    spec_.surface_pressure_Pa *= *anchor->pressure_Pa / there;
    ln_p = std::log(spec_.surface_pressure_Pa);
    integrate_up();
  }
}

AirState Profile::air(double height_m) const {
  if (!(height_m >= 0)) throw std::domain_error("height " + std::to_string(height_m) + " m is below the ground");
  const double h = std::min(height_m, us76::air_top_m);
  const auto above = std::upper_bound(panel_m_.begin(), panel_m_.end(), h);
  const std::size_t i = std::min(static_cast<std::size_t>(above - panel_m_.begin()), panel_m_.size() - 1) - 1;
  const double foot = panel_m_[i], p_foot = std::exp(panel_ln_pressure_[i]);
  const double rate_foot = humidity_.empty() ? 0 : hydrostatic_rate(foot, p_foot);
  const double ln_p = panel_ln_pressure_[i] + integrate_panel(foot, h, [&](double x) {
                        return hydrostatic_rate(x, barometric(p_foot, rate_foot, x - foot));
                      });
  const double p = std::exp(ln_p);
  AirState state;
  state.temperature_K = temperature_or_throw(h);
  state.pressure_Pa = {p, p * hydrostatic_rate(h, p)};
  double slope = 0;
  const double rh = relative_humidity(h, slope);
  if (rh > 0 || slope != 0)
    state.vapour_Pa = Dual(rh, slope) * saturation_vapour_Pa(state.temperature_K, state.pressure_Pa);
  return state;
}

double Profile::density_kg_m3(double height_m) const {
  if (!is_air() || height_m > us76::air_top_m) return 0;
  const AirState a = air(height_m);
  return (a.pressure_Pa.value - vapour_deficit * a.vapour_Pa.value) * us76::molar_mass_kg_kmol /
         (us76::gas_constant_J_kmol_K * a.temperature_K.value);
}

Dual Profile::refractivity(double height_m, double wavelength_nm) const {
  if (!(height_m >= 0)) throw std::domain_error("height " + std::to_string(height_m) + " m is below the ground");
  if (is_air()) {
    if (height_m > us76::air_top_m) return 0;
    return Dual(spec_.exaggerate) * greenray::refractivity(spec_.index, wavelength_nm, air(height_m));
  }
  const double dispersion =
      reference_refractivity(spec_.index, wavelength_nm) / reference_refractivity(spec_.index, 550.0);
  return Dual(spec_.exaggerate * dispersion) * index_(height_m);
}

double Profile::zenith_column_kg_m2(double height_m) const {
  if (!is_air()) return 0;
  double mass = 0, from = height_m;
  for (double edge : panel_m_) {
    if (edge <= from) continue;
    mass += integrate_panel(from, edge, [this](double h) { return density_kg_m3(h); });
    from = edge;
  }
  return mass;
}

}  // namespace greenray
