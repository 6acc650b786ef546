#include "render/refraction.hpp"

#include <algorithm>
#include <cmath>

#include "atmosphere/layer_table.hpp"
#include "compute/layer_tracer.hpp"
#include "render/host_rays.hpp"
#include "render/launch.hpp"
#include "render/renderer.hpp"
#include "render/section_rays.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

/// One choice of table and step tolerance.
struct Setting {
  double table_arcsec, step_rad;
  Precision precision;
};

/// Local errors of some hundred steps add up, mostly of one sign; a tenth of the tolerance each was measured to be safe
/// (docs/method.md, "Error control").
Setting setting_for(double tolerance_arcsec, Precision precision) {
  const bool single = precision == Precision::single_;
  const double table_arcsec = std::clamp(tolerance_arcsec / 4, single ? 1e-4 : 1e-8, 1.0);
  const double step_rad = std::clamp(from_arcsec(tolerance_arcsec / 20), single ? 1e-10 : 1e-14, 1e-5);
  return {table_arcsec, step_rad, precision};
}

struct Traced {
  std::vector<f64::RayEnd> ends;
  std::vector<double> sideways_rad;
  std::size_t cells_per_row = 0;
  double table_bound_arcsec = 0;
  TraceStats stats;
  HostRay on_host;  // through the same table, at the first wavelength; of air that varies
};

Traced trace_with(const Setting &setting, const AirSection &air, const RefractionRequest &request,
                  const std::vector<double> &elevations_rad, const std::shared_ptr<Device> &device) {
  SkyRayOptions options;
  options.height_m = request.height_m;
  options.flat = request.flat;
  options.method = request.method;
  options.precision = setting.precision;
  options.error_arcsec = setting.table_arcsec;
  options.step_rad = setting.step_rad;
  options.max_steps = 1000000;
  options.azimuth_rad = request.azimuth_rad;
  Traced traced;
  const auto trace = [&](SkyRays &&rays) {
    const std::vector<double> azimuths(elevations_rad.size(), request.azimuth_rad);
    traced.ends = rays.trace(elevations_rad, azimuths, &traced.sideways_rad);
    traced.sideways_rad.resize(traced.ends.size(), 0.0);
    traced.cells_per_row = rays.cells();
    traced.table_bound_arcsec = rays.table_bound_arcsec();
    traced.stats = rays.stats();
    if (rays.varies()) traced.on_host = rays.on_host(0);
  };
  if (request.section) trace(SkyRays(air, request.wavelengths_nm, options, device));
  else trace(SkyRays(air.at(0), request.wavelengths_nm, options, device));
  return traced;
}

/// The rays of a request traced again, each with a neighbour on either side.
struct Check {
  std::vector<f64::RayEnd> rays;
  std::vector<double> stretch;  // max(1, |dR/da|); of the side where the ray ends alike, the larger
};

Check check_with(const Setting &setting, const AirSection &air, const RefractionRequest &request,
                 const std::vector<double> &elevations_rad, const std::shared_ptr<Device> &device) {
  const double beside_rad = setting.precision == Precision::double_ ? 1e-11 : 3e-6;
  std::vector<double> three;
  for (double e : elevations_rad)
    for (double offset : {-beside_rad, 0.0, beside_rad}) three.push_back(std::clamp(e + offset, -pi / 2, pi / 2));
  const std::vector<f64::RayEnd> ends = trace_with(setting, air, request, three, device).ends;
  const std::size_t rows = request.wavelengths_nm.size();
  Check check;
  for (std::size_t i = 0; i < elevations_rad.size(); ++i)
    for (std::size_t w = 0; w < rows; ++w) {
      const f64::RayEnd &middle = ends[(3 * i + 1) * rows + w];
      double stretch = 1;
      for (std::size_t side : {3 * i, 3 * i + 2})
        if (ends[side * rows + w].outcome == middle.outcome)
          stretch = std::max(stretch, std::abs(ends[side * rows + w].bending_rad - middle.bending_rad) / beside_rad);
      check.rays.push_back(middle);
      check.stretch.push_back(stretch);
    }
  return check;
}

double difference_arcsec(const f64::RayEnd &a, const f64::RayEnd &b) {
  return a.outcome == b.outcome ? to_arcsec(std::abs(a.bending_rad - b.bending_rad)) : 1e9;
}

/// An error bound for each ray [arcsec]. both_settings_arcsec: what kept and check may have in common.
std::vector<double> error_bounds(const std::vector<f64::RayEnd> &kept, const Check &check,
                                 double both_settings_arcsec) {
  std::vector<double> bounds;
  for (std::size_t i = 0; i < kept.size(); ++i)
    bounds.push_back(1.5 * difference_arcsec(kept[i], check.rays[i]) + check.stretch[i] * both_settings_arcsec);
  return bounds;
}

/// Tells the error of the table from that of the device: some rays in double on the host through the table kept.
void measure_parts(const Traced &kept, const Check &check, const std::vector<double> &elevations_rad,
                   std::size_t wavelengths, RefractionTable &result) {
  constexpr std::size_t most_rays = 48;
  const std::size_t stride = (elevations_rad.size() + most_rays - 1) / most_rays;
  double table = 0, solver = 0;
  for (std::size_t i = 0; i < elevations_rad.size(); i += stride) {
    const std::size_t row = i * wavelengths;
    if (kept.ends[row].outcome != f64::RAY_SPACE) continue;
    const f64::RayEnd on_host = kept.on_host(elevations_rad[i]);
    if (on_host.outcome != f64::RAY_SPACE || check.rays[row].outcome != f64::RAY_SPACE) continue;
    table = std::max(table, difference_arcsec(on_host, check.rays[row]) / check.stretch[row]);
    solver = std::max(solver, difference_arcsec(on_host, kept.ends[row]) / check.stretch[row]);
  }
  result.measured_table_arcsec = table;
  result.measured_solver_arcsec = solver;
}

double worst_difference(const std::vector<f64::RayEnd> &kept, const std::vector<f64::RayEnd> &check) {
  double worst = 0;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i].outcome == f64::RAY_SPACE) worst = std::max(worst, difference_arcsec(kept[i], check[i]));
  return worst;
}

RefractionRow make_row(const RefractionRequest &request, std::size_t i, const f64::RayEnd &end, double curvature_per_m,
                       double zenith_column) {
  const std::size_t wavelengths = request.wavelengths_nm.size();
  RefractionRow row{};
  row.apparent_altitude_deg = request.altitudes_deg[i / wavelengths];
  row.wavelength_nm = request.wavelengths_nm[i % wavelengths];
  row.outcome = end.outcome;
  row.turning_points = end.turning_points;
  const bool ended = end.outcome == f64::RAY_SPACE || end.outcome == f64::RAY_GROUND;
  if (ended) {
    row.refraction_arcsec = to_arcsec(end.bending_rad);
    row.ground_distance_m = end.run * end.sigma_m;
    if (zenith_column > 0) row.air_mass = end.column[0] / zenith_column;
  }
  if (end.outcome == f64::RAY_SPACE) row.true_altitude_deg = row.apparent_altitude_deg - to_deg(end.bending_rad);
  row.min_height_m = std::max(0.0, f64::geometric_height_m(end.min_z_m, curvature_per_m));
  if (std::abs(row.min_height_m - request.height_m) < 1e-6 * std::max(1.0, request.height_m))
    row.min_height_m = request.height_m;  // float knows the eye's height to 7 digits
  row.max_height_m = f64::geometric_height_m(end.max_z_m, curvature_per_m);
  return row;
}

/// What the two settings of an estimate may have in common. Errors of single layers add up: over 4000 rows of hard
/// cases (tests/hard_cases) to at most eleven times that of one. Steps from above the air land on its top to their
/// tolerance.
double common_error_arcsec(double table_arcsec, const Profile &profile, const RefractionRequest &request) {
  if (request.method == RayMethod::cells) return 16 * table_arcsec;
  return table_arcsec + (request.height_m > profile.top_m(request.flat) ? 1e-5 : 0);
}

}  // namespace

RefractionTable refraction_table(const Profile &profile, const RefractionRequest &request,
                                 const std::shared_ptr<Device> &device) {
  return refraction_table(AirSection(profile.spec()), request, device);
}

RefractionTable refraction_table(const AirSection &air, const RefractionRequest &request,
                                 const std::shared_ptr<Device> &device) {
  const Profile profile = air.at(0);  // over the eye
  const bool single = request.precision == Precision::single_;
  const bool check_in_double = single && device->info().has_double;
  std::vector<double> elevations_rad;
  for (double altitude : request.altitudes_deg) elevations_rad.push_back(to_rad(altitude));
  double tolerance = request.tolerance_arcsec;
  RefractionTable result;
  Traced kept;
  std::vector<double> bounds;
  Check check;
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Setting fine = setting_for(tolerance / 8, request.precision);
    Setting other = setting_for(check_in_double ? tolerance / 8 : tolerance, request.precision);
    if (check_in_double) other = setting_for(tolerance / 64, Precision::double_);
    kept = trace_with(fine, air, request, elevations_rad, device);
    check = check_with(other, air, request, elevations_rad, device);
    const double table_arcsec = std::min(fine.table_arcsec, other.table_arcsec);
    bounds = error_bounds(kept.ends, check, common_error_arcsec(table_arcsec, profile, request));
    stop_if_asked();
    const bool at_the_floor = fine.table_arcsec <= (single ? 1e-4 : 1e-8) && fine.step_rad <= (single ? 1e-10 : 1e-14);
    if (worst_difference(kept.ends, check.rays) <= request.tolerance_arcsec || at_the_floor) break;
    tolerance /= 10;
  }

  if (request.section) measure_parts(kept, check, elevations_rad, request.wavelengths_nm.size(), result);
  const double curvature = request.flat ? 0 : 1 / profile.spec().earth_radius_m;
  const double zenith = profile.zenith_column_kg_m2(request.height_m);
  result.cells_per_row = kept.cells_per_row;
  result.table_bound_arcsec = kept.table_bound_arcsec;
  result.stats = kept.stats;
  for (std::size_t i = 0; i < kept.ends.size(); ++i) {
    RefractionRow row = make_row(request, i, kept.ends[i], curvature, zenith);
    row.max_height_m = std::min(row.max_height_m, std::max(profile.top_m(request.flat), request.height_m));
    row.error_arcsec = bounds[i];
    row.sideways_arcsec = to_arcsec(kept.sideways_rad[i]);
    if (request.height_m >= profile.top_m(request.flat) && row.turning_points == 0 && row.outcome == f64::RAY_SPACE)
      row.ground_distance_m = 0;  // in space from the first
    if (row.outcome == f64::RAY_SPACE) {
      result.error_arcsec = std::max(result.error_arcsec, row.error_arcsec);
      // Near a fold, what is allowed is an error of the direction that is seen wrongly.
      result.rows_over_tolerance += row.error_arcsec > request.tolerance_arcsec * check.stretch[i];
    }
    result.rows.push_back(row);
  }
  return result;
}

namespace {

TraceOptions stepping(const Setting &setting, RayMethod method) {
  TraceOptions options;
  options.precision = setting.precision;
  options.integrator = method == RayMethod::richardson ? Integrator::richardson : Integrator::dormand_prince;
  options.tolerance_rad = setting.step_rad;
  options.max_steps = 1000000;
  options.between_batches = stop_if_asked;
  return options;
}

/// By steps: one ray for each distance.
std::vector<f64::RayEnd> step_to_places(const Setting &setting, const Profile &profile, const TraceRequest &request,
                                        const std::shared_ptr<Device> &device) {
  const IndexTable table =
      build_index_table(profile, request.wavelengths_nm, {request.flat, setting.table_arcsec, request.height_m});
  std::vector<f64::RayStart> starts;
  for (double altitude : request.altitudes_deg)
    for (std::size_t w = 0; w < request.wavelengths_nm.size(); ++w)
      for (double distance_m : request.distances_m)
        starts.push_back(launch(table, w, request.height_m, to_rad(altitude), distance_m));
  std::vector<f64::RayEnd> ends = RayTracer(device, table, stepping(setting, request.method)).trace(starts);
  for (f64::RayEnd &end : ends) end.above_m += table.cell(0, static_cast<std::size_t>(end.cell)).bottom_m;
  return ends;
}

std::vector<f64::RayEnd> places_in_section(const Setting &setting, const AirSection &air, const TraceRequest &request,
                                           const std::shared_ptr<Device> &device) {
  const SectionTable table = build_section_table(section_medium(air, request.flat), request.wavelengths_nm,
                                                 {setting.table_arcsec, request.height_m});
  std::vector<f64_section::RayStart> starts;
  for (double altitude : request.altitudes_deg)
    for (std::size_t w = 0; w < request.wavelengths_nm.size(); ++w)
      for (double distance_m : request.distances_m)
        starts.push_back(launch(table, w, {0, request.height_m}, to_rad(altitude), request.azimuth_rad, distance_m));
  std::vector<f64::RayEnd> ends;
  for (const f64_section::RayEnd &end : SectionTracer(device, table, stepping(setting, request.method)).trace(starts))
    ends.push_back(plain(end, table));
  return ends;
}

/// Layers are placed by the bending of rays that cross them; a place inside one was measured to be some ten times
/// worse.
constexpr double part_of_a_layer = 16;

std::vector<f64::RayEnd> places_in_layers(const Setting &setting, const Profile &profile, const TraceRequest &request,
                                          const std::shared_ptr<Device> &device) {
  const IndexTable fine = build_index_table(
      profile, request.wavelengths_nm, {request.flat, std::max(setting.table_arcsec / 30, 1e-9), request.height_m});
  const double eye_m = f64::flattened_height_m(request.height_m, fine.curvature_per_m);
  const std::vector<double> edges = place_layers(fine, 0, eye_m, setting.table_arcsec / part_of_a_layer);
  LayerTracer tracer(device, build_layer_table(fine, edges, eye_m, {}), setting.precision, stop_if_asked);
  std::vector<double> elevations;
  for (double altitude : request.altitudes_deg) elevations.push_back(to_rad(altitude));
  return tracer.places(elevations, request.distances_m);
}

}  // namespace

std::vector<TraceRow> trace_table(const Profile &profile, const TraceRequest &request,
                                  const std::shared_ptr<Device> &device) {
  return trace_table(AirSection(profile.spec()), request, device);
}

std::vector<TraceRow> trace_table(const AirSection &air, const TraceRequest &request,
                                  const std::shared_ptr<Device> &device) {
  const Setting setting = setting_for(request.tolerance_arcsec, request.precision);
  const Profile profile = air.at(0);  // over the eye
  const std::vector<f64::RayEnd> ends = request.section ? places_in_section(setting, air, request, device)
                                        : request.method == RayMethod::cells
                                            ? places_in_layers(setting, profile, request, device)
                                            : step_to_places(setting, profile, request, device);
  const double curvature = request.flat ? 0 : 1 / profile.spec().earth_radius_m;
  std::vector<TraceRow> rows;
  for (double altitude : request.altitudes_deg)
    for (double wavelength : request.wavelengths_nm)
      for (double distance : request.distances_m) {
        const f64::RayEnd &end = ends[rows.size()];
        // Where the air varies, a ray that turned twice may yet leave its duct.
        const bool trapped = !request.section && end.outcome == f64::RAY_IN_FLIGHT && end.turning_points >= 2;
        rows.push_back({altitude, wavelength, distance, trapped ? static_cast<int>(f64::RAY_TRAPPED) : end.outcome,
                        f64::geometric_height_m(end.above_m, curvature), to_deg(std::atan2(end.rise, end.run)),
                        to_arcsec(end.bending_rad), end.optical_path_m});
      }
  return rows;
}

}  // namespace greenray
