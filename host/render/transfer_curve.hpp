// The transfer curve: for an eye in layered air, what every ray of sight does, over elevation and wavelength.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "render/sky_rays.hpp"
#include "render/transfer.hpp"

namespace greenray {

/// Entries at elevations placed by themselves. Between two entries a quantity is interpolated linearly, unless it jumps
/// there for that wavelength (such a pair of entries brackets the jump closely).
struct TransferCurve {
  std::string profile;
  double height_m = 0, zenith_column_kg_m2 = 0;
  std::vector<double> wavelength_nm, elevation_rad;  // elevations ascending
  std::vector<Transfer> rays;                        // [elevations][wavelengths]
  std::vector<bool> joined_to_next;                  // [elevations][wavelengths]
  double interpolation_arcsec = 0;  // largest error seen half way between entries, over max(1, |d true/d apparent|)
  std::size_t rays_traced = 0;

  std::size_t index(std::size_t entry, std::size_t wave) const { return entry * wavelength_nm.size() + wave; }
  const Transfer &at(std::size_t entry, std::size_t wave) const { return rays[index(entry, wave)]; }
  bool joined(std::size_t entry, std::size_t wave) const { return joined_to_next[index(entry, wave)]; }
};

/// Traces elevations until linear interpolation is good to tolerance_arcsec, and columns and distance to 1e-3
/// relatively, each over max(1, |d true/d apparent|). The jumps of every wavelength (sky_rays.hpp, breaks_rad) are
/// bracketed; in air that varies along the surface they are closed in on by halving.
/// narrowest_rad: no interval is split further. Leaves profile and zenith_column_kg_m2 to the caller.
TransferCurve trace_transfer_curve(SkyRays &rays, double low_rad, double high_rad, double tolerance_arcsec,
                                   double narrowest_rad = 2e-9);

/// One image of a point outside the air.
struct Image {
  double apparent_altitude_deg;
  bool erect;            // d apparent/d true > 0
  double magnification;  // |d apparent/d true|, vertical
};

/// All apparent altitudes at which a true altitude is seen, ascending: the inverse question, which has none, one or
/// many answers. From the curve alone; good to its interpolation error.
std::vector<Image> images_of(const TransferCurve &curve, std::size_t wave, double true_altitude_rad);

/// Evenly spaced entries for pictures, each interpolated from the curve, with the places of its jumps.
TransferTable evenly_spaced(const TransferCurve &curve, double first_rad, double spacing_rad, std::size_t entries);

/// CSV with a header that says all that is needed to read it back; see docs/file-formats.md.
std::string as_csv(const TransferCurve &curve);
/// Throws InputError with file:line:column.
TransferCurve read_transfer_curve(const std::filesystem::path &path);

}  // namespace greenray
