#include "render/photon_mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "render/lit_photons.hpp"
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
    std::size_t records = 0;
    double middle_m = 0;  // radius that the cells are made for; 0: not known yet
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

  void file(Side &side, std::size_t records) {
    side.records = records;
    const double radius_m = side.middle_m > 0 ? side.middle_m * ratio : first_radius_m(side, records);
    side.map.build(records, options.bounds, cell_of_radius(radius_m));
  }

  /// The radii of the nearest k are the same whatever the cells are.
  void survey(Side &side) {
    const double guess_m = first_radius_m(side, side.records);
    search(side, guess_m);
    std::vector<float> found;
    for (const Gathered &g : gather.read().gathered)
      if (g.count > 0) found.push_back(g.radius_m);
    side.middle_m = found.empty() ? static_cast<double>(static_cast<float>(guess_m)) : median(std::move(found));
    if (side.middle_m < 0.8 * guess_m || side.middle_m > 1.25 * guess_m) file(side, side.records);
  }

  void search(Side &side, double guess_m) {
    GatherSettings s = settings();
    s.nearest = side.nearest;
    s.guess_m = static_cast<float>(guess_m);
    if (side.nearest > 0) gather.nearest(side.map, s);
    else gather.within(side.map, s);
  }

  /// Radii of places, appended: those of the nearest k, a hair less, so that the k-th itself stays outside.
  void find_radii(Side &side, std::span<const GatherPoint> places) {
    search(side, side.middle_m > 0 ? side.middle_m : first_radius_m(side, side.records));
    const std::vector<Gathered> found = gather.read().gathered;
    const float hair = side.nearest > 0 ? 1 - 3e-7f : 1;
    for (std::size_t i = 0; i < places.size(); ++i)
      side.radius_m.push_back(is_place(places[i]) || side.middle_m == 0 ? hair * found[i].radius_m
                                                                        : static_cast<float>(side.middle_m));
  }

  void ask(Side &side, std::size_t first, std::span<const GatherPoint> places, PassIrradiance &sum) {
    if (lit && &side == &diffuse) return lit->ask(places, options.most_radius_m, sum);
    const auto begin = side.radius_m.begin() + static_cast<std::ptrdiff_t>(first);
    std::vector<float> radius_m(begin, begin + static_cast<std::ptrdiff_t>(places.size()));
    for (float &r : radius_m) r *= static_cast<float>(ratio);
    estimate(side, places, std::move(radius_m), sum);
  }

  /// Radii that reach photons behind a wall end at it. Whether there are any is asked of the map at a place there, so
  /// that the dark under a block that stands on a floor costs nothing.
  void stop_at_walls(Side &side, std::span<const GatherPoint> places, std::span<float> radius_m,
                     std::vector<GatherCover> &covers) {
    std::vector<std::size_t> beside;
    std::vector<GatherPoint> behind;
    std::vector<float> half_m;
    for (std::size_t i = 0; i < covers.size(); ++i)
      if (covers[i].clear < 1) {
        beside.push_back(i), behind.push_back(covers[i].hidden);
        half_m.push_back(std::max(0.5f, 1 - covers[i].clear) * radius_m[i]);
      }
    if (beside.empty()) return;
    gather.set_points(behind);
    gather.within(side.map, settings(), half_m);
    const std::vector<Gathered> lit_behind = gather.read().gathered;
    std::vector<std::size_t> shortened;
    std::vector<GatherPoint> again;
    std::vector<float> shorter_m;
    for (std::size_t k = 0; k < beside.size(); ++k) {
      if (lit_behind[k].count == 0) continue;
      const std::size_t i = beside[k];
      radius_m[i] *= std::max(covers[i].clear, least_clear);
      shortened.push_back(i), again.push_back(places[i]), shorter_m.push_back(radius_m[i]);
    }
    if (shortened.empty()) return;
    const std::vector<GatherCover> found = options.cover(again, shorter_m);
    for (std::size_t k = 0; k < shortened.size(); ++k) covers[shortened[k]] = found[k];
  }

  void estimate(Side &side, std::span<const GatherPoint> places, std::vector<float> radius_m, PassIrradiance &sum) {
    std::vector<GatherCover> covers(places.size());
    if (options.cover) covers = options.cover(places, radius_m), stop_at_walls(side, places, radius_m, covers);
    gather.set_points(places);
    gather.within(side.map, settings(), radius_m);
    const GatherAnswers answers = gather.read();
    const auto waves = static_cast<std::size_t>(options.waves);
    for (std::size_t i = 0; i < places.size(); ++i) {
      const float whole = 1 / covers[i].whole;
      for (std::size_t w = 0; w < waves; ++w)
        sum.irradiance[i * waves + w] += answers.irradiance[i * waves + w] * whole;
      sum.narrower[i] += answers.spread[i].inner_W_m2 / covers[i].inner;
      sum.variance[i] += answers.spread[i].variance_W2_m4 * whole * whole;
      sum.photons[i] += answers.gathered[i].count;
    }
  }

  /// Every so many photons of the diffuse map get the irradiance of this pass, from radii of their own.
  void light_photons() {
    if (options.precomputed <= 0 || lit_pass == pass) return;
    const PhotonMap::Contents c = diffuse.map.read();
    std::vector<GatherPoint> all;
    for (std::size_t i = 0; i < c.x_m.size(); i += static_cast<std::size_t>(options.precomputed))
      all.push_back({{c.x_m[i], c.y_m[i], c.z_m[i]}, c.normal[i]});
    PassIrradiance light = blank(all.size());
    double middle_m = 0;
    for (std::size_t first = 0; first < all.size(); first += lit_at_once) {
      const std::span<const GatherPoint> part =
          std::span(all).subspan(first, std::min(lit_at_once, all.size() - first));
      PassIrradiance here = blank(part.size());
      gather.set_points(part);
      Side &side = diffuse;
      search(side, side.middle_m > 0 ? side.middle_m : first_radius_m(side, side.records));
      std::vector<float> radius_m;
      for (const Gathered &g : gather.read().gathered)
        radius_m.push_back((1 - 3e-7f) * g.radius_m * static_cast<float>(ratio));
      if (first == 0) middle_m = median(radius_m);
      estimate(side, part, std::move(radius_m), here);
      const auto at = [&](auto &values, std::size_t each) {
        return values.begin() + static_cast<std::ptrdiff_t>(first * each);
      };
      std::copy(here.irradiance.begin(), here.irradiance.end(),
                at(light.irradiance, static_cast<std::size_t>(options.waves)));
      std::copy(here.narrower.begin(), here.narrower.end(), at(light.narrower, 1));
      std::copy(here.variance.begin(), here.variance.end(), at(light.variance, 1));
      std::copy(here.photons.begin(), here.photons.end(), at(light.photons, 1));
    }
    lit.emplace(device, options.waves);
    const double photons_within = std::max(1.0, ratio * ratio * std::max(diffuse.nearest, 1));
    lit->file(all, light, options.bounds, std::max(middle_m, 1e-9) * std::sqrt(options.precomputed / photons_within));
    lit_pass = pass;
  }

  PassIrradiance blank(std::size_t places) const {
    PassIrradiance sum;
    sum.irradiance.resize(places * static_cast<std::size_t>(options.waves));
    sum.narrower.resize(places), sum.variance.resize(places), sum.photons.resize(places);
    return sum;
  }

  template <class F>
  void each_side(const F &f) {
    f(diffuse);
    if (caustic) f(*caustic);
  }

  std::shared_ptr<Device> device;
  PhotonMapperOptions options;
  PhotonGather gather;
  Side diffuse;
  std::unique_ptr<Side> caustic;
  static constexpr float least_clear = 0.03f;  // of the radius that is left at the foot of a wall
  static constexpr std::size_t lit_at_once = std::size_t{1} << 18;
  std::optional<LitPhotons> lit;
  int lit_pass = -1;
  int pass = -1;  // filed
  double ratio = 1;
};

PhotonMapper::PhotonMapper(std::shared_ptr<Device> device, const PhotonMapperOptions &options)
    : state_(std::make_unique<State>(std::move(device), options)) {}
PhotonMapper::~PhotonMapper() = default;

PhotonMap &PhotonMapper::diffuse() { return state_->diffuse.map; }
PhotonMap *PhotonMapper::caustic() { return state_->caustic ? &state_->caustic->map : nullptr; }

double PhotonMapper::file(int pass, std::size_t diffuse_records, std::size_t caustic_records) {
  State &s = *state_;
  if (pass < 0) throw RunError("passes of photons are counted from 0");
  const double begin = now();
  s.pass = pass;
  s.ratio = pass_radius_ratio(pass, s.options.alpha);
  s.file(s.diffuse, diffuse_records);
  if (s.caustic) s.file(*s.caustic, caustic_records);
  return now() - begin;
}

void PhotonMapper::survey(std::span<const GatherPoint> places) {
  if (state_->pass != 0 || places.empty()) return;
  state_->gather.set_points(places);
  state_->each_side([&](State::Side &side) { state_->survey(side); });
}

void PhotonMapper::find_radii(std::span<const GatherPoint> places) {
  if (places.empty()) return;
  state_->gather.set_points(places);
  state_->each_side([&](State::Side &side) { state_->find_radii(side, places); });
}

void PhotonMapper::settle_radii(std::span<const GatherPoint> places, std::size_t columns, std::size_t samples) {
  state_->each_side([&](State::Side &side) {
    if (side.nearest > 0) limit_radius_slope(places, columns, samples, state_->options.radius_slope, side.radius_m);
  });
}

void PhotonMapper::limit_radii(std::size_t first, std::span<const GatherPoint> places,
                               std::span<const GatherPoint> others, std::span<const std::size_t> around) {
  state_->each_side([&](State::Side &side) {
    if (side.nearest > 0)
      limit_radii_beside(places, std::span(side.radius_m).subspan(first), others, side.radius_m, around,
                         state_->options.radius_slope);
  });
}

void PhotonMapper::keep_radii(std::span<const std::size_t> places) {
  state_->each_side([&](State::Side &side) {
    std::vector<float> kept;
    for (const std::size_t i : places) kept.push_back(side.radius_m.at(i));
    side.radius_m = std::move(kept);
  });
}

PassIrradiance PhotonMapper::ask(std::size_t first, std::span<const GatherPoint> places) {
  State &s = *state_;
  if (s.pass < 0) throw RunError("a gather before any photons were filed");
  PassIrradiance sum = s.blank(places.size());
  if (places.empty()) return sum;
  const double begin = now(), compiled = s.device->compile_seconds();
  s.light_photons();
  s.gather.set_points(places);
  s.each_side([&](State::Side &side) {
    if (side.radius_m.size() < first + places.size())
      throw RunError("photons are asked for other places than their radii were found for");
    s.ask(side, first, places, sum);
  });
  sum.gather_seconds = now() - begin - (s.device->compile_seconds() - compiled);
  return sum;
}

PassIrradiance PhotonMapper::gather(int pass, std::size_t diffuse_records, std::size_t caustic_records,
                                    std::span<const GatherPoint> places) {
  const double build_seconds = file(pass, diffuse_records, caustic_records);
  if (pass == 0) {
    survey(places);
    state_->each_side([](State::Side &side) { side.radius_m.clear(); });
    find_radii(places);
    settle_radii(places, state_->options.columns, state_->options.samples);
  }
  PassIrradiance sum = ask(0, places);
  sum.build_seconds = build_seconds;
  return sum;
}

std::vector<float> PhotonMapper::radii() const {
  std::vector<float> all;
  state_->each_side([&](const State::Side &side) {
    if (side.radius_m.empty()) return;
    all.push_back(static_cast<float>(side.middle_m));
    all.insert(all.end(), side.radius_m.begin(), side.radius_m.end());
  });
  return all;
}

void PhotonMapper::set_radii(std::span<const float> radii) {
  const std::size_t maps = state_->caustic ? 2 : 1, each = radii.size() / maps;
  if (each * maps != radii.size() || each == 0) throw RunError("the radii of other maps than these");
  state_->each_side([&](State::Side &side) {
    side.middle_m = static_cast<double>(radii[0]);
    side.radius_m.assign(radii.begin() + 1, radii.begin() + static_cast<std::ptrdiff_t>(each));
    radii = radii.last(radii.size() - each);
  });
}

std::size_t PhotonMapper::device_bytes(std::size_t records, std::size_t places, int waves) {
  const std::size_t place = sizeof(GatherPoint) + sizeof(GatherSpread) + sizeof(Gathered) +
                            sizeof(float) * (1 + static_cast<std::size_t>(waves));
  // Cells of the grid: two a photon at most.
  return records * (PhotonMap::bytes_per_photon(waves) + 2 * sizeof(int)) + places * place;
}

}  // namespace greenray
