#include "render/sea.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "support/angle.hpp"

namespace greenray {

double SeaState::crests_per_m() const { return height_m > 0 ? slope / (2 * pi * height_m) : 0; }

SeaState sea_state(const SeaScene &sea) {
  constexpr double gravity_m_s2 = 9.81, wind_at_19_5_m = 1.026;  // over that at 10 m: a logarithmic profile over water
  const double u = wind_at_19_5_m * sea.wind_m_s;
  const double significant_m = sea.significant_height_m.value_or(0.21 * u * u / gravity_m_s2);
  return {significant_m / 4, std::sqrt(0.5 * (0.003 + 0.00512 * sea.wind_m_s))};
}

namespace {

constexpr double reach = 6;  // standard deviations: no crest is so high
constexpr std::size_t rays_at_once = 128;

class SeaTracer {
 public:
  SeaTracer(SightPlaces &rays, const TransferTable &transfer, const std::vector<double> &station_m, const SeaState &sea,
            double eye_m, double earth_radius_m, bool coarse)
      : rays_(rays), transfer_(transfer), station_m_(station_m), sea_(sea) {
    out_.stations = station_m.size();
    out_.wavelengths = transfer.wavelengths;
    out_.crests.assign(transfer.entries * out_.wavelengths * (out_.stations + 1), 0.0f);
    out_.horizon_m = std::sqrt(2 * earth_radius_m * std::max(eye_m, 0.1));
    const double crest_m = std::sqrt(2 * earth_radius_m * reach * sea.height_m);
    double farthest_m = std::clamp(3 * out_.horizon_m + crest_m, 5e3, 3e5);
    if (!station_m.empty()) farthest_m = std::max(farthest_m, std::min(station_m.back(), 3e5));
    const int steps = coarse ? 64 : 256;
    for (int i = 1; i <= steps; ++i) stop_m_.push_back(farthest_m * std::pow(i / static_cast<double>(steps), 1.5));
  }

  SeaSights trace() {
    std::vector<std::size_t> some;
    for (std::size_t e = 0; e < transfer_.entries; ++e) {
      if (waves_matter(e)) some.push_back(e);
      if (some.size() == rays_at_once || (e + 1 == transfer_.entries && !some.empty())) {
        add(some);
        some.clear();
      }
    }
    find_sea();
    return std::move(out_);
  }

 private:
  /// Rays that come near the surface; of those that meet it only such as pass a target before.
  bool waves_matter(std::size_t entry) const {
    const Transfer &ray = transfer_.at(entry, transfer_.wavelengths / 2);
    if (ray.outcome != f64::RAY_GROUND) return ray.min_height_m < reach * sea_.height_m;
    return !station_m_.empty() && ray.distance_m > 0.9 * station_m_.front();
  }

  struct Crests {
    std::vector<double> before;  // each station, and in all
    std::size_t middle = 0;      // stop before which half of them stand
  };

  Crests along(const SightPlace *place) const {
    Crests crests{std::vector<double>(out_.stations + 1), 0};
    const double rate = sea_.crests_per_m(), two_s2 = 2 * sea_.height_m * sea_.height_m;
    std::vector<double> sum{0};
    double last = 0, last_m = 0;
    for (std::size_t i = 0; i < stop_m_.size() && place[i].outcome == f64::RAY_IN_FLIGHT; ++i) {
      const double density = rate * std::exp(-place[i].height_m * place[i].height_m / two_s2);
      sum.push_back(sum.back() + 0.5 * (last + density) * (stop_m_[i] - last_m));
      last = density, last_m = stop_m_[i];
    }
    crests.before.back() = sum.back();
    for (std::size_t s = 0; s < out_.stations; ++s) crests.before[s] = sum_at(sum, station_m_[s]);
    while (crests.middle + 2 < sum.size() && sum[crests.middle + 1] < 0.5 * sum.back()) ++crests.middle;
    return crests;
  }

  double sum_at(const std::vector<double> &sum, double distance_m) const {
    const auto next = std::lower_bound(stop_m_.begin(), stop_m_.end(), distance_m) - stop_m_.begin();
    const auto i = static_cast<std::size_t>(next);
    if (i + 1 >= sum.size()) return sum.back();
    const double from_m = i > 0 ? stop_m_[i - 1] : 0;
    return sum[i] + (sum[i + 1] - sum[i]) * (distance_m - from_m) / (stop_m_[i] - from_m);
  }

  void add(const std::vector<std::size_t> &entries) {
    std::vector<double> elevations;
    for (const std::size_t e : entries) elevations.push_back(transfer_.elevation_rad(e));
    const std::vector<SightPlace> places = rays_.at(elevations, stop_m_);
    const std::size_t waves = places.size() / (entries.size() * stop_m_.size());
    for (std::size_t i = 0; i < entries.size(); ++i) {
      std::vector<Crests> crests;
      for (std::size_t w = 0; w < waves; ++w) crests.push_back(along(&places[(i * waves + w) * stop_m_.size()]));
      const std::size_t e = entries[i], middle = waves / 2;
      const double number = crests[middle].before.back();  // the horizon: as likely hidden as not
      if (number > 0 && std::abs(number - 0.7) < nearest_) {
        nearest_ = std::abs(number - 0.7);
        out_.horizon_m = stop_m_[crests[middle].middle];
      }
      for (std::size_t w = 0; w < out_.wavelengths; ++w)
        for (std::size_t s = 0; s <= out_.stations; ++s)
          out_.crests[(e * out_.wavelengths + w) * (out_.stations + 1) + s] = static_cast<float>(between(crests, w, s));
    }
  }

  /// Of three wavelengths by a parabola through the logarithms, at 0, 1/2 and 1.
  double between(const std::vector<Crests> &crests, std::size_t wave, std::size_t station) const {
    if (crests.size() == 1) return crests.front().before[station];
    const double x = out_.wavelengths > 1 ? static_cast<double>(wave) / static_cast<double>(out_.wavelengths - 1) : 0.5;
    double log[3];
    for (std::size_t k = 0; k < 3; ++k) log[k] = std::log(std::max(crests[k].before[station], 1e-30));
    return std::exp((1 - x) * (1 - 2 * x) * log[0] + 4 * x * (1 - x) * log[1] + x * (2 * x - 1) * log[2]);
  }

  void find_sea() {
    const auto all_ground = [&](std::size_t e) {
      for (std::size_t w = 0; w < transfer_.wavelengths; ++w)
        if (transfer_.at(e, w).outcome != f64::RAY_GROUND) return false;
      return true;
    };
    while (out_.sea_entry + 1 < transfer_.entries && all_ground(out_.sea_entry + 1)) ++out_.sea_entry;
  }

  SightPlaces &rays_;
  const TransferTable &transfer_;
  const std::vector<double> &station_m_;
  SeaState sea_;
  std::vector<double> stop_m_;
  SeaSights out_;
  double nearest_ = 1e9;
};

/// Uniform in 0..1 of the next 53 bits: the same on every machine, as std::uniform_real_distribution is not.
double uniform(std::mt19937_64 &random) { return (static_cast<double>(random() >> 11) + 0.5) * 0x1p-53; }

}  // namespace

SeaSights trace_sea(SightPlaces &rays, const TransferTable &transfer, const std::vector<double> &station_m,
                    const SeaState &sea, double eye_m, double earth_radius_m, bool coarse) {
  return SeaTracer(rays, transfer, station_m, sea, eye_m, earth_radius_m, coarse).trace();
}

std::vector<float> crest_thresholds(double first_rad, double step_rad, std::size_t count, double width_rad,
                                    std::uint64_t seed) {
  constexpr int cosines = 64;
  std::mt19937_64 random(seed);
  struct Wave {
    double number, phase;
  };
  std::vector<Wave> waves;
  for (int k = 0; k < cosines; ++k) {
    // A normal wave number by the inverse of the cumulative distribution is not needed: a sum of four uniforms will do.
    double sum = -2;
    for (int i = 0; i < 4; ++i) sum += uniform(random);
    waves.push_back({std::sqrt(3.0) * sum * 2 / width_rad, 2 * pi * uniform(random)});
  }
  std::vector<float> thresholds;
  for (std::size_t i = 0; i < count; ++i) {
    double value = 0;
    for (const Wave &wave : waves)
      value += std::cos(wave.number * (first_rad + step_rad * static_cast<double>(i)) + wave.phase);
    value *= std::sqrt(2.0 / cosines);
    const double rank = 0.5 * std::erfc(-value / std::sqrt(2.0));  // uniform in 0..1
    thresholds.push_back(static_cast<float>(-std::log(std::max(rank, 1e-12))));
  }
  return thresholds;
}

}  // namespace greenray
