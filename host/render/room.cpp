#include "render/room.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "atmosphere/profile.hpp"
#include "render/photon_picture.hpp"
#include "render/room_checkpoint.hpp"
#include "render/room_choices.hpp"
#include "render/room_error.hpp"
#include "render/room_eye.hpp"
#include "render/room_looks.hpp"
#include "render/room_photons.hpp"
#include "scene/bvh.hpp"
#include "scene/room_frame.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

constexpr int passes_before_stopping = 4;  // the noise from pass to pass is not known from fewer

/// The state of one render.
class Room {
 public:
  Room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device)
      : scene_(moved_to_middle(scene)),
        options_(options),
        device_(device),
        begin_(Clock::now()),
        plan_(plan_room(scene, options)),
        looks_(room_looks(scene_)) {
    const double compiled = device->compile_seconds();
    take_up();
    air_ = room_air(scene_, looks_.wavelength_nm, options.straight);
    tree_ = build_surface_tree(scene_.surfaces, SurfaceScene::lanes_for(*device));
    tracer_.emplace(device, tree_, air_, looks_);
    out_.report.table_arcsec = room_table_error_arcsec(air_, diagonal_m(tree_.bounds));
    out_.report.solver_arcsec = room_solver_error_arcsec(*tracer_, air_, scene_.camera);
    alone_ = medium_disperses(air_, diagonal_m(tree_.bounds));
    out_.report.triangles = scene.surfaces.triangles.size(), out_.report.spheres = scene.surfaces.spheres.size();
    out_.report.air_cells = air_.cells, out_.report.table_error_m = air_.error_m;
    out_.report.build_seconds = seconds_since(begin_) - (device->compile_seconds() - compiled);
    compiled_before_ = compiled;
  }

  RoomPicture render() {
    photons_.emplace(scene_, options_, device_, *tracer_, looks_, tree_.bounds, alone_);
    photons_->fit(plan_, eye_bytes(), state_.passes > 0);
    eye_.emplace(scene_.camera, glass_around(scene_, scene_.camera.from), plan_, options_.seed, alone_, looks_.waves());
    statistics_.emplace(plan_.pixels(), looks_.waves());
    if (state_.passes > 0) restore();
    else state_.sums.assign(3 * plan_.pixels(), 0.0f);
    state_.photons_a_pass = plan_.photons_a_pass;
    find_counting_pixels();
    last_kept_ = Clock::now();
    while (!done()) run_pass();
    finish();
    return std::move(out_);
  }

 private:
  /// Looks for a checkpoint of this picture.
  void take_up() {
    if (options_.checkpoint.empty() || options_.resume == RoomOptions::Resume::never) return;
    const bool must = options_.resume == RoomOptions::Resume::always;
    std::optional<RoomCheckpoint> found;
    std::vector<std::string> changed;
    try {
      found = read_checkpoint(options_.checkpoint);
      if (found) changed = changed_keys(found->identity, identity());
    } catch (const InputError &error) {
      if (must) throw;
      return say("the checkpoint " + options_.checkpoint.string() + " is damaged: starting anew");
    }
    const SourcePlace place{options_.checkpoint.string(), 1, 1};
    if (!found && must) throw InputError(place, "expected a checkpoint to resume, found none");
    if (!found) return;
    if (changed.empty()) {
      state_ = std::move(found->state);
      while (plan_.photons_a_pass > state_.photons_a_pass) halve_passes(plan_, scene_, options_);
      if (plan_.photons_a_pass != state_.photons_a_pass)
        throw InputError(place, "expected passes of " + std::to_string(plan_.photons_a_pass) + " photons, found " +
                                    std::to_string(state_.photons_a_pass) + "; --no-resume starts anew");
      return;
    }
    std::vector<Diagnostic> all;
    for (const std::string &key : changed)
      all.push_back({place, "expected a checkpoint of this picture: " + key + "; --no-resume starts anew"});
    if (must) throw InputError(all);
    std::string keys;
    for (const std::string &key : changed) keys += (keys.empty() ? "" : "; ") + key;
    say("the checkpoint is of another picture, starting anew: " + keys);
  }

  RoomIdentity identity() const {
    RoomIdentity own = room_identity(scene_, options_, plan_);
    own.options["--lanes"] = std::to_string(device_->lanes().lanes_float);  // sums over lanes have another order
    return own;
  }

  void restore() {
    const std::size_t pixels = plan_.pixels();
    const auto fit = [&](const std::vector<int> &list) {
      return std::all_of(list.begin(), list.end(),
                         [&](int i) { return i >= 0 && static_cast<std::size_t>(i) < pixels; });
    };
    if (state_.sums.size() != 3 * pixels || !fit(state_.lamp_pixels) || !fit(state_.edge_pixels))
      throw RunError("the checkpoint is of another picture");
    statistics_->restore(state_.statistics);
    photons_->mapper().set_radii(state_.radii);
    photons_->set_totals(state_.photons);
    eye_->set_lamp_pixels(state_.lamp_pixels), eye_->set_edge_pixels(state_.edge_pixels);
    if (statistics_->passes() != state_.passes) throw RunError("the checkpoint is of another picture");
    out_.report.resumed_at = state_.passes;
  }

  void say(const std::string &words) const {
    if (options_.note) options_.note(words);
  }

  std::size_t eye_bytes() const {
    return RoomEye(scene_.camera, 0, plan_, options_.seed, alone_, looks_.waves()).device_bytes();
  }

  /// The crop without the pixels around it.
  void find_counting_pixels() {
    for (int y = plan_.region[1]; y < plan_.region[3]; ++y)
      for (int x = plan_.region[0]; x < plan_.region[2]; ++x)
        counts_.push_back(x >= plan_.crop[0] && x < plan_.crop[2] && y >= plan_.crop[1] && y < plan_.crop[3]);
  }

  double spent_seconds() const { return state_.seconds + seconds_since(begin_); }

  bool done() const {
    const int behind = statistics_->passes();
    if (behind >= plan_.passes) return true;
    if (!plan_.open || behind < passes_before_stopping) return false;
    if (options_.error_pct && 100 * totals_.error_rms() <= *options_.error_pct) return true;
    return options_.minutes && spent_seconds() + 0.5 * pass_seconds_ >= 60 * *options_.minutes;
  }

  /// How much is done, as far as that can be told.
  double fraction(double part) const {
    const double behind = statistics_->passes() + part;
    if (!plan_.open) return behind / plan_.passes;
    double most = behind / plan_.passes;
    if (options_.minutes) most = std::max(most, spent_seconds() / (60 * *options_.minutes));
    const double error_pct = 100 * totals_.error_rms();  // falls as passes^(-1/3)
    if (options_.error_pct && error_pct > 0) most = std::max(most, std::pow(*options_.error_pct / error_pct, 3));
    return std::min(most, 0.99);
  }

  void show(const char *phase, double part) const {
    if (options_.progress) options_.progress(phase, fraction(part), totals_.error_rms());
  }

  void run_pass() {
    const int pass = statistics_->passes();
    const auto begin = Clock::now();
    try {
      stop_if_asked();
      show("photons", 0);
      photons_->trace(plan_, pass);
      stop_if_asked();
      show("picture", 0.5);
      if (pass == 0) eye_->find_radii(*tracer_, photons_->mapper());
      const bool shows_map = options_.photon_map > 0 && !out_.photon_map;
      const RoomPass seen = eye_->see(pass, *tracer_, photons_->mapper());
      if (shows_map) picture_photons(seen);
      add(seen);
    } catch (const Error &error) {
      keep_after(error);
    }
    pass_seconds_ = seconds_since(begin);
    totals_ = statistics_->totals(counts_, static_cast<std::size_t>(plan_.width()));
    state_.photons = photons_->totals();
    if (!options_.checkpoint.empty() && seconds_since(last_kept_) >= options_.checkpoint_seconds) keep_if_possible();
  }

  /// Both maps share out the dots as they share the photons.
  void picture_photons(const RoomPass &seen) {
    PhotonMap &diffuse = photons_->mapper().diffuse(), *caustic = photons_->mapper().caustic();
    const double all = static_cast<double>(diffuse.filed() + (caustic ? caustic->filed() : 0));
    PhotonPicture picture(seen.ends, static_cast<std::size_t>(plan_.width()), static_cast<std::size_t>(plan_.samples),
                          looks_.waves());
    for (const PhotonMap *map : {&diffuse, caustic}) {
      if (!map || map->filed() == 0) continue;
      const double share = static_cast<double>(map->filed()) / all;
      picture.show(map->read(), static_cast<std::size_t>(share * static_cast<double>(options_.photon_map)));
    }
    SpectralImage &image = out_.photon_map.emplace();
    image.width = plan_.crop[2] - plan_.crop[0], image.height = plan_.crop[3] - plan_.crop[1];
    image.wavelength_nm = looks_.wavelength_nm;
    image.radiance = cropped(picture.power(), looks_.waves(), 1);
    image.channels["photon_count"] = cropped(picture.counts(), 1, 1);
  }

  /// An interrupted or failed pass leaves those before it.
  [[noreturn]] void keep_after(const Error &error) {
    const bool interrupted = error.exit_code() == ExitCode::interrupted;
    if (options_.checkpoint.empty() || statistics_->passes() == 0) throw;
    try {
      keep();
    } catch (const Error &second) {
      if (interrupted) throw Interrupted(std::string("interrupted; no checkpoint: ") + second.what());
      throw error;
    }
    const std::string kept =
        "checkpoint of " + std::to_string(statistics_->passes()) + " passes kept in " + options_.checkpoint.string();
    if (interrupted) throw Interrupted("interrupted: " + kept);
    throw Error(ExitCode::stopped_early, std::string(error.what()) + "; " + kept);
  }

  /// A full disk must not end a render that may still fit its picture.
  void keep_if_possible() {
    try {
      keep();
    } catch (const RunError &error) {
      say(std::string("no checkpoint: ") + error.what());
      last_kept_ = Clock::now();
    }
  }

  void keep() {
    RoomCheckpoint checkpoint{identity(), state_};
    RoomState &s = checkpoint.state;
    s.passes = statistics_->passes();
    s.statistics = statistics_->state();
    s.radii = photons_->mapper().radii();
    s.lamp_pixels = eye_->lamp_pixels(), s.edge_pixels = eye_->edge_pixels();
    s.seconds = spent_seconds();
    write_checkpoint(options_.checkpoint, checkpoint);
    last_kept_ = Clock::now();
  }

  void add(const RoomPass &pass) {
    std::size_t i = 0;
    for (const std::vector<float> *values : {&pass.depth_m, &pass.bend_mrad, &pass.photon_count})
      for (const float value : *values) state_.sums[i++] += value;
    statistics_->add({pass.radiance, pass.narrower, pass.variance});
  }

  /// The crop of values over the region.
  std::vector<float> cropped(const std::vector<float> &values, std::size_t each, float scale) const {
    std::vector<float> out;
    for (std::size_t p = 0; p < plan_.pixels(); ++p)
      if (counts_[p])
        for (std::size_t k = 0; k < each; ++k) out.push_back(values[p * each + k] * scale);
    return out;
  }

  void finish() {
    const std::size_t waves = looks_.waves(), pixels = plan_.pixels();
    SpectralImage &image = out_.image;
    image.width = plan_.crop[2] - plan_.crop[0], image.height = plan_.crop[3] - plan_.crop[1];
    image.wavelength_nm = looks_.wavelength_nm;
    image.radiance = cropped(statistics_->mean(), waves, 1);
    const float of_band = 1 / static_cast<float>(waves);
    image.channels["noise"] = cropped(statistics_->noise(), 1, of_band);
    image.channels["bias"] = cropped(statistics_->bias(), 1, of_band);
    std::size_t first = 0;
    for (const char *name : {"depth_m", "bend_mrad", "photon_count"}) {
      const auto from = state_.sums.begin() + static_cast<std::ptrdiff_t>(first);
      image.channels[name] = cropped({from, from + static_cast<std::ptrdiff_t>(pixels)}, 1,
                                     1 / static_cast<float>(std::max(statistics_->passes(), 1)));
      first += pixels;
    }
    report();
  }

  void report() {
    RoomReport &r = out_.report;
    totals_ = statistics_->totals(counts_, static_cast<std::size_t>(plan_.width()));
    r.noise_rms = totals_.noise_rms, r.bias_rms = totals_.bias_rms, r.bias_mean = totals_.bias;
    r.bias_below = totals_.bias_below, r.bias_is_seen = totals_.bias_is_seen();
    r.error_rms = totals_.error_rms(), r.error_of_rms = totals_.error_of_rms();
    r.passes = statistics_->passes(), r.spp = r.passes * plan_.samples, r.photons_a_pass = plan_.photons_a_pass;
    r.aimed_cells = photons_->aimed_cells();
    r.lamp_pixels = eye_->lamp_pixels().size(), r.edge_pixels = eye_->edge_pixels().size();
    r.photons = photons_->totals();
    r.emit_seconds = r.photons.seconds, r.map_seconds = photons_->map_seconds();
    r.gather_seconds = eye_->gather_seconds(), r.cover_seconds = photons_->cover_seconds(),
    r.eye_seconds = tracer_->eye_seconds();
    r.compile_seconds = device_->compile_seconds() - compiled_before_;
  }

  const RoomScene scene_;  // as it is traced
  RoomOptions options_;
  std::shared_ptr<Device> device_;
  Clock::time_point begin_, last_kept_;
  RoomPlan plan_;
  RoomLooks looks_;
  RoomState state_;
  AirTable air_;
  SurfaceTree tree_;
  bool alone_ = false;
  std::optional<RoomTracer> tracer_;
  std::optional<RoomPhotons> photons_;
  std::optional<RoomEye> eye_;
  std::optional<PixelStatistics> statistics_;
  std::vector<unsigned char> counts_;  // [pixels of the region]
  PixelStatistics::Totals totals_;     // so far
  double pass_seconds_ = 0, compiled_before_ = 0;
  RoomPicture out_;
};

}  // namespace

AirTable room_air(const RoomScene &scene, const std::vector<double> &wavelength_nm, bool straight) {
  AirTable air = uniform_air(0, wavelength_nm);
  if (scene.air && !straight) {
    const Profile profile(*scene.air);
    const surface32::GeometryBounds bounds = build_surface_tree(scene.surfaces, 1).bounds;
    AirTableOptions options;
    options.low_m = static_cast<double>(bounds.low[2]), options.high_m = static_cast<double>(bounds.high[2]);
    options.length_m = diagonal_m(bounds);
    options.error_m = 1e-3;
    air = build_air_table(layered_medium(profile, true), wavelength_nm, options);
  }
  air.extinction_per_m = scene.extinction_per_m;
  return air;
}

RoomPicture render_room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device) {
  return Room(scene, options, device).render();
}

}  // namespace greenray
