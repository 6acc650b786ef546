#include "cli/observe.hpp"

#include <cmath>

#include "image/colour.hpp"
#include "image/picture_sink.hpp"
#include "image/picture_source.hpp"
#include "image/png.hpp"
#include "render/scene_eye.hpp"
#include "support/angle.hpp"
#include "vision/report_json.hpp"

namespace greenray::cli {

Observed observe(const EyeScene &eye, double fov_deg, int full_width, const SpectralImage &image, AtomicFile &png) {
  Observed observed;
  if (eye.model != EyeScene::Model::human) {
    const CameraPicture camera = develop_camera(rgb_from_spectral(image), {eye.exposure_ev, 8, true});
    write_png(png, camera.pixels);
    observed.camera = camera.report;
    return observed;
  }
  const double half_width = std::tan(to_rad(fov_deg) / 2) * image.width / full_width;
  const double own_fov_deg = image.width == full_width ? fov_deg : to_deg(2 * std::atan(half_width));
  const vision::EyeOptions options = eye_options_of(eye, own_fov_deg);
  const auto source = picture_source(image, own_fov_deg);
  const auto sink = png_sink(png, image.width, image.height);
  observed.eye = vision::report_json(vision::HumanEye(options).develop(*source, *sink), options);
  return observed;
}

}  // namespace greenray::cli
