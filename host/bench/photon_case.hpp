// Photons on the walls of a room, and the places on them that a camera inside sees.
#pragma once
#include <string>
#include <vector>

#include "compute/photon_map.hpp"

namespace greenray::bench {

/// One wavelength, powers that differ by a factor of ten.
struct PhotonCase {
  std::string name;
  std::vector<Photon> photons;  // in the order of their emission
  std::vector<float> power_W;
  std::vector<GatherPoint> points;  // in tiles of 8 x 8 pixels
  Bounds room;
  double area_m2 = 0;
};

/// even: the same density everywhere. lit: three photons in ten lie in a bright patch of 1 m^2 with soft edges.
PhotonCase photon_case(bool lit, std::size_t photons, int width, int height);

/// Irradiance by Epanechnikov's kernel and count, in double over all photons; distances in float, as ours and peers'.
struct BruteForce {
  std::vector<double> irradiance;
  std::vector<int> counts;
};
/// one_wall: of the asking point's own wall only.
BruteForce brute_force(const PhotonCase &c, const std::vector<std::size_t> &points, float radius_m, bool one_wall,
                       unsigned threads);

/// Squared distance of the k-th nearest photon, over all photons.
std::vector<float> brute_nearest(const PhotonCase &c, const std::vector<std::size_t> &points, int k, unsigned threads);

}  // namespace greenray::bench
