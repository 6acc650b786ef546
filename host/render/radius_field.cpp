#include "render/radius_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "twin/photon_twin.hpp"

namespace greenray {
namespace {

struct Facing {
  explicit Facing(const GatherPoint &p)
      : x(photon_twin::unpack_normal(p.normal, 0)),
        y(photon_twin::unpack_normal(p.normal, 1)),
        z(photon_twin::unpack_normal(p.normal, 2)) {}
  float x, y, z;
};

/// A place as its neighbours see it.
struct Neighbour {
  const GatherPoint &place;
  const Facing &facing;
  float radius_m;
};

/// The radius of a, no larger than that of b allows.
float limited_radius_m(const Neighbour &a, const Neighbour &b, float slope) {
  if (!(b.radius_m < a.radius_m)) return a.radius_m;
  if (!(a.facing.x * b.facing.x + a.facing.y * b.facing.y + a.facing.z * b.facing.z > 0.5f)) return a.radius_m;
  float square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float d = a.place.place_m[k] - b.place.place_m[k];
    square += d * d;
  }
  return std::min(a.radius_m, b.radius_m + slope * std::sqrt(square));
}

class Field {
 public:
  Field(std::span<const GatherPoint> places, double slope, std::span<float> radius_m)
      : places_(places), slope_(static_cast<float>(slope)), radius_m_(radius_m) {
    facing_.reserve(places.size());
    for (const GatherPoint &p : places) facing_.emplace_back(p);
  }

  void lower(std::size_t i, std::size_t neighbour) { radius_m_[i] = limited_radius_m(at(i), at(neighbour), slope_); }

 private:
  Neighbour at(std::size_t i) const { return {places_[i], facing_[i], radius_m_[i]}; }

  std::span<const GatherPoint> places_;
  float slope_;
  std::span<float> radius_m_;
  std::vector<Facing> facing_;
};

}  // namespace

void limit_radius_slope(std::span<const GatherPoint> places, std::size_t columns, std::size_t samples, double slope,
                        std::span<float> radius_m) {
  if (columns == 0 || samples == 0) return;
  Field field(places, slope, radius_m);
  const std::size_t pixels = places.size() / samples;
  const auto lower = [&](std::size_t pixel, std::size_t neighbour) {
    for (std::size_t i = pixel * samples; i < (pixel + 1) * samples; ++i)
      for (std::size_t j = neighbour * samples; j < (neighbour + 1) * samples; ++j) field.lower(i, j);
  };
  for (std::size_t p = 0; p < pixels; ++p) {
    const std::size_t column = p % columns;
    lower(p, p);
    if (column > 0) lower(p, p - 1);
    if (p < columns) continue;
    lower(p, p - columns);
    if (column > 0) lower(p, p - columns - 1);
    if (column + 1 < columns) lower(p, p - columns + 1);
  }
  for (std::size_t p = pixels; p-- > 0;) {
    const std::size_t column = p % columns;
    if (column + 1 < columns && p + 1 < pixels) lower(p, p + 1);
    if (p + columns >= pixels) continue;
    lower(p, p + columns);
    if (column > 0) lower(p, p + columns - 1);
    if (column + 1 < columns && p + columns + 1 < pixels) lower(p, p + columns + 1);
  }
}

void limit_radii_beside(std::span<const GatherPoint> places, std::span<float> radius_m,
                        std::span<const GatherPoint> others, std::span<const float> other_radius_m,
                        std::span<const std::size_t> around, double slope) {
  const std::size_t each = places.empty() ? 0 : around.size() / places.size();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Facing facing(places[i]);
    for (std::size_t k = i * each; k < (i + 1) * each; ++k) {
      const std::size_t j = around[k];
      if (j >= others.size()) continue;
      radius_m[i] = limited_radius_m({places[i], facing, radius_m[i]},
                                     {others[j], Facing(others[j]), other_radius_m[j]}, static_cast<float>(slope));
    }
  }
}

}  // namespace greenray
