#include "render/renderer.hpp"

#include <atomic>
#include <chrono>
#include <cmath>

#include "render/host_rays.hpp"
#include "render/sky.hpp"
#include "render/sky_own_rays.hpp"
#include "render/sky_picture.hpp"
#include "render/sky_rows_run.hpp"
#include "render/sky_run.hpp"
#include "render/sky_sight.hpp"
#include "render/sun_place.hpp"
#include "render/targets.hpp"
#include "render/terrain_light.hpp"
#include "render/transfer_curve.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::atomic<bool> stop_flag{false};

constexpr std::size_t cached_bytes = std::size_t{8} << 20;  // a band of this size is still in cache when it is read

class Renderer {
 public:
  Renderer(const Scene &scene, const RenderPlan &plan, const RenderOptions &options, std::shared_ptr<Device> device)
      : scene_(scene), plan_(plan), options_(options), device_(std::move(device)) {}

  Rendered run() {
    bool reused = false;
    const double compiled_before = options_.cache && options_.cache->sight ? device_->compile_seconds() : 0;
    ranks().together([&] {
      sight_ = sky_sight(scene_, plan_, options_, device_, options_.cache, reused,
                         [this](const std::string &phase) { progress(phase, 0); });
      report_ = sight_->report();
      if (reused) report_.build_seconds = report_.emit_seconds = 0;
      light();
    });
    shade();
    report_.compile_seconds = device_->compile_seconds() - compiled_before;
    return {std::move(image_), report_};
  }

 private:
  void progress(const std::string &phase, double fraction, double noise = 0) {
    stop_if_asked();
    if (options_.progress) options_.progress(phase, fraction, noise);
  }

  void place_sun() {
    const std::optional<double> horizon = sight_->horizon_rad();
    if (horizon) report_.horizon_altitude_deg = to_deg(*horizon);
    sun_ = place_of_sun(scene_, sight_->reference());
    if (!sun_.shines) return;
    report_.sun_true_altitude_deg = to_deg(sun_.true_altitude_rad);
    if (const auto seen = apparent_altitude_rad(sight_->reference(), sun_.true_altitude_rad, horizon))
      report_.sun_apparent_altitude_deg = to_deg(*seen);
    else find_sun_in(sight_->curve());
  }

  /// Through a duct the Sun may be seen far from where iteration looks for it: then as the curve shows it.
  void find_sun_in(const TransferCurve &curve) {
    if (!plan_.section) return;
    const std::vector<Image> images = images_of(curve, plan_.bent_nm.size() / 2, sun_.true_altitude_rad);
    if (!images.empty()) report_.sun_apparent_altitude_deg = images.front().apparent_altitude_deg;
  }

  void light() {
    const auto begin = Clock::now();
    const double compiled_before = device_->compile_seconds();
    place_sun();
    light_ = {scene_.sky, sun_, sight_->rays_at(sunlight_altitude_deg()), spectral_air(scene_, plan_.wavelengths_nm)};
    light_.moon = place_of_moon(scene_, sight_->reference(), light_.air, plan_.wavelengths_nm);
    light_by_sun_or_moon();
    light_.glow = glow();
    if (light_.glow) {
      report_.azimuth_error = light_.glow->azimuth_error();
      for (double distance_m : plan_.station_m) light_.air_before.push_back(light_.glow->air_before(distance_m));
    }
    report_.emit_seconds += std::max(0.0, seconds_since(begin) - (device_->compile_seconds() - compiled_before));
  }

  /// Where the Sun is seen; below the horizon, just above it: a few arc-seconds, for each wavelength has its own
  /// horizon.
  double sunlight_altitude_deg() const {
    constexpr double clear_of_the_ground_deg = 5.0 / 3600;
    const double seen_deg = report_.sun_apparent_altitude_deg.value_or(to_deg(sun_.true_altitude_rad));
    if (!report_.horizon_altitude_deg) return report_.sun_apparent_altitude_deg.value_or(std::max(seen_deg, 0.0));
    return std::max(seen_deg, *report_.horizon_altitude_deg + clear_of_the_ground_deg);
  }

  /// Who lights the sky: the Sun, and in a scene without it the Moon, which then stands in its place.
  void light_by_sun_or_moon() {
    if (sun_.shines) {
      for (const SpectralAir &air : light_.air) light_.irradiance.push_back(air.irradiance_outside(sun_.radius_rad));
      return;
    }
    if (!light_.moon.shines) return;
    sun_.true_altitude_rad = light_.moon.true_altitude_rad;
    sun_.azimuth_rad = light_.moon.azimuth_rad;
    light_.irradiance = light_.moon.irradiance;
    light_.sun = sun_;
    report_.sun_apparent_altitude_deg.reset();
    if (const auto seen = apparent_altitude_rad(sight_->reference(), sun_.true_altitude_rad, sight_->horizon_rad()))
      light_.towards_sun = sight_->rays_at(to_deg(*seen));
  }

  std::shared_ptr<const SkyGlow> glow() const {
    if (light_.irradiance.empty() || !sight_->field()) return nullptr;
    const double low = to_rad(plan_.first_elevation_deg);
    const double high = low + from_arcsec(plan_.spacing_arcsec) * static_cast<double>(plan_.entries - 1);
    const AzimuthRange seen = azimuths_from(scene_, plan_, sun_.azimuth_rad);
    return std::make_shared<SkyGlow>(sight_->field(), scene_.sky, sun_.true_altitude_rad, light_.irradiance,
                                     GlowRange{low, std::min(high, pi / 2), seen.nearest_rad, seen.farthest_rad});
  }

  f32::SkyView view() const {
    const double altitude = to_rad(scene_.observer.altitude_deg);
    f32::SkyView v{};
    v.sin_altitude = static_cast<float>(std::sin(altitude));
    v.cos_altitude = static_cast<float>(std::cos(altitude));
    v.pixel_tangent = static_cast<float>(2 * std::tan(to_rad(scene_.observer.fov_deg) / 2) / plan_.size[0]);
    v.centre_column = 0.5f * static_cast<float>(plan_.size[0]);
    v.centre_row = 0.5f * static_cast<float>(plan_.size[1]);
    v.first_elevation_rad = static_cast<float>(sight_->transfer().first_elevation_rad);
    v.entries_per_rad = static_cast<float>(1 / sight_->transfer().spacing_rad);
    v.sun_azimuth_rad = static_cast<float>(sun_.azimuth_rad);
    v.sun_sin_altitude = static_cast<float>(std::sin(sun_.true_altitude_rad));
    v.sun_cos_altitude = static_cast<float>(std::cos(sun_.true_altitude_rad));
    v.sun_radius_rad = static_cast<float>(sun_.radius_rad);
    set_azimuths(light_.glow.get(), v);
    v.moon = moon_view(scene_.moon, light_.moon, sun_.true_altitude_rad);
    v.entries = static_cast<int>(sight_->transfer().entries);
    v.width = plan_.crop[2] - plan_.crop[0];
    v.first_column = plan_.crop[0];
    v.seed = static_cast<unsigned int>(options_.seed ^ (options_.seed >> 32));
    return v;
  }

  void shade() {
    const auto begin = Clock::now();
    const double compiled_before = device_->compile_seconds();
    const int waves = padded_waves(*device_, static_cast<int>(plan_.wavelengths_nm.size()));
    const SkyTable sky = make_sky_table(light_, sight_->transfer(), waves);
    const std::size_t middle = light_.air.size() / 2;
    if (sun_.shines) report_.sun_optical_depth = optical_depth(light_.towards_sun[middle], light_.air[middle]);
    measure_bias(sky, waves);
    const TargetShapes shapes = target_shapes(scene_, plan_.station_m);
    const SeaDraw sea = sight_->sea() ? draw_waves(*sight_->sea()) : SeaDraw{};
    const TargetTable targets = make_target_table(scene_, shapes, light_, plan_.wavelengths_nm, sight_->stations(),
                                                  sight_->transfer().edges, sea, waves);
    TerrainTable terrain;
    if (sight_->terrain())
      terrain = make_terrain_table(scene_, light_, plan_.wavelengths_nm, *sight_->terrain(), sight_->terrain_sights(),
                                   waves, sight_->sea() ? sight_->sea()->horizon_m : 0);
    SkyPicture picture(plan_);
    if (plan_.per_pixel) shade_per_pixel(shapes, picture);
    else shade_from_table(sky, targets, terrain, picture);
    if (!ranks().first()) return;
    picture.describe(view(), sight_->transfer());
    if (!targets.targets.empty()) picture.describe_targets(view(), targets, sight_->stations());
    if (terrain.any()) picture.describe_terrain(view(), terrain);
    report_.noise_rms = picture.noise_rms();
    report_.spp = picture.most_samples();
    if (options_.keeping && options_.keeping->share && !run_->is_complete())
      run_->complete(options_.part_report ? options_.part_report(report_) : "{}");
    image_ = picture.take();
    report_.gather_seconds = seconds_since(begin) - (device_->compile_seconds() - compiled_before);
  }

  SeaDraw draw_waves(const SeaSights &sights) const {
    const double pixel_rad = from_arcsec(plan_.pixel_arcsec);
    const double tilt = std::cos(to_rad(scene_.observer.altitude_deg));  // azimuths widen towards the zenith
    const double half_rad = std::min(0.55 * to_rad(scene_.observer.fov_deg) / std::max(tilt, 0.05) + 2 * pixel_rad, pi);
    return draw_sea(sights, sea_state(scene_.sea), half_rad, pixel_rad, options_.seed);
  }

  void shade_per_pixel(const TargetShapes &shapes, SkyPicture &picture) {
    const OwnRayTargets targets{scene_, shapes, plan_.station_m.empty() ? nullptr : &sight_->places()};
    const TraceStats before = sight_->rays().stats();
    shade_rows(picture, 1, 0, [&](int first, int last, SkyRun &run) {
      const TraceStats before_these = sight_->rays().stats();
      shade_with_own_rays(sight_->rays(), light_, targets, view(), plan_, {first, last}, picture);
      progress("picture", static_cast<double>(last) / picture.height());  // may throw: then the row is made again
      run.add_rays(sight_->rays().stats().since(before_these));
    });
    report_.trace = before;
    report_.trace.add(run_->rays());
    report_.lookup_arcsec = report_.bias = 0;
  }

  void shade_from_table(const SkyTable &sky, const TargetTable &targets, const TerrainTable &terrain,
                        SkyPicture &picture) {
    const int rows = rows_of_band(sky, targets.bytes() + terrain.bytes(), picture);
    SkyShader shader(device_, sky, targets, terrain, picture.width(), rows);
    shade_rows(picture, rows, adaptive() ? rows : 0, [&](int first, int last, SkyRun &run) {
      f32::SkyView v = view();
      v.first_row = plan_.crop[1] + first;
      v.rows = last - first;
      shade_band(shader, v, picture, run);
    });
  }

  void shade_rows(SkyPicture &picture, int rows_a_band, int rows_that_stop,
                  const std::function<void(int, int, SkyRun &)> &shade) {
    const std::string lanes = std::to_string(device_->lanes().lanes_float);
    run_.emplace(ranks().first() ? options_.keeping : nullptr, sky_identity(scene_, plan_, options_, lanes),
                 rows_that_stop, picture);
    report_.resumed_rows = run_->resumed_rows(), report_.workers = adaptive() ? 1 : ranks().size();
    run_rows(ranks(), adaptive(), *run_, picture, rows_a_band, shade);
  }

  Ranks &ranks() { return options_.ranks ? *options_.ranks : alone_; }

  bool adaptive() const { return plan_.error_pct || plan_.minutes; }

  /// As many rows as the device has memory for; with a fixed number of samples no more than its caches like.
  int rows_of_band(const SkyTable &sky, std::size_t bytes_before_it, const SkyPicture &picture) const {
    const std::size_t row_bytes = SkyShader::band_bytes(picture.width(), 1, sky.waves);
    const std::size_t fixed =
        (sky.values.size() + sky.disks.size()) * sizeof(float) + bytes_before_it + device_->used_bytes();
    const std::size_t left = device_->budget_bytes() > fixed ? (device_->budget_bytes() - fixed) / 10 * 9 : 0;
    std::size_t most = std::min(left, device_->info().largest_buffer_bytes);
    if (!adaptive() && device_->info().is_cpu) most = std::min(most, cached_bytes);
    return static_cast<int>(std::clamp<std::size_t>(most / row_bytes, 1, static_cast<std::size_t>(picture.height())));
  }

  /// Passes of a few samples until enough, good enough or late enough; each band decides for itself.
  void shade_band(SkyShader &shader, const f32::SkyView &v, SkyPicture &picture, SkyRun &run) {
    shader.begin(v);
    const int first_row = v.first_row - plan_.crop[1], wanted = plan_.spp;
    const double before = static_cast<double>(first_row) / picture.height();
    const double share = static_cast<double>(v.rows) / picture.height();
    const auto begin = Clock::now();
    int samples = 0;
    double noise = 0, seconds_before = 0;
    if (const std::optional<SkyBand> begun = run.begun(first_row, v.rows)) {
      shader.set_sums({begun->spectra, begun->moments});
      samples = begun->samples, seconds_before = begun->seconds;
    }
    const auto seconds = [&] { return seconds_before + seconds_since(begin); };
    const auto is_enough = [&] {
      if (!adaptive() || samples == 0) return false;
      shader.with_sums([&](const SkySums &sums) { noise = relative_noise(sums, samples); });
      if (plan_.error_pct && noise * 100 <= *plan_.error_pct) return true;
      return plan_.minutes && seconds() >= *plan_.minutes * 60 * share;
    };
    // Whatever stops it, its sums must be read while it is there.
    const SkyRun::InBand leave(run);
    while (samples < wanted && !is_enough()) {
      const int pass = std::min(adaptive() ? std::max(4, samples / 2) : 8, wanted - samples);
      run.in_band({});
      shader.add_samples(samples, pass, stop_if_asked);
      samples += pass;
      run.in_band([&, samples] {
        SkyBand band{first_row, v.rows, samples, seconds(), {}, {}};
        shader.with_sums([&](const SkySums &sums) {
          band.spectra.assign(sums.spectra.begin(), sums.spectra.end());
          band.moments.assign(sums.moments.begin(), sums.moments.end());
        });
        return band;
      });
      progress("picture", before + share * samples / wanted, noise);
    }
    run.in_band({});
    shader.with_sums([&](const SkySums &sums) { picture.keep(sums, first_row, v.rows, samples); });
  }

  /// Relative RMS error of radiance (Sun and glow) that interpolating the table half way causes.
  void measure_bias(const SkyTable &sky, int waves) {
    TransferTable between = sight_->transfer();
    between.entries = sight_->probes().below.size();
    between.rays = sight_->probes().rays;
    const SkyTable truth = make_sky_table(light_, between, waves);
    const auto n = static_cast<std::size_t>(waves), entry = n * static_cast<std::size_t>(sky.channels);
    double error = 0, light = 0;
    for (std::size_t k = 0; k < between.entries; ++k)
      for (std::size_t w = 0; w < light_.air.size(); ++w) {
        const float *a = &sky.values[sight_->probes().below[k] * entry + w], *b = a + entry,
                    *t = &truth.values[k * entry + w];
        if (a[f32::SKY_JOINED * n] < 1.0f) continue;
        for (std::size_t c : {f32::SKY_PASSED * n, f32::SKY_LIGHT * n}) {
          if (c >= entry) continue;  // no light but the Sun's
          const double scale = c == f32::SKY_LIGHT * n ? 1 : sun_.shines ? light_.air[w].sun_centre_radiance : 0;
          const double difference = scale * (0.5 * (static_cast<double>(a[c]) + b[c]) - t[c]), is = scale * t[c];
          error += difference * difference;
          light += is * is;
        }
      }
    report_.bias = light > 0 ? std::sqrt(error / light) : 0;
  }

  const Scene &scene_;
  const RenderPlan &plan_;
  const RenderOptions &options_;
  std::shared_ptr<Device> device_;
  std::shared_ptr<SkySight> sight_;
  SunPlace sun_;
  SkyLight light_;
  SpectralImage image_;
  RenderReport report_;
  OneRank alone_;
  std::optional<SkyRun> run_;
};

}  // namespace

void request_stop() { stop_flag = true; }
bool stop_requested() { return stop_flag; }
void stop_if_asked() {
  if (stop_flag) throw Interrupted();
}

Rendered render(const Scene &scene, const RenderPlan &plan, const RenderOptions &options,
                const std::shared_ptr<Device> &device) {
  return Renderer(scene, plan, options, device).run();
}

}  // namespace greenray
