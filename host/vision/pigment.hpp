// The pigment left on a retina that looks at one picture after the other.
#pragma once
#include <array>
#include <vector>

#include "vision/planes.hpp"
#include "vision/retina.hpp"

namespace greenray::vision {

/* Unbleached fractions [L, M, S] of a retina: of every pixel, of the cells, and of the bright disk as a whole.
   New pictures meet the pigment that earlier ones left; forget() puts the eye to rest. */
class PigmentHistory {
 public:
  void forget();
  /// Room for the pixels of a sequence, at rest on first call.
  void keep_pixels(std::size_t pixels);
  bool keeps_pixels() const { return !pixels_[0].empty(); }
  /// Of a kind of cone, from pixel `first` on.
  float *pixels(std::size_t cone, std::size_t first) { return pixels_[cone].data() + first; }

  /* Lets the cells bleach under this picture and writes retina.pool and, where the disk bleaches as one, retina.shared.
     The pool is what a light-weighted gaze catches: sum of T (u T) over sum of T T, T trolands of a cell. The faint
     veil around a Sun, wide and unbleached, would rule a mean over the light and turn a white disk blue. colour: planes
     X, Y, Z of the cells and their luminance. */
  void expose(const Planes &cells, const Plane &luminance, Retina &retina);

 private:
  std::array<std::vector<float>, 3> pixels_, cells_;
  std::array<double, 3> disk_{1, 1, 1};
};

}  // namespace greenray::vision
