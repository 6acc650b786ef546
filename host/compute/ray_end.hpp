// Ends of rays from either precision as the double the host works with.
#pragma once
#include "twin/twin.hpp"

namespace greenray {

inline f64::RayEnd widened(const f32::RayEnd &e) {
  return {e.above_m,
          e.run,
          e.rise,
          e.sigma_m,
          e.bending_rad,
          e.optical_path_m,
          {e.column[0], e.column[1], e.column[2]},
          e.min_z_m,
          e.max_z_m,
          e.solver_error_rad,
          e.bouguer_drift,
          e.cell,
          e.outcome,
          e.turning_points,
          e.steps,
          e.rejected};
}
inline f64::RayEnd widened(const f64::RayEnd &e) { return e; }

}  // namespace greenray
