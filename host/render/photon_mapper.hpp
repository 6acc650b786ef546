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
/// clear: of the radius, up to what stands in the disc before surfaces behind it; `hidden` is a place there.
struct GatherCover {
  float whole = 1, inner = 1, clear = 1;
  GatherPoint hidden{};
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
  /// Of the diffuse map, every so many photons are given the irradiance there, and places take the nearest one's; 0:
  /// places ask all photons around (render/lit_photons.hpp).
  int precomputed = 0;
  int local_size = 0;
  /// For gather(): places are a picture, [rows][columns][samples]. columns 0: they are not, and radii are left as
  /// found.
  std::size_t columns = 0, samples = 1;
  double radius_slope = 0.2;  // limit_radius_slope
  CoverFinder cover;          // empty: discs are taken as whole, and edges are too dark
};

/// A place far from everything, for paths that ask nothing: it keeps their number.
constexpr GatherPoint no_place() { return {{3e8f, 3e8f, 3e8f}, 0}; }
constexpr bool is_place(const GatherPoint &point) { return point.place_m[0] < 1e8f; }

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

  /// Files the photons of a pass. `diffuse_records`, `caustic_records`: how many slots of each map are in use, holes
  /// included. returns: seconds
  double file(int pass, std::size_t diffuse_records, std::size_t caustic_records);
  /// After the first pass was filed: the middle radius at these places sets the size of the grids' cells. Cells do not
  /// change which photons are found, but in what order they are summed: the same places, the same bits.
  void survey(std::span<const GatherPoint> places);
  /// In pass 0: the radii of places, after those found already.
  void find_radii(std::span<const GatherPoint> places);
  /// Then: keeps radii from reaching over bright edges (render/radius_field.hpp). All places, a picture.
  void settle_radii(std::span<const GatherPoint> places, std::size_t columns, std::size_t samples);
  /// Keeps radii first .. first + places.size() from reaching further than those of other places beside them:
  /// around[places][any number], numbers of `others`, which are the first ones; beyond them: none.
  void limit_radii(std::size_t first, std::span<const GatherPoint> places, std::span<const GatherPoint> others,
                   std::span<const std::size_t> around);
  /// And forgets all radii but these, in this order.
  void keep_radii(std::span<const std::size_t> places);
  /// Asks the filed photons for places first .. first + places.size(), in any parts. Place i of every pass is that of
  /// pass 0, moved by less than a pixel, and keeps its radius.
  PassIrradiance ask(std::size_t first, std::span<const GatherPoint> places);
  /// All of it: file; in pass 0 survey by these places themselves and find their radii; ask.
  PassIrradiance gather(int pass, std::size_t diffuse_records, std::size_t caustic_records,
                        std::span<const GatherPoint> places);

  /// What a run that is taken up again at a later pass needs: middle radius and [places] of the diffuse map, then of
  /// the caustic one; empty before pass 0.
  std::vector<float> radii() const;
  void set_radii(std::span<const float> radii);

  /// Bytes on the device for so many records and places.
  static std::size_t device_bytes(std::size_t records, std::size_t places, int waves);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
