#include "compute/photon_map.hpp"

#include <algorithm>
#include <chrono>

#include "compute/device_answers.hpp"
#include "compute/photon_map_state.hpp"
#include "compute/program.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

// A chunk and what it is dealt into fit the third-level cache of a core (4 MB); pieces of buckets in it are then long.
constexpr std::size_t most_of_chunk = 65536, least_of_chunk = 1024;
constexpr std::size_t photons_of_bucket = 3000, most_buckets = 4096;  // so many fit a second-level cache several times

std::size_t room(std::size_t photons) { return std::max<std::size_t>(photons, 1); }

}  // namespace

PhotonMap::State::State(std::shared_ptr<Device> d, const PhotonMapOptions &o)
    : owner(std::move(d)),
      device(owner->state()),
      options(o),
      stride(static_cast<int>(room(o.photons)) + device.lanes.lanes_float),
      records(device, room(o.photons), "photon records"),
      record_power_W(device, room(o.photons) * static_cast<std::size_t>(o.waves), "the power of photons"),
      moved(device, room(o.photons), "photons that are filed"),
      order(device, room(o.photons), "the order of photons"),
      boxes(device, room(o.photons), "the cells of the photon map"),
      x_m(device, static_cast<std::size_t>(stride), "the photon map"),
      y_m(device, static_cast<std::size_t>(stride), "the photon map"),
      z_m(device, static_cast<std::size_t>(stride), "the photon map"),
      power_W(device, static_cast<std::size_t>(stride) * static_cast<std::size_t>(o.waves), "the photon map"),
      normal(device, static_cast<std::size_t>(stride), "the photon map"),
      filing_(device, 1, "the counts of a sort") {}

cl::Kernel &PhotonMap::State::kernel(const char *name) {
  const auto known = kernels_.find(name);
  if (known != kernels_.end()) return known->second;
  BuildPlan plan{"build_map", device.lanes.lanes_float};
  plan.words = " -DWAVES=" + std::to_string(options.waves);
  if (device.info.platform_name == "Portable Computing Language") plan.words += " -DWITH_FETCH_EARLY=1";
  if (device.info.platform_name == "Oclgrind") plan.words += " -DWITHOUT_SHUFFLES=1";
  const cl::Program program = build_program(device, plan);
  try {
    return kernels_[name] = cl::Kernel(program, name);
  } catch (const cl::Error &error) {
    throw_failed_call(error, std::string("kernel ") + name, device.info.name);
  }
}

void PhotonMap::State::launch(const char *name, std::size_t items) {
  try {
    const std::size_t local =
        static_cast<std::size_t>(options.local_size ? options.local_size : device.lanes.local_size);
    device.queue.enqueueNDRangeKernel(kernel(name), cl::NullRange, cl::NDRange((items + local - 1) / local * local),
                                      cl::NDRange(local));
  } catch (const cl::Error &error) {
    throw_failed_call(error, std::string("kernel ") + name, device.info.name);
  }
}

SortPlan PhotonMap::State::plan_sort(std::size_t count) const {
  const std::size_t units = 8 * std::max(1u, device.info.compute_units);
  const std::size_t chunk = options.chunk > 0 ? static_cast<std::size_t>(options.chunk)
                                              : std::clamp(count / units + 1, least_of_chunk, most_of_chunk);
  const std::size_t buckets = std::clamp(count / photons_of_bucket, std::min<std::size_t>(units, 64), most_buckets);
  SortPlan plan{};
  plan.photons = static_cast<cl_int>(count);
  plan.chunk = static_cast<cl_int>(chunk);
  plan.chunks = static_cast<cl_int>((count + chunk - 1) / chunk);
  plan.cells = cells();
  while (static_cast<std::size_t>((plan.cells - 1) >> plan.shift) >= buckets) ++plan.shift;
  plan.buckets = ((plan.cells - 1) >> plan.shift) + 1;
  const int lanes = device.lanes.lanes_float;
  plan.row = (plan.buckets / lanes + 1) * lanes + lanes;
  return plan;
}

void PhotonMap::State::make_room(const SortPlan &plan) {
  const auto need = [&](auto &buffer, std::size_t count, const char *what) {
    if (buffer && buffer->count() >= count) return;
    buffer.reset();
    buffer.emplace(device, count, what);
  };
  const auto chunks = static_cast<std::size_t>(std::max(plan.chunks, 1)), row = static_cast<std::size_t>(plan.row);
  need(cell_start, static_cast<std::size_t>(plan.cells) + 1, "the cells of the photon map");
  need(starts_, chunks * row, "the counts of a sort");
  need(bucket_start_, row, "the counts of a sort");
  need(chunk_order_, chunks, "the counts of a sort");
}

void PhotonMap::State::build(std::size_t count, const Bounds &bounds, double cell_m) {
  grid = plan_grid(bounds, cell_m, std::clamp<std::size_t>(2 * count, std::size_t{1} << 12, std::size_t{1} << 24));
  const SortPlan plan = plan_sort(count);
  make_room(plan);
  const auto bound = [&](const char *name, std::initializer_list<const cl::Buffer *> buffers) -> cl::Kernel & {
    cl::Kernel &k = kernel(name);
    cl_uint argument = 0;
    for (const cl::Buffer *buffer : buffers) k.setArg(argument++, *buffer);
    return k;
  };
  const cl::Buffer &photons = records.cl(), &power = record_power_W.cl(), &starts = starts_->cl(),
                   &bucket_start = bucket_start_->cl(), &chunk_order = chunk_order_->cl(), &filing = filing_.cl();
  try {
    cl::Kernel &deal = bound("deal_photons", {&photons, &power, &order.cl(), &moved.cl(), &starts, &chunk_order});
    deal.setArg(6, plan);
    deal.setArg(7, grid);
    launch("deal_photons", static_cast<std::size_t>(std::max(plan.chunks, 1)));

    bound("total_buckets", {&starts, &bucket_start}).setArg(2, plan);
    const int lanes = device.lanes.lanes_float;
    launch("total_buckets", static_cast<std::size_t>((plan.buckets + lanes - 1) / lanes));

    bound("scan_buckets", {&chunk_order, &bucket_start, &filing}).setArg(3, plan);
    launch("scan_buckets", 1);

    cl::Kernel &file =
        bound("file_photons", {&photons, &power, &moved.cl(), &starts, &bucket_start, &filing, &cell_start->cl(),
                               &boxes.cl(), &x_m.cl(), &y_m.cl(), &z_m.cl(), &normal.cl(), &power_W.cl(), &order.cl()});
    file.setArg(14, stride);
    file.setArg(15, plan);
    file.setArg(16, grid);
    launch("file_photons", static_cast<std::size_t>(plan.buckets));
  } catch (const cl::Error &error) {
    throw_failed_call(error, "filing photons", device.info.name);
  }
  Filing done{};
  filing_.read(&done, 1);
  if (done.filed < 0 || static_cast<std::size_t>(done.filed) > count) throw_bad_answer("a number of photons");
  filed = static_cast<std::size_t>(done.filed);
}

PhotonMap::PhotonMap(std::shared_ptr<Device> device, const PhotonMapOptions &options)
    : state_(std::make_unique<State>(std::move(device), options)) {
  // PoCL compiles at the first launch: no photons at all, counted as compiling.
  const auto begin = std::chrono::steady_clock::now();
  build(0, {}, 1);
  state_->device.compile_seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}
PhotonMap::~PhotonMap() = default;

void PhotonMap::upload(std::span<const Photon> photons, std::span<const float> power_W) {
  const std::size_t powers = photons.size() * static_cast<std::size_t>(state_->options.waves);
  if (photons.size() > state_->options.photons || power_W.size() != powers)
    throw RunError("the photon map has room for " + std::to_string(state_->options.photons) + " photons of " +
                   std::to_string(state_->options.waves) + " wavelengths, and was given " +
                   std::to_string(photons.size()) + " with " + std::to_string(power_W.size()) + " powers");
  if (photons.empty()) return;
  state_->records.write(photons.data(), photons.size());
  state_->record_power_W.write(power_W.data(), power_W.size());
}

void PhotonMap::build(std::size_t photons, const Bounds &bounds, double cell_m) {
  if (photons > state_->options.photons) throw RunError("the photon map was asked to file more photons than it has");
  state_->build(photons, bounds, cell_m);
}

std::size_t PhotonMap::filed() const { return state_->filed; }
const PhotonGrid &PhotonMap::grid() const { return state_->grid; }
int PhotonMap::waves() const { return state_->options.waves; }
const Device &PhotonMap::device() const { return *state_->owner; }

std::size_t PhotonMap::bytes_per_photon(int waves) {
  return sizeof(Photon) + sizeof(MovedPhoton) + 6 * sizeof(float) + 2 * sizeof(float) * static_cast<std::size_t>(waves);
}

PhotonMap::Contents PhotonMap::read() const {
  const std::size_t n = filed(), waves_count = static_cast<std::size_t>(waves());
  Contents c;
  const PhotonGrid &g = grid();
  c.cell_start.resize(static_cast<std::size_t>(g.cells[0] * g.cells[1] * g.cells[2]) + 1);
  state_->cell_start->read(c.cell_start.data(), c.cell_start.size());
  std::vector<float> power(static_cast<std::size_t>(state_->stride) * waves_count);
  state_->power_W.read(power.data(), power.size());
  for (std::vector<float> *array : {&c.x_m, &c.y_m, &c.z_m}) array->resize(n);
  c.order.resize(n), c.normal.resize(n);
  for (std::size_t w = 0; w < waves_count; ++w) {
    const auto row = power.begin() + static_cast<std::ptrdiff_t>(w) * state_->stride;
    c.power_W.insert(c.power_W.end(), row, row + static_cast<std::ptrdiff_t>(n));
  }
  if (n == 0) return c;
  state_->order.read(c.order.data(), n);
  state_->normal.read(c.normal.data(), n);
  state_->x_m.read(c.x_m.data(), n);
  state_->y_m.read(c.y_m.data(), n);
  state_->z_m.read(c.z_m.data(), n);
  return c;
}

}  // namespace greenray
