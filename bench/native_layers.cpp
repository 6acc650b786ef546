// The kernel of the closed form as C++ for this processor: kernels/entry/closed_form.cl itself, its work-items called
// one after the other, with what host/compute/layer_tracer.cpp and bend_batch.cpp give it. Compiled once per lane count
// and precision, each in its own namespace.
#include <algorithm>
#include <cmath>
#include <type_traits>

#include "bench/race.hpp"
#include "native_rays.hpp"

#define LANES NATIVE_LANES
#define REAL_IS_DOUBLE NATIVE_IS_DOUBLE
#define TABLE_IS_IMAGE 0
#define WITH_COLUMNS 0

namespace greenray::bench::NATIVE_NAMESPACE {
namespace {
namespace text {
// What OpenCL gives a kernel: which work-item it is, of how many, and types of its own.
thread_local std::size_t work_item[3], work_items[3];
[[maybe_unused]] std::size_t get_global_id(int dimension) { return work_item[dimension]; }
[[maybe_unused]] std::size_t get_global_size(int dimension) { return work_items[dimension]; }
using std::min;
using uchar = unsigned char;
struct int4 {
  int x, y, z, w;
};
// g++ has no operators between its vectors and enumerations.
template <class Lanes, class Name>
requires(std::is_enum_v<Name> && !std::is_scalar_v<Lanes>) auto operator==(Lanes a, Name b) {
  return a == static_cast<int>(b);
}
template <class Lanes, class Name>
requires(std::is_enum_v<Name> && !std::is_scalar_v<Lanes>) auto operator<<(Lanes a, Name b) {
  return a << static_cast<int>(b);
}
#define __kernel [[maybe_unused]] static
#define __global
#include "entry/closed_form.cl"
#undef __kernel
#undef __global
}  // namespace text

constexpr int groups_per_item = 64;  // as bend_batch.cpp

text::scalar narrow(double x) { return static_cast<text::scalar>(x); }

std::vector<text::Layer> kernel_layers(const std::vector<LayerData> &all, std::size_t count) {
  std::vector<text::Layer> layers;
  for (std::size_t i = 0; i < count; ++i) {
    const LayerData &data = all[i];
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

std::vector<text::FarNode> kernel_nodes(const std::vector<FarNode> &all) {
  std::vector<text::FarNode> nodes;
  for (const FarNode &data : all) {
    text::FarNode node;
    node.lift = narrow(data.lift);
    std::transform(data.weight.begin(), data.weight.end(), node.weight, narrow);
    nodes.push_back(node);
  }
  return nodes;
}

text::scalar lowest_lift(const std::vector<text::Layer> &layers) {
  text::scalar lowest = 0;
  for (const text::Layer &layer : layers) lowest = std::min(lowest, layer.lift);
  return lowest;
}

/// Rays of one wavelength, as peers have.
class LayerRunner : public Runner {
 public:
  LayerRunner(const LayerTable &table, const std::vector<double> &elevations_rad, unsigned threads)
      : threads_(threads),
        groups_(static_cast<int>((elevations_rad.size() + LANES - 1) / LANES)),
        above_(kernel_layers(table.above.front().layers, table.near_above)),
        below_(kernel_layers(table.below.front().layers, table.below.front().layers.size())),
        far_(kernel_nodes(table.far.front())) {
    const std::vector<LayerData> &up = table.above.front().layers;
    row_.eye_m = narrow(table.eye_m);
    row_.index_eye = narrow(table.index_eye.front());
    row_.lowest_lift_above = lowest_lift(above_);
    row_.lowest_lift_below = lowest_lift(below_);
    row_.top_m = narrow(up.empty() ? table.eye_m : up.back().far_m);
    row_.level_rises = table.level_rises.front() ? 1 : 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(groups_) * LANES; ++i)
      sines_.push_back(narrow(std::sin(elevations_rad[std::min(i, elevations_rad.size() - 1)])));
    bending_rad_.resize(sines_.size());
    status_.resize(sines_.size());
  }

  void run() override {
    const text::int4 counts{static_cast<int>(above_.size()), static_cast<int>(below_.size()),
                            static_cast<int>(far_.size()), groups_per_item};
    on_threads(static_cast<std::size_t>(groups_), groups_per_item, threads_, [&](std::size_t first, std::size_t) {
      text::work_item[0] = first / groups_per_item, text::work_item[1] = 0;
      text::bend_rays(above_.data(), below_.data(), far_.data(), &row_, counts, sines_.data(), bending_rad_.data(),
                      status_.data(), groups_);
    });
  }
  Bent result(std::size_t ray) const override {
    return {static_cast<double>(bending_rad_[ray]), status_[ray] & ((1 << text::LAYER_STATUS_TURNS) - 1), 0};
  }

 private:
  unsigned threads_;
  int groups_;
  std::vector<text::Layer> above_, below_;
  std::vector<text::FarNode> far_;
  text::LayerRow row_{};
  std::vector<text::scalar> sines_, bending_rad_;
  std::vector<unsigned char> status_;
};

}  // namespace

std::unique_ptr<Runner> prepare_layers(const IndexTable &table, std::span<const f64::RayStart> starts,
                                       double error_arcsec, unsigned threads) {
  return std::make_unique<LayerRunner>(layers_for(table, error_arcsec, starts), elevations_of(starts), threads);
}

}  // namespace greenray::bench::NATIVE_NAMESPACE
