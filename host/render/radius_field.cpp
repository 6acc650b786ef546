#include "render/radius_field.hpp"

#include <array>
#include <cmath>
#include <vector>

#include "twin/photon_twin.hpp"

namespace greenray {
namespace {

struct Facing {
  float x, y, z;
};

class Field {
 public:
  Field(std::span<const GatherPoint> places, double slope, std::span<float> radius_m)
      : places_(places), slope_(static_cast<float>(slope)), radius_m_(radius_m) {
    facing_.reserve(places.size());
    for (const GatherPoint &p : places)
      facing_.push_back({photon_twin::unpack_normal(p.normal, 0), photon_twin::unpack_normal(p.normal, 1),
                         photon_twin::unpack_normal(p.normal, 2)});
  }

  void lower(std::size_t i, std::size_t neighbour) {
    const float theirs = radius_m_[neighbour];
    if (!(theirs < radius_m_[i])) return;
    const Facing &a = facing_[i], &b = facing_[neighbour];
    if (!(a.x * b.x + a.y * b.y + a.z * b.z > 0.5f)) return;
    float square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const float d = places_[i].place_m[k] - places_[neighbour].place_m[k];
      square += d * d;
    }
    const float limit = theirs + slope_ * std::sqrt(square);
    if (limit < radius_m_[i]) radius_m_[i] = limit;
  }

 private:
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

}  // namespace greenray
