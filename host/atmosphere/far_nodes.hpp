// What lies far above the eye, merged into a few nodes (kernels/shared/layers.h, struct FarNode).
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "atmosphere/layer_data.hpp"

namespace greenray {

/// The medium beyond some height as a ray sees it: for any s2 = sin^2 of its elevation at the eye, every quantity is
///   F(s2) = integral of weight dz / sqrt(s2 + (1 - s2) lift),
/// here a sum over points, fine enough to be taken for the integral. All lifts are above 0.
struct FarMedium {
  std::vector<double> lift;
  std::vector<std::array<double, layer_quantities>> weight;  // [points], the step of z included
};

/// The same medium as few points as will do: weights are handed to eight nodes a panel of width 1/4 in ln(lift), by
/// interpolation of the kernel, which is analytic at a distance of pi: exact to about 1e-13.
FarMedium compressed(const FarMedium &medium);

/// Nodes whose sum agrees with F for every s2 in 0..1: to error_rad for the bending (times cos e), and relatively to
/// relative_error for the other quantities, unless bending_only. At most `most` of them, a multiple of 4; empty when
/// that is not enough. source: derived here. The nodes are those of Gauss's quadrature in ln(lift) for the medium's own
/// measure (Lanczos; Golub & Welsch, Math. Comp. 23 (1969) 221), since 1/sqrt(s2 e^-x + 1 - s2) is analytic in |Im x| <
/// pi; their weights are fitted by least squares over s2, so that the measure need not be positive (air over a hot
/// road).
std::vector<FarNode> merge_far(const FarMedium &medium, double error_rad, double relative_error, bool bending_only,
                               std::size_t most);

/// Nodes of a given number for another wavelength of the same air, and by how much their bending is off [rad].
struct FarFit {
  std::vector<FarNode> nodes;
  double bending_error_rad, relative_error;
};
FarFit fit_far(const FarMedium &medium, std::size_t count, bool bending_only);

}  // namespace greenray
