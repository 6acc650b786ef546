// What the eye adapts to: foveal samples, histogram, pupil, and the bleaching of the pool.
#pragma once
#include "vision/human_eye.hpp"
#include "vision/planes.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

/* One sample a degree across the picture (plane width / 1 degree, at least 2 by 2), each the mean of its part. A field
   under 5 degrees, which Ward's method refuses, gets one sample a Sun radius (0.2666 degrees). */
Plane foveal_samples(const Plane &cells, const ViewGeometry &view);
std::array<int, 2> foveal_size(const ViewGeometry &view);

/// Light that the pupil answers: the picture, filled up to 60 square degrees with the light around it.
PupilField pupil_field(const ViewGeometry &view, double mean_cd_m2, double surround_cd_m2, const EyeOptions &options);

}  // namespace greenray::vision
