#include "vision/pigment.hpp"

#include <algorithm>

namespace greenray::vision {

void PigmentHistory::forget() {
  for (std::size_t k = 0; k < 3; ++k) pixels_[k].clear(), cells_[k].clear();
  disk_ = {1, 1, 1};
}

void PigmentHistory::keep_pixels(std::size_t pixels) {
  if (pixels_[0].size() == pixels) return;
  for (std::vector<float> &cone : pixels_) cone.assign(pixels, 1.0F);
}

void PigmentHistory::expose(const Planes &cells, const Plane &luminance, Retina &retina) {
  const std::size_t count = luminance.value.size();
  if (cells_[0].size() != count)
    for (std::vector<float> &cone : cells_) cone.assign(count, 1.0F);
  const float brightest = *std::max_element(luminance.value.begin(), luminance.value.end());
  std::vector<float> response(count);
  std::array<float, 3> shared{1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k) {
    cone_response(k, cells[0].value.data(), cells[1].value.data(), cells[2].value.data(), count, response.data());
    expose_cones(retina, k, response.data(), count, cells_[k].data());
    double light = 0, left = 0, disk = 0, disk_cells = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const double td = std::max(0.0, static_cast<double>(response[i] * retina.td_per_lms[k]));
      light += td * td;
      left += td * td * static_cast<double>(cells_[k][i]);
      if (brightest > 0 && luminance.value[i] >= 0.5F * brightest) disk += td, ++disk_cells;
    }
    if (retina.options.pooled && disk_cells > 0) {
      disk_[k] = retina.after(disk_[k], disk / disk_cells);
      shared[k] = static_cast<float>(disk_[k]);
    }
    retina.pool[k] = retina.options.pooled ? shared[k] : light > 0 ? static_cast<float>(left / light) : 1.0F;
  }
  if (retina.options.pooled) retina.shared = shared;
}

}  // namespace greenray::vision
