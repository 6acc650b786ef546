// The human eye from light to display: glare, acuity, bleaching, rods, tone curve. Needs no renderer and no device.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/picture_sink.hpp"
#include "image/picture_source.hpp"
#include "vision/display_rows.hpp"
#include "vision/glare.hpp"
#include "vision/greener.hpp"
#include "vision/light.hpp"
#include "vision/pupil.hpp"
#include "vision/retina.hpp"
#include "vision/tone_curve.hpp"

namespace greenray::vision {

struct EyeOptions {
  Display display;
  bool sensitivity = true;  // ceiling by human contrast sensitivity; false: contrast is just not raised
  bool glare = true, acuity = true;
  RodVision rods = RodVision::ward;  // colour sensitivity
  BleachingOptions bleaching;
  PupilModel pupil = PupilModel::watson_yellott;
  Eye eye;  // age and pigmentation
  int eyes = 2;
  std::optional<double> fov_deg;         // replaces what the picture says
  double magnification = 1;              // of a telescope: angles at the eye
  std::optional<double> surround_cd_m2;  // light around the picture; nothing: as along its frame
  bool map_greener = false;              // compare with and without bleaching: costs about as much as all the rest
  bool carry_state = false;              // a sequence: bleaching goes on from picture to picture
  unsigned threads = 0;                  // 0: all cores
  std::size_t memory_bytes = std::size_t{1} << 30U;  // for keeping a picture between its two readings
};

struct EyeReport {
  LightFaults faults;
  std::size_t pixels = 0;
  double least_cd_m2 = 0, most_cd_m2 = 0, mean_cd_m2 = 0, fifth_percentile_cd_m2 = 0;
  double histogram_low_cd_m2 = 0, histogram_high_cd_m2 = 0, adaptation_cd_m2 = 0;
  bool linear = false;
  double linear_scale = 0;
  int tone_passes = 0;
  std::array<int, 2> foveal{0, 0};
  double fov_deg = 0;  // at the eye
  bool fov_assumed = false;
  double pupil_mm = 0, effectivity = 0, field_cd_m2 = 0, field_deg2 = 0, td_per_cd_m2 = 0;
  double surround_cd_m2 = 0;
  bool glare_applied = false, acuity_applied = false, rods_applied = false;
  double coarsest_sample_pixels = 1;
  std::array<double, 3> least_unbleached{1, 1, 1}, pool_unbleached{1, 1, 1};
  bool spectra_assumed = false;  // `shape` from a picture without spectra
  std::uint64_t gamut_moved = 0;
  GreenerStats greener;
  bool kept_in_memory = true;
};

/// Where the map of greener pixels goes; either may be missing.
struct GreenerSinks {
  PictureSink *overlay = nullptr;  // display-linear
  PictureSink *map = nullptr;      // channels hue_shift_deg, delta_e2000, unbleached_L, unbleached_M
};
inline const std::vector<std::string> greener_channels{"hue_shift_deg", "delta_e2000", "unbleached_L", "unbleached_M"};

class PigmentHistory;

class HumanEye {
 public:
  explicit HumanEye(EyeOptions options);
  ~HumanEye();

  /// What develop() would complain about, as far as that can be told without pixels. first: of the sequence, if any.
  void check(const PictureFacts &facts, const PictureFacts *first = nullptr) const;

  /* One picture to display-linear rows in `sink` (Rec. 709, 0..1). With carry_state the pictures are a sequence, each
     looked at for options.bleaching.seconds, and must have one size if they bleach.
     Order: glare (optics), acuity, bleaching, rods, tone curve. Deterministic: the same bits for any number of threads
     and whether the picture is kept or read twice. errors: a picture that is not absolute, or of another size than the
     sequence -> InputError; a field of view outside 0..179 degrees -> std::domain_error */
  EyeReport develop(PictureSource &picture, PictureSink &sink, const GreenerSinks &greener = {});

 private:
  bool carries_pigment() const;
  void meet(const PictureFacts &facts);

  EyeOptions options_;
  std::unique_ptr<PigmentHistory> pigment_;  // of a sequence
  std::optional<PictureFacts> first_;        // of a sequence
};

}  // namespace greenray::vision
