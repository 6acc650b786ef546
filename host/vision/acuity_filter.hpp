// Detail that the eye does not resolve, averaged away: more of it where the scene is dark.
#pragma once
#include <memory>
#include <vector>

#include "vision/planes.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

/* How coarse each place is seen: log2 of the side [pixels] of one sample of acuity, 0 where every pixel is resolved.
   Follows the foveal luminance (about 1 degree) around the place, as in pcond. */
class AcuityMap {
 public:
  AcuityMap(const Plane &foveal_cd_m2, const ViewGeometry &view);
  bool resolves_everything() const { return coarsest_ <= 0; }
  float coarsest() const { return coarsest_; }
  /// Of every pixel of a row.
  void levels_of_row(int y, std::vector<float> &levels) const;

 private:
  ViewGeometry view_;
  Plane level_;  // at the foveal samples
  float coarsest_ = 0;
};

/* A picture at every resolution: means of 2^l x 2^l pixels. The fine levels come from a band of rows, the coarse ones
   from the cells of the whole picture. */
class Pyramid {
 public:
  /// cells: level `levels` (a cell is 2^levels pixels). Kept by reference in the bands.
  Pyramid(const Plane &cells, int levels);
  /// value: band of rows, first_row a multiple of 2^levels.
  class Band {
   public:
    Band(const Pyramid &whole, Plane rows, int first_row);
    /// Value at a pixel, seen at this (fractional) level.
    float at(int x, int y, float level) const;

   private:
    float at_level(int x, int y, int level) const;
    const Pyramid &whole_;
    std::vector<Plane> fine_;
    int first_row_;
  };

 private:
  int levels_;
  std::vector<Plane> coarse_;  // from level `levels` on
};

}  // namespace greenray::vision
