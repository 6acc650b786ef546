#include "render/room_photons.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "render/room_looks.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr int first_chunk = 64;                 // photons that a work-item follows
constexpr std::size_t most_doublings = 32;      // of its length, as a factor
constexpr std::uint32_t fewest_photons = 4096;  // of a pass that is made smaller to fit
constexpr double least_share = 0.05;            // of the photons that an even share would give a light

double area_m2(const Surfaces &surfaces) {
  double area = 0;
  for (const Triangle &t : surfaces.triangles) area += length(t.area_vector_m2());
  for (const Sphere &s : surfaces.spheres) area += 4 * M_PI * s.radius_m * s.radius_m;
  return area;
}

bool has_specular(const RoomScene &scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const MaterialScene &m) { return m.kind != MaterialScene::Kind::lambert; });
}

}  // namespace

double diagonal_m(const surface32::GeometryBounds &b) {
  return std::hypot(static_cast<double>(b.high[0] - b.low[0]), static_cast<double>(b.high[1] - b.low[1]),
                    static_cast<double>(b.high[2] - b.low[2]));
}

RoomPhotons::RoomPhotons(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device,
                         RoomTracer &tracer, RoomLooks &looks, const surface32::GeometryBounds &bounds, bool alone)
    : scene_(scene),
      options_(options),
      device_(device),
      tracer_(tracer),
      looks_(looks),
      bounds_(bounds),
      alone_(alone),
      chunk_(first_chunk) {}
RoomPhotons::~RoomPhotons() = default;

std::uint32_t RoomPhotons::aimed_of(const RoomPlan &plan, int pass) const {
  return aim_ ? static_cast<std::uint32_t>(scene_.photons.caustic_share * plan.photons_of(pass)) : 0;
}

PhotonBatch RoomPhotons::batch_of(const RoomPlan &plan, int pass) const {
  PhotonBatch batch;
  batch.seed = options_.seed, batch.pass = static_cast<std::uint32_t>(pass);
  batch.photons = plan.photons_of(pass) - aimed_of(plan, pass);
  batch.chunk = chunk_;
  batch.most_bounces = scene_.photons.most_bounces;
  batch.alone = alone_;
  batch.keep_caustics = !aim_;
  return batch;
}

/// The aimed photons of a pass, with random numbers of their own.
PhotonBatch RoomPhotons::caustics_of(const RoomPlan &plan, int pass) const {
  PhotonBatch batch = batch_of(plan, pass);
  batch.pass |= 1u << 31;
  batch.photons = aimed_of(plan, pass);
  batch.chunk = first_chunk;
  batch.slots = {first_chunk, 0};
  return batch;
}

void RoomPhotons::find_aim(const RoomPlan &plan) {
  if (!has_specular(scene_) || !scene_.photons.aimed) return;
  CausticAim aim = find_caustic_aim(tracer_, looks_, batch_of(plan, 0));
  // Photons that go everywhere make caustics for nothing: aimed ones must make half as many again to be worth it.
  double reached = 0, whole = 0;
  for (std::size_t i = 0; i < looks_.lights.size(); ++i)
    reached += looks_.light_power_W_nm[i] * aim.share[i], whole += looks_.light_power_W_nm[i];
  if (aim.marked == 0 || 1.5 * reached > scene_.photons.caustic_share * whole) return;
  tracer_.set_aim(aim.lights);
  aim_ = std::move(aim);
}

void RoomPhotons::share_out(const PhotonBatch &batch, bool aimed) {
  std::vector<double> weights;
  for (std::size_t i = 0; i < looks_.lights.size(); ++i)
    weights.push_back(looks_.light_power_W_nm[i] * scene_.lights[i].photon_weight * (aimed ? aim_->share[i] : 1));
  // A weak lamp may be all the light there is in its corner: each has a twentieth of an even share at least.
  const double whole = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double &weight : weights)
    if (weight > 0) weight = std::max(weight, least_share * whole / static_cast<double>(weights.size()));
  share_photons(looks_, batch.photons, weights);
  tracer_.set_lights(looks_.lights);
}

/// Slots for each chunk from sixteen samples of the photons; a chunk that needs more makes the pass be run again.
std::array<int, 2> RoomPhotons::slots_for(const PhotonBatch &batch) {
  std::array<int, 2> most{0, 0};
  const std::uint32_t part = std::min<std::uint32_t>(batch.photons, static_cast<std::uint32_t>(4 * batch.chunk));
  for (std::uint32_t i = 0; i < 16; ++i) {
    PhotonBatch sample = batch;
    sample.first = static_cast<std::uint32_t>(static_cast<std::uint64_t>(batch.photons - part) * i / 15);
    sample.photons = part;
    tracer_.count(sample, most);
  }
  std::array<int, 2> slots{most[0] + most[0] / 4 + 16, most[1] + most[1] / 2 + 16};
  if (!has_specular(scene_) || !batch.keep_caustics) slots[1] = 0;
  return slots;
}

std::array<std::size_t, 2> RoomPhotons::records_for(const RoomPlan &plan) const {
  const std::size_t chunks = batch_of(plan, 0).chunks() + most_doublings;
  const std::size_t aimed = (caustics_of(plan, 0).chunks() + 1) * first_chunk;
  return {chunks * static_cast<std::size_t>(slots_[0]), aim_ ? aimed : chunks * static_cast<std::size_t>(slots_[1])};
}

bool RoomPhotons::fits(const RoomPlan &plan, std::size_t other_bytes) const {
  const std::array<std::size_t, 2> records = records_for(plan);
  const int waves = static_cast<int>(looks_.waves());
  const std::size_t power_bytes = std::max(records[0], records[1]) * sizeof(float) * looks_.waves();
  const std::size_t bytes = PhotonMapper::device_bytes(records[0] + records[1], 0, waves) + other_bytes +
                            batch_of(plan, 0).chunks() * sizeof(room_twin::ChunkTally);
  return power_bytes <= device_->info().largest_buffer_bytes && records[0] < (std::size_t{1} << 30) &&
         records[1] < (std::size_t{1} << 30) && bytes + device_->used_bytes() <= device_->budget_bytes() / 20 * 19;
}

void RoomPhotons::fit(RoomPlan &plan, std::size_t other_bytes, bool fixed) {
  find_aim(plan);
  for (;;) {
    const PhotonBatch batch = batch_of(plan, 0);
    share_out(batch, false);
    slots_ = slots_for(batch);
    if (fixed || fits(plan, other_bytes) || batch.photons <= fewest_photons) return make_mapper(plan);
    halve_passes(plan, scene_, options_);
  }
}

void RoomPhotons::make_mapper(const RoomPlan &plan) {
  mapper_.reset();
  PhotonMapperOptions o;
  o.waves = static_cast<int>(looks_.waves());
  const std::array<std::size_t, 2> records = records_for(plan);
  o.precomputed = scene_.photons.precomputed;
  if (plan.even_radii) o.alpha = 1;
  o.diffuse_photons = records[0], o.caustic_photons = records[1];
  for (std::size_t a = 0; a < 3; ++a) {
    o.bounds.low_m[a] = static_cast<double>(bounds_.low[a]);
    o.bounds.high_m[a] = static_cast<double>(bounds_.high[a]);
  }
  const int k = plan.nearest;
  o.nearest = scene_.photons.radius_m ? 0 : k;
  o.caustic_nearest = scene_.photons.radius_m ? 0 : std::max(std::min(8, scene_.photons.gather), k / 2);
  // The radius of k photons, were they spread evenly over everything; four times that at most.
  const double even_m = std::sqrt(k * area_m2(scene_.surfaces) / (M_PI * plan.photons_of(0)));
  o.most_radius_m = scene_.photons.radius_m.value_or(std::min(4 * even_m, 0.2 * diagonal_m(bounds_)));
  o.cover = [this](std::span<const GatherPoint> places, std::span<const float> radius_m) {
    return find_cover(places, radius_m);
  };
  mapper_ = std::make_unique<PhotonMapper>(device_, o);
  if (!no_caustic_) no_caustic_ = std::make_unique<PhotonMap>(device_, PhotonMapOptions{1, o.waves, 0, 0});
}

/// Only of places that ask; the others stand far off.
std::vector<GatherCover> RoomPhotons::find_cover(std::span<const GatherPoint> places, std::span<const float> radius_m) {
  const auto begin = std::chrono::steady_clock::now();
  const double compiled = device_->compile_seconds();
  const PhotonMapperOptions defaults;
  const std::vector<room_twin::Cover> found =
      tracer_.cover(places, radius_m, defaults.flatness, std::cos(defaults.facing_deg * M_PI / 180));
  std::vector<GatherCover> covers;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const room_twin::Cover &c = found[i];
    covers.push_back({c.whole, c.inner, c.clear, {{c.hidden[0], c.hidden[1], c.hidden[2]}, places[i].normal}});
  }
  cover_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() -
                    (device_->compile_seconds() - compiled);
  return covers;
}

/// returns: records of the caustic map, holes included
std::size_t RoomPhotons::store_caustics(const RoomPlan &plan, int pass) {
  const PhotonBatch batch = caustics_of(plan, pass);
  share_out(batch, true);
  tracer_.store_caustics(batch, *mapper_->caustic(), totals_);
  return batch.chunks() * static_cast<std::size_t>(first_chunk);
}

void RoomPhotons::trace(const RoomPlan &plan, int pass) {
  for (;;) {
    PhotonBatch batch = batch_of(plan, pass);
    share_out(batch, false);
    batch.slots = slots_;
    PhotonMap *caustic = mapper_->caustic();
    std::array<int, 2> most{};
    if (tracer_.store(batch, mapper_->diffuse(), caustic ? *caustic : *no_caustic_, totals_, most)) {
      const std::size_t records = batch.chunks() * static_cast<std::size_t>(slots_[0]);
      map_seconds_ += mapper_->file(
          pass, records, aim_ ? store_caustics(plan, pass) : batch.chunks() * static_cast<std::size_t>(slots_[1]));
      return;
    }
    if (pass == 0) {
      for (std::size_t i = 0; i < 2; ++i) slots_[i] = std::max(slots_[i], most[i] + most[i] / 4);
      make_mapper(plan);
      continue;
    }
    // The same room in chunks twice as long, which differ less from each other.
    if (chunk_ >= first_chunk * static_cast<int>(most_doublings))
      throw RunError("photons of a later pass need more room than those of the first: give more photons a pass");
    chunk_ *= 2;
    for (int &slots : slots_) slots *= 2;
  }
}

}  // namespace greenray
