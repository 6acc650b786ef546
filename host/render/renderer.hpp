// A scene becomes a spectral picture: plan, table, rays, pixels; every number of the report on the way.
#pragma once
#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/spectral_image.hpp"
#include "render/sky_rays.hpp"
#include "scene/scene.hpp"

namespace greenray {

struct SkySightCache;

struct RenderOptions {
  std::uint64_t seed = 1;
  bool straight = false;                   // no bending, for comparison
  bool quick = false;                      // quarter size
  std::optional<std::array<int, 2>> size;  // overrides observer.resolution
  std::optional<std::array<int, 4>> crop;  // x0, y0, x1, y1 in pixels, x1 and y1 excluded
  SourcePlace crop_place{"command line", 1, 1};
  std::optional<int> spp;  // these three override tracing.quality; the first one reached stops
  std::optional<double> error_pct, minutes;
  std::function<void(const std::string &phase, double fraction, double noise)> progress;
  SkySightCache *cache = nullptr;  // rays of sight of the picture before, for this one if it has the same
};

/// One decision of the planner: what was chosen, why, and what the choice costs in accuracy.
struct PlanChoice {
  std::string what, chosen, why;
  double cost = 0;
  std::string cost_unit;  // "arcsec", "pixel"; empty: no cost
};

/// What will be done and why; decided before the picture is computed.
struct RenderPlan {
  std::array<int, 2> size{};  // of the whole picture
  std::array<int, 4> crop{};
  std::vector<double> wavelengths_nm;  // of the picture
  std::vector<double> bent_nm;         // that have rays of their own: all, or one whose rays serve all
  Precision precision = Precision::single_;
  RayMethod method = RayMethod::cells;
  bool section = false;              // the air varies along the surface: adaptive steps
  double azimuth_from_path_rad = 0;  // of the picture's middle, clockwise from the direction of x
  std::vector<double> station_m;     // distances of targets, ascending
  bool rough_sea = false;            // waves before the horizon
  bool per_pixel = false;            // rays for every sample instead of a transfer table
  double pixel_arcsec = 0;
  double first_elevation_deg = 0, spacing_arcsec = 0;
  std::size_t entries = 0;  // of the evenly spaced table that pixels look up
  std::size_t device_bytes = 0, host_bytes = 0;
  int spp = 16;
  std::optional<double> error_pct, minutes;
  std::vector<PlanChoice> choices;
  std::vector<std::string> modelled, left_out;  // each with its reason
};

/// Azimuths from a direction that lies azimuth_rad from the picture's centre, over the whole picture, 0..pi.
struct AzimuthRange {
  double nearest_rad, farthest_rad;
};
AzimuthRange azimuths_from(const Scene &scene, const RenderPlan &plan, double azimuth_rad);

RenderPlan plan_render(const Scene &scene, const RenderOptions &options);

/// Throws InputError when the Sun's or the Moon's apparent altitude is given and light from there does not come from
/// the sky. Needs no device; `render` does the same later.
void require_sun_in_sky(const Scene &scene, const RenderOptions &options);

struct RenderReport {
  TraceStats trace;
  bool table_in_image = false;
  std::size_t table_cells = 0, curve_entries = 0;
  double table_bound_arcsec = 0;                                  // the builder's own, worst grazing ray
  double table_arcsec = 0, solver_arcsec = 0, lookup_arcsec = 0;  // errors
  std::optional<double> target_arcsec;                            // of heights at targets, as an angle at the eye
  std::optional<double> sun_optical_depth;                        // on the Sun's own path, at the middle wavelength
  double noise_rms = 0, bias = 0;                                 // relative to the mean radiance
  double azimuth_error = 0;  // of the sky's light between the azimuths of its table, largest, relative
  int spp = 0;
  std::optional<double> sun_true_altitude_deg, sun_apparent_altitude_deg;  // of its centre, at 550 nm
  std::optional<double> horizon_altitude_deg;                              // apparent, at 550 nm
  double compile_seconds = 0, build_seconds = 0, emit_seconds = 0, gather_seconds = 0;
};

struct Rendered {
  SpectralImage image;
  RenderReport report;
};

/// Throws InputError when the Sun's apparent altitude is not in the sky, Interrupted when asked to stop.
Rendered render(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                const std::shared_ptr<Device> &device);

/// Set by the signal handler; looked at between batches.
void request_stop();
bool stop_requested();
void stop_if_asked();  // throws Interrupted

}  // namespace greenray
