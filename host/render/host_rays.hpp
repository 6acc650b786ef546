// A few rays in double on the host twin: for the Sun's place, the horizon and the error of a table.
#pragma once
#include <functional>
#include <optional>

#include "atmosphere/index_table.hpp"
#include "atmosphere/layer_table.hpp"
#include "render/section_rays.hpp"
#include "twin/twin.hpp"

namespace greenray {

/// One ray of a row of the table to its end; step_rad: local error a step.
f64::RayEnd trace_on_host(const IndexTable &table, std::size_t row, double height_m, double elevation_rad,
                          const LayerAbsorbers &absorbers = {}, double step_rad = 1e-12);

/// Rays of one eye at one wavelength, by elevation [rad].
using HostRay = std::function<f64::RayEnd(double elevation_rad)>;
HostRay host_ray(IndexTable table, std::size_t row, double height_m);
HostRay host_ray(SectionTable table, std::size_t row, const SectionEye &eye, double azimuth_rad);

/// Apparent altitude [rad] of the lowest ray below 1 degree that still reaches space, above the topmost one that does
/// not; nothing when no ray meets the ground.
std::optional<double> horizon_rad(const HostRay &ray);
std::optional<double> horizon_rad(const IndexTable &table, double height_m);

/// Where a true altitude [rad] is seen, by iteration from the apparent side; nothing if it is below the horizon. In air
/// with several images, one of them. horizon: as horizon_rad tells; with it images close above the horizon are found,
/// too.
std::optional<double> apparent_altitude_rad(const HostRay &ray, double true_altitude_rad,
                                            const std::optional<double> &horizon = {});

}  // namespace greenray
