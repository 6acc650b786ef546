// Suite gather: irradiance from a photon map, against searches in a tree.
#include <algorithm>
#include <cmath>
#include <memory>

#include "bench/device_methods.hpp"
#include "bench/photon_case.hpp"
#include "bench/photon_suites.hpp"
#include "compute/photon_gather.hpp"

namespace greenray::bench {
namespace {

constexpr int wanted = 150;

/// Every so many-th point is checked by brute force.
std::vector<std::size_t> checked_points(const PhotonCase &c) {
  std::vector<std::size_t> points;
  for (std::size_t i = 0; i < c.points.size(); i += std::max<std::size_t>(c.points.size() / 61, 1)) points.push_back(i);
  return points;
}

struct Accuracy {
  double error = 0;  // largest relative error
  int wrong_counts = 0;
};

Accuracy accuracy_within(const BruteForce &truth, const std::vector<std::size_t> &points,
                         std::span<const float> irradiance, const std::function<int(std::size_t)> &count) {
  Accuracy a;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double got = static_cast<double>(irradiance[points[i]]);
    if (truth.irradiance[i] > 0) a.error = std::max(a.error, std::abs(got / truth.irradiance[i] - 1));
    a.wrong_counts += count(points[i]) != truth.counts[i];
  }
  return a;
}

Record blank(const PhotonCase &c, const std::string &what, const std::string &variant, const std::string &device) {
  Record r;
  r.suite = "gather";
  r.case_name = c.name + " " + what;
  r.variant = variant;
  r.device = device;
  r.rate_unit = "point/s";
  r.error_unit = "relative";
  r.more = {{"photons", static_cast<double>(c.photons.size())}, {"points", static_cast<double>(c.points.size())}};
  return r;
}

/// Everything that answers about one case.
struct Field {
  const PhotonCase &c;
  const SuiteOptions &options;
  std::shared_ptr<Device> device;
  const std::vector<NeighbourPeer> &peers;
  std::vector<std::unique_ptr<NeighbourTree>> trees;
  float radius_m;
  std::vector<std::size_t> checked;
};

std::vector<Record> race_within(Field &f, PhotonMap &map) {
  const auto count = static_cast<double>(f.c.points.size());
  const BruteForce truth = brute_force(f.c, f.checked, f.radius_m, false, f.options.threads);
  const BruteForce wall_truth = brute_force(f.c, f.checked, f.radius_m, true, f.options.threads);
  std::vector<Contender> group;
  const GatherSettings ball = gather_settings(static_cast<double>(f.radius_m), 1, 180);
  const GatherSettings sides = gather_settings(static_cast<double>(f.radius_m));
  std::vector<std::unique_ptr<PhotonGather>> gathers;
  for (const bool with_sides : {false, true}) {
    if (with_sides && f.c.name == "volume") continue;  // the truth knows walls
    gathers.push_back(std::make_unique<PhotonGather>(f.device, 1, GatherOptions{}));
    PhotonGather &gather = *gathers.back();
    gather.set_points(f.c.points);
    const GatherSettings &settings = with_sides ? sides : ball;
    gather.within(map, settings);
    const GatherAnswers answers = gather.read();
    Contender ours{blank(f.c, "radius", with_sides ? "radius float, sides and disc told apart" : "radius float",
                         device_words(*f.device)),
                   count, false, [&gather, &map, settings] {
                     gather.within(map, settings);
                     (void)gather.read();
                   }};
    const Accuracy a = accuracy_within(with_sides ? wall_truth : truth, f.checked, answers.irradiance,
                                       [&](std::size_t i) { return answers.gathered[i].count; });
    ours.record.error = a.error;
    ours.record.more["wrong_counts"] = a.wrong_counts;
    double mean = 0;
    for (const Gathered &g : answers.gathered) mean += g.count / count;
    ours.record.more["photons_per_point"] = mean;
    group.push_back(std::move(ours));
  }
  std::vector<float> irradiance(f.c.points.size());
  std::vector<int> counts(f.c.points.size());
  for (std::size_t p = 0; p < f.peers.size(); ++p) {
    Contender peer{blank(f.c, "radius", f.peers[p].variant, "host"), count, true,
                   [&, p] { f.trees[p]->within(f.c.points, f.radius_m, irradiance, counts); }};
    peer.run();
    const Accuracy a = accuracy_within(truth, f.checked, irradiance, [&](std::size_t i) { return counts[i]; });
    peer.record.error = a.error;
    peer.record.more["wrong_counts"] = a.wrong_counts;
    group.push_back(std::move(peer));
  }
  return race_group(group, f.options, f.peers.empty() ? "" : f.peers[0].peer,
                    f.peers.empty() ? "" : f.peers[0].version);
}

double radius_error(const std::vector<float> &truth2, const std::vector<std::size_t> &points,
                    const std::function<double(std::size_t)> &radius_m) {
  double worst = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    worst = std::max(worst, std::abs(radius_m(points[i]) / static_cast<double>(std::sqrt(truth2[i])) - 1));
  return worst;
}

std::vector<Record> race_nearest(Field &f, PhotonMap &map) {
  const auto count = static_cast<double>(f.c.points.size());
  const std::vector<float> truth2 = brute_nearest(f.c, f.checked, wanted, f.options.threads);
  GatherSettings settings = gather_settings(10, 1, 180);
  settings.guess_m = f.radius_m;
  settings.nearest = wanted;
  PhotonGather gather(f.device, 1, GatherOptions{});
  gather.set_points(f.c.points);
  gather.nearest(map, settings);
  const GatherAnswers answers = gather.read();
  std::vector<Contender> group;
  group.push_back(
      {blank(f.c, "150 nearest", "nearest float, with the estimate", device_words(*f.device)), count, false, [&] {
         gather.nearest(map, settings);
         (void)gather.read();
       }});
  group[0].record.error =
      radius_error(truth2, f.checked, [&](std::size_t i) { return static_cast<double>(answers.gathered[i].radius_m); });
  std::vector<float> radius2(f.c.points.size());
  for (std::size_t p = 0; p < f.peers.size(); ++p) {
    if (f.peers[p].variant.find("list") != std::string::npos) continue;  // differs in the radius search only
    Contender peer{blank(f.c, "150 nearest", f.peers[p].variant, "host"), count, true,
                   [&, p] { f.trees[p]->nearest(f.c.points, wanted, radius2); }};
    peer.run();
    peer.record.error =
        radius_error(truth2, f.checked, [&](std::size_t i) { return static_cast<double>(std::sqrt(radius2[i])); });
    group.push_back(std::move(peer));
  }
  SuiteOptions fewer = f.options;
  fewer.repeats = std::min(f.options.repeats, 3);
  return race_group(group, fewer, f.peers.empty() ? "" : f.peers[0].peer, f.peers.empty() ? "" : f.peers[0].version);
}

}  // namespace

std::vector<Record> run_gather_suite(const SuiteOptions &options, const std::vector<NeighbourPeer> &peers) {
  std::vector<Record> all;
  for (const Light light : {Light::even, Light::lit, Light::caustic, Light::volume}) {
    const int scale = light == Light::caustic || light == Light::volume ? 2 : 4;
    const PhotonCase c =
        options.quick ? photon_case(light, 30000, 40, 30) : photon_case(light, 3000000, 100 * scale, 75 * scale);
    Field f{c, options, open_device(options.device), peers, {}, static_cast<float>(c.radius_m), checked_points(c)};
    PhotonMap map(f.device, {c.photons.size(), 1, 0, 0});
    map.upload(c.photons, c.power_W);
    map.build(c.photons.size(), c.room, cell_of_radius(static_cast<double>(f.radius_m)));
    for (const NeighbourPeer &peer : peers) {
      if (options.say) options.say(c.name + ": build " + peer.variant);
      f.trees.push_back(peer.build(c.photons, c.power_W, options.threads));
    }
    if (light != Light::caustic)  // a ball that holds a whole line would only add
      for (Record &r : race_within(f, map)) all.push_back(std::move(r));
    for (Record &r : race_nearest(f, map)) all.push_back(std::move(r));
  }
  return all;
}

}  // namespace greenray::bench
