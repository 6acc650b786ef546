// What an eye's rays do, elevation by elevation: all of a sky picture in which the Sun has no part, so that the frames
// of a sunset share it.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/host_rays.hpp"
#include "render/renderer.hpp"
#include "render/sky_glow.hpp"
#include "render/targets.hpp"
#include "render/terrain_sights.hpp"
#include "render/transfer.hpp"
#include "render/transfer_curve.hpp"

namespace greenray {

class SkySight {
 public:
  /// progress(phase): looked at between the parts of the work; may throw to stop it.
  SkySight(const Scene &scene, const RenderPlan &plan, const RenderOptions &options, std::shared_ptr<Device> device,
           const std::function<void(const std::string &phase)> &progress);

  const HostRay &reference() const { return reference_; }  // a fine table at 550 nm
  std::optional<double> horizon_rad() const { return horizon_rad_; }
  SkyRays &rays() { return *rays_; }
  const TransferCurve &curve() const { return curve_; }
  const TransferTable &transfer() const { return transfer_; }  // of all wavelengths of the picture
  const TransferProbes &probes() const { return probes_; }
  /// Light of the sky, wherever the Sun stands; null in an academic scene.
  const std::shared_ptr<const SkyField> &field() const { return field_; }
  /// Where the entries' rays pass the targets of the scene; without targets empty.
  const StationSights &stations() const { return stations_; }
  SightPlaces &places() { return *places_; }
  /// What waves hide; nothing: a smooth sea.
  const std::optional<SeaSights> &sea() const { return sea_; }
  /// Terrain and the rays above it; null: a scene without.
  const PolarTerrain *terrain() const { return terrain_ ? &*terrain_ : nullptr; }
  const TerrainSights &terrain_sights() const { return terrain_sights_; }
  /// Rays at one apparent altitude, [wavelengths of the picture].
  std::vector<Transfer> rays_at(double altitude_deg);
  /// Its part of a picture's report: cells, errors, rays, seconds.
  const RenderReport &report() const { return report_; }

 private:
  void measure_table();
  void trace_table();
  void trace_targets(const Scene &scene);
  void trace_waves(const Scene &scene);
  void trace_above_terrain(const Scene &scene);
  bool measures_solver() const;
  HostRay finer_ray(double wavelength_nm) const;
  SkyRayOptions ray_options(const Scene &scene) const;

  RenderPlan plan_;
  std::shared_ptr<Device> device_;
  AirSection air_;
  bool flat_;
  double height_m_, table_arcsec_;
  HostRay reference_;
  std::optional<double> horizon_rad_;
  std::optional<SkyRays> rays_;
  TransferCurve curve_;
  TransferTable transfer_;
  TransferProbes probes_;
  std::shared_ptr<const SkyField> field_;
  std::optional<SightPlaces> places_;
  StationSights stations_;
  std::optional<SeaSights> sea_;
  std::optional<PolarTerrain> terrain_;
  TerrainSights terrain_sights_;
  RenderReport report_;
};

/// The last sight, for the next picture if that has the same.
struct SkySightCache {
  std::string key;
  std::shared_ptr<SkySight> sight;
};

/// The cached sight where it fits, else a new one, which is then cached. cache: may be null. reused: which of the two.
std::shared_ptr<SkySight> sky_sight(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                                    const std::shared_ptr<Device> &device, SkySightCache *cache, bool &reused,
                                    const std::function<void(const std::string &phase)> &progress);

}  // namespace greenray
