#include "render/photon_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "render/photon_mapper.hpp"
#include "twin/photon_twin.hpp"

namespace greenray {
namespace {

using Place = std::array<float, 3>;

float distance2(const Place &a, const float *b) {
  float sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

Place normal_of(unsigned packed) {
  return {photon_twin::unpack_normal(packed, 0), photon_twin::unpack_normal(packed, 1),
          photon_twin::unpack_normal(packed, 2)};
}

bool faces(const Place &a, const Place &b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] > 0.5f; }

/// A photon that is shown, and the end that is nearest to it so far.
struct Dot {
  Place place_m, normal;
  std::size_t photon;
  std::size_t end = 0;
  float distance2_m2 = std::numeric_limits<float>::infinity();
};

/// Dots by cells of a grid, hashed.
class DotGrid {
 public:
  DotGrid(std::vector<Dot> &dots, float cell_m) : dots_(dots), per_cell_(1 / cell_m) {
    for (std::size_t i = 0; i < dots.size(); ++i) cells_[key(cell_of(dots[i].place_m))].push_back(i);
  }

  template <class F>
  void each_within(const float *place_m, float radius_m, const F &f) {
    Place low{}, high{};
    for (std::size_t k = 0; k < 3; ++k) low[k] = place_m[k] - radius_m, high[k] = place_m[k] + radius_m;
    const Cell from = cell_of(low), to = cell_of(high);
    for (std::int64_t x = from[0]; x <= to[0]; ++x)
      for (std::int64_t y = from[1]; y <= to[1]; ++y)
        for (std::int64_t z = from[2]; z <= to[2]; ++z) {
          const auto cell = cells_.find(key({x, y, z}));
          if (cell == cells_.end()) continue;
          for (const std::size_t i : cell->second) f(dots_[i]);
        }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_of(const Place &p) const {
    Cell cell{};
    for (std::size_t k = 0; k < 3; ++k) cell[k] = static_cast<std::int64_t>(std::floor(p[k] * per_cell_));
    return cell;
  }
  static std::uint64_t key(const Cell &c) {  // 21 bits each: no two cells of a scene share one
    std::uint64_t key = 0;
    for (const std::int64_t i : c) key = key << 21 | (static_cast<std::uint64_t>(i) & 0x1fffff);
    return key;
  }

  std::vector<Dot> &dots_;
  float per_cell_;
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells_;
};

/// Distance to the farthest of the four neighbours that lie on the same surface; what lies on another is farther than
/// four times the nearest one.
std::vector<float> reaches(std::span<const GatherPoint> ends, std::size_t columns, std::size_t samples) {
  std::vector<float> reach(ends.size(), 0.0f);
  const std::size_t pixels = samples > 0 ? ends.size() / samples : 0;
  for (std::size_t p = 0; p < pixels; ++p) {
    const bool left = p % columns > 0, right = p % columns + 1 < columns;
    for (std::size_t s = 0; s < samples; ++s) {
      const GatherPoint &end = ends[p * samples + s];
      if (!is_place(end)) continue;
      const Place at{end.place_m[0], end.place_m[1], end.place_m[2]};
      std::vector<float> apart;
      const auto look = [&](bool there, std::size_t pixel) {
        if (!there) return;
        const GatherPoint &other = ends[pixel * samples + s];
        if (is_place(other) && faces(normal_of(end.normal), normal_of(other.normal)))
          apart.push_back(std::sqrt(distance2(at, other.place_m)));
      };
      look(left, p - 1), look(right, p + 1), look(p >= columns, p - columns), look(p + columns < pixels, p + columns);
      if (apart.empty()) continue;
      const float nearest = *std::min_element(apart.begin(), apart.end());
      for (const float d : apart)
        if (d <= 4 * nearest) reach[p * samples + s] = std::max(reach[p * samples + s], d);
    }
  }
  return reach;
}

}  // namespace

PhotonPicture::PhotonPicture(std::span<const GatherPoint> ends, std::size_t columns, std::size_t samples,
                             std::size_t waves)
    : ends_(ends.begin(), ends.end()),
      reach_m_(reaches(ends, columns, samples)),
      samples_(samples),
      waves_(waves),
      counts_(ends.size() / std::max<std::size_t>(samples, 1)),
      power_(counts_.size() * waves) {}

void PhotonPicture::show(const PhotonMap::Contents &photons, std::size_t most) {
  const std::size_t filed = photons.x_m.size();
  if (filed == 0 || most == 0) return;
  const double share = std::min(1.0, static_cast<double>(most) / static_cast<double>(filed));
  const auto limit = static_cast<std::uint64_t>(share * 4294967296.0);
  std::vector<Dot> dots;
  for (std::size_t i = 0; i < filed; ++i)
    if (static_cast<std::uint32_t>(photons.order[i] * 2654435761u) < limit)  // Knuth's multiplicative hash
      dots.push_back({{photons.x_m[i], photons.y_m[i], photons.z_m[i]}, normal_of(photons.normal[i]), i});
  std::vector<float> sorted = reach_m_;
  std::sort(sorted.begin(), sorted.end());
  const auto first = std::upper_bound(sorted.begin(), sorted.end(), 0.0f);
  if (first == sorted.end() || dots.empty()) return;
  DotGrid grid(dots, std::max(first[(sorted.end() - first) / 2], 0.1f * sorted.back()));
  for (std::size_t e = 0; e < ends_.size(); ++e) {
    if (!(reach_m_[e] > 0)) continue;
    const Place normal = normal_of(ends_[e].normal);
    grid.each_within(ends_[e].place_m, reach_m_[e], [&](Dot &dot) {
      const float d2 = distance2(dot.place_m, ends_[e].place_m);
      if (d2 <= reach_m_[e] * reach_m_[e] && d2 < dot.distance2_m2 && faces(normal, dot.normal))
        dot.distance2_m2 = d2, dot.end = e;
    });
  }
  for (const Dot &dot : dots) {
    if (!std::isfinite(dot.distance2_m2)) continue;
    const std::size_t pixel = dot.end / samples_;
    ++shown_, counts_[pixel] += 1;
    for (std::size_t w = 0; w < waves_; ++w) power_[pixel * waves_ + w] += photons.power_W[w * filed + dot.photon];
  }
}

}  // namespace greenray
