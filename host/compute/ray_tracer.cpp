#include "compute/ray_tracer.hpp"

#include <algorithm>
#include <map>

#include "compute/buffer.hpp"
#include "compute/program.hpp"
#include "compute/ray_batches.hpp"
#include "compute/ray_end.hpp"
#include "support/error.hpp"

namespace greenray {

void TraceStats::add(const TraceStats &o) {
  for (std::size_t i = 0; i < outcomes.size(); ++i) outcomes[i] += o.outcomes[i];
  rays += o.rays, steps += o.steps, rejected += o.rejected, device_seconds += o.device_seconds;
  solver_error_rad = std::max(solver_error_rad, o.solver_error_rad);
  bouguer_drift = std::max(bouguer_drift, o.bouguer_drift);
}

TraceStats TraceStats::since(const TraceStats &then) const {
  TraceStats more = *this;
  for (std::size_t i = 0; i < outcomes.size(); ++i) more.outcomes[i] -= then.outcomes[i];
  more.rays -= then.rays, more.steps -= then.steps, more.rejected -= then.rejected;
  more.device_seconds -= then.device_seconds;
  return more;
}
namespace {

constexpr std::size_t probe_rays = 4096;  // enough to tell a buffer from an image

template <class Cell>
std::vector<Cell> cells_for_device(const IndexTable &table) {
  using Scalar = decltype(Cell::bottom_m);
  std::vector<Cell> cells;
  cells.reserve(table.cells.size());
  for (const IndexCellData &c : table.cells) {
    Cell cell;
    for (int k = 0; k < 4; ++k) {
      cell.gradient[k] = static_cast<Scalar>(c.gradient[k]);
      cell.density[k] = static_cast<Scalar>(c.density[k]);
    }
    cell.bottom_m = static_cast<Scalar>(c.bottom_m);
    cell.thickness_m = static_cast<Scalar>(c.thickness_m);
    cell.log_index = static_cast<Scalar>(c.log_index);
    cell.step_cap_m = static_cast<Scalar>(c.step_cap_m);
    cells.push_back(cell);
  }
  return cells;
}

f32::RayStart narrowed(const f64::RayStart &s) {
  return {static_cast<float>(s.above_m),
          static_cast<float>(s.run),
          static_cast<float>(s.rise),
          static_cast<float>(s.sigma_end_m),
          s.row,
          s.cell};
}

cl::Image2D upload_image(Device::State &device, const IndexTable &table, const std::vector<f32::IndexCell> &cells) {
  const std::size_t width = table.cells_per_row * 3, height = table.wavelength_nm.size();
  cl::Image2D image(device.context, CL_MEM_READ_ONLY, cl::ImageFormat(CL_RGBA, CL_FLOAT), width, height);
  device.queue.enqueueWriteImage(image, CL_TRUE, {0, 0, 0}, {width, height, 1}, 0, 0,
                                 const_cast<f32::IndexCell *>(cells.data()));  // the C++ binding lacks const here
  return image;
}

}  // namespace

const char *outcome_name(int outcome) {
  constexpr const char *names[] = {"running", "space", "ground", "trapped", "limit", "in-flight", "not-finite"};
  return names[outcome];
}

struct RayTracer::State {
  std::shared_ptr<Device> owner;
  Device::State &device;
  TraceOptions options;
  int cells_per_row;
  std::size_t rows;
  bool image_possible, use_image = false, decided = false;
  Reservation table_memory;
  cl::Buffer table_buffer;
  cl::Image2D table_image;
  TraceStats stats;
  std::map<bool, cl::Kernel> kernels;  // by table_is_image; the first launch is done

  State(std::shared_ptr<Device> d, const IndexTable &table, const TraceOptions &o)
      : owner(std::move(d)),
        device(owner->state()),
        options(o),
        cells_per_row(static_cast<int>(table.cells_per_row)),
        rows(table.wavelength_nm.size()),
        image_possible(!is_double() && device.info.has_images &&
                       table.cells_per_row * 3 <= device.info.image_width_max && rows <= device.info.image_height_max),
        table_memory(device, table.cells.size() * sizeof(IndexCellData), "the index table") {
    if (is_double() && !device.info.has_double)
      throw DeviceError(device.info.name + " has no double precision: try --precision float or another --device");
    if (options.storage == TableStorage::image && !image_possible)
      throw RunError("the index table does not fit an image on " + device.info.name + ": use a buffer");
    options.absorbers.earth_curvature_per_m = table.curvature_per_m;
    upload(table);
  }

  bool is_double() const { return options.precision == Precision::double_; }
  int lanes() const { return is_double() ? device.lanes.lanes_double : device.lanes.lanes_float; }
  std::size_t local() const {
    return static_cast<std::size_t>(options.local_size ? options.local_size : device.lanes.local_size);
  }

  void upload(const IndexTable &table) {
    try {
      if (is_double()) {
        auto cells = cells_for_device<f64::IndexCell>(table);
        table_buffer = cl::Buffer(device.context, cells.begin(), cells.end(), true);
        return;
      }
      auto cells = cells_for_device<f32::IndexCell>(table);
      if (options.storage != TableStorage::image)
        table_buffer = cl::Buffer(device.context, cells.begin(), cells.end(), true);
      if (image_possible && options.storage != TableStorage::buffer) table_image = upload_image(device, table, cells);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "uploading the index table", device.info.name);
    }
  }

  template <class Scalar, class Absorbers>
  void set_constants(cl::Kernel &kernel) {
    const f64::Absorbers &a = options.absorbers;
    kernel.setArg(4, cells_per_row);
    kernel.setArg(5, options.max_steps);
    kernel.setArg(6, static_cast<Scalar>(options.tolerance_rad));
    kernel.setArg(7, Absorbers{static_cast<Scalar>(a.earth_curvature_per_m), static_cast<Scalar>(a.ozone_peak_m),
                               static_cast<Scalar>(a.ozone_width_m), static_cast<Scalar>(a.aerosol_scale_m)});
  }

  cl::Kernel &kernel(bool image) {
    const auto known = kernels.find(image);
    if (known != kernels.end()) return known->second;
    BuildPlan plan{"trace_rays",        lanes(), is_double(), image, options.integrator == Integrator::richardson,
                   options.with_columns};
    const cl::Program program = build_program(device, plan);
    try {
      cl::Kernel made(program, "trace_rays");
      image ? made.setArg(0, table_image) : made.setArg(0, table_buffer);
      is_double() ? set_constants<double, f64::Absorbers>(made) : set_constants<float, f32::Absorbers>(made);
      return kernels[image] = made;
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel trace_rays", device.info.name);
    }
  }

  template <class Start, class End>
  double launch(bool image, Buffer<Start> &starts, Buffer<End> &ends, std::size_t count) {
    cl::Kernel &k = kernel(image);
    try {
      k.setArg(1, starts.cl());
      k.setArg(2, ends.cl());
      k.setArg(3, static_cast<cl_int>(count));
      const std::size_t items = (count + static_cast<std::size_t>(lanes()) - 1) / static_cast<std::size_t>(lanes());
      const std::size_t global = (items + local() - 1) / local() * local();
      const auto begin = std::chrono::steady_clock::now();
      device.queue.enqueueNDRangeKernel(k, cl::NullRange, cl::NDRange(global), cl::NDRange(local()));
      device.queue.finish();
      return seconds_since(begin);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel trace_rays", device.info.name);
    }
  }

  /// PoCL compiles at the first launch of a kernel and local size: do it with one ray and count it as compiling.
  template <class Start, class End>
  void warm_up(bool image, Buffer<Start> &starts, Buffer<End> &ends) {
    if (kernels.count(image)) return;
    device.compile_seconds += launch(image, starts, ends, 1);
  }

  /// Which storage is faster, decided once by timing the first rays on both.
  template <class Start, class End>
  void decide(Buffer<Start> &starts, Buffer<End> &ends, std::size_t count) {
    if (options.storage != TableStorage::measured || !image_possible) {
      use_image = options.storage == TableStorage::image;
      decided = true;
    } else if (count >= probe_rays) {
      double best[2] = {1e30, 1e30};
      for (int repeat = 0; repeat < 3; ++repeat)
        for (int image = 0; image < 2; ++image) {
          warm_up(image, starts, ends);
          best[image] = std::min(best[image], launch(image, starts, ends, probe_rays));
        }
      use_image = best[1] < best[0];
      decided = true;
    }  // too few rays to measure: the buffer, undecided
  }

  template <class Start, class End, class Narrow>
  std::vector<f64::RayEnd> run(std::span<const f64::RayStart> all, Narrow narrow) {
    std::vector<f64::RayEnd> results;
    results.reserve(all.size());
    trace_in_batches<Start, End>(
        device, all, options.between_batches, narrow,
        [&](Buffer<Start> &starts, Buffer<End> &ends, std::size_t count) {
          if (!decided) decide(starts, ends, count);
          warm_up(use_image, starts, ends);
          stats.device_seconds += launch(use_image, starts, ends, count);
        },
        [&](const End &end) { note_end(stats, results.emplace_back(widened(end))); });
    return results;
  }
};

RayTracer::RayTracer(std::shared_ptr<Device> device, const IndexTable &table, const TraceOptions &options)
    : state_(std::make_unique<State>(std::move(device), table, options)) {}
RayTracer::~RayTracer() = default;
const TraceStats &RayTracer::stats() const { return state_->stats; }
bool RayTracer::uses_image() const { return state_->use_image; }
const Device &RayTracer::device() const { return *state_->owner; }

std::vector<f64::RayEnd> RayTracer::trace(std::span<const f64::RayStart> starts) {
  if (state_->is_double())
    return state_->run<f64::RayStart, f64::RayEnd>(starts, [](const f64::RayStart &s) { return s; });
  return state_->run<f32::RayStart, f32::RayEnd>(starts, narrowed);
}

}  // namespace greenray
