// The photon map itself as a picture: every photon a dot in the pixel whose eye path ends beside it. G04 figure 3.1,
// right.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "compute/photon_map.hpp"

namespace greenray {

/* Which pixel shows which photons, for eye paths however bent or mirrored: each photon belongs to the nearest end of an
   eye path that faces the same way (60 degrees), no further from it than the ends of neighbouring pixels are. Photons
   that no path ends at are hidden or outside the picture. Of several paths that show the same place, in a mirror and
   directly, one shows the photon. */
class PhotonPicture {
 public:
  /// ends: [rows][columns][samples], of paths through each pixel; waves: that photons carry.
  PhotonPicture(std::span<const GatherPoint> ends, std::size_t columns, std::size_t samples, std::size_t waves);

  /// Dots for about `most` of the photons of this map, chosen by their numbers, so that the same map gives the same.
  void show(const PhotonMap::Contents &photons, std::size_t most);

  std::size_t shown() const { return shown_; }  // dots in the picture
  /// Photons in each pixel, and the sum of their powers [pixels][waves], wave fastest.
  const std::vector<float> &counts() const { return counts_; }
  const std::vector<float> &power() const { return power_; }

 private:
  std::vector<GatherPoint> ends_;
  std::vector<float> reach_m_;  // of each end; 0: shows nothing
  std::size_t samples_, waves_, shown_ = 0;
  std::vector<float> counts_, power_;
};

}  // namespace greenray
