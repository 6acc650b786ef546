#include "compute/photon_map.hpp"

#include <algorithm>
#include <bit>
#include <chrono>

#include "compute/photon_map_state.hpp"
#include "compute/program.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr int digit_bits = 11;  // counters of one chunk: 8 kB, half of a first-level cache
constexpr int key_cell = 0, key_id = 1, key_bounce = 2;
constexpr int transposed_at_once = 4096;  // photons of one work-item

std::size_t room(std::size_t photons) { return std::max<std::size_t>(photons, 1); }

/// Chunks follow on one another: each begins at or after the end of the one before.
bool in_order(const std::vector<ChunkOrder> &chunks) {
  const ChunkOrder *before = nullptr;
  for (const ChunkOrder &chunk : chunks) {
    if (chunk.photons == 0) continue;
    if (chunk.unsorted) return false;
    if (before && std::pair(chunk.first_id, chunk.first_bounce) < std::pair(before->last_id, before->last_bounce))
      return false;
    before = &chunk;
  }
  return true;
}

}  // namespace

PhotonMap::State::State(std::shared_ptr<Device> d, const PhotonMapOptions &o)
    : owner(std::move(d)),
      device(owner->state()),
      options(o),
      stride(static_cast<int>(room(o.photons)) + device.lanes.lanes_float),
      records(device, room(o.photons), "photon records"),
      record_power_W(device, room(o.photons) * static_cast<std::size_t>(o.waves), "the power of photons"),
      pairs{Buffer<KeyedPhoton>{device, room(o.photons), "photon keys"},
            Buffer<KeyedPhoton>{device, room(o.photons), "photon keys"}},
      order(device, room(o.photons), "the order of photons"),
      x_m(device, static_cast<std::size_t>(stride), "the photon map"),
      y_m(device, static_cast<std::size_t>(stride), "the photon map"),
      z_m(device, static_cast<std::size_t>(stride), "the photon map"),
      power_W(device, static_cast<std::size_t>(stride) * static_cast<std::size_t>(o.waves), "the photon map"),
      normal(device, static_cast<std::size_t>(stride), "the photon map") {}

cl::Kernel &PhotonMap::State::kernel(const char *name) {
  const auto known = kernels_.find(name);
  if (known != kernels_.end()) return known->second;
  BuildPlan plan{"build_map", device.lanes.lanes_float};
  plan.words = " -DWAVES=" + std::to_string(options.waves);
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
  const std::size_t chunks = 8 * std::max(1u, device.info.compute_units);
  SortPlan plan{};
  plan.photons = static_cast<cl_int>(count);
  plan.chunk = options.chunk > 0 ? options.chunk : static_cast<cl_int>(std::max<std::size_t>(count / chunks + 1, 1024));
  plan.shift = std::max(0, static_cast<int>(std::bit_width(static_cast<unsigned>(cells()))) - digit_bits);
  plan.buckets = (cells() >> plan.shift) + 1;
  plan.digit_mask = ~0u;
  return plan;
}

/// pairs[from] -> pairs[1 - from], by the plan's digit. Returns whether the records were met in the order of
/// (id, bounce).
bool PhotonMap::State::sort_by_digit(const SortPlan &plan, int from) {
  const Buffer<KeyedPhoton> &before = pairs[static_cast<std::size_t>(from)], &after = pairs[from ? 0 : 1];
  const std::size_t chunks =
      std::max<std::size_t>(static_cast<std::size_t>((plan.photons + plan.chunk - 1) / plan.chunk), 1);
  const std::size_t counters = chunks * static_cast<std::size_t>(plan.buckets);
  if (!counts_ || counts_->count() < counters) counts_.emplace(device, counters, "the counts of a sort");
  if (!bucket_start_ || bucket_start_->count() < static_cast<std::size_t>(plan.buckets) + 1)
    bucket_start_.emplace(device, static_cast<std::size_t>(plan.buckets) + 1, "the counts of a sort");
  if (!chunk_order_ || chunk_order_->count() < chunks) chunk_order_.emplace(device, chunks, "the counts of a sort");

  cl::Kernel &keys = kernel("key_photons");
  keys.setArg(0, records.cl());
  keys.setArg(1, before.cl());
  keys.setArg(2, counts_->cl());
  keys.setArg(3, chunk_order_->cl());
  keys.setArg(4, plan);
  keys.setArg(5, grid);
  launch("key_photons", chunks);

  cl::Kernel &scan = kernel("scan_counts");
  scan.setArg(0, counts_->cl());
  scan.setArg(1, bucket_start_->cl());
  scan.setArg(2, plan.buckets);
  scan.setArg(3, static_cast<cl_int>(chunks));
  launch("scan_counts", static_cast<std::size_t>(plan.buckets));

  cl::Kernel &totals = kernel("scan_totals");
  totals.setArg(0, bucket_start_->cl());
  totals.setArg(1, plan.buckets);
  launch("scan_totals", 1);

  cl::Kernel &deal = kernel("deal_photons");
  deal.setArg(0, before.cl());
  deal.setArg(1, after.cl());
  deal.setArg(2, bucket_start_->cl());
  deal.setArg(3, counts_->cl());
  deal.setArg(4, plan);
  launch("deal_photons", chunks);

  std::vector<ChunkOrder> chunk_order(chunks);
  chunk_order_->read(chunk_order.data(), chunks);
  return in_order(chunk_order);
}

/// Leaves pairs[1] in the order of (id, bounce): the tie-break, where the records are not so already.
void PhotonMap::State::sort_by_id(SortPlan plan) {
  plan.buckets = 1 << digit_bits;
  plan.digit_mask = (1u << digit_bits) - 1;
  int from = 0;
  for (const auto &[key, shift] : {std::pair{key_bounce, 0},
                                   {key_bounce, digit_bits},
                                   {key_id, 0},
                                   {key_id, digit_bits},
                                   {key_id, 2 * digit_bits}}) {
    plan.key = key, plan.shift = shift;
    sort_by_digit(plan, from);
    from = 1 - from;
    plan.from_order = 1;
  }
}

void PhotonMap::State::build(std::size_t count, const Bounds &bounds, double cell_m) {
  grid = plan_grid(bounds, cell_m, std::clamp<std::size_t>(2 * count, std::size_t{1} << 12, std::size_t{1} << 24));
  const std::size_t starts = static_cast<std::size_t>(cells()) + 1;
  if (!cell_start || cell_start->count() < starts) {
    cell_start.reset();
    cell_start.emplace(device, starts, "the cells of the photon map");
  }
  try {
    SortPlan plan = plan_sort(count);
    int sorted = 1;
    if (!sort_by_digit(plan, 0)) {
      sort_by_id(plan);
      plan.from_order = 1;
      sort_by_digit(plan, 1);
      sorted = 0;
    }
    cl::Kernel &sort = kernel("sort_cells");
    sort.setArg(0, pairs[static_cast<std::size_t>(sorted)].cl());
    sort.setArg(1, bucket_start_->cl());
    sort.setArg(2, cell_start->cl());
    sort.setArg(3, order.cl());
    sort.setArg(4, plan);
    sort.setArg(5, cells());
    launch("sort_cells", static_cast<std::size_t>(plan.buckets));

    cl::Kernel &turn = kernel("transpose");
    int argument = 0;
    for (const cl::Buffer &buffer : {records.cl(), record_power_W.cl(), order.cl(), cell_start->cl(), x_m.cl(),
                                     y_m.cl(), z_m.cl(), normal.cl(), power_W.cl()})
      turn.setArg(static_cast<cl_uint>(argument++), buffer);
    turn.setArg(9, cells());
    turn.setArg(10, transposed_at_once);
    turn.setArg(11, stride);
    launch("transpose", static_cast<std::size_t>(stride) / transposed_at_once + 1);
    cl_int last = 0;
    device.queue.enqueueReadBuffer(cell_start->cl(), CL_TRUE, static_cast<std::size_t>(cells()) * sizeof(cl_int),
                                   sizeof(cl_int), &last);
    filed = static_cast<std::size_t>(last);
  } catch (const cl::Error &error) {
    throw_failed_call(error, "filing photons", device.info.name);
  }
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
  return sizeof(Photon) + 2 * sizeof(KeyedPhoton) + 5 * sizeof(float) +
         2 * sizeof(float) * static_cast<std::size_t>(waves);
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
