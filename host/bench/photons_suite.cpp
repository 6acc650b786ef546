// Suite photons: filing photons by place, against sorting the same keys and against building a tree.
#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <thread>

#include "bench/device_methods.hpp"
#include "bench/photon_case.hpp"
#include "bench/photon_suites.hpp"
#include "bench/race.hpp"

namespace greenray::bench {
namespace {

using Keyed = std::uint64_t;  // cell, then number of the record: what std::sort needs to be stable

/// The keys a sort would be given; computing them is not timed for the peer.
std::vector<Keyed> keys_of(const PhotonCase &c, const PhotonGrid &g) {
  std::vector<Keyed> keys(c.photons.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    std::uint64_t cell[3];
    for (int k = 0; k < 3; ++k) {
      const int along = static_cast<int>(std::floor((c.photons[i].place_m[k] - g.origin_m[k]) * g.per_m));
      const bool wraps = g.wrap && k > 0;
      cell[k] = static_cast<std::uint64_t>(wraps ? along % g.cells[k] : std::clamp(along, 0, g.cells[k] - 1));
    }
    const std::uint64_t key =
        (cell[2] * static_cast<std::uint64_t>(g.cells[1]) + cell[1]) * static_cast<std::uint64_t>(g.cells[0]) + cell[0];
    keys[i] = key << 32 | i;
  }
  return keys;
}

/// As many pieces as threads, sorted side by side, then merged in pairs.
void sort_on_threads(std::vector<Keyed> &keys, unsigned threads) {
  std::vector<std::size_t> edges;
  for (unsigned i = 0; i <= threads; ++i) edges.push_back(keys.size() * i / threads);
  const auto at = [&](std::size_t i) { return keys.begin() + static_cast<std::ptrdiff_t>(edges[i]); };
  on_threads(threads, 1, threads, [&](std::size_t i, std::size_t) { std::sort(at(i), at(i + 1)); });
  for (std::size_t width = 1; width < threads; width *= 2)
    for (std::size_t i = 0; i + width < threads; i += 2 * width)
      std::inplace_merge(at(i), at(i + width), at(std::min<std::size_t>(i + 2 * width, threads)));
}

/// Photons that do not stand where std::sort puts them; within a dense cell, which the map sorts further, any place is
/// right.
std::size_t misplaced(const PhotonMap &map, const std::vector<Keyed> &keys, const std::vector<Keyed> &sorted) {
  constexpr std::size_t dense = 1025;
  const PhotonMap::Contents c = map.read();
  if (c.order.size() != sorted.size()) return sorted.size();
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const Keyed cell = sorted[i] >> 32;
    const auto at = static_cast<std::size_t>(cell);
    if (static_cast<std::size_t>(c.cell_start[at + 1] - c.cell_start[at]) >= dense)
      wrong += keys[c.order[i]] >> 32 != cell;
    else wrong += c.order[i] != static_cast<unsigned>(sorted[i] & 0xffffffffu);
  }
  return wrong;
}

Record blank(const PhotonCase &c, const std::string &variant, const std::string &device) {
  Record r;
  r.suite = "photons";
  r.case_name = c.name;
  r.variant = variant;
  r.device = device;
  r.rate_unit = "photon/s";
  r.error_unit = "misplaced photons";
  r.more = {{"photons", static_cast<double>(c.photons.size())}};
  return r;
}

void run_case(const PhotonCase &c, const SuiteOptions &options, const std::vector<NeighbourPeer> &peers,
              const std::shared_ptr<Device> &device, std::vector<Record> &all) {
  const double radius_m = c.radius_m;
  const auto count = static_cast<double>(c.photons.size());
  PhotonMap map(device, {c.photons.size(), 1, 0, 0});
  map.upload(c.photons, c.power_W);
  map.build(c.photons.size(), c.room, cell_of_radius(radius_m));
  const std::vector<Keyed> keys = keys_of(c, map.grid());
  std::vector<Keyed> sorted = keys;
  std::sort(sorted.begin(), sorted.end());

  const auto ours = [&] {
    Contender o{blank(c, "map float", device_words(*device)), count, false,
                [&] { map.build(c.photons.size(), c.room, cell_of_radius(radius_m)); }};
    o.record.error = static_cast<double>(misplaced(map, keys, sorted));
    return o;
  };
  std::vector<Keyed> work(keys.size());
  std::vector<Contender> sorts{ours()};
  for (unsigned threads = 1; threads <= options.threads; threads *= 2) {
    const std::string words = "std::sort " + std::to_string(threads) + (threads > 1 ? " threads" : " thread");
    sorts.push_back({blank(c, words, "host"), count, true, [&work, &keys, threads] {
                       std::copy(keys.begin(), keys.end(), work.begin());  // 24 MB: a hundredth of the sort
                       sort_on_threads(work, threads);
                     }});
  }
  for (Record &r : race_group(sorts, options, "std::sort", __VERSION__)) all.push_back(std::move(r));
  if (peers.empty()) return;

  std::vector<Contender> trees{ours()};
  trees[0].record.variant += " (beside trees)";
  for (const NeighbourPeer &peer : peers) {
    if (peer.variant.find("list") != std::string::npos) continue;  // the same tree
    trees.push_back({blank(c, peer.variant, "host, 1 thread: it has no other way"), count, true,
                     [&c, &peer] { (void)peer.build(c.photons, c.power_W, 1); }});
  }
  SuiteOptions fewer = options;
  fewer.repeats = std::min(options.repeats, 3);
  for (Record &r : race_group(trees, fewer, peers[0].peer, peers[0].version)) all.push_back(std::move(r));
}

}  // namespace

std::vector<Record> run_photons_suite(const SuiteOptions &options, const std::vector<NeighbourPeer> &peers) {
  const std::shared_ptr<Device> device = open_device(options.device);
  std::vector<Record> records;
  const std::size_t most = options.quick ? 30000 : 3000000;
  for (const Light light : {Light::even, Light::lit, Light::caustic, Light::volume}) {
    PhotonCase c = photon_case(light, most, 8, 8);
    c.name += options.quick ? "" : " 3 M";
    run_case(c, options, light == Light::even || light == Light::lit ? peers : std::vector<NeighbourPeer>{}, device,
             records);
  }
  if (options.quick) return records;
  for (const std::size_t photons : {most / 16, 4 * most}) {  // what a photon costs when there are fewer or more
    PhotonCase c = photon_case(Light::even, photons, 8, 8);
    c.name += photons < most ? " 0.19 M" : " 12 M";
    run_case(c, options, {}, device, records);
  }
  return records;
}

}  // namespace greenray::bench
