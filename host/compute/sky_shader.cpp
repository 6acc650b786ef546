#include "compute/sky_shader.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "compute/buffer.hpp"
#include "compute/device_answers.hpp"
#include "compute/program.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {
constexpr std::size_t local_size = 16;
constexpr std::size_t largest_launch = std::size_t{1} << 20;  // pixels: a second or so, to hear an interrupt
}  // namespace

int padded_waves(const Device &device, int wavelengths) {
  const int lanes = device.lanes().lanes_float;
  return (wavelengths + lanes - 1) / lanes * lanes;
}

/// A buffer cannot be empty: then one entry, never read.
template <class T>
class Filled {
 public:
  Filled(Device::State &device, const std::vector<T> &values, const char *what)
      : buffer_(device, std::max<std::size_t>(values.size(), 1), what) {
    if (!values.empty()) buffer_.write(values.data(), values.size());
  }
  const cl::Buffer &cl() const { return buffer_.cl(); }

 private:
  Buffer<T> buffer_;
};

/// Targets and waves on the device; of a picture without them nothing.
struct TargetBuffers {
  Filled<float> sight, corners, light, crests;
  Filled<f32::Target> rows;
  Filled<f32::TargetTexel> texels;

  TargetBuffers(Device::State &device, const TargetTable &t)
      : sight(device, t.sight, "the sight table of targets"),
        corners(device, t.corners, "outlines of targets"),
        light(device, t.light, "light of targets"),
        crests(device, t.crests, "wave crests"),
        rows(device, t.targets, "targets"),
        texels(device, t.texels, "pictures of targets") {}
};

struct SkyShader::State {
  std::shared_ptr<Device> owner;
  Device::State &device;
  Buffer<float> table, limb, spectra, moments;
  int waves;
  f32::SkyView view{};
  cl::Kernel kernel;
  bool warm = false;
  std::optional<TargetBuffers> targets;

  State(std::shared_ptr<Device> d, const SkyTable &t, const TargetTable &before, int width, int rows)
      : owner(std::move(d)),
        device(owner->state()),
        table(device, t.values.size(), "the transfer table"),
        limb(device, t.limb.size(), "limb darkening"),
        spectra(device, band_floats(width, rows, t.waves), "the spectral picture"),
        moments(device, band_floats(width, rows, 2), "the noise estimate"),
        waves(t.waves) {
    table.write(t.values.data(), t.values.size());
    limb.write(t.limb.data(), t.limb.size());
    BuildPlan plan{"shade_sky", device.lanes.lanes_float, false, false, false, false};
    plan.sky_waves = waves;
    if (before.any()) plan.words = " -DWITH_TARGETS=1";
    const std::string key = plan.entry + build_options(plan);
    warm = device.kernels.count(key) > 0;
    try {
      if (!warm) device.kernels[key] = cl::Kernel(build_program(device, plan), "shade_sky");
      kernel = device.kernels[key];
      kernel.setArg(0, table.cl());
      kernel.setArg(1, limb.cl());
      kernel.setArg(2, spectra.cl());
      kernel.setArg(3, moments.cl());
      if (before.any()) set_targets(before);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel shade_sky", device.info.name);
    }
  }

  void set_targets(const TargetTable &t) {
    targets.emplace(device, t);
    kernel.setArg(5, targets->sight.cl());
    kernel.setArg(6, targets->rows.cl());
    kernel.setArg(7, targets->corners.cl());
    kernel.setArg(8, targets->light.cl());
    kernel.setArg(9, targets->texels.cl());
    kernel.setArg(10, targets->crests.cl());
    kernel.setArg(11, t.scale());
  }

  static std::size_t band_floats(int width, int rows, int each) {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(rows) * static_cast<std::size_t>(each);
  }
  std::size_t pixels() const { return band_floats(view.width, view.rows, 1); }

  void launch(const f32::SkyView &v, const std::function<void()> &between = {}) {
    try {
      kernel.setArg(4, v);
      const std::size_t items = band_floats(v.width, v.rows, 1);
      for (std::size_t first = 0; first < items; first += largest_launch) {
        if (first > 0 && between) between();
        const std::size_t count = std::min(largest_launch, items - first);
        const std::size_t global = (count + local_size - 1) / local_size * local_size;
        device.queue.enqueueNDRangeKernel(kernel, cl::NDRange(first), cl::NDRange(global), cl::NDRange(local_size));
        device.queue.finish();
      }
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel shade_sky", device.info.name);
    }
  }
};

std::size_t SkyShader::band_bytes(int width, int rows, int waves) {
  return State::band_floats(width, rows, waves + 2) * sizeof(float);
}

SkyShader::SkyShader(std::shared_ptr<Device> device, const SkyTable &table, const TargetTable &targets, int width,
                     int most_rows)
    : state_(std::make_unique<State>(std::move(device), table, targets, width, most_rows)) {
  if (state_->warm) return;
  // PoCL compiles at the first launch: one pixel without samples, counted as compiling.
  f32::SkyView nothing{};
  nothing.width = nothing.rows = 1;
  nothing.entries = table.entries;
  state_->view = nothing;
  const auto begin_time = std::chrono::steady_clock::now();
  state_->launch(nothing);
  state_->device.compile_seconds +=
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_time).count();
}
SkyShader::~SkyShader() = default;

void SkyShader::begin(const f32::SkyView &view) { state_->view = view; }

void SkyShader::add_samples(int first_sample, int samples, const std::function<void()> &between) {
  f32::SkyView view = state_->view;
  view.first_sample = first_sample;
  view.samples = samples;
  state_->launch(view, between);
}

void SkyShader::set_sums(const SkySums &sums) {
  if (sums.spectra.size() != state_->pixels() * static_cast<std::size_t>(state_->waves) ||
      sums.moments.size() != 2 * state_->pixels())
    throw RunError("the checkpoint is of another picture");
  state_->spectra.write(sums.spectra.data(), sums.spectra.size());
  state_->moments.write(sums.moments.data(), sums.moments.size());
}

void SkyShader::with_sums(const std::function<void(const SkySums &)> &use) const {
  const auto spectra = state_->spectra.map(state_->pixels() * static_cast<std::size_t>(state_->waves));
  const auto moments = state_->moments.map(state_->pixels() * 2);
  require_numbers(spectra.values(), "radiances");
  require_numbers(moments.values(), "radiances");
  use({spectra.values(), moments.values()});
}

}  // namespace greenray
