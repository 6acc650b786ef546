// The PNG of a rendered picture: what the scene's observer sees.
#pragma once
#include <nlohmann/json.hpp>

#include "image/develop.hpp"
#include "image/spectral_image.hpp"
#include "scene/scene.hpp"
#include "support/atomic_file.hpp"

namespace greenray::cli {

struct Observed {
  CameraReport camera;
  nlohmann::json eye;  // null: a camera
};

/// fov_deg: of a picture full_width pixels wide, of which `image` may be a crop.
Observed observe(const EyeScene &eye, double fov_deg, int full_width, const SpectralImage &image, AtomicFile &png);

}  // namespace greenray::cli
