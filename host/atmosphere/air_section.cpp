#include "atmosphere/air_section.hpp"

#include <algorithm>
#include <cmath>

#include "atmosphere/profile_file.hpp"
#include "atmosphere/temperature_curve.hpp"

namespace greenray {
namespace {

bool does_nothing(const InversionSpec &v) {
  return std::all_of(v.delta_T_K.value.begin(), v.delta_T_K.value.end(), [](double jump) { return jump == 0; });
}

bool varies(const InversionSpec &v) {
  return !does_nothing(v) && (v.delta_T_K.varies() || v.height_m.varies() || v.diffuseness_m.varies());
}

/// The same air, whatever its name and its notes.
bool same_air(const ProfileSpec &a, const ProfileSpec &b) {
  ProfileSpec other = b;
  other.name = a.name;
  other.notes = a.notes;
  return write_profile(a) == write_profile(other);
}

double value_at(const AlongSurface &quantity, double x_m, Interpolation interpolation) {
  if (!quantity.has_points()) return quantity.constant();
  return LevelCurve(quantity.x_m, quantity.value, interpolation)(x_m).value;
}

std::vector<AirShare> shares_at(const ProfileSpec &spec, double x_m) {
  const std::vector<Station> &s = spec.stations;
  if (x_m <= s.front().x_m) return {{1, s.front().air}};
  if (x_m >= s.back().x_m) return {{1, s.back().air}};
  std::size_t i = 0;
  while (s[i + 1].x_m <= x_m) ++i;
  const double t = (x_m - s[i].x_m) / (s[i + 1].x_m - s[i].x_m);
  const double weight = spec.along_surface == Interpolation::cubic ? t * t * (3 - 2 * t) : t;
  if (weight == 0) return {{1, s[i].air}};
  return {{1 - weight, s[i].air}, {weight, s[i + 1].air}};
}

/// At the surface [Pa]: as given, or as a level's own pressure sets it.
double surface_pressure_Pa(const ProfileSpec &air) {
  const bool given = std::none_of(air.levels.begin(), air.levels.end(), [](const Level &l) { return l.pressure_Pa; });
  return given ? air.surface_pressure_Pa : Profile(air).spec().surface_pressure_Pa;
}

bool is_humid(const ProfileSpec &spec) {
  const auto humid = [](const Level &level) { return level.relative_humidity.value_or(0) > 0; };
  return std::any_of(spec.levels.begin(), spec.levels.end(), humid) ||
         std::any_of(spec.stations.begin(), spec.stations.end(), [](const Station &s) { return is_humid(*s.air); });
}

void add_points(const AlongSurface &quantity, std::vector<double> &points_m) {
  points_m.insert(points_m.end(), quantity.x_m.begin(), quantity.x_m.end());
}

}  // namespace

bool varies_along_surface(const ProfileSpec &spec) {
  const auto differs = [&](const Station &s) { return !same_air(*s.air, *spec.stations.front().air); };
  return spec.exaggerate != 0 && (std::any_of(spec.inversions.begin(), spec.inversions.end(), varies) ||
                                  std::any_of(spec.stations.begin(), spec.stations.end(), differs));
}

bool has_places(const ProfileSpec &spec) {
  return !spec.stations.empty() ||
         std::any_of(spec.inversions.begin(), spec.inversions.end(), [](const InversionSpec &v) {
           return v.delta_T_K.has_points() || v.height_m.has_points() || v.diffuseness_m.has_points();
         });
}

ProfileSpec frozen_at(const ProfileSpec &spec, double x_m) {
  if (!has_places(spec)) return spec;
  ProfileSpec here = spec;
  for (InversionSpec &v : here.inversions) {
    v.delta_T_K = value_at(v.delta_T_K, x_m, spec.along_surface);
    v.height_m = value_at(v.height_m, x_m, spec.along_surface);
    v.diffuseness_m = value_at(v.diffuseness_m, x_m, spec.along_surface);
  }
  if (spec.stations.empty()) return here;
  here.blend = shares_at(spec, x_m);
  here.stations.clear();
  double ln_pressure = 0;
  for (const AirShare &share : here.blend) ln_pressure += share.weight * std::log(surface_pressure_Pa(*share.air));
  here.surface_pressure_Pa = std::exp(ln_pressure);
  return here;
}

AirSection::AirSection(ProfileSpec spec) : spec_(std::move(spec)) {
  for (Station &station : spec_.stations) {  // once for all
    auto air = std::make_shared<ProfileSpec>(*station.air);
    air->surface_pressure_Pa = surface_pressure_Pa(*air);
    for (Level &level : air->levels) level.pressure_Pa.reset();
    station.air = std::move(air);
  }
  if (varies_along_surface(spec_)) {
    for (const InversionSpec &v : spec_.inversions)
      if (!does_nothing(v))
        for (const AlongSurface *quantity : {&v.delta_T_K, &v.height_m, &v.diffuseness_m})
          if (quantity->varies()) add_points(*quantity, points_m_);
    for (const Station &station : spec_.stations) points_m_.push_back(station.x_m);
    std::sort(points_m_.begin(), points_m_.end());
    points_m_.erase(std::unique(points_m_.begin(), points_m_.end()), points_m_.end());
  }
  separable_ = !is_humid(spec_) || (spec_.index != IndexModel::ciddor && spec_.index != IndexModel::iag1999);
  for (std::size_t i = 0; i < points_m_.size(); ++i) {
    (void)at(points_m_[i]);
    if (i > 0) (void)at(0.5 * (points_m_[i - 1] + points_m_[i]));
  }
}

}  // namespace greenray
