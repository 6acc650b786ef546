// What the eye adapts to: foveal samples, histogram, pupil.
#pragma once
#include <array>
#include <optional>

#include "vision/acuity_filter.hpp"
#include "vision/human_eye.hpp"
#include "vision/planes.hpp"
#include "vision/retinal_light.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

/* One sample a degree across the picture (plane width / 1 degree, at least 2 by 2), each the mean of its part. A field
   under 5 degrees, which Ward's method refuses, gets one sample a Sun radius (0.2666 degrees). */
Plane foveal_samples(const Plane &cells, const ViewGeometry &view);
std::array<int, 2> foveal_size(const ViewGeometry &view);

/// Light that the pupil answers: the picture, filled up to 60 square degrees with the light around it.
PupilField pupil_field(const ViewGeometry &view, double mean_cd_m2, double surround_cd_m2, const EyeOptions &options);

/// What an adapted eye makes of luminances and detail.
struct Adaptation {
  ToneTable tone;
  RodVision rods = RodVision::off;  // off where the scene is bright enough for cones alone
  std::optional<AcuityMap> acuity;  // nothing where the eye resolves every pixel
};

/// Single pixels for the histogram: 16 for each foveal sample, 4096 to a million.
std::size_t point_count(const ViewGeometry &view);

/// Foveal samples and histogram of the retinal light, and what follows from them. report: its part is filled in.
Adaptation adapt(const RetinalLight &light, const ViewGeometry &view, const EyeOptions &options, EyeReport &report);

/// The pupil, and what of the cones' exposure is common to all pixels. report: its part is filled in.
Retina open_pupil(const RetinalLight &light, const ViewGeometry &view, const EyeOptions &options, EyeReport &report);

}  // namespace greenray::vision
