// The sky kernel: pixels of a rectilinear picture, filled by look-up in a transfer table.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "compute/device.hpp"
#include "twin/twin.hpp"

namespace greenray {

/// Rows of the transfer table for the kernel: [entries][channels][waves], waves padded (kernels/shared/sky.h).
struct SkyTable {
  int entries = 0, waves = 0, channels = 0;
  std::vector<float> values;
  std::vector<float> disks;  // of Sun and Moon: [DISK_MOON_SHADOW + shadow rows][waves]
};

/// What stands before the sky, targets and waves, for the same kernel (kernels/shared/target.h). Of as many wavelengths
/// and entries as the sky.
struct TargetTable {
  int stations = 0;
  std::vector<float> sight;          // [entries][stations][TARGET_CHANNEL_COUNT][waves]
  std::vector<f32::Target> targets;  // farthest first
  std::vector<float> corners;        // [corners][2]
  std::vector<float> light;          // [1 + targets][waves]
  std::vector<f32::TargetTexel> texels;
  std::vector<float> crests;  // thresholds over azimuth; empty: no waves
  int sea_entry = 0;
  float first_crest_rad = 0, crests_per_rad = 0;

  bool any() const { return !targets.empty() || !crests.empty(); }
  std::size_t bytes() const {
    return (sight.size() + corners.size() + light.size() + crests.size()) * sizeof(float) +
           targets.size() * sizeof(f32::Target) + texels.size() * sizeof(f32::TargetTexel);
  }
  f32::TargetScale scale() const {
    return {static_cast<int>(targets.size()),
            stations,
            static_cast<int>(crests.size()),
            sea_entry,
            first_crest_rad,
            crests_per_rad};
  }
  f32::Targets view(int waves) const {
    return {sight.data(), targets.data(), corners.data(), light.data(), texels.data(), crests.data(), scale(), waves};
  }
};

/// Terrain before the sky, for the same kernel (kernels/shared/terrain.h). What does not depend on light is looked at
/// where it is kept.
struct TerrainTable {
  std::span<const float> heights, tops, node_entry, rays, grounded;
  std::span<const short> slopes;
  std::span<const f32::TerrainBlock> blocks;
  std::span<const int> first_node;
  std::span<const unsigned int> masks;
  std::vector<float> light, shine;
  f32::TerrainScale scale{};

  bool any() const { return !heights.empty(); }
  std::size_t bytes() const {
    return (heights.size() + tops.size() + node_entry.size() + rays.size() + grounded.size() + light.size() +
            shine.size()) *
               sizeof(float) +
           slopes.size() * sizeof(short) + blocks.size() * sizeof(f32::TerrainBlock) +
           (first_node.size() + masks.size()) * sizeof(int);
  }
  f32::Terrain view(int sky_waves) const {
    return {heights.data(),    slopes.data(), tops.data(),     blocks.data(), node_entry.data(),
            first_node.data(), rays.data(),   grounded.data(), masks.data(),  light.data(),
            shine.data(),      scale,         sky_waves};
  }
};

/// Wavelengths rounded up to whole groups of the device's lanes.
int padded_waves(const Device &device, int wavelengths);

/// Sums over the samples of a band of rows.
struct SkySums {
  std::span<const float> spectra;  // [rows][width][waves padded]
  std::span<const float> moments;  // [rows][width][2]: sum and sum of squares of the spectrum's sum
};

/// Accumulates samples for a band of rows; the band's memory counts against the device's budget.
class SkyShader {
 public:
  /// targets, terrain: may be empty; then the kernel is built without them.
  SkyShader(std::shared_ptr<Device> device, const SkyTable &table, const TargetTable &targets,
            const TerrainTable &terrain, int width, int most_rows);
  ~SkyShader();

  /// Starts a band: view.first_row, view.rows. Its first samples (first_sample 0) replace what the last band left.
  void begin(const f32::SkyView &view);
  /// Adds samples first_sample .. first_sample + samples - 1 to every pixel of the band. between: called between the
  /// launches of a large band; may throw to stop.
  void add_samples(int first_sample, int samples, const std::function<void()> &between = {});
  /// Puts the sums of samples that were taken before into the band.
  void set_sums(const SkySums &sums);
  /// Shows the band's sums to `use`, in place where the device shares the host's memory.
  void with_sums(const std::function<void(const SkySums &)> &use) const;
  /// Bytes that a band of this many rows needs on the device.
  static std::size_t band_bytes(int width, int rows, int waves);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
