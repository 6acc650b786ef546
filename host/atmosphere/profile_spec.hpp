// What a profile file says, before any physics: the keys of docs/file-formats.md, one field each.
#pragma once
#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "support/error.hpp"

namespace greenray {

enum class IndexModel { born_wolf, iag1999, ciddor, peck_reeder };
enum class Interpolation { linear, cubic };

/// A number, or a number that varies along the surface: value[i] at x_m[i], constant beyond the ends, between them as
/// ProfileSpec::along_surface says. `x_m` empty means constant value[0].
struct AlongSurface {
  std::vector<double> x_m;
  std::vector<double> value;
  AlongSurface() = default;
  AlongSurface(double constant) : value{constant} {}  // NOLINT(google-explicit-constructor)
  bool has_points() const { return !x_m.empty(); }
  bool varies() const { return std::adjacent_find(value.begin(), value.end(), std::not_equal_to<>()) != value.end(); }
  double constant() const { return value.front(); }
};

/// Thinner layers are refused: real air smooths them away, and a table of them could not keep its errors.
inline constexpr double thinnest_layer_m = 1e-3, closest_levels_m = 5e-4;

/// One row of air. Heights are geometric metres above the surface.
struct Level {
  double height_m = 0;
  double temperature_K = 0;
  std::optional<double> pressure_Pa;
  std::optional<double> relative_humidity;  // 0..1
  SourcePlace place;
};

/// G04 4.4: T = T_atm - delta_T + delta_T / (1 + exp(-(h - height)/diffuseness)).
struct InversionSpec {
  AlongSurface delta_T_K;
  AlongSurface height_m;
  AlongSurface diffuseness_m;
  SourcePlace place;
};

/// T = T_atm + delta_T exp(-h/scale).
struct SurfaceLayerSpec {
  double delta_T_K = 0;
  double scale_m = 1;
  SourcePlace place;
};

/// Refractivity n-1 at 550 nm, given directly instead of air.
struct IndexLevel {
  double height_m = 0;
  double refractivity = 0;
  SourcePlace place;
};

struct ProfileSpec;

/// The air over one place of the path.
struct Station {
  double x_m = 0;
  std::string file;  // as named in the profile
  std::shared_ptr<const ProfileSpec> air;
  SourcePlace place;
};

/// A share of the air between two stations: T, relative humidity and ln of the surface pressure are weighted means.
struct AirShare {
  double weight = 1;
  std::shared_ptr<const ProfileSpec> air;
};

struct ProfileSpec {
  std::string name = "us76";  // shown in reports
  bool base_is_us76 = true;   // base = "us76"; false for "none": levels or index_levels are then required
  IndexModel index = IndexModel::born_wolf;
  double earth_radius_m = 6371000.0;
  double surface_pressure_Pa = 101325.0;
  Interpolation interpolation = Interpolation::linear;
  double smooth_m = 0.0;
  double exaggerate = 1.0;
  std::vector<Level> levels;  // ascending heights
  std::vector<InversionSpec> inversions;
  std::vector<SurfaceLayerSpec> surface_layers;
  std::vector<IndexLevel> index_levels;  // ascending heights; excludes levels, inversions and surface layers
  Interpolation along_surface = Interpolation::cubic;  // between points x_m: linear, or cubic (monotone)
  std::optional<double> azimuth_deg;                   // of the direction of x, from north through east
  std::vector<Station> stations;                       // ascending x_m; exclude levels and surface layers
  std::vector<AirShare> blend;                         // stations at one place (frozen_at); not in files
  std::vector<std::string> notes;                      // repairs an importer made, one sentence each
  SourcePlace place;
};

}  // namespace greenray
