// The rays of one eye through one layered medium to their ends, by the method asked for.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "atmosphere/layer_table.hpp"
#include "compute/ray_tracer.hpp"
#include "compute/section_tracer.hpp"

namespace greenray {

/// cells: layers in closed form. The others step.
enum class RayMethod { cells, dormand_prince, richardson };
const char *method_name(RayMethod method);  // "cells", "rk", "richardson"

struct SkyRayOptions {
  double height_m = 0;
  bool flat = false;
  RayMethod method = RayMethod::cells;
  Precision precision = Precision::single_;
  double error_arcsec = 0.003;  // allowed to the index table; of cells: to the layers, whose table is 30 times finer
  double step_rad = 1e-9;       // stepping methods: local error of direction per step
  int max_steps = 20000;
  LayerAbsorbers absorbers;
  double place_m = 0;      // of air that varies along the surface: x of the eye,
  double azimuth_rad = 0;  // and where it looks, clockwise from the direction of x
};

class SkyRays {
 public:
  SkyRays(const Profile &profile, const std::vector<double> &wavelengths_nm, const SkyRayOptions &options,
          std::shared_ptr<Device> device);
  /// Through air that varies along the surface, or is treated as if it did. Only stepping methods.
  SkyRays(const AirSection &air, const std::vector<double> &wavelengths_nm, const SkyRayOptions &options,
          std::shared_ptr<Device> device);
  ~SkyRays();

  /// [elevations][wavelengths]. Elevations [rad] above the eye's horizontal.
  std::vector<f64::RayEnd> trace(std::span<const double> elevations_rad);

  /// The same at azimuths of their own, [directions][wavelengths]; how far each was turned out of its vertical plane is
  /// added to sideways_rad where that is given. Elsewhere than in air that varies along the surface, azimuths tell
  /// nothing.
  std::vector<f64::RayEnd> trace(std::span<const double> elevations_rad, std::span<const double> azimuths_rad,
                                 std::vector<double> *sideways_rad = nullptr);

  bool varies() const;  // along the surface: by the second constructor
  const std::vector<double> &wavelengths_nm() const;
  double curvature_per_m() const;
  double table_bound_arcsec() const;

  /// The medium in layers for this eye, none merged; made when first asked for. Not of air that varies.
  const LayerTable &layers();

  const IndexTable &table() const;      // the one the method reads; of air that varies:
  const SectionTable &section() const;  // this one
  /// The same rays in double on the host, through the same table. Valid as long as this.
  std::function<f64::RayEnd(double elevation_rad)> on_host(std::size_t row) const;
  double index_error_arcsec() const;  // that `table` was asked for
  std::size_t cells() const;          // of that table, or layers, per wavelength
  const TraceStats &stats() const;
  bool table_in_image() const;
  const SkyRayOptions &options() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Elevations [rad], ascending, at which what a ray does jumps: where it just clears or just misses an extreme of N or
/// the ground. Exact: a ray turns at a height of lift L where tan^2 e = -L. Between two of them every quantity of the
/// ray is a smooth function of its elevation.
std::vector<double> breaks_rad(const LayerTable &layers, std::size_t wavelength);

/// Elevations [rad] whose rays turn at an edge of a layer: where the curve of refraction may bend sharply.
std::vector<double> turning_knots_rad(const LayerTable &layers, std::size_t wavelength);

}  // namespace greenray
