#include "render/lit_photons.hpp"

#include <algorithm>
#include <cmath>

#include "render/photon_mapper.hpp"

namespace greenray {
namespace {
constexpr std::size_t extra = 3;  // beside the irradiance: narrower kernel, variance, number of photons
}

void LitPhotons::file(std::span<const GatherPoint> places, const PassIrradiance &light, const Bounds &bounds,
                      double apart_m) {
  const auto waves = static_cast<std::size_t>(waves_), all = waves + extra;
  std::vector<Photon> records(places.size());
  std::vector<float> values(places.size() * all);
  for (std::size_t i = 0; i < places.size(); ++i) {
    Photon &p = records[i];
    p = {};
    std::copy(std::begin(places[i].place_m), std::end(places[i].place_m), p.place_m);
    p.normal = places[i].normal;
    p.id = static_cast<unsigned>(i);
    p.tags = PHOTON_TAGS(1, PHOTON_INDIRECT);
    float *into = &values[i * all];
    std::copy_n(&light.irradiance[i * waves], waves, into);
    into[waves] = light.narrower[i], into[waves + 1] = light.variance[i];
    into[waves + 2] = static_cast<float>(light.photons[i]);
  }
  apart_m_ = apart_m;
  map_ = std::make_unique<PhotonMap>(device_, PhotonMapOptions{places.size(), static_cast<int>(all), 0, 0});
  map_->upload(records, values);
  map_->build(records.size(), bounds, cell_of_radius(1.5 * apart_m));
}

void LitPhotons::ask(std::span<const GatherPoint> places, double most_radius_m, PassIrradiance &sum) {
  const auto waves = static_cast<std::size_t>(waves_), all = waves + extra;
  if (!gather_)
    gather_ = std::make_unique<PhotonGather>(device_, static_cast<int>(all), GatherOptions{GATHER_FLAT, false, 0, 16});
  gather_->set_points(places);
  GatherSettings settings = gather_settings(most_radius_m);
  settings.nearest = 2;  // the second only sets the radius, which is divided out again
  settings.guess_m = static_cast<float>(std::min(1.5 * apart_m_, most_radius_m));
  gather_->nearest(*map_, settings);
  const GatherAnswers found = gather_->read();
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Gathered &g = found.gathered[i];
    if (g.count == 0) continue;
    const float area = static_cast<float>(M_PI) * g.radius_m * g.radius_m / static_cast<float>(g.count);
    const float *values = &found.irradiance[i * all];
    for (std::size_t w = 0; w < waves; ++w) sum.irradiance[i * waves + w] += area * values[w];
    sum.narrower[i] += area * values[waves], sum.variance[i] += area * values[waves + 1];
    sum.photons[i] += static_cast<int>(std::lround(area * values[waves + 2]));
  }
}

}  // namespace greenray
