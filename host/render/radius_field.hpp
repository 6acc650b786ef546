// Radii of density estimates that do not reach over bright edges.
#pragma once
#include <cstddef>
#include <span>

#include "compute/photon.hpp"

namespace greenray {

/* The radius of the k nearest photons, taken place by place, makes bright patches grow: a dark place reaches out until
   it holds k photons, and finds them beyond the edge. Here radii are lowered until none is more than slope (0..1) times
   the distance larger than that of a place around it which faces the same way (60 degrees): a place d from an edge then
   has at most radius(edge) + slope d, and for d above radius(edge)/(1 - slope) does not reach it.

   places: [rows][columns][samples], neighbours in the picture; radius_m: one for each, lowered. Two sweeps over the
   picture, as in a chamfer distance: every bound holds, but neighbours behind others may be missed. source: Borgefors,
   "Distance transformations in digital images", CVGIP 34 (1986), for the sweeps */
void limit_radius_slope(std::span<const GatherPoint> places, std::size_t columns, std::size_t samples, double slope,
                        std::span<float> radius_m);

/* The same for places that came later: each is lowered by the others around it, which stay as they are.
   around: [places][any number] numbers of others; beyond the last: none */
void limit_radii_beside(std::span<const GatherPoint> places, std::span<float> radius_m,
                        std::span<const GatherPoint> others, std::span<const float> other_radius_m,
                        std::span<const std::size_t> around, double slope);

}  // namespace greenray
