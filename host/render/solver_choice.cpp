#include "render/solver_choice.hpp"

namespace greenray {

SolverChoice choose_solver(const ProfileSpec &air, const std::string &method, const SourcePlace &asked_at) {
  const bool varies = varies_along_surface(air), stepping = method == "rk" || method == "richardson";
  SolverChoice choice;
  choice.section = varies || method == "section" || (stepping && has_places(air));
  choice.method = method == "richardson"             ? RayMethod::richardson
                  : method == "rk" || choice.section ? RayMethod::dormand_prince
                                                     : RayMethod::cells;
  if (varies && method == "cells")
    throw InputError(asked_at,
                     "the air varies along the surface, which layers in closed form cannot follow: expected "
                     "auto, rk or richardson");
  if (varies) choice.why = "n varies along the surface: adaptive steps through the section";
  else if (choice.section) choice.why = "asked for: adaptive steps through the section, though nothing varies along it";
  else if (has_places(air)) choice.why = "the lists x_m change nothing along the surface: the solver for layers serves";
  else choice.why = method == "auto" ? "n depends on height alone: layers in closed form" : "asked for";
  return choice;
}

}  // namespace greenray
