#include "scene/absorbers_file.hpp"

namespace greenray {

void read_absorbers(const TomlTable &atmosphere, AtmosphereScene &air) {
  atmosphere.read("extinction", air.extinction);
  atmosphere.read("ozone_DU", air.ozone_DU, {0, 2000, "DU"});
  const TomlTable aerosol = atmosphere.table("aerosol");
  aerosol.read("visibility_km", air.visibility_km, {0, 1000, "km", true});
  aerosol.read("turbidity", air.turbidity, {1, 100});
  aerosol.read("angstrom", air.angstrom, {-1, 5});
  aerosol.read("scale_height_m", air.aerosol_scale_height_m, {0, 1e5, "m", true});
  aerosol.read("asymmetry", air.aerosol_asymmetry, {-0.95, 0.95});
  aerosol.read("scattering_albedo", air.aerosol_scattering_albedo, {0, 1});
  if (aerosol.has("visibility_km") && aerosol.has("turbidity"))
    aerosol.complain("turbidity", "expected either visibility_km or turbidity, found both");
}

}  // namespace greenray
