// Ends of rays from either precision as the double the host works with.
#pragma once
#include <cmath>

#include "compute/device_answers.hpp"
#include "twin/twin.hpp"

namespace greenray {

/// errors: RunError for what no ray can end as
template <class End>
void require_ray_end(const End &e) {
  const bool has_outcome = e.outcome >= 0 && e.outcome < static_cast<int>(f64::RAY_OUTCOMES);
  const bool arrived = e.outcome == f64::RAY_SPACE || e.outcome == f64::RAY_GROUND;
  if (!has_outcome || e.steps < 0 || e.rejected < 0 || e.turning_points < 0 ||
      (arrived && !std::isfinite(e.bending_rad)))
    throw_bad_answer("ends of rays");
}

inline f64::RayEnd widened(const f64::RayEnd &e) {
  require_ray_end(e);
  return e;
}
inline f64::RayEnd widened(const f32::RayEnd &e) {
  return widened(f64::RayEnd{e.above_m,
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
                             e.rejected});
}

}  // namespace greenray
