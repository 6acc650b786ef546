// The first look at a picture: its light in cells, single points, and what was wrong with it.
#pragma once
#include "vision/light.hpp"
#include "vision/planes.hpp"

namespace greenray::vision {

/// How a picture lies before the eye.
struct ViewGeometry {
  int width = 0, height = 0;
  double fov_deg = 0;                      // horizontal, at the eye: magnified
  bool assumed = false;                    // the picture did not say: its smaller side is taken as 40 degrees wide
  double half_width = 0, half_height = 0;  // tangents
  double pixel_deg = 0;                    // in the middle
  double area_deg2() const;
};
/// errors: fov_deg x magnification outside 0 .. 179 degrees -> std::domain_error
ViewGeometry view_geometry(int width, int height, std::optional<double> fov_deg, double magnification);

struct Survey {
  int levels = 0;  // a cell is 2^levels x 2^levels pixels
  Planes cells;    // [light plane]: means over the pixels of a cell that lie in the picture
  /* [light plane]: the cells again, each a smooth mean that takes from its neighbours, so that a light between two
     cells is shared by them (halved_smoothly, nothing outside), with a frame of one cell around. What a picture of 1
     has there is the product of a column's value and a row's. */
  Planes smooth;
  std::vector<float> smooth_across, smooth_down;
  std::vector<float> points;  // luminance of single pixels, evenly scattered (R2 sequence), always the same ones
  LightFaults faults;
  float least_cd_m2 = 0, most_cd_m2 = 0;
  double mean_cd_m2 = 0;
};

/* Reads the whole picture once, twice if it has infinite pixels: they become as bright as the brightest finite one.
   points: wanted number of single pixels; all of them if the picture has fewer. smooth: make the smooth cells, too */
Survey survey_picture(LightStore &store, const PictureFacts &facts, std::size_t points, bool smooth, unsigned threads);

/// Light around the picture: the mean of the cells along its frame, without the brightest quarter (a Sun at the edge).
std::vector<float> surround_of(const Survey &survey, std::size_t luminance_plane);

/// Rows that threads take at a time; a multiple of every cell.
inline constexpr int rows_per_piece = 64;

}  // namespace greenray::vision
