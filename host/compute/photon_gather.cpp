#include "compute/photon_gather.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "compute/device_answers.hpp"
#include "compute/photon_map_state.hpp"
#include "compute/program.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr int listed_groups = 256;  // of distances that one work-item writes down: 8 kB with 8 lanes
constexpr const char *radius_kernel = "gather_radius";

}  // namespace

GatherSettings gather_settings(double radius_m, double flatness, double facing_deg) {
  if (!(radius_m > 0) || !(flatness > 0) || flatness > 1)
    throw RunError("a gather needs a radius and a flatness above 0");
  GatherSettings s{};
  s.radius_m = static_cast<float>(radius_m);
  s.guess_m = s.radius_m;
  s.squash = static_cast<float>(1 / (flatness * flatness) - 1);
  s.facing = facing_deg >= 180 ? -2.0f : static_cast<float>(std::cos(facing_deg * std::numbers::pi / 180));
  s.nearest = 0;
  return s;
}

struct PhotonGather::State {
  State(std::shared_ptr<Device> d, int waves_asked, const GatherOptions &o)
      : owner(std::move(d)), device(owner->state()), waves(waves_asked), options(o) {}

  /// with_sides: see kernels/map/gather.h; a ball that takes every side costs half of what others do.
  cl::Kernel make_kernel(const char *name, bool with_sides) {
    BuildPlan plan{"gather", device.lanes.lanes_float};
    plan.words = " -DWAVES=" + std::to_string(waves) + " -DGATHER_KERNEL=" + std::to_string(options.kernel) +
                 " -DWITH_SPREAD=" + (options.with_spread ? "1" : "0") + " -DWITH_SIDES=" + (with_sides ? "1" : "0") +
                 " -DPOINTS_PER_ITEM=" + std::to_string(options.points_per_item) +
                 " -DNEAR_GROUPS=" + std::to_string(device.lanes.lanes_float > 1 ? listed_groups : 0);
    return {build_program(device, plan), name};
  }

  void set_points(std::span<const GatherPoint> asked) {
    count = asked.size();
    const std::size_t size = std::max<std::size_t>(count, 1);
    if (!points || points->count() < size) {
      points.reset(), irradiance.reset(), spread.reset(), gathered.reset(), radius_m.reset();
      points.emplace(device, size, "places to gather at");
      irradiance.emplace(device, size * static_cast<std::size_t>(waves), "gathered light");
      spread.emplace(device, size, "gathered light");
      radius_m.emplace(device, size, "the radii of gathers");
      gathered.emplace(device, size, "gathered light");
    }
    if (count > 0) points->write(asked.data(), count);
  }

  void launch(const char *name, const PhotonMap &map, const GatherSettings &settings) {
    if (!points) throw RunError("a gather was asked before it was given places");
    PhotonMap::State &m = map.state();
    if (map.waves() != waves) throw RunError("a gather of other wavelengths than the photon map has");
    const std::pair<std::string, bool> kind{name, settings.squash != 0 || settings.facing > -1.5f};
    const bool warm = kernels.count(kind);
    try {
      cl::Kernel &kernel = warm ? kernels[kind] : (kernels[kind] = make_kernel(name, kind.second));
      const auto begin = std::chrono::steady_clock::now();
      cl_uint argument = 0;
      for (const cl::Buffer &buffer :
           {m.cell_start->cl(), m.boxes.cl(), m.x_m.cl(), m.y_m.cl(), m.z_m.cl(), m.normal.cl(), m.power_W.cl()})
        kernel.setArg(argument++, buffer);
      kernel.setArg(argument++, static_cast<cl_int>(m.stride));
      kernel.setArg(argument++, m.grid);
      for (const cl::Buffer &buffer : {points->cl(), irradiance->cl(), spread->cl(), gathered->cl()})
        kernel.setArg(argument++, buffer);
      kernel.setArg(argument + 1, settings);
      if (std::string_view(name) == radius_kernel) kernel.setArg(argument + 2, radius_m->cl());
      if (!warm) {  // PoCL compiles at the first launch: of no points
        enqueue(kernel, argument, 0);
        device.compile_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      }
      if (count > 0) enqueue(kernel, argument, count);
    } catch (const cl::Error &error) {
      throw_failed_call(error, std::string("kernel ") + name, device.info.name);
    }
  }

  void enqueue(cl::Kernel &kernel, cl_uint count_argument, std::size_t asked) {
    kernel.setArg(count_argument, static_cast<cl_int>(asked));
    const auto local = static_cast<std::size_t>(options.local_size ? options.local_size : device.lanes.local_size);
    const auto each = static_cast<std::size_t>(options.points_per_item);
    const std::size_t items = std::max<std::size_t>((asked + each - 1) / each, 1);
    device.queue.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange((items + local - 1) / local * local),
                                      cl::NDRange(local));
    device.queue.finish();
  }

  std::shared_ptr<Device> owner;
  Device::State &device;
  int waves;
  GatherOptions options;
  std::map<std::pair<std::string, bool>, cl::Kernel> kernels;  // by name and with_sides
  std::size_t count = 0;
  std::optional<Buffer<GatherPoint>> points;
  std::optional<Buffer<float>> irradiance, radius_m;
  std::optional<Buffer<GatherSpread>> spread;
  std::optional<Buffer<Gathered>> gathered;
};

PhotonGather::PhotonGather(std::shared_ptr<Device> device, int waves, const GatherOptions &options)
    : state_(std::make_unique<State>(std::move(device), waves, options)) {}
PhotonGather::~PhotonGather() = default;

void PhotonGather::set_points(std::span<const GatherPoint> points) { state_->set_points(points); }

void PhotonGather::within(const PhotonMap &map, const GatherSettings &settings) {
  if (!(settings.radius_m > 0)) throw RunError("a gather needs a radius above 0");
  state_->launch(radius_kernel, map, settings);
}

void PhotonGather::within(const PhotonMap &map, GatherSettings settings, std::span<const float> radius_m) {
  if (radius_m.size() != state_->count) throw RunError("a gather needs a radius for each of its points");
  if (radius_m.empty()) return;
  state_->radius_m->write(radius_m.data(), radius_m.size());
  settings.radius_m = 0;
  state_->launch(radius_kernel, map, settings);
}

void PhotonGather::nearest(const PhotonMap &map, const GatherSettings &settings) {
  if (!(settings.radius_m > 0) || !(settings.guess_m > 0) || settings.nearest < 1)
    throw RunError("a gather of the nearest photons needs a radius, a first guess and a number above 0");
  state_->launch("gather_nearest", map, settings);
}

GatherAnswers PhotonGather::read() const {
  GatherAnswers answers;
  const std::size_t n = state_->count;
  answers.irradiance.resize(n * static_cast<std::size_t>(state_->waves));
  answers.spread.resize(n), answers.gathered.resize(n);
  if (n == 0) return answers;
  state_->irradiance->read(answers.irradiance.data(), answers.irradiance.size());
  state_->spread->read(answers.spread.data(), n);
  state_->gathered->read(answers.gathered.data(), n);
  require_numbers(answers.irradiance, "irradiances");
  return answers;
}

}  // namespace greenray
