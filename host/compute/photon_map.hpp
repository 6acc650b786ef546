// The photon map on a device: records in, photons filed by cell out, the same bits whatever the way they were filed.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "compute/device.hpp"
#include "compute/photon.hpp"

namespace greenray {

struct Bounds {
  std::array<double, 3> low_m{}, high_m{};
};

/// Smallest box around the photons that are not empty slots; a point at the origin if there is none.
Bounds bounds_of(std::span<const Photon> photons);

/// A grid of cells of edge cell_m over the box, at most most_cells of them: rows are wrapped around (a spatial hash)
/// where a dense grid would need more, and cells are enlarged where that is not enough. Throws RunError unless
/// cell_m > 0.
PhotonGrid plan_grid(const Bounds &bounds, double cell_m, std::size_t most_cells);

/// Edge of a cell that suits a gather of this radius: with 1.5 cells a radius fewer photons outside the ball are looked
/// at than with one, and rows are still long enough (measured: 5 to 9 % faster).
constexpr double cell_of_radius(double radius_m) { return radius_m / 1.5; }

struct PhotonMapOptions {
  std::size_t photons = 0;  // room for so many records
  int waves = 1;            // wavelengths that every photon carries
  int local_size = 0;       // 0: the device's own
  int chunk = 0;            // photons counted by one work-item; 0: chosen
};

class PhotonMap {
 public:
  PhotonMap(std::shared_ptr<Device> device, const PhotonMapOptions &options);
  ~PhotonMap();

  /// Copies records to the device. power_W[photons][waves]. Throws RunError if there is no room for them.
  void upload(std::span<const Photon> photons, std::span<const float> power_W);
  /// Files the first `photons` records on the device. bounds: where photons are expected; others are found, too.
  /// Records that stand in the order of (id, bounce), with holes or without, are filed faster: others are sorted first.
  void build(std::size_t photons, const Bounds &bounds, double cell_m);

  std::size_t filed() const;  // photons in the map: empty slots, and places that are no numbers, are left out
  const PhotonGrid &grid() const;
  int waves() const;
  const Device &device() const;
  static std::size_t bytes_per_photon(int waves);

  /// The map as it stands on the device, for tests and pictures.
  struct Contents {
    std::vector<int> cell_start;       // [cells + 1]
    std::vector<unsigned int> order;   // [filed]: number of the record
    std::vector<float> x_m, y_m, z_m;  // [filed]
    std::vector<unsigned int> normal;
    std::vector<float> power_W;  // [waves][filed]
  };
  Contents read() const;

  struct State;  // OpenCL objects (compute/photon_map_state.hpp)
  State &state() const { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace greenray
