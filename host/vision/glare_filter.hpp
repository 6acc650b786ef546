// The glare of the eye over a whole picture: every pixel's light spread by the CIE function, coarse to fine.
#pragma once
#include "vision/glare.hpp"
#include "vision/planes.hpp"

namespace greenray::vision {

/* Spreads light over a picture given in two resolutions: pixels, in bands of rows, and cells of 2^levels pixels, whole.
   Wide Gaussians of the spread function are convolved at a resolution that suits them (the blur of going down and up
   again is taken off their width), the widest in one sum over all pairs of at most 40 x 40 points.
   Light must be given as the difference to the light around the picture: what is outside is then 0, and the sum stays
   right up to the frame, the share from outside it included.
   pixel_deg: at the eye, in the middle of the picture; angles are measured in the picture's plane. */
class GlareFilter {
 public:
  GlareFilter(int width, int height, int levels, double pixel_deg, const Eye &eye);

  /// Rows that a band needs above and below; a multiple of 2^levels.
  int halo_rows() const { return halo_rows_; }
  /// Share of its own light that a cell keeps: all that is spread less than about a cell.
  double kept_by_cells() const { return kept_by_cells_; }
  double kept_by_pixels() const { return kept_by_pixels_; }

  /// Veil over the cells from everything wider than a cell. cells: smooth differences to the light around, with a frame
  /// of one cell (Survey::smooth). returns: the same size.
  Plane veil(const Plane &cells) const;
  /* Spread light of a band, all rows valid but the halo. band: differences, a cell more on the left and the right, its
     first row at first_row (a multiple of 2^levels, may be negative), 0 outside the picture. */
  Plane spread(const Plane &band, int first_row, const Plane &veil) const;

 private:
  struct Blur {
    double variance, share;  // [pixels of its level]^2, of the light
  };
  std::vector<Blur> blurs_of_level(int level) const;
  Plane all_pairs(const Plane &cells, int level) const;

  int width_, height_, levels_, halo_rows_ = 0;
  double pixel_sr_;
  GlareSum sum_;
  double pixel_deg_;
  double kept_by_pixels_ = 0, kept_by_cells_ = 0;
};

}  // namespace greenray::vision
