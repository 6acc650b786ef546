#include "render/scene_eye.hpp"

#include <algorithm>

namespace greenray {

vision::EyeOptions eye_options_of(const EyeScene &eye, double fov_deg) {
  using namespace vision;
  EyeOptions options;
  options.display = {eye.ldmax_cd_m2, eye.contrast};
  options.sensitivity = eye.sensitivity;
  options.glare = eye.glare;
  options.acuity = eye.acuity;
  options.rods = eye.colour ? RodVision::ward : RodVision::off;
  options.eye.age_years = eye.age_years;
  options.fov_deg = fov_deg;
  options.magnification = std::min(eye.magnification, 179 / fov_deg);
  options.pupil = eye.pupil == "de-groot"       ? PupilModel::de_groot
                  : eye.pupil == "moon-spencer" ? PupilModel::moon_spencer
                  : eye.pupil == "g04"          ? PupilModel::g04
                                                : PupilModel::watson_yellott;
  BleachingOptions &bleaching = options.bleaching;
  if (eye.bleaching_steady) bleaching.exposure = BleachingOptions::Exposure::steady;
  else if (eye.bleaching_seconds) bleaching.exposure = BleachingOptions::Exposure::seconds;
  bleaching.seconds = eye.bleaching_seconds.value_or(0);
  bleaching.model = eye.bleaching_model == "shape"       ? BleachModel::shape
                    : eye.bleaching_model == "threshold" ? BleachModel::threshold
                    : eye.bleaching_model == "adapted"   ? BleachModel::adapted
                                                         : BleachModel::catch_;
  bleaching.pooled = eye.bleaching_pool == "disk";
  return options;
}

}  // namespace greenray
