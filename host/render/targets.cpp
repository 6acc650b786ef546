#include "render/targets.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "image/alpha_picture.hpp"
#include "image/colour.hpp"
#include "image/uplift.hpp"
#include "render/transfer.hpp"
#include "support/angle.hpp"
#include "support/csv_table.hpp"

namespace greenray {
namespace {

using Kind = TargetScene::Kind;

std::vector<std::array<double, 2>> outline_of(const TargetScene &t) {
  const double half = 0.5 * t.width_m, top = t.base_m + t.height_m;
  if (t.kind == Kind::rectangle) return {{-half, t.base_m}, {half, t.base_m}, {half, top}, {-half, top}};
  if (t.kind == Kind::triangle) return {{-half, t.base_m}, {half, t.base_m}, {0, top}};
  std::vector<std::array<double, 2>> corners = t.outline_m;
  for (auto &corner : corners) corner[1] += t.base_m;
  return corners;
}

/// Across and up are measured on the arc at the target's distance about the eye.
double metres_per_rad(const Scene &scene, double distance_m) {
  if (scene.atmosphere.surface == Surface::flat) return distance_m;
  const double radius_m = scene.atmosphere.profile.earth_radius_m;
  return radius_m * std::sin(distance_m / radius_m);
}

/// In -pi .. pi.
double wrapped_rad(double angle_rad) { return std::remainder(angle_rad, 2 * pi); }

class ShapeMaker {
 public:
  ShapeMaker(const Scene &scene, const std::vector<double> &station_m) : scene_(scene), station_m_(station_m) {}

  TargetShapes make() {
    std::vector<std::size_t> order(scene_.targets.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return scene_.targets[a].distance_m > scene_.targets[b].distance_m;
    });
    for (const std::size_t i : order) add(scene_.targets[i], i);
    return std::move(out_);
  }

 private:
  void add(const TargetScene &from, std::size_t number) {
    f32::Target t{};
    const double across = metres_per_rad(scene_, from.distance_m);
    const double azimuth = to_rad(from.azimuth_deg.value_or(scene_.observer.azimuth_deg) - scene_.observer.azimuth_deg);
    t.azimuth_rad = static_cast<float>(wrapped_rad(azimuth + from.offset_m / across));
    t.metres_per_rad = static_cast<float>(across);
    t.distance_m = static_cast<float>(from.distance_m);
    t.station =
        static_cast<int>(std::lower_bound(station_m_.begin(), station_m_.end(), from.distance_m) - station_m_.begin());
    if (from.kind == Kind::billboard) add_picture(from, t);
    else add_outline(outline_of(from), t);
    out_.rows.push_back(t);
    out_.number.push_back(number);
  }

  void add_outline(const std::vector<std::array<double, 2>> &corners, f32::Target &t) {
    t.first = static_cast<int>(out_.corners.size() / 2);
    t.corners = static_cast<int>(corners.size());
    t.left_m = t.right_m = static_cast<float>(corners.front()[0]);
    t.bottom_m = t.top_m = static_cast<float>(corners.front()[1]);
    for (const auto &corner : corners) {
      const auto across = static_cast<float>(corner[0]), up = static_cast<float>(corner[1]);
      out_.corners.insert(out_.corners.end(), {across, up});
      t.left_m = std::min(t.left_m, across), t.right_m = std::max(t.right_m, across);
      t.bottom_m = std::min(t.bottom_m, up), t.top_m = std::max(t.top_m, up);
    }
  }

  void add_picture(const TargetScene &from, f32::Target &t) {
    const AlphaPicture picture = read_alpha_picture(from.picture);
    t.left_m = static_cast<float>(-0.5 * from.width_m), t.right_m = -t.left_m;
    t.bottom_m = static_cast<float>(from.base_m), t.top_m = static_cast<float>(from.base_m + from.height_m);
    t.first = static_cast<int>(out_.texels.size());
    t.width = picture.colours.width, t.height = picture.colours.height;
    for (int row = t.height - 1; row >= 0; --row)
      for (int column = 0; column < t.width; ++column) {
        const auto at =
            static_cast<std::size_t>(row) * static_cast<std::size_t>(t.width) + static_cast<std::size_t>(column);
        const CurveCoefficients c = uplift_.coefficients(even(picture.colours.pixel(at)));
        out_.texels.push_back(
            {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]), picture.alpha[at]});
      }
  }

  /// Within 0 .. 1 and in steps of 1/1024, so that a photograph has fewer spectra to look for.
  static Rgb even(Rgb colour) {
    for (double &part : colour) part = part > 0 ? std::round(std::min(part, 1.0) * 1024) / 1024 : 0;
    return colour;
  }

  const Scene &scene_;
  const std::vector<double> &station_m_;
  TargetShapes out_;
  Uplift uplift_;
};

/// Spectral radiance of D65 of a luminance of 1 cd/m2.
class Lamp {
 public:
  Lamp() : table_(CsvTable::embedded("host/data/cie_d65_5nm.csv")) {
    for (int nm = 360; nm <= 830; ++nm) luminance_ += luminous_efficacy_lm_W * at_table(nm) * colour_matching(nm)[1];
  }
  double at(double wavelength_nm) const { return at_table(wavelength_nm) / luminance_; }

 private:
  double at_table(double nm) const { return table_.interpolate("nm", "S", nm, CsvTable::Outside::clamp); }
  CsvTable table_;
  double luminance_ = 0;
};

/// Radiance of an outline, or of a white texel, by wavelength.
class TargetLight {
 public:
  double radiance(const TargetScene &target, const f32::Target &row, const SkyLight &light, double wavelength_nm,
                  std::size_t wave) {
    const double white = target.luminance_cd_m2
                             ? *target.luminance_cd_m2 * lamp_.at(wavelength_nm)
                             : irradiance_on_upright(light, static_cast<double>(row.azimuth_rad), wave) / pi;
    return white * reflectance(target.colour, wavelength_nm);
  }

 private:
  double reflectance(const std::array<double, 3> &colour, double wavelength_nm) {
    if (colour[0] == colour[1] && colour[1] == colour[2]) return colour[0];
    return curve_value(uplift_.coefficients(colour), wavelength_nm);
  }
  Lamp lamp_;
  Uplift uplift_;
};

/// Whether heights may be interpolated from one entry to the next: jumps of the whole ray that lie beyond the station
/// do not count.
float joined(const SightPlace &here, const SightPlace &next, float edge) {
  const bool same =
      here.outcome == f64::RAY_IN_FLIGHT && next.outcome == here.outcome && here.turning_points == next.turning_points;
  return edge < 1 && same ? 1.0f : edge;
}

}  // namespace

std::vector<double> station_distances_m(const Scene &scene) {
  std::vector<double> distances;
  for (const TargetScene &target : scene.targets) distances.push_back(target.distance_m);
  std::sort(distances.begin(), distances.end());
  distances.erase(std::unique(distances.begin(), distances.end()), distances.end());
  return distances;
}

StationSights trace_stations(SightPlaces &rays, const std::vector<double> &elevations_rad,
                             const std::vector<double> &station_m, const std::vector<double> &azimuths_rad) {
  StationSights sights{station_m, elevations_rad, 0, {}};
  if (station_m.empty()) return sights;
  sights.places = rays.at(elevations_rad, station_m, azimuths_rad);
  sights.wavelengths = sights.places.size() / (elevations_rad.size() * station_m.size());
  return sights;
}

double station_error_arcsec(const StationSights &entries, const std::vector<float> &edges,
                            const std::vector<std::size_t> &below, const StationSights &middles) {
  double worst = 0;
  const std::size_t waves = edges.empty() ? 1 : edges.size() / entries.elevation_rad.size();
  for (std::size_t k = 0; k < below.size(); ++k)
    for (std::size_t w = 0; w < entries.wavelengths; ++w)
      for (std::size_t s = 0; s < entries.station_m.size(); ++s) {
        const std::size_t e = below[k];
        const SightPlace &a = entries.at(e, w, s), &b = entries.at(e + 1, w, s), &middle = middles.at(k, w, s);
        const float edge = edges.empty() ? 1.0f : edges[e * waves + w];
        if (joined(a, b, edge) < 1) continue;
        const double width = entries.elevation_rad[e + 1] - entries.elevation_rad[e];
        const double slope = std::max(entries.station_m[s], std::abs(b.height_m - a.height_m) / width);
        worst = std::max(worst, std::abs(0.5 * (a.height_m + b.height_m) - middle.height_m) / slope);
      }
  return to_arcsec(worst);
}

TargetShapes target_shapes(const Scene &scene, const std::vector<double> &station_m) {
  return ShapeMaker(scene, station_m).make();
}

SeaDraw draw_sea(const SeaSights &sights, const SeaState &state, double half_width_rad, double pixel_rad,
                 std::uint64_t seed) {
  constexpr double most = 1 << 18;
  const double width_rad = 1 / (state.crests_per_m() * sights.horizon_m);  // a crest as wide as they are apart
  SeaDraw draw{&sights, {}, -half_width_rad, 0};
  draw.step_rad = std::max(std::min(pixel_rad / 2, width_rad / 8), 2 * half_width_rad / most);
  const auto count = static_cast<std::size_t>(2 * half_width_rad / draw.step_rad) + 2;
  draw.thresholds = crest_thresholds(draw.first_rad, draw.step_rad, count, width_rad, seed);
  return draw;
}

namespace {

/// Writes the channels of stations and sea for all entries.
class SightWriter {
 public:
  SightWriter(const SkyLight &light, const StationSights &sights, const SeaDraw &sea, const std::vector<float> &edges,
              std::size_t wavelengths, std::size_t padded)
      : light_(light), sights_(sights), sea_(sea), edges_(edges), wavelengths_(wavelengths), padded_(padded) {
    const std::size_t stations = sights.station_m.size() + (sea.sights ? 1 : 0);
    entries_ = sights.elevation_rad.size();
    table_.assign(entries_ * stations * f32::TARGET_CHANNEL_COUNT * padded, 0.0f);
    for (std::size_t e = 0; e < entries_; ++e)
      for (std::size_t s = 0; s < stations; ++s)
        for (std::size_t w = 0; w < wavelengths; ++w) {
          float *at = &table_[(e * stations + s) * f32::TARGET_CHANNEL_COUNT * padded + w];
          if (s < sights.station_m.size()) write_station(at, e, s, w);
          else at[f32::TARGET_JOINED * padded] = edge(e, w);
          if (sea.sights) at[f32::TARGET_CRESTS * padded] = sea.sights->at(e, w, s);
        }
  }
  std::vector<float> take() { return std::move(table_); }

 private:
  float edge(std::size_t entry, std::size_t wave) const {
    return edges_.empty() || entry + 1 == entries_ ? 1.0f : edges_[entry * wavelengths_ + wave];
  }

  void write_path(float *at, double from_sun_rad, const PathLight &air) const {
    at[f32::TARGET_PASSED * padded_] = static_cast<float>(air.passed);
    at[f32::TARGET_AIRLIGHT * padded_] = static_cast<float>(air.isotropic);
    at[f32::TARGET_AUREOLE * padded_] = static_cast<float>(air.aureole);
    at[f32::TARGET_FROM_SUN * padded_] = static_cast<float>(from_sun_rad);
  }

  void write_station(float *at, std::size_t e, std::size_t s, std::size_t w) const {
    const SightPlace &place = sights_.at(e, w, s);
    Transfer path{};
    path.column = place.column;
    path.bending_rad = place.bending_rad;
    path.true_altitude_rad = sights_.elevation_rad[e] - place.bending_rad;
    write_path(at, path.true_altitude_rad - light_.sun.true_altitude_rad,
               light_of_path(light_, path, light_.air_before.empty() ? nullptr : &light_.air_before.at(s), w));
    at[f32::TARGET_HEIGHT * padded_] = static_cast<float>(place.height_m);
    const SightPlace &next = sights_.at(std::min(e + 1, entries_ - 1), w, s);
    at[f32::TARGET_JOINED * padded_] = joined(place, next, edge(e, w));
  }

  const SkyLight &light_;
  const StationSights &sights_;
  const SeaDraw &sea_;
  const std::vector<float> &edges_;
  std::size_t wavelengths_, padded_, entries_ = 0;
  std::vector<float> table_;
};

}  // namespace

TargetTable make_target_table(const Scene &scene, const TargetShapes &shapes, const SkyLight &light,
                              const std::vector<double> &wavelengths_nm, const StationSights &sights,
                              const std::vector<float> &edges, const SeaDraw &sea, int waves) {
  TargetTable table;
  if (shapes.rows.empty() && !sea.sights) return table;
  const auto padded = static_cast<std::size_t>(waves);
  table.stations = static_cast<int>(sights.station_m.size()) + (sea.sights ? 1 : 0);
  table.targets = shapes.rows;
  table.corners = shapes.corners;
  table.texels = shapes.texels;
  table.crests = sea.thresholds;
  table.sea_entry = sea.sights ? static_cast<int>(sea.sights->sea_entry) : 0;
  table.first_crest_rad = static_cast<float>(sea.first_rad);
  table.crests_per_rad = static_cast<float>(1 / sea.step_rad);
  table.sight = SightWriter(light, sights, sea, edges, wavelengths_nm.size(), padded).take();
  table.light.assign((f32::TARGET_LIGHT_FIRST + shapes.rows.size()) * padded, 0.0f);
  TargetLight lights;
  for (std::size_t w = 0; w < wavelengths_nm.size(); ++w) {
    table.light[f32::TARGET_LIGHT_PLACE * padded + w] = static_cast<float>(curve_place(wavelengths_nm[w]));
    for (std::size_t k = 0; k < shapes.rows.size(); ++k)
      table.light[(f32::TARGET_LIGHT_FIRST + k) * padded + w] = static_cast<float>(
          lights.radiance(scene.targets[shapes.number[k]], shapes.rows[k], light, wavelengths_nm[w], w));
  }
  return table;
}

}  // namespace greenray
