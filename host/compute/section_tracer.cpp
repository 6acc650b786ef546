#include "compute/section_tracer.hpp"

#include <optional>

#include "compute/program.hpp"
#include "compute/ray_batches.hpp"
#include "compute/ray_end.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

f32_section::RayStart narrowed(const f64_section::RayStart &s) {
  const auto f = [](double x) { return static_cast<float>(x); };
  return {f(s.above_m), f(s.run), f(s.rise),    f(s.sigma_end_m), s.row,
          s.cell,       s.column, f(s.along_m), f(s.course),      f(s.beam)};
}

f64_section::RayEnd widened(const f64_section::RayEnd &e) {
  require_ray_end(e);
  return e;
}
f64_section::RayEnd widened(const f32_section::RayEnd &e) {
  return widened(f64_section::RayEnd{e.above_m,
                                     e.run,
                                     e.rise,
                                     e.sigma_m,
                                     e.bending_rad,
                                     e.optical_path_m,
                                     {e.column[0], e.column[1], e.column[2]},
                                     e.min_z_m,
                                     e.max_z_m,
                                     e.solver_error_rad,
                                     e.bouguer_drift,
                                     e.cell,
                                     e.outcome,
                                     e.turning_points,
                                     e.steps,
                                     e.rejected,
                                     e.column_number,
                                     e.along_m,
                                     e.sideways_rad});
}

}  // namespace

struct SectionTracer::State {
  std::shared_ptr<Device> owner;
  Device::State &device;
  TraceOptions options;
  Reservation table_memory;
  cl::Buffer cells, columns, rows;
  std::optional<cl::Kernel> kernel;
  TraceStats stats;

  State(std::shared_ptr<Device> d, const SectionTable &table, const TraceOptions &o)
      : owner(std::move(d)),
        device(owner->state()),
        options(o),
        table_memory(
            device,
            table.cells.size() * (is_double() ? sizeof(f64_section::SectionCell) : sizeof(f32_section::SectionCell)),
            "the section table") {
    if (is_double() && !device.info.has_double)
      throw DeviceError(device.info.name + " has no double precision: try --precision float or another --device");
    options.absorbers.earth_curvature_per_m = table.curvature_per_m;
    try {
      is_double() ? upload<f64_section::SectionCell, f64_section::SectionColumn, f64_section::SectionRow>(table)
                  : upload<f32_section::SectionCell, f32_section::SectionColumn, f32_section::SectionRow>(table);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "uploading the section table", device.info.name);
    }
  }

  bool is_double() const { return options.precision == Precision::double_; }
  int lanes() const { return is_double() ? device.lanes.lanes_double : device.lanes.lanes_float; }

  template <class Cell, class Column, class Row>
  void upload(const SectionTable &table) {
    auto host_cells = section_cells<Cell>(table);
    auto host_columns = section_columns<Column>(table);
    auto host_rows = section_rows<Row>(table);
    cells = cl::Buffer(device.context, host_cells.begin(), host_cells.end(), true);
    columns = cl::Buffer(device.context, host_columns.begin(), host_columns.end(), true);
    rows = cl::Buffer(device.context, host_rows.begin(), host_rows.end(), true);
  }

  template <class Scalar, class Absorbers>
  void make_kernel() {
    BuildPlan plan{"trace_section",     lanes(), is_double(), false, options.integrator == Integrator::richardson,
                   options.with_columns};
    plan.medium_varies = true;
    const cl::Program program = build_program(device, plan);
    const f64::Absorbers &a = options.absorbers;
    kernel.emplace(program, "trace_section");
    kernel->setArg(0, cells);
    kernel->setArg(4, cl_int{0});
    kernel->setArg(5, options.max_steps);
    kernel->setArg(6, static_cast<Scalar>(options.tolerance_rad));
    kernel->setArg(7, Absorbers{static_cast<Scalar>(a.earth_curvature_per_m), static_cast<Scalar>(a.ozone_peak_m),
                                static_cast<Scalar>(a.ozone_width_m), static_cast<Scalar>(a.aerosol_scale_m)});
    kernel->setArg(8, columns);
    kernel->setArg(9, rows);
  }

  template <class Start, class End>
  double launch(Buffer<Start> &starts, Buffer<End> &ends, std::size_t count) {
    kernel->setArg(1, starts.cl());
    kernel->setArg(2, ends.cl());
    kernel->setArg(3, static_cast<cl_int>(count));
    const auto local = static_cast<std::size_t>(options.local_size ? options.local_size : device.lanes.local_size);
    const std::size_t items = (count + static_cast<std::size_t>(lanes()) - 1) / static_cast<std::size_t>(lanes());
    const auto begin = std::chrono::steady_clock::now();
    device.queue.enqueueNDRangeKernel(*kernel, cl::NullRange, cl::NDRange((items + local - 1) / local * local),
                                      cl::NDRange(local));
    device.queue.finish();
    return seconds_since(begin);
  }

  /// The first launch of a kernel compiles it: one ray, counted as compiling.
  template <class Start, class End>
  void launch_warm(Buffer<Start> &starts, Buffer<End> &ends, std::size_t count) {
    try {
      if (!kernel) {
        is_double() ? make_kernel<double, f64_section::Absorbers>() : make_kernel<float, f32_section::Absorbers>();
        device.compile_seconds += launch(starts, ends, 1);
      }
      stats.device_seconds += launch(starts, ends, count);
    } catch (const cl::Error &error) {
      throw_failed_call(error, "kernel trace_section", device.info.name);
    }
  }

  template <class Start, class End, class Narrow>
  std::vector<f64_section::RayEnd> run(std::span<const f64_section::RayStart> all, Narrow narrow) {
    std::vector<f64_section::RayEnd> results;
    results.reserve(all.size());
    trace_in_batches<Start, End>(
        device, all, options.between_batches, narrow,
        [&](Buffer<Start> &starts, Buffer<End> &ends, std::size_t count) { launch_warm(starts, ends, count); },
        [&](const End &end) { note_end(stats, results.emplace_back(widened(end))); });
    return results;
  }
};

SectionTracer::SectionTracer(std::shared_ptr<Device> device, const SectionTable &table, const TraceOptions &options)
    : state_(std::make_unique<State>(std::move(device), table, options)) {}
SectionTracer::~SectionTracer() = default;
const TraceStats &SectionTracer::stats() const { return state_->stats; }

std::vector<f64_section::RayEnd> SectionTracer::trace(std::span<const f64_section::RayStart> starts) {
  if (state_->is_double())
    return state_->run<f64_section::RayStart, f64_section::RayEnd>(starts,
                                                                   [](const f64_section::RayStart &s) { return s; });
  return state_->run<f32_section::RayStart, f32_section::RayEnd>(starts, narrowed);
}

}  // namespace greenray
