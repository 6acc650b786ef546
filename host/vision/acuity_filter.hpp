// Detail that the eye does not resolve, averaged away: more of it where the scene is dark.
#pragma once
#include <vector>

#include "vision/planes.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

/// How coarse the places of a row are seen.
struct RowLevels {
  std::vector<float> level;   // of each pixel
  float least = 0, most = 0;  // of the row
};

/* How coarse each place is seen: log2 of the side [pixels] of one sample of acuity, 0 where every pixel is resolved.
   Follows the foveal luminance (about 1 degree) around the place, as in pcond. */
class AcuityMap {
 public:
  AcuityMap(const Plane &foveal_cd_m2, const ViewGeometry &view);
  bool resolves_everything() const { return coarsest_ <= 0; }
  float coarsest() const { return coarsest_; }
  /// Of every pixel of a row.
  void levels_of_row(int y, RowLevels &levels) const;

 private:
  int width_, height_;  // of the picture
  Plane level_;         // at the foveal samples
  float coarsest_ = 0;
};

/* A picture at every resolution: means of 2^l x 2^l pixels. The fine levels come from a band of rows, the coarse ones
   from the cells of the whole picture. */
class Pyramid {
 public:
  /// cells: level `levels` (a cell is 2^levels pixels).
  Pyramid(const Plane &cells, int levels);

  class Band {
   public:
    /// rows: of the picture from first_row on, a multiple of 2^levels. The pyramid must outlive the band.
    Band(const Pyramid &whole, Plane rows, int first_row);
    float *row(int y) { return fine_[0].row(y - first_row_); }
    /// A row of the picture as it is seen at these levels: bilinear in each level, straight between two.
    void seen_row(int y, const RowLevels &levels, float *to) const;

   private:
    void row_of_level(int y, int level, int width, std::vector<float> &to) const;
    const Pyramid &whole_;
    std::vector<Plane> fine_;
    int first_row_;
  };

 private:
  int levels_;
  std::vector<Plane> coarse_;  // from level `levels` on
};

}  // namespace greenray::vision
