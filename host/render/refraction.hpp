// Refraction tables: for apparent altitudes and wavelengths, where the light comes from, and how well that is known.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "atmosphere/air_section.hpp"
#include "render/sky_rays.hpp"

namespace greenray {

struct RefractionRequest {
  double height_m = 0;                // of the eye
  std::vector<double> altitudes_deg;  // apparent: above the horizontal, in the air there
  std::vector<double> wavelengths_nm;
  Precision precision = Precision::double_;
  RayMethod method = RayMethod::cells;
  double tolerance_arcsec = 1e-4;  // bounds the error of refraction for rays that reach space, the table's included
  bool flat = false;
  bool section = false;    // step through the air as varying along the surface, whether or not it does
  double azimuth_rad = 0;  // clockwise from the direction of x; of air that varies
};

struct RefractionRow {
  double apparent_altitude_deg, wavelength_nm;
  int outcome;                              // RayOutcome
  std::optional<double> refraction_arcsec;  // space: total; ground: up to the hit
  std::optional<double> true_altitude_deg, air_mass;
  double min_height_m, max_height_m;
  std::optional<double> ground_distance_m;
  int turning_points;
  double error_arcsec;         // bound: see refraction_table
  double sideways_arcsec = 0;  // out of the vertical plane, clockwise; of air that varies
};

struct RefractionTable {
  std::vector<RefractionRow> rows;  // altitudes outermost, in the order given
  std::size_t cells_per_row = 0;
  double table_bound_arcsec = 0;  // above the tolerance when a layer is too thin for the table
  double error_arcsec = 0;        // largest estimate over rows with status space
  /// Of air that varies: the largest error of rays that reach space, by the finer setting, that the table causes, and
  /// what the device's steps and rounding add to it; over max(1, |dR/da|).
  std::optional<double> measured_table_arcsec, measured_solver_arcsec;
  std::size_t rows_over_tolerance = 0;  // status space, and over max(1, |dR/da|) above it
  TraceStats stats;
};

/// Traces twice, with a coarser and a finer table and step tolerance, and tightens both until the difference is within
/// the tolerance; in float the finer one is in double where the device has it, so that rounding is part of the
/// estimate. A row's error: one and a half times that difference, plus what both settings may have in common, the finer
/// one's table error times max(1, |dR/da|), for near a fold an error of direction is an error of refraction so many
/// times larger.
/// Air that varies along the surface: request.section with a stepping method.
RefractionTable refraction_table(const AirSection &air, const RefractionRequest &request,
                                 const std::shared_ptr<Device> &device);
RefractionTable refraction_table(const Profile &profile, const RefractionRequest &request,
                                 const std::shared_ptr<Device> &device);

struct TraceRequest {
  double height_m = 0;
  std::vector<double> altitudes_deg, wavelengths_nm, distances_m;
  Precision precision = Precision::double_;
  RayMethod method = RayMethod::cells;
  double tolerance_arcsec = 1e-4;
  bool flat = false;
  bool section = false;  // as in RefractionRequest
  double azimuth_rad = 0;
};

struct TraceRow {
  double apparent_altitude_deg, wavelength_nm, distance_m;
  int outcome;                                                     // in flight, or what ended it before the distance
  double height_m, elevation_deg, bending_arcsec, optical_path_m;  // at the distance, or where it ended
};

/// Where each ray is after a distance along the surface. Rows: altitude outermost, then wavelength, then distance.
std::vector<TraceRow> trace_table(const AirSection &air, const TraceRequest &request,
                                  const std::shared_ptr<Device> &device);
std::vector<TraceRow> trace_table(const Profile &profile, const TraceRequest &request,
                                  const std::shared_ptr<Device> &device);

}  // namespace greenray
