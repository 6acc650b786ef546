// What a photon of a room costs, from its light into the filed map: straight and curved, 16 times the photons, 16 times
// the triangles.
#include <cmath>

#include "bench/device_methods.hpp"
#include "bench/geometry_suite.hpp"
#include "bench/photon_suites.hpp"
#include "render/room_choices.hpp"
#include "render/room_looks.hpp"
#include "render/room_photons.hpp"
#include "support/embedded.hpp"

namespace greenray::bench {
namespace {

/// The same surfaces in four times as many triangles, `splits` times.
Surfaces divided(const Surfaces &surfaces, int splits) {
  Surfaces out = surfaces;
  for (int i = 0; i < splits; ++i) {
    std::vector<Triangle> finer;
    for (const Triangle &t : out.triangles) {
      const auto &c = t.corner;
      const Triple ab = 0.5 * (c[0] + c[1]), bc = 0.5 * (c[1] + c[2]), ca = 0.5 * (c[2] + c[0]);
      for (const auto &corners : {std::array{c[0], ab, ca}, {ab, c[1], bc}, {ca, bc, c[2]}, {ab, bc, ca}}) {
        Triangle part = t;
        part.corner = corners;
        finer.push_back(part);
      }
    }
    out.triangles = std::move(finer);
  }
  return out;
}

/// All photons of a picture of the cross room, traced and filed.
class PhotonRun {
 public:
  PhotonRun(const std::shared_ptr<Device> &device, std::int64_t photons, bool straight, int splits)
      : scene_(parse_room("scenes/cross-room.toml", embedded_file("scenes/cross-room.toml").value())),
        looks_(room_looks(scene_)) {
    scene_.surfaces = divided(scene_.surfaces, splits);
    options_.size = scene_.camera.resolution;
    options_.straight = straight, options_.photons = photons;
    const AirTable air = room_air(scene_, looks_.wavelength_nm, straight);
    const SurfaceTree tree = build_surface_tree(scene_.surfaces, SurfaceScene::lanes_for(*device));
    build_seconds = tree.build_seconds;
    tracer_.emplace(device, tree, air, looks_);
    plan_ = plan_room(scene_, options_);
    photons_.emplace(scene_, options_, device, *tracer_, looks_, tree.bounds,
                     medium_disperses(air, diagonal_m(tree.bounds)));
    photons_->fit(plan_, 0);
  }

  void run() {
    totals_ = {};
    for (int pass = 0; pass < plan_.passes; ++pass) {
      photons_->trace(plan_, pass);
      totals_.add(photons_->totals());
    }
  }

  Record record(const Device &device, const std::string &variant) const {
    const PhotonTotals &t = totals_;
    Record r;
    r.suite = "geometry", r.case_name = "cross-room", r.variant = variant;
    r.device = device_words(device), r.rate_unit = "photon/s";
    r.kind = {"", "", "photons", "float", device.lanes().lanes_float};
    r.error = std::abs(t.emitted - t.absorbed - t.escaped - t.medium - t.dropped) / t.emitted;
    r.error_unit = "of the power lost";
    r.more = {{"photons", static_cast<double>(t.photons)},
              {"triangles", static_cast<double>(scene_.surfaces.triangles.size())},
              {"curved", options_.straight ? 0.0 : 1.0},
              {"pieces", static_cast<double>(t.pieces)},
              {"build_seconds", build_seconds}};
    return r;
  }

  double build_seconds = 0;

 private:
  RoomScene scene_;
  RoomLooks looks_;
  RoomOptions options_;
  PhotonTotals totals_;
  RoomPlan plan_;
  std::optional<RoomTracer> tracer_;
  std::optional<RoomPhotons> photons_;
};

}  // namespace

std::vector<Record> race_room_photons(const SuiteOptions &options, const std::shared_ptr<Device> &device) {
  const std::int64_t most = options.quick ? 64000 : 3000000;
  struct Setting {
    const char *words;
    std::int64_t photons;
    bool straight;
    int splits;
  };
  const Setting settings[] = {{"straight", most, true, 0},
                              {"curved", most, false, 0},
                              {"curved, a sixteenth of the photons", most / 16, false, 0},
                              {"curved, many triangles", most / 4, false, 4},
                              {"curved, 16 times as many triangles", most / 4, false, 6}};
  std::vector<std::unique_ptr<PhotonRun>> runs;
  std::vector<Contender> group;
  for (const Setting &s : settings) {
    if (options.say) options.say(std::string("cross-room: ") + s.words);
    runs.push_back(std::make_unique<PhotonRun>(device, s.photons, s.straight, s.splits));
    PhotonRun *run = runs.back().get();
    run->run();
    group.push_back({run->record(*device, s.words), static_cast<double>(s.photons), false, [run] { run->run(); }});
  }
  return race_group(group, options, "", "");
}

}  // namespace greenray::bench
