// The photons of a room, pass by pass: traced into the maps, filed, ready to be asked.
#pragma once
#include <memory>

#include "render/caustic_aim.hpp"
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
  void fit(RoomPlan &plan, std::size_t other_bytes, bool fixed = false);
  /// Makes the maps of a plan that is made already, with room as its first pass needed it.
  void fit_as(const RoomPlan &plan, const std::array<int, 2> &slots);
  /// Traces a pass and files it.
  void trace(const RoomPlan &plan, int pass);

  PhotonMapper &mapper() { return *mapper_; }
  /// Of the pass that was traced last.
  const PhotonTotals &totals() const { return totals_; }
  /// Room for the records of a chunk, as the first pass needed it.
  const std::array<int, 2> &slots() const { return slots_; }
  double map_seconds() const { return map_seconds_; }
  double cover_seconds() const { return cover_seconds_; }
  /// Cells of the lights' emission that caustic photons are aimed at; 0: they are not.
  std::size_t aimed_cells() const { return aim_ ? aim_->marked : 0; }

 private:
  PhotonBatch batch_of(const RoomPlan &plan, int pass) const;
  PhotonBatch caustics_of(const RoomPlan &plan, int pass) const;
  std::uint32_t aimed_of(const RoomPlan &plan, int pass) const;
  void find_aim(const RoomPlan &plan);
  std::size_t store_caustics(const RoomPlan &plan, int pass);
  std::array<int, 2> slots_for(const PhotonBatch &batch);
  std::array<std::size_t, 2> records_for(const RoomPlan &plan) const;
  bool fits(const RoomPlan &plan, std::size_t other_bytes) const;
  void make_mapper(const RoomPlan &plan);
  void share_out(const PhotonBatch &batch, bool aimed);
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
  std::optional<CausticAim> aim_;  // caustic photons are traced by themselves
};

double diagonal_m(const surface32::GeometryBounds &bounds);

}  // namespace greenray
