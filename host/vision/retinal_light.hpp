// A picture after the optics of the eye: over cells for what adapts, in bands of rows for what is seen.
#pragma once
#include <optional>
#include <vector>

#include "vision/glare_filter.hpp"
#include "vision/light.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

struct RetinalLightOptions {
  bool glare = true;
  Eye eye;
  std::optional<double> surround_cd_m2;  // light around the picture; nothing: as along its frame
  unsigned threads = 1;
};

class RetinalLight {
 public:
  /// Looks at the picture once (twice where it has infinite pixels). points: single pixels for the histogram.
  RetinalLight(const RetinalLightOptions &options, const ViewGeometry &view, const PictureFacts &facts,
               LightStore &store, std::size_t points);

  const Survey &survey() const { return survey_; }
  bool has_glare() const { return filter_.has_value(); }
  /// Of the light around the picture.
  double surround_cd_m2() const { return static_cast<double>(surround_[luminance_plane_]); }

  /// [light plane]: mean retinal light of each cell.
  const Planes &cells() const { return cells_; }
  const Plane &luminance_cells() const { return cells_[luminance_plane_]; }

  /* Rows [first - beyond, last + beyond) of the first `planes` light planes, the last row rounded up to a whole cell.
     first, beyond: multiples of a cell. Rows are as wide as whole cells. Safe to call from several threads. */
  Planes band(int first, int last, int beyond, std::size_t planes) const;

 private:
  void scatter_cells(const RetinalLightOptions &options);
  void fill(std::size_t plane, int inside_top, int inside_bottom, const std::vector<float> &loaded, int top, int left,
            Plane &light) const;

  LightStore &store_;
  int width_, height_;
  std::size_t luminance_plane_;
  Survey survey_;
  std::vector<float> surround_;  // [light plane]
  std::optional<GlareFilter> filter_;
  Planes veils_, cells_;
};

}  // namespace greenray::vision
