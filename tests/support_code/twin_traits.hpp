// One test body for both precisions: types and functions of the host twin behind a name that a typed test can take.
#pragma once
#include <cstdlib>
#include <span>
#include <vector>

#include "compute/device.hpp"
#include "compute/ray_tracer.hpp"
#include "twin/twin.hpp"

namespace greenray {

/// GREENRAY_TEST_KERNELS names another copy of kernels/: for checks that these tests see broken physics.
inline DeviceOptions device_options() {
  DeviceOptions options;
  if (const char *folder = std::getenv("GREENRAY_TEST_KERNELS")) options.kernel_folder = folder;
  return options;
}

/// A device opened once per test program. lanes: 1, 4, 8; 0: the device's own.
inline std::shared_ptr<Device> shared_device(int lanes = 0) {
  static std::shared_ptr<Device> opened[9];
  std::shared_ptr<Device> &device = opened[lanes];
  if (!device) {
    DeviceOptions options = device_options();
    if (lanes) options.lanes = lanes;
    device = open_device(options);
  }
  return device;
}

#define TWIN_TRAITS(Name, space, precision_value)                                                                     \
  struct Name {                                                                                                       \
    using Scalar = space::scalar;                                                                                     \
    using Cell = space::IndexCell;                                                                                    \
    using Lanes = space::CellLanes;                                                                                   \
    using Start = space::RayStart;                                                                                    \
    using End = space::RayEnd;                                                                                        \
    using State = space::RayState;                                                                                    \
    using Layers = space::Medium;                                                                                     \
    using Bodies = space::Absorbers;                                                                                  \
    using ProbeIn = space::ProbeInput;                                                                                \
    using ProbeOut = space::ProbeOutput;                                                                              \
    static constexpr Precision precision = precision_value;                                                           \
    static constexpr bool is_double = sizeof(Scalar) == 8;                                                            \
    static State derivative(const Layers &m, const State &y) { return space::derivative(&m, y.above_m, y.rise); }     \
    static State dormand_prince(const Layers &m, const State &y, Scalar h, Scalar *error) {                           \
      const State slope = derivative(m, y);                                                                           \
      return space::dormand_prince_step(&m, &y, &slope, h, error);                                                    \
    }                                                                                                                 \
    static State richardson(const Layers &m, const State &y, Scalar h, Scalar *error) {                               \
      const State slope = derivative(m, y);                                                                           \
      return space::richardson_step(&m, &y, &slope, h, error);                                                        \
    }                                                                                                                 \
    static Scalar to_edge(const Layers &m, const State &y, bool rising) {                                             \
      const State slope = derivative(m, y);                                                                           \
      return space::sigma_to_edge(&m, &y, &slope, rising);                                                            \
    }                                                                                                                 \
    static Scalar gradient(const Lanes &c, Scalar t) { return space::log_index_gradient(&c, t); }                     \
    static Scalar gradient_slope(const Lanes &c, Scalar t) { return space::log_index_gradient_slope(&c, t); }         \
    static Scalar log_index(const Lanes &c, Scalar t) { return space::log_index(&c, t); }                             \
    static Scalar density(const Lanes &c, Scalar t) { return space::air_density(&c, t); }                             \
    static Scalar potential(const Layers &m, Scalar above_m) { return space::potential(&m, above_m); }                \
    static ProbeOut probe(const ProbeIn &in, const Bodies &bodies) { return space::probe(&in, bodies); }              \
    static std::vector<End> trace(std::span<const Cell> cells, std::size_t cells_per_row,                             \
                                  std::span<const Start> starts, const TraceOptions &options, const Bodies &bodies) { \
      const space::TraceSettings settings{static_cast<Scalar>(options.tolerance_rad), options.max_steps,              \
                                          static_cast<int>(cells_per_row)};                                           \
      std::vector<End> ends(starts.size());                                                                           \
      for (int i = 0; i < static_cast<int>(starts.size()); ++i) {                                                     \
        space::March march;                                                                                           \
        space::start_march(&march, cells.data(), starts.data(), i, i, &settings, bodies);                             \
        space::trace(&march, cells.data(), &settings);                                                                \
        space::record(&march, ends.data(), i, i);                                                                     \
      }                                                                                                               \
      return ends;                                                                                                    \
    }                                                                                                                 \
  }

TWIN_TRAITS(Single, f32, Precision::single_);
TWIN_TRAITS(Double, f64, Precision::double_);
TWIN_TRAITS(SinglePaper, f32_richardson, Precision::single_);
TWIN_TRAITS(DoublePaper, f64_richardson, Precision::double_);
#undef TWIN_TRAITS

/// A table's cells as the device holds them.
template <class Twin>
std::vector<typename Twin::Cell> twin_cells(const IndexTable &table) {
  using Scalar = typename Twin::Scalar;
  std::vector<typename Twin::Cell> cells;
  for (const IndexCellData &from : table.cells) {
    typename Twin::Cell cell;
    for (int k = 0; k < 4; ++k) {
      cell.gradient[k] = static_cast<Scalar>(from.gradient[k]);
      cell.density[k] = static_cast<Scalar>(from.density[k]);
    }
    cell.bottom_m = static_cast<Scalar>(from.bottom_m);
    cell.thickness_m = static_cast<Scalar>(from.thickness_m);
    cell.log_index = static_cast<Scalar>(from.log_index);
    cell.step_cap_m = static_cast<Scalar>(from.step_cap_m);
    cells.push_back(cell);
  }
  return cells;
}

/// Traces on the host twin, with the constants that RayTracer would hand to the device.
template <class Twin>
std::vector<typename Twin::End> trace_on_twin(const IndexTable &table, std::span<const f64::RayStart> starts,
                                              const TraceOptions &options) {
  using Scalar = typename Twin::Scalar;
  std::vector<typename Twin::Start> narrow;
  for (const f64::RayStart &s : starts)
    narrow.push_back({static_cast<Scalar>(s.above_m), static_cast<Scalar>(s.run), static_cast<Scalar>(s.rise),
                      static_cast<Scalar>(s.sigma_end_m), s.row, s.cell});
  const typename Twin::Bodies bodies{
      static_cast<Scalar>(table.curvature_per_m), static_cast<Scalar>(options.absorbers.ozone_peak_m),
      static_cast<Scalar>(options.absorbers.ozone_width_m), static_cast<Scalar>(options.absorbers.aerosol_scale_m)};
  return Twin::trace(twin_cells<Twin>(table), table.cells_per_row, narrow, options, bodies);
}

/// A smooth cell 400 m thick over a sphere of 6371 km, as steep as a strong inversion, and a ray in it.
template <class Twin>
typename Twin::ProbeIn smooth_cell_ray(double above_m = 30, double rise = 0.002, double step_m = 2000) {
  using Scalar = typename Twin::Scalar;
  const auto s = [](double x) { return static_cast<Scalar>(x); };
  typename Twin::ProbeIn in;
  const double gradient[4] = {-3e-8, -9e-8, 6e-8, 1.5e-8}, density[4] = {1.2, -0.04, 0.003, -0.001};
  for (int k = 0; k < 4; ++k) {
    in.cell.gradient[k] = s(gradient[k]);
    in.cell.density[k] = s(density[k]);
  }
  in.cell.bottom_m = s(100);
  in.cell.thickness_m = s(400);
  in.cell.log_index = s(2.7e-4);
  in.cell.step_cap_m = s(30000);
  in.above_m = s(above_m);
  in.run = s(1.0003);
  in.rise = s(rise);
  in.step_m = s(step_m);
  return in;
}

template <class Twin>
typename Twin::Bodies usual_absorbers(double curvature_per_m = 1 / 6371000.0) {
  using Scalar = typename Twin::Scalar;
  return {static_cast<Scalar>(curvature_per_m), static_cast<Scalar>(22000), static_cast<Scalar>(5000),
          static_cast<Scalar>(1200)};
}

/// The medium of one cell with the ray's state in it, from a probe input.
template <class Twin>
typename Twin::Layers layers_of(const typename Twin::ProbeIn &in, const typename Twin::Bodies &bodies) {
  typename Twin::Layers m;
  m.absorbers = bodies;
  m.run = in.run;
  for (int k = 0; k < 4; ++k) {
    m.cell.gradient[k] = in.cell.gradient[k];
    m.cell.density[k] = in.cell.density[k];
  }
  m.cell.bottom_m = in.cell.bottom_m;
  m.cell.thickness_m = in.cell.thickness_m;
  m.cell.log_index = in.cell.log_index;
  m.cell.step_cap_m = in.cell.step_cap_m;
  return m;
}

template <class Twin>
typename Twin::State state_of(const typename Twin::ProbeIn &in) {
  typename Twin::State y{};
  y.above_m = in.above_m;
  y.rise = in.rise;
  return y;
}

}  // namespace greenray
