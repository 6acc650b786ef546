#include "bench/geometry_suite.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "bench/device_methods.hpp"
#include "bench/photon_suites.hpp"
#include "compute/surface_scene.hpp"

namespace greenray::bench {
namespace {

constexpr double room_m = 5;

Triple random_place(std::mt19937 &engine) {
  std::uniform_real_distribution<double> uniform(-room_m, room_m);
  const double x = uniform(engine), y = uniform(engine), z = uniform(engine);
  return {x, y, z};
}
Triple random_direction(std::mt19937 &engine) {
  std::normal_distribution<double> gauss;
  const double x = gauss(engine), y = gauss(engine), z = gauss(engine);
  return unit({x, y, z});
}

/// Bumpy balls all over the room: surfaces with neighbours, as meshes have them.
Surfaces balls(std::size_t triangles) {
  std::mt19937 engine(17);
  Surfaces out;
  constexpr int rings = 25, sectors = 50;  // 2400 triangles a ball
  while (out.triangles.size() < triangles) {
    const Triple centre = random_place(engine);
    const auto at = [&](int ring, int sector) {
      const double polar = M_PI * ring / rings, round = 2 * M_PI * (sector % sectors) / sectors;
      const double r = 0.7 + 0.05 * std::sin(5 * polar) * std::cos(7 * round);
      return centre + r * Triple{std::sin(polar) * std::cos(round), std::sin(polar) * std::sin(round), std::cos(polar)};
    };
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < sectors; ++j) {
        if (i > 0) out.triangles.push_back({{at(i, j), at(i + 1, j), at(i, j + 1)}, {}, {}, 0, -1});
        if (i < rings - 1) out.triangles.push_back({{at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)}, {}, {}, 0, -1});
      }
  }
  out.triangles.resize(triangles);
  return out;
}

std::vector<surface32::Segment> short_segments(std::size_t count) {
  std::mt19937 engine(23);
  std::vector<surface32::Segment> segments(count);
  for (surface32::Segment &s : segments) {
    const Triple from = random_place(engine), d = 0.2 * room_m * random_direction(engine);
    for (std::size_t a = 0; a < 3; ++a)
      s.place[a] = static_cast<float>(from[a]), s.direction[a] = static_cast<float>(d[a]);
  }
  return segments;
}

/// Nearest hit by Moller and Trumbore's test on everything, in double.
int nearest_of_all(const Surfaces &scene, const surface32::Segment &s) {
  Triple o{}, d{};
  for (std::size_t a = 0; a < 3; ++a)
    o[a] = static_cast<double>(s.place[a]), d[a] = static_cast<double>(s.direction[a]);
  double nearest = 1;
  int found = -1;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const auto &c = scene.triangles[i].corner;
    const Triple e1 = c[1] - c[0], e2 = c[2] - c[0], p = cross(d, e2), from = o - c[0], q = cross(from, e1);
    const double inverse = 1 / dot(e1, p), u = dot(from, p) * inverse, v = dot(d, q) * inverse,
                 t = dot(e2, q) * inverse;
    if (u >= 0 && v >= 0 && u + v <= 1 && t >= 0 && t < nearest) nearest = t, found = static_cast<int>(i);
  }
  return found;
}

double wrong_share(const Surfaces &scene, const std::vector<surface32::Segment> &segments,
                   const std::vector<surface32::SegmentHit> &hits) {
  constexpr std::size_t checked = 300;
  int wrong = 0;
  for (std::size_t i = 0; i < checked; ++i) wrong += nearest_of_all(scene, segments[i]) != hits[i].primitive;
  return wrong / static_cast<double>(checked);
}

Record named(const std::string &case_name, const std::string &variant, const std::string &device, const char *unit) {
  Record r;
  r.suite = "geometry";
  r.case_name = case_name, r.variant = variant, r.device = device, r.rate_unit = unit;
  r.error_unit = "share of wrong hits";
  return r;
}

/// Short segments; both sides search the same triangles.
std::vector<Record> race_segments(const SuiteOptions &options, const MakeSegmentPeer &make_peer,
                                  const std::shared_ptr<Device> &device, std::size_t triangles) {
  const Surfaces scene = balls(triangles);
  const auto segments = short_segments(options.quick ? 20000 : 1000000);
  const std::string name = "segments-" + std::to_string(triangles / 1000) + "k";
  std::vector<Contender> group;
  std::vector<std::unique_ptr<SurfaceScene>> scenes;
  std::vector<TreeBuilder> builders{TreeBuilder::own};
  if (bvh_by_embree_is_built()) builders.push_back(TreeBuilder::embree);
  for (const TreeBuilder builder : builders) {
    const SurfaceTree tree = build_surface_tree(scene, SurfaceScene::lanes_for(*device), builder);
    scenes.push_back(std::make_unique<SurfaceScene>(device, tree, uniform_air(0, {550})));
    SurfaceScene *s = scenes.back().get();
    s->load(segments);
    Record r =
        named(name, builder == TreeBuilder::own ? "own tree" : "tree by Embree", device_words(*device), "segment/s");
    r.error = wrong_share(scene, segments, s->find_loaded());
    r.more = {{"build_seconds", tree.build_seconds}, {"nodes", static_cast<double>(tree.node_count)}};
    group.push_back({r, static_cast<double>(segments.size()), false, [s] { s->run_loaded(); }});
  }
  std::unique_ptr<SegmentPeer> peer;
  std::vector<surface32::SegmentHit> hits(segments.size());
  if (make_peer) {
    peer = make_peer(scene, options.threads);
    peer->find(segments, hits);
    Record r = named(name, "Embree rtcIntersect1", "host", "segment/s");
    r.error = std::max(wrong_share(scene, segments, hits), group[0].record.error);  // edges decide differently
    group.push_back({r, static_cast<double>(segments.size()), true, [&] { peer->find(segments, hits); }});
  }
  return race_group(group, options, "Embree", peer ? peer->version() : "");
}

/// n - 1 falls from 0.1 to 0 over the room's height, steeper above.
AirTable bending_air() {
  LayeredMedium medium;
  medium.refractivity = [](double h, double) { return Dual{0.1 * (1 - h * h / 100), -0.002 * h}; };
  medium.density_kg_m3 = [](double) { return 1.0; };
  medium.top_m = 10;
  return build_air_table(medium, {550}, {0, 10, 2 * room_m, 1e-4, 4096});
}

/// Whole paths from random places, straight and curved.
std::vector<Record> race_paths(const SuiteOptions &options, const std::shared_ptr<Device> &device) {
  Surfaces scene = balls(100000);
  for (Triangle &t : scene.triangles)
    for (Triple &c : t.corner) c[2] += room_m;
  const SurfaceTree tree = build_surface_tree(scene, SurfaceScene::lanes_for(*device));
  SurfaceScene straight(device, tree, uniform_air(0, {550})), curved(device, tree, bending_air());
  std::mt19937 engine(29);
  std::vector<surface32::PathStart> starts(options.quick ? 20000 : 500000);
  for (surface32::PathStart &s : starts) {
    const Triple from = random_place(engine) + Triple{0, 0, room_m}, d = random_direction(engine);
    for (std::size_t a = 0; a < 3; ++a)
      s.place[a] = static_cast<float>(from[a]), s.momentum[a] = static_cast<float>(d[a]);
  }
  std::vector<Contender> group;
  for (SurfaceScene *s : {&straight, &curved})
    group.push_back({named("paths-100k", s == &straight ? "straight" : "curved", device_words(*device), "path/s"),
                     static_cast<double>(starts.size()), false, [s, &starts] { s->trace(starts); }});
  std::vector<Record> records = race_group(group, options, "", "");
  records[1].more["cost_against_straight"] = records[0].rate / records[1].rate;
  return records;
}

}  // namespace

std::vector<Record> run_geometry_suite(const SuiteOptions &options, const MakeSegmentPeer &peer) {
  const std::shared_ptr<Device> device = open_device(options.device);
  std::vector<Record> all;
  for (const std::size_t triangles : {std::size_t{100000}, std::size_t{1600000}}) {
    if (options.quick && triangles > 200000) continue;
    const std::vector<Record> records = race_segments(options, peer, device, triangles);
    all.insert(all.end(), records.begin(), records.end());
  }
  const std::vector<Record> paths = race_paths(options, device);
  all.insert(all.end(), paths.begin(), paths.end());
  const std::vector<Record> photons = race_room_photons(options, device);
  all.insert(all.end(), photons.begin(), photons.end());
  return all;
}

}  // namespace greenray::bench
