// Symmetry: with n(h) and a fixed eye, all that a sky ray does depends on its elevation and wavelength alone.
// The transfer table holds it over evenly spaced elevations; pictures are filled from it by look-up.
#pragma once
#include <vector>

#include "render/sky_rays.hpp"

namespace greenray {

/// One ray of the table: where it ends and what it went through.
struct Transfer {
  int outcome;
  double true_altitude_rad;  // of its direction outside the air (space only)
  double bending_rad;
  std::array<double, 3> column;  // air [kg/m^2], ozone and aerosol [m], as in kernels/shared/ray.h
  double distance_m, min_height_m;
};

struct TransferTable {
  double first_elevation_rad = 0, spacing_rad = 0;
  std::size_t entries = 0, wavelengths = 0;
  std::vector<Transfer> rays;  // [entries][wavelengths]
  std::vector<float> edges;    // [entries][wavelengths]: 1, or where to the next entry the outcome changes (below 1)
  const Transfer &at(std::size_t entry, std::size_t wave) const { return rays[entry * wavelengths + wave]; }
  double elevation_rad(std::size_t entry) const {
    return first_elevation_rad + static_cast<double>(entry) * spacing_rad;
  }
};

/// Apparent elevation [rad] at which a ray was sent.
inline double elevation_rad(const Transfer &ray) { return ray.true_altitude_rad + ray.bending_rad; }

/// A ray's end as an entry.
Transfer transfer_of(const f64::RayEnd &end, double elevation_rad, double curvature_per_m);

/// Where one wavelength's rays serve all: as many copies of each. [n][bent] -> [n][wanted]; bent is 1 or wanted.
template <class Value>
std::vector<Value> for_all_wavelengths(const std::vector<Value> &values, std::size_t bent, std::size_t wanted) {
  if (bent == wanted) return values;
  std::vector<Value> all;
  all.reserve(values.size() * wanted);
  for (const Value &value : values) all.insert(all.end(), wanted, value);
  return all;
}

/// Every wavelength at the elevations given, unevenly spaced (first_elevation_rad and spacing_rad are left 0).
TransferTable trace_elevations(SkyRays &rays, const std::vector<double> &elevations_rad);
/// The same, each at its own azimuth, clockwise from where the eye of `rays` looks.
TransferTable trace_directions(SkyRays &rays, const std::vector<double> &elevations_rad,
                               const std::vector<double> &azimuths_rad);

/// The entries half way between those of `table`, at most `probes` of them, evenly chosen; `below` says after which
/// entry.
struct TransferProbes {
  std::vector<std::size_t> below;
  std::vector<Transfer> rays;  // [probes][wavelengths]
};
TransferProbes probe_between(SkyRays &rays, const TransferTable &table, std::size_t probes);

/// Largest error [arcsec] of true altitude when joined entries are interpolated half way, over max(1, |d true/d
/// apparent|): near a fold, the direction that is seen wrongly.
double lookup_error_arcsec(const TransferTable &table, const TransferProbes &probes);

}  // namespace greenray
