// Which solver a profile needs, and what to say about it.
#pragma once
#include <string>

#include "render/sky_rays.hpp"

namespace greenray {

struct SolverChoice {
  RayMethod method = RayMethod::cells;
  bool section = false;  // the adaptive solver for air that varies along the surface
  std::string why;
};

/// method: "auto", "cells", "rk", "richardson" or "section". The layered solvers serve wherever nothing varies along
/// the surface; "section", and "rk" or "richardson" for a profile that speaks of places x_m, step through the section
/// all the same. errors: InputError at asked_at for cells and air that varies
SolverChoice choose_solver(const ProfileSpec &air, const std::string &method, const SourcePlace &asked_at);

}  // namespace greenray
