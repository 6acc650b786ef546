// Photons in a room, on its walls or in its air, and places that ask for them.
#pragma once
#include <string>
#include <vector>

#include "compute/photon_map.hpp"

namespace greenray::bench {

/// even: on all walls with the same density. lit: three photons in ten lie in a bright patch of 1 m^2 with soft edges.
/// caustic: six in ten lie along a cusped line on one wall, 4 mm wide. volume: anywhere in the air.
enum class Light { even, lit, caustic, volume };

/// One wavelength, powers that differ by a factor of ten.
struct PhotonCase {
  std::string name;
  std::vector<Photon> photons;  // in the order of their emission
  std::vector<float> power_W;
  std::vector<GatherPoint> points;  // in tiles of 8 x 8 pixels; volume: in places along lines of sight
  Bounds room;
  double radius_m = 0;  // of what holds 150 photons on average, were they spread evenly
};

PhotonCase photon_case(Light light, std::size_t photons, int width, int height);

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
