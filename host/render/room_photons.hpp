// The photons of a room, pass by pass: traced into the maps, filed, ready to be asked.
#pragma once
#include <memory>

#include "render/photon_mapper.hpp"
#include "render/room_plan.hpp"

namespace greenray {

class RoomPhotons {
 public:
  /// looks: must outlive this, as the scene must. alone: the medium parts wavelengths, one a photon.
  RoomPhotons(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
              RoomTracer &tracer, RoomLooks &looks, const surface32::GeometryBounds &bounds, bool alone);
  ~RoomPhotons();

  /// Makes the maps; passes are made smaller until they fit the device's budget beside `other_bytes`, unless `fixed`.
  void fit(RoomPlan &plan, std::size_t other_bytes, bool fixed);
  /// Traces a pass and files it. Nothing is counted or changed when it is interrupted.
  void trace(const RoomPlan &plan, int pass);

  PhotonMapper &mapper() { return *mapper_; }
  const PhotonTotals &totals() const { return totals_; }
  void set_totals(const PhotonTotals &totals) { totals_ = totals; }
  double map_seconds() const { return map_seconds_; }
  double cover_seconds() const { return cover_seconds_; }

 private:
  PhotonBatch batch_of(const RoomPlan &plan, int pass) const;
  std::array<int, 2> slots_for(const PhotonBatch &batch);
  std::array<std::size_t, 2> records_for(const PhotonBatch &batch) const;
  bool fits(const PhotonBatch &batch, std::size_t other_bytes) const;
  void make_mapper(const RoomPlan &plan, const PhotonBatch &batch);
  void share_out(const PhotonBatch &batch);
  std::vector<GatherCover> find_cover(std::span<const GatherPoint> places, std::span<const float> radius_m);

  const RoomScene &scene_;
  const RoomOptions &options_;
  std::shared_ptr<Device> device_;
  RoomTracer &tracer_;
  RoomLooks &looks_;
  surface32::GeometryBounds bounds_;
  bool alone_;
  int chunk_;
  std::array<int, 2> slots_{};
  PhotonTotals totals_;
  double map_seconds_ = 0, cover_seconds_ = 0;
  std::unique_ptr<PhotonMapper> mapper_;
  std::unique_ptr<PhotonMap> no_caustic_;
};

double diagonal_m(const surface32::GeometryBounds &bounds);

}  // namespace greenray
