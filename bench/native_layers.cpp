// The kernel of the closed form as C++ for this processor: kernels/entry/closed_form.cl itself, its work-items called
// one after the other. Compiled once per lane count and precision, each in its own namespace.
#include <algorithm>
#include <cmath>

#include "bench/race.hpp"
#include "native_rays.hpp"

#define LANES NATIVE_LANES
#define REAL_IS_DOUBLE NATIVE_IS_DOUBLE
#define TABLE_IS_IMAGE 0
#define WITH_COLUMNS 0

namespace greenray::bench::NATIVE_NAMESPACE {
namespace {
namespace text {
// What OpenCL gives a kernel: which work-item it is, of how many.
thread_local std::size_t work_item[2], work_items[2];
inline std::size_t get_global_id(int dimension) { return work_item[dimension]; }
inline std::size_t get_global_size(int dimension) { return work_items[dimension]; }
using std::min;
#define __kernel inline
#define __global
#include "entry/closed_form.cl"
#undef __kernel
#undef __global
}  // namespace text

text::scalar narrow(double x) { return static_cast<text::scalar>(x); }

/// The layers of one side as the kernel reads them.
std::vector<text::Layer> kernel_layers(const LayerSide &side) {
  std::vector<text::Layer> layers;
  for (const LayerData &data : side.layers) {
    text::Layer layer;
    layer.lift = narrow(data.lift), layer.bulge = narrow(data.bulge), layer.skew = narrow(data.skew);
    layer.far_m = narrow(data.far_m);
    std::transform(data.mean.begin(), data.mean.end(), layer.mean, narrow);
    std::transform(data.tilt.begin(), data.tilt.end(), layer.tilt, narrow);
    std::transform(data.bow.begin(), data.bow.end(), layer.bow, narrow);
    layers.push_back(layer);
  }
  return layers;
}

class LayerRunner : public Runner {
 public:
  LayerRunner(const LayerTable &table, const std::vector<double> &elevations_rad, unsigned threads)
      : threads_(threads),
        above_(kernel_layers(table.above.front())),
        below_(kernel_layers(table.below.front())),
        row_{narrow(table.eye_m),
             narrow(table.index_eye.front()),
             narrow(table.above.front().lowest_lift),
             narrow(table.below.front().lowest_lift),
             table.level_rises.front() ? 1 : 0,
             0},
        ends_(elevations_rad.size()) {
    for (const double elevation : elevations_rad) {
      sines_.push_back(narrow(std::sin(elevation)));
      cosines_.push_back(narrow(std::cos(elevation)));
    }
  }

  void run() override {
    on_threads(ends_.size(), 256 * LANES, threads_, [this](std::size_t first, std::size_t last) {
      text::work_items[0] = (ends_.size() + LANES - 1) / LANES, text::work_items[1] = 1;
      text::work_item[1] = 0;
      for (std::size_t i = first; i < last; i += LANES) {
        text::work_item[0] = i / LANES;
        text::trace_layers(above_.data(), below_.data(), &row_, sines_.data(), cosines_.data(), ends_.data(),
                           static_cast<int>(ends_.size()), static_cast<int>(above_.size()),
                           static_cast<int>(below_.size()));
      }
    });
  }
  Bent result(std::size_t ray) const override {
    return {static_cast<double>(ends_[ray].bending_rad), ends_[ray].outcome, 0};
  }

 private:
  unsigned threads_;
  std::vector<text::Layer> above_, below_;
  text::LayerRow row_;
  std::vector<text::scalar> sines_, cosines_;
  std::vector<text::RayEnd> ends_;
};

}  // namespace

std::unique_ptr<Runner> prepare_layers(const IndexTable &table, std::span<const f64::RayStart> starts,
                                       double error_arcsec, unsigned threads) {
  return std::make_unique<LayerRunner>(layers_for(table, error_arcsec, starts), elevations_of(starts), threads);
}

}  // namespace greenray::bench::NATIVE_NAMESPACE
