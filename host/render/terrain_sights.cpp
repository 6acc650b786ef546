#include "render/terrain_sights.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

// Of blocks farther apart than that every one is traced; in air that varies every distance is a ray of its own.
constexpr double traced_over_distance = 0.03, traced_in_section = 0.1;
constexpr std::size_t most_nodes = 4096, places_at_once = 400000;
constexpr int pixels_between_nodes = 4, light_stations = 48, error_probes = 64;
constexpr double tolerance_pixels = 0.02, narrowest_pixels = 1.0 / 64;

/// Heights of rays where blocks begin: traced at some, between them by cubics through heights and slopes.
class BlockHeights {
 public:
  BlockHeights(const std::vector<double> &block_m, double radius_m, double apart)
      : block_m_(block_m), radius_m_(radius_m) {
    for (std::size_t i = 0; i < block_m.size();) {
      traced_.push_back(i);
      std::size_t next = i + 1;
      while (next + 1 < block_m.size() && block_m[next + 1] < block_m[i] * (1 + apart)) ++next;
      i = next;
    }
    if (traced_.back() + 1 != block_m.size()) traced_.push_back(block_m.size() - 1);
    for (const std::size_t i : traced_) traced_m_.push_back(block_m[i]);
  }
  const std::vector<double> &traced_m() const { return traced_m_; }

  /// place: of one ray at traced_m; into: [blocks + 1], `stride` apart
  void fill(const SightPlace *place, float *into, std::size_t stride) const {
    for (std::size_t k = 0; k + 1 < traced_.size(); ++k) {
      const SightPlace &a = place[k], &b = place[k + 1];
      const double length = traced_m_[k + 1] - traced_m_[k];
      const double rise_a = slope(a) * length, rise_b = slope(b) * length, rise = b.height_m - a.height_m;
      const bool smooth = a.outcome == b.outcome;
      for (std::size_t i = traced_[k]; i < traced_[k + 1]; ++i) {
        const double t = (block_m_[i] - traced_m_[k]) / length;
        const double bulge = smooth ? t * (1 - t) * ((1 - t) * (rise_a - rise) - t * (rise_b - rise)) : 0;
        into[i * stride] = static_cast<float>(a.height_m + t * rise + bulge);
      }
    }
    into[traced_.back() * stride] = static_cast<float>(place[traced_.size() - 1].height_m);
  }

 private:
  double slope(const SightPlace &at) const {
    return at.outcome == f64::RAY_IN_FLIGHT ? at.slope * (1 + at.height_m / radius_m_) : at.slope;
  }
  const std::vector<double> &block_m_;
  double radius_m_;
  std::vector<std::size_t> traced_;
  std::vector<double> traced_m_;
};

/// Calls use(i, places of elevation i: [wavelengths][distances]).
template <class Use>
void each_ray(SightPlaces &rays, const std::vector<double> &elevations, const std::vector<double> &distances_m,
              std::size_t wavelengths, const Use &use) {
  const std::size_t each = wavelengths * distances_m.size();
  const std::size_t at_once = std::max<std::size_t>(1, places_at_once / each);
  for (std::size_t first = 0; first < elevations.size(); first += at_once) {
    stop_if_asked();
    const std::size_t count = std::min(at_once, elevations.size() - first);
    const std::vector<SightPlace> places = rays.at(std::span(elevations).subspan(first, count), distances_m);
    for (std::size_t i = 0; i < count; ++i) use(first + i, &places[i * each]);
  }
}

/// Places nodes by halving.
class NodePlacer {
 public:
  NodePlacer(SightPlaces &rays, std::size_t wavelengths, const std::vector<double> &distances_m, double highest_m,
             double tolerance_rad, double narrowest_rad)
      : rays_(rays),
        wavelengths_(wavelengths),
        distances_m_(distances_m),
        highest_m_(highest_m),
        tolerance_(tolerance_rad),
        narrowest_(narrowest_rad) {}

  std::vector<double> place(const std::vector<double> &first) {
    std::vector<Node> nodes = traced(first);
    for (Node &node : nodes) node.open = true;
    for (bool more = true; more && nodes.size() < most_nodes;) more = refine(nodes);
    std::vector<double> elevations;
    for (const Node &node : nodes) elevations.push_back(node.elevation);
    return elevations;
  }

 private:
  struct Node {
    double elevation = 0;
    bool open = false;  // not known yet whether heights are linear to the next one
    std::vector<float> height;
  };

  std::vector<Node> traced(const std::vector<double> &elevations) {
    std::vector<Node> nodes(elevations.size());
    each_ray(rays_, elevations, distances_m_, wavelengths_, [&](std::size_t i, const SightPlace *place) {
      nodes[i].elevation = elevations[i];
      for (std::size_t k = 0; k < wavelengths_ * distances_m_.size(); ++k)
        nodes[i].height.push_back(static_cast<float>(place[k].height_m));
    });
    return nodes;
  }

  bool refine(std::vector<Node> &nodes) {
    std::vector<double> middles;
    std::vector<std::size_t> below;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i)
      if (nodes[i].open && nodes[i + 1].elevation - nodes[i].elevation > narrowest_)
        middles.push_back(0.5 * (nodes[i].elevation + nodes[i + 1].elevation)), below.push_back(i);
    for (Node &node : nodes) node.open = false;
    std::vector<Node> found = traced(middles), kept;
    std::size_t k = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      const bool looked = k < below.size() && below[k] == i;
      const bool bent = looked && !linear(nodes[i], found[k], nodes[i + 1]);
      kept.push_back(std::move(nodes[i]));
      if (bent) {
        kept.back().open = found[k].open = true;
        kept.push_back(std::move(found[k]));
      }
      k += looked;
    }
    const bool more = kept.size() > nodes.size();
    nodes = std::move(kept);
    return more;
  }

  /// Only where the ray is low enough to meet terrain, and not below the sea.
  bool linear(const Node &a, const Node &middle, const Node &b) const {
    for (std::size_t k = 0; k < a.height.size(); ++k) {
      const double low = static_cast<double>(a.height[k]), high = static_cast<double>(b.height[k]);
      const double there = static_cast<double>(middle.height[k]), distance_m = distances_m_[k % distances_m_.size()];
      if (std::min({low, high, there}) > highest_m_ || std::max({low, high, there}) < -1 || distance_m <= 0) continue;
      const double magnified = std::max(distance_m, std::abs(high - low) / (b.elevation - a.elevation));
      if (std::abs(there - 0.5 * (low + high)) > tolerance_ * magnified) return false;
    }
    return true;
  }

  SightPlaces &rays_;
  std::size_t wavelengths_;
  const std::vector<double> &distances_m_;
  double highest_m_, tolerance_, narrowest_;
};

class TerrainTracer {
 public:
  TerrainTracer(const RaysOfSight &from, const std::vector<double> &bent_nm, std::size_t padded,
                const PolarTerrain &terrain, const TransferCurve &curve, const TransferTable &transfer,
                double pixel_rad)
      : from_(from),
        nm_(bent_nm),
        terrain_(terrain),
        curve_(curve),
        transfer_(transfer),
        pixel_(pixel_rad),
        heights_(terrain.block_m, from.air.spec().earth_radius_m,
                 from.section ? traced_in_section : traced_over_distance) {
    out_.waves = bent_nm.size() > 1 ? padded : 1;
  }

  TerrainSights trace() {
    place_nodes();
    SightPlaces rays(from_.air, nm_, from_.options, from_.section, from_.device);
    trace_rays(rays);
    trace_light(rays);
    measure(rays);
    make_masks();
    return std::move(out_);
  }

 private:
  std::size_t blocks() const { return terrain_.block_m.size() - 1; }

  void place_nodes() {
    std::vector<double> three = nm_;
    if (from_.section) three = {nm_[nm_.size() / 2]};
    else if (three.size() > 3) three = {nm_.front(), nm_[nm_.size() / 2], nm_.back()};
    SightPlaces rays(from_.air, three, from_.options, from_.section, from_.device);
    const double low = transfer_.elevation_rad(0), high = transfer_.elevation_rad(transfer_.entries - 1);
    std::vector<double> first{low, high};
    for (const double e : curve_.elevation_rad)
      if (e > low && e < high) first.push_back(e);
    const int even = static_cast<int>((high - low) / (pixels_between_nodes * pixel_)) + 1;
    for (int i = 1; i < even; ++i) first.push_back(low + (high - low) * i / even);
    std::sort(first.begin(), first.end());
    first.erase(std::unique(first.begin(), first.end()), first.end());
    out_.elevation_rad = NodePlacer(rays, three.size(), heights_.traced_m(), terrain_.highest_m,
                                    tolerance_pixels * pixel_, narrowest_pixels * pixel_)
                             .place(first);
    for (const double e : out_.elevation_rad)
      out_.node_entry.push_back(static_cast<float>((e - low) / transfer_.spacing_rad));
    int node = 0;
    for (std::size_t entry = 0; entry < transfer_.entries; ++entry) {
      while (node + 2 < static_cast<int>(out_.node_entry.size()) &&
             out_.node_entry[static_cast<std::size_t>(node) + 1] <= static_cast<float>(entry))
        ++node;
      out_.first_node.push_back(node);
    }
  }

  void trace_rays(SightPlaces &rays) {
    const std::size_t nodes = out_.elevation_rad.size(), each = (blocks() + 1) * out_.waves;
    const std::size_t last = heights_.traced_m().size() - 1;
    out_.rays.assign(nodes * each, 0.0f);
    out_.grounded.assign(nodes * out_.waves, 0.0f);
    each_ray(rays, out_.elevation_rad, heights_.traced_m(), nm_.size(), [&](std::size_t node, const SightPlace *place) {
      for (std::size_t w = 0; w < out_.waves; ++w) {  // what is added to whole lanes is as the last one
        const SightPlace *of_wave = place + std::min(w, nm_.size() - 1) * (last + 1);
        heights_.fill(of_wave, &out_.rays[node * each + w], out_.waves);
        out_.grounded[node * out_.waves + w] = of_wave[last].outcome == f64::RAY_GROUND ? 1.0f : 0.0f;
      }
    });
  }

  void trace_light(SightPlaces &rays) {
    out_.blocks_per_light = static_cast<int>((blocks() + light_stations - 1) / light_stations);
    std::vector<double> stations;
    for (std::size_t b = 0; b < blocks(); b += static_cast<std::size_t>(out_.blocks_per_light))
      stations.push_back(terrain_.block_m[b]);
    stations.push_back(terrain_.block_m.back());
    out_.light = trace_stations(rays, out_.elevation_rad, stations);
  }

  float ray(std::size_t node, std::size_t block, std::size_t wave) const {
    return out_.rays[(node * (blocks() + 1) + block) * out_.waves + wave];
  }

  /// Half way between nodes and between blocks, at the middle wavelength; not across jumps.
  void measure(SightPlaces &rays) {
    std::vector<double> middles, distances;
    std::vector<std::size_t> nodes, some;
    const std::size_t intervals = out_.elevation_rad.size() - 1,
                      step = std::max<std::size_t>(1, intervals / error_probes);
    for (std::size_t i = 0; i < intervals; i += step)
      nodes.push_back(i), middles.push_back(0.5 * (out_.elevation_rad[i] + out_.elevation_rad[i + 1]));
    for (std::size_t b = 1; b < blocks(); b += std::max<std::size_t>(1, blocks() / 64))
      some.push_back(b), distances.push_back(0.5 * (terrain_.block_m[b] + terrain_.block_m[b + 1]));
    const std::size_t wave = nm_.size() / 2;
    double worst = 0;
    each_ray(rays, middles, distances, nm_.size(), [&](std::size_t i, const SightPlace *place) {
      for (std::size_t k = 0; k < some.size(); ++k) {
        const SightPlace &truth = place[wave * some.size() + k];
        const std::size_t n = nodes[i], b = some[k];
        const float a = ray(n, b, wave), c = ray(n + 1, b, wave), d = ray(n, b + 1, wave), e = ray(n + 1, b + 1, wave);
        if (truth.outcome != f64::RAY_IN_FLIGHT || std::min({a, c, d, e}) > static_cast<float>(terrain_.highest_m))
          continue;
        const double width = out_.elevation_rad[n + 1] - out_.elevation_rad[n];
        if (width <= narrowest_pixels * pixel_) continue;  // a jump, closed in on
        const double magnified = std::max(distances[k], 0.5 * static_cast<double>(std::abs(c + e - a - d)) / width);
        worst = std::max(worst, std::abs(0.25 * static_cast<double>(a + c + d + e) - truth.height_m) / magnified);
      }
    });
    out_.error_arcsec = to_arcsec(worst);
  }

  /// Lowest height of a block over both nodes and all wavelengths.
  std::vector<float> lowest_rays() const {
    const std::size_t intervals = out_.elevation_rad.size() - 1;
    std::vector<float> lowest(intervals * blocks());
    const auto least = [&](std::size_t node, std::size_t block) {
      float low = ray(node, block, 0);
      for (std::size_t w = 1; w < out_.waves; ++w) low = std::min(low, ray(node, block, w));
      return low;
    };
    std::vector<float> below(blocks() + 1), above(blocks() + 1);
    for (std::size_t b = 0; b <= blocks(); ++b) below[b] = least(0, b);
    for (std::size_t i = 0; i < intervals; ++i) {
      for (std::size_t b = 0; b <= blocks(); ++b) above[b] = least(i + 1, b);
      for (std::size_t b = 0; b < blocks(); ++b)
        lowest[i * blocks() + b] = std::min({below[b], below[b + 1], above[b], above[b + 1]});
      below.swap(above);
    }
    return lowest;
  }

  void make_masks() {
    const std::size_t intervals = out_.elevation_rad.size() - 1, words = (blocks() + 31) / 32;
    const auto columns = static_cast<std::size_t>(terrain_.columns) - 1;
    const std::vector<float> lowest = lowest_rays();
    out_.words = static_cast<int>(words);
    out_.masks.assign(columns * intervals * words, 0u);
    for_pieces(columns, 8, host_threads(), [&](std::size_t first, std::size_t last) {
      std::vector<float> top(blocks());
      for (std::size_t c = first; c < last; ++c) {
        const float *left = &terrain_.tops[c * blocks()], *right = left + blocks();
        for (std::size_t b = 0; b < blocks(); ++b) top[b] = std::max({left[b], right[b], 0.0f});
        for (std::size_t i = 0; i < intervals; ++i) {
          unsigned int *mask = &out_.masks[(c * intervals + i) * words];
          for (std::size_t b = 0; b < blocks(); ++b)
            mask[b / 32] |= static_cast<unsigned int>(lowest[i * blocks() + b] <= top[b]) << (31 - b % 32);
        }
      }
    });
  }

  const RaysOfSight &from_;
  const std::vector<double> &nm_;
  const PolarTerrain &terrain_;
  const TransferCurve &curve_;
  const TransferTable &transfer_;
  double pixel_;
  BlockHeights heights_;
  TerrainSights out_;
};

}  // namespace

TerrainSights trace_terrain(const RaysOfSight &from, const std::vector<double> &bent_nm, std::size_t padded,
                            const PolarTerrain &terrain, const TransferCurve &curve, const TransferTable &transfer,
                            double pixel_rad) {
  return TerrainTracer(from, bent_nm, padded, terrain, curve, transfer, pixel_rad).trace();
}

}  // namespace greenray
