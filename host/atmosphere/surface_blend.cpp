#include "atmosphere/surface_blend.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "atmosphere/diagnosis.hpp"
#include "atmosphere/profile.hpp"
#include "atmosphere/temperature_curve.hpp"

namespace greenray {
namespace {

constexpr double ice_point_K = 273.15;
constexpr double left_at_top = 0.01;
constexpr double joins_by = 2;  // rows up to this many top_m give way, so that no step of a metre bends light by itself

std::string celsius(double temperature_K) { return plain_number(temperature_K - ice_point_K, 4) + " C"; }

/// T(h) of the rows or the standard atmosphere alone.
TemperatureCurve bare(ProfileSpec spec) {
  spec.inversions.clear();
  spec.surface_layers.clear();
  spec.smooth_m = 0;
  return TemperatureCurve(spec);
}

/// Relative humidity of the rows at a height; none where no row has one.
std::optional<double> humidity_at(const std::vector<Level> &levels, double height_m) {
  std::vector<double> rows_m, values;
  for (const Level &level : levels)
    if (level.relative_humidity) {
      rows_m.push_back(level.height_m);
      values.push_back(*level.relative_humidity);
    }
  if (rows_m.empty()) return std::nullopt;
  return LevelCurve(rows_m, values, Interpolation::linear)(height_m).value;
}

void set_air_below(ProfileSpec &spec, double air_K, double top_m) {
  const TemperatureCurve whole(spec), rows_alone = bare(spec);
  const double surface_Pa = Profile(spec).spec().surface_pressure_Pa;  // the dropped rows may be those that tell it
  std::vector<Level> levels;
  for (const double h : std::array{0.0, top_m}) {
    Level level;
    level.height_m = h;
    level.temperature_K = air_K - (whole(h).value - rows_alone(h).value);
    level.relative_humidity = humidity_at(spec.levels, h);
    level.place = spec.place;
    levels.push_back(level);
  }
  spec.surface_pressure_Pa = surface_Pa;
  levels.front().pressure_Pa = surface_Pa;
  const double difference_K = air_K - whole(top_m).value;
  std::size_t dropped = 0;
  for (const Level &level : spec.levels) {
    if (level.height_m > joins_by * top_m) levels.push_back(level);
    else ++dropped;
  }
  spec.notes.push_back("surface layer: air of " + celsius(air_K) + " up to " + plain_number(top_m) + " m in place of " +
                       std::to_string(dropped) + " rows; that is " + plain_number(std::abs(difference_K), 2) + " K " +
                       (difference_K < 0 ? "below" : "above") + " the profile's own at that height");
  spec.levels = std::move(levels);
}

}  // namespace

void blend_surface(ProfileSpec &spec, const SurfaceBlend &blend, const SourcePlace &place) {
  if (!spec.index_levels.empty())
    throw InputError(place, "a surface layer needs air: this profile gives the refractivity itself");
  if (!(blend.top_m > 0 && blend.top_m <= 10000))
    throw InputError(place, "top_m: expected a number above 0 and at most 10000 m");
  const auto sensible = [](double kelvin) { return kelvin >= 100 && kelvin <= 2000; };
  if (!sensible(blend.water_K)) throw InputError(place, "water_C: expected a number from -173.15 to 1726.85 C");
  if (blend.air_K && !sensible(*blend.air_K))
    throw InputError(place, "air_C: expected a number from -173.15 to 1726.85 C");
  if (blend.air_K) set_air_below(spec, *blend.air_K, blend.top_m);
  const double air_K = TemperatureCurve(spec)(0).value;
  SurfaceLayerSpec layer;
  layer.delta_T_K = blend.water_K - air_K;
  layer.scale_m = blend.top_m / -std::log(left_at_top);
  layer.place = place;
  spec.surface_layers.push_back(layer);
  spec.notes.push_back("surface layer: " + plain_number(layer.delta_T_K, 4) + " K (surface " + celsius(blend.water_K) +
                       ", air " + celsius(air_K) + ") dies out by " + plain_number(blend.top_m) + " m, scale " +
                       plain_number(layer.scale_m, 4) + " m");
}

}  // namespace greenray
