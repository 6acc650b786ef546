// The camera view: exposure, a filmic curve that keeps hue, the sRGB gamut. (The eye lives in host/vision.)
#pragma once
#include <cstddef>
#include <memory>
#include <optional>

#include "image/png.hpp"
#include "image/spectral_image.hpp"

namespace greenray {

struct CameraOptions {
  std::optional<double> exposure_ev;  // stops on top of the automatic exposure
  int bits = 8;                       // 8 or 16
  bool dither = true;
};

struct CameraReport {
  double key_cd_m2 = 0;         // scene value (largest of R,G,B) that the curve puts just below white
  double exposure_ev = 0;       // stops added by the caller
  std::size_t gamut_moved = 0;  // pixels brought into sRGB by lowering chroma
  std::size_t replaced = 0;     // pixels with NaN, infinite or negative light: shown black
};

struct CameraPicture {
  Raster pixels;
  CameraReport report;
};

/* Scene-linear Rec. 709 [cd/m2] to display-linear, 1 = display white.
   Exposure: geometric mean of the 99.5 % and 99.98 % points of max(R,G,B) over the lit pixels: a large disk is keyed
   on itself, a tiny one halfway between itself and the sky. Curve: straight near the key, shadows lifted, a shoulder
   below white, all on max(R,G,B) with the colour scaled along, so a disk keeps its hue at any exposure and a sky ten
   stops darker still glows.
   Deterministic; a pixel depends on its own value and the key only. */
RgbImage camera_display(const RgbImage &scene, const CameraOptions &options, CameraReport &report);

/* The key of a picture that is looked at in pieces: the same value as from the whole. Every piece is shown to look(),
   then, as long as again() says so, all of them once more. Safe to call from several threads. */
class ExposureKey {
 public:
  ExposureKey();
  ~ExposureKey();
  void look(const float *rgb, std::size_t pixels);
  /// After all pieces: whether another look is needed.
  bool again();
  double cd_m2() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// camera_display() of some pixels, given the key in the report, whose counts grow.
void camera_rows(const CameraOptions &options, CameraReport &report, const float *scene, std::size_t pixels,
                 float *display);

/// The same, encoded: see quantise().
CameraPicture develop_camera(const RgbImage &scene, const CameraOptions &options = {});

}  // namespace greenray
