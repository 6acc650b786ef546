#include "render/caustic_aim.hpp"

#include <algorithm>

namespace greenray {
namespace {

using room_twin::LightProjection;
constexpr int cells = room_twin::PROJECTION_CELLS, words = room_twin::PROJECTION_WORDS;
constexpr int samples = 16;                 // photons that try a cell
constexpr std::uint32_t trying_pass = ~0u;  // no pass of the picture has these random numbers
constexpr double explored = 0.1, least_share = 0.02;

/// Which of the emission's words matter: directions of point lights and spots, the Sun's disk, both of lamps.
LightProjection domain_of(const room_twin::Light &light) {
  LightProjection p{};
  if (light.kind == room_twin::LIGHT_AREA) std::copy_n(std::array{4, 4, 2, 1, 1}.begin(), words, p.bits);
  else if (light.kind == room_twin::LIGHT_SUN) p.bits[2] = p.bits[3] = 6;
  else p.bits[0] = p.bits[1] = 6;
  return p;
}

/// Words that are angles around an axis.
bool goes_round(const room_twin::Light &light, int word) {
  return word == 1 || (word == 3 && light.kind == room_twin::LIGHT_SUN);
}

/// Marks cells beside marked ones, one step along each word.
std::vector<char> with_neighbours(const std::vector<char> &marked, const room_twin::Light &light,
                                  const LightProjection &p) {
  std::vector<char> grown = marked;
  for (int cell = 0; cell < cells; ++cell) {
    if (!marked[static_cast<std::size_t>(cell)]) continue;
    for (int word = 0, shift = 0; word < words; shift += p.bits[word++]) {
      const int size = 1 << p.bits[word], at = cell >> shift & (size - 1);
      for (const int step : {-1, 1}) {
        int to = at + step;
        if (goes_round(light, word)) to &= size - 1;
        if (to >= 0 && to < size) grown[static_cast<std::size_t>(cell + ((to - at) << shift))] = 1;
      }
    }
  }
  return grown;
}

}  // namespace

CausticAim find_caustic_aim(RoomTracer &tracer, const RoomLooks &looks, const PhotonBatch &like) {
  CausticAim aim;
  for (const room_twin::Light &light : looks.lights) aim.lights.lights.push_back(domain_of(light));
  PhotonBatch batch = like;
  batch.pass = trying_pass;
  const std::vector<int> counts = tracer.mark_cells(batch, aim.lights.lights, samples);
  for (std::size_t l = 0; l < looks.lights.size(); ++l) {
    LightProjection &p = aim.lights.lights[l];
    std::vector<char> marked(cells);
    for (std::size_t c = 0; c < marked.size(); ++c) marked[c] = counts[l * marked.size() + c] > 0;
    marked = with_neighbours(marked, looks.lights[l], p);
    p.first = static_cast<int>(aim.lights.cells.size());
    for (int c = 0; c < cells; ++c)
      if (marked[static_cast<std::size_t>(c)]) aim.lights.cells.push_back(c);
    p.marked = static_cast<int>(aim.lights.cells.size()) - p.first;
    const double anywhere = p.marked > 0 ? explored : 1;
    p.explored = static_cast<float>(anywhere);
    for (const char is_marked : marked) {
      const double probability = anywhere + (is_marked ? (1 - anywhere) * cells / p.marked : 0);  // over the even one
      aim.lights.weights.push_back(static_cast<float>(1 / probability));
    }
    aim.share.push_back(std::max(least_share, p.marked / static_cast<double>(cells)));
    aim.marked += static_cast<std::size_t>(p.marked);
  }
  return aim;
}

}  // namespace greenray
