// Irradiance at the places the eye asks for, pass by pass: files the photons of a pass in two maps, sets the radii,
// gathers from both.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "compute/photon_gather.hpp"

namespace greenray {

/// Part of a gather's disc that surfaces fill, of the whole one and of the one of half its area: 1 away from edges.
struct GatherCover {
  float whole = 1, inner = 1;
};
using CoverFinder =
    std::function<std::vector<GatherCover>(std::span<const GatherPoint> places, std::span<const float> radius_m)>;

struct PhotonMapperOptions {
  int waves = 1;
  std::size_t diffuse_photons = 0, caustic_photons = 0;  // room for so many records of one pass; caustic 0: no such map
  Bounds bounds;                                         // of the scene's surfaces
  /// The radius of pass 0: that of the `nearest` nearest photons of each place, but at most most_radius_m. nearest 0:
  /// most_radius_m everywhere.
  int nearest = 150, caustic_nearest = 60;
  double most_radius_m = 1;
  GatherKernel kernel = GATHER_EPANECHNIKOV;
  double flatness = 0.25, facing_deg = 60;
  double alpha = 2.0 / 3;  // of the shrinking radius
  int local_size = 0;
  /// Places are a picture: [rows][columns][samples]. columns 0: they are not, and radii are left as found.
  std::size_t columns = 0, samples = 1;
  double radius_slope = 0.2;  // limit_radius_slope
  CoverFinder cover;          // empty: discs are taken as whole, and edges are too dark
};

/// Answers of a pass for each place, both maps together. Irradiance in the unit of the powers per m^2.
struct PassIrradiance {
  std::vector<float> irradiance;  // [places][waves]
  std::vector<float> narrower;    // [places], summed over waves, from kernels of half the area
  std::vector<float> variance;    // [places], of that sum
  std::vector<int> photons;       // [places]
  double build_seconds = 0, gather_seconds = 0;
};

class PhotonMapper {
 public:
  /// Throws MemoryError when the maps do not fit the device's budget: give fewer photons per pass then, never fewer
  /// photons.
  PhotonMapper(std::shared_ptr<Device> device, const PhotonMapperOptions &options);
  ~PhotonMapper();

  /// Where a tracer on the device writes its records; caustic: null without one.
  PhotonMap &diffuse();
  PhotonMap *caustic();

  /// One pass over all places. `diffuse_records`, `caustic_records`: how many slots of each map are in use, holes
  /// included. The places are those of pass 0 in the same order, moved by less than a pixel: place i keeps its radius.
  /// A run that is taken up again at a later pass is given the radii of the first by set_radii.
  PassIrradiance gather(int pass, std::size_t diffuse_records, std::size_t caustic_records,
                        std::span<const GatherPoint> places);

  /// [places] of the diffuse map, then of the caustic one; empty before pass 0.
  std::vector<float> radii() const;
  void set_radii(std::span<const float> radii);

  /// Bytes on the device for so many records and places.
  static std::size_t device_bytes(std::size_t records, std::size_t places, int waves);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
