#include "render/photon_mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "render/pixel_statistics.hpp"
#include "render/radius_field.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

double now() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

/// Of numbers above 0.
double median(std::vector<float> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

struct PhotonMapper::State {
  /// One map and the radii of pass 0.
  struct Side {
    Side(const std::shared_ptr<Device> &d, const PhotonMapperOptions &o, std::size_t photons, int k)
        : map(d, {photons, o.waves, o.local_size}), nearest(k) {}
    PhotonMap map;
    int nearest;
    std::vector<float> radius_m;
  };

  State(std::shared_ptr<Device> d, const PhotonMapperOptions &o)
      : device(std::move(d)),
        options(o),
        gather(device, o.waves, {o.kernel, true, o.local_size}),
        diffuse(device, o, o.diffuse_photons, o.nearest) {
    if (!(o.most_radius_m > 0) || o.nearest < 0 || o.caustic_nearest < 0 || !(o.alpha > 0 && o.alpha <= 1))
      throw RunError("photon mapping needs a radius above 0 and an alpha above 0, up to 1");
    if (o.caustic_photons > 0) caustic = std::make_unique<Side>(device, o, o.caustic_photons, o.caustic_nearest);
  }

  GatherSettings settings() const {
    return gather_settings(options.most_radius_m, options.flatness, options.facing_deg);
  }

  /// Where the search of pass 0 begins: as many photons as asked for, were they spread over the box's faces.
  double first_radius_m(const Side &side, std::size_t records) const {
    double area_m2 = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
      area_m2 += 2 * (options.bounds.high_m[a] - options.bounds.low_m[a]) *
                 (options.bounds.high_m[b] - options.bounds.low_m[b]);
    }
    const double each = area_m2 / static_cast<double>(std::max<std::size_t>(records, 1));
    const double radius_m = std::sqrt(each * std::max(side.nearest, 1) / 3.14159);
    return radius_m > 0 ? std::min(radius_m, options.most_radius_m) : options.most_radius_m;
  }

  struct Estimates {
    GatherAnswers answers;
    std::vector<float> radius_m;
  };

  /// Finds radii for good, and what lies within them.
  Estimates first_estimates(Side &side, double guess_m, std::span<const GatherPoint> places) {
    GatherSettings s = settings();
    if (side.nearest == 0) {
      gather.within(side.map, s);
      side.radius_m.assign(places.size(), s.radius_m);
      return {gather.read(), side.radius_m};
    }
    s.nearest = side.nearest, s.guess_m = static_cast<float>(guess_m);
    gather.nearest(side.map, s);
    Estimates found{gather.read(), {}};
    for (const Gathered &g : found.answers.gathered) found.radius_m.push_back(g.radius_m);
    limit_radius_slope(places, options.columns, options.samples, options.radius_slope, found.radius_m);
    ask_again_where_lowered(side, places, found);
    side.radius_m = found.radius_m;
    return found;
  }

  void ask_again_where_lowered(Side &side, std::span<const GatherPoint> places, Estimates &found) {
    std::vector<std::size_t> lowered;
    std::vector<GatherPoint> at;
    std::vector<float> radius_m;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (!(found.radius_m[i] < found.answers.gathered[i].radius_m)) continue;
      lowered.push_back(i), at.push_back(places[i]), radius_m.push_back(found.radius_m[i]);
    }
    if (lowered.empty()) return;
    gather.set_points(at);
    gather.within(side.map, settings(), radius_m);
    const GatherAnswers again = gather.read();
    const auto waves = static_cast<std::size_t>(options.waves);
    for (std::size_t i = 0; i < lowered.size(); ++i) {
      found.answers.gathered[lowered[i]] = again.gathered[i], found.answers.spread[lowered[i]] = again.spread[i];
      for (std::size_t w = 0; w < waves; ++w)
        found.answers.irradiance[lowered[i] * waves + w] = again.irradiance[i * waves + w];
    }
    gather.set_points(places);
  }

  Estimates later_estimates(const Side &side, double ratio) {
    Estimates found{{}, side.radius_m};
    for (float &r : found.radius_m) r *= static_cast<float>(ratio);
    gather.within(side.map, settings(), found.radius_m);
    found.answers = gather.read();
    return found;
  }

  void add(const Estimates &found, std::span<const GatherPoint> places, PassIrradiance &sum) const {
    std::vector<GatherCover> covers(places.size());
    if (options.cover) covers = options.cover(places, found.radius_m);
    const auto waves = static_cast<std::size_t>(options.waves);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const float whole = 1 / covers[i].whole;
      for (std::size_t w = 0; w < waves; ++w)
        sum.irradiance[i * waves + w] += found.answers.irradiance[i * waves + w] * whole;
      sum.narrower[i] += found.answers.spread[i].inner_W_m2 / covers[i].inner;
      sum.variance[i] += found.answers.spread[i].variance_W2_m4 * whole * whole;
      sum.photons[i] += found.answers.gathered[i].count;
    }
  }

  /// Pass 0 looks for the radii, later ones have them.
  void ask(Side &side, int pass, std::size_t records, std::span<const GatherPoint> places, PassIrradiance &sum) {
    const double ratio = pass_radius_ratio(pass, options.alpha), begin = now();
    const bool search = side.radius_m.empty();
    const double radius_m = search ? first_radius_m(side, records) : median(side.radius_m) * ratio;
    side.map.build(records, options.bounds, cell_of_radius(radius_m));
    const double built = now();
    sum.build_seconds += built - begin;
    const double compiled = device->compile_seconds();
    const Estimates found = search ? first_estimates(side, radius_m, places) : later_estimates(side, ratio);
    add(found, places, sum);
    sum.gather_seconds += now() - built - (device->compile_seconds() - compiled);
  }

  std::shared_ptr<Device> device;
  PhotonMapperOptions options;
  PhotonGather gather;
  Side diffuse;
  std::unique_ptr<Side> caustic;
};

PhotonMapper::PhotonMapper(std::shared_ptr<Device> device, const PhotonMapperOptions &options)
    : state_(std::make_unique<State>(std::move(device), options)) {}
PhotonMapper::~PhotonMapper() = default;

PhotonMap &PhotonMapper::diffuse() { return state_->diffuse.map; }
PhotonMap *PhotonMapper::caustic() { return state_->caustic ? &state_->caustic->map : nullptr; }

PassIrradiance PhotonMapper::gather(int pass, std::size_t diffuse_records, std::size_t caustic_records,
                                    std::span<const GatherPoint> places) {
  State &s = *state_;
  if (pass < 0 || (pass > 0 && s.diffuse.radius_m.empty() && !places.empty()))
    throw RunError("a later pass of photons without the radii of the first");
  if (!s.diffuse.radius_m.empty() && s.diffuse.radius_m.size() != places.size())
    throw RunError("a pass of photons with other places than the first");
  PassIrradiance sum;
  sum.irradiance.resize(places.size() * static_cast<std::size_t>(s.options.waves));
  sum.narrower.resize(places.size()), sum.variance.resize(places.size()), sum.photons.resize(places.size());
  if (places.empty()) return sum;
  s.gather.set_points(places);
  s.ask(s.diffuse, pass, diffuse_records, places, sum);
  if (s.caustic) s.ask(*s.caustic, pass, caustic_records, places, sum);
  return sum;
}

std::vector<float> PhotonMapper::radii() const {
  std::vector<float> all = state_->diffuse.radius_m;
  if (state_->caustic) all.insert(all.end(), state_->caustic->radius_m.begin(), state_->caustic->radius_m.end());
  return all;
}

void PhotonMapper::set_radii(std::span<const float> radii) {
  const std::size_t maps = state_->caustic ? 2 : 1, each = radii.size() / maps;
  if (each * maps != radii.size()) throw RunError("the radii of other maps than these");
  state_->diffuse.radius_m.assign(radii.begin(), radii.begin() + static_cast<std::ptrdiff_t>(each));
  if (state_->caustic) state_->caustic->radius_m.assign(radii.begin() + static_cast<std::ptrdiff_t>(each), radii.end());
}

std::size_t PhotonMapper::device_bytes(std::size_t records, std::size_t places, int waves) {
  const std::size_t place = sizeof(GatherPoint) + sizeof(GatherSpread) + sizeof(Gathered) +
                            sizeof(float) * (1 + static_cast<std::size_t>(waves));
  // Cells of the grid: two a photon at most.
  return records * (PhotonMap::bytes_per_photon(waves) + 2 * sizeof(int)) + places * place;
}

}  // namespace greenray
