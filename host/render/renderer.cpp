#include "render/renderer.hpp"

#include <atomic>
#include <chrono>
#include <cmath>

#include "render/host_rays.hpp"
#include "render/sky.hpp"
#include "render/sky_own_rays.hpp"
#include "render/sky_picture.hpp"
#include "render/sun_place.hpp"
#include "render/transfer_curve.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::atomic<bool> stop_flag{false};

constexpr std::size_t lookup_probes = 64;
constexpr std::size_t cached_bytes = std::size_t{8} << 20;  // a band of this size is still in cache when it is read

class Renderer {
 public:
  Renderer(const Scene &scene, const RenderPlan &plan, const RenderOptions &options, std::shared_ptr<Device> device)
      : scene_(scene),
        plan_(plan),
        options_(options),
        device_(std::move(device)),
        air_(spec_for(scene, options)),
        flat_(scene.atmosphere.surface == Surface::flat) {}

  Rendered run() {
    const auto begin = Clock::now();
    progress("table", 0);
    reference_ = reference_ray(scene_, air_);
    if (plan_.section) rays_.emplace(air_, plan_.bent_nm, ray_options(), device_);
    else rays_.emplace(air_.at(0), plan_.bent_nm, ray_options(), device_);
    report_.table_cells = rays_->cells();
    report_.table_bound_arcsec = rays_->table_bound_arcsec();
    place_sun();
    measure_table();
    report_.build_seconds = seconds_since(begin);
    trace_table();
    shade();
    report_.compile_seconds = device_->compile_seconds();
    report_.emit_seconds = std::max(0.0, report_.emit_seconds - compiled_while_tracing_);
    return {std::move(image_), report_};
  }

 private:
  void progress(const std::string &phase, double fraction, double noise = 0) {
    stop_if_asked();
    if (options_.progress) options_.progress(phase, fraction, noise);
  }

  void place_sun() {
    const std::optional<double> horizon = horizon_rad(reference_);
    if (horizon) report_.horizon_altitude_deg = to_deg(*horizon);
    sun_ = place_of_sun(scene_, reference_);
    if (!sun_.shines) return;
    report_.sun_true_altitude_deg = to_deg(sun_.true_altitude_rad);
    if (const auto seen = apparent_altitude_rad(reference_, sun_.true_altitude_rad, horizon))
      report_.sun_apparent_altitude_deg = to_deg(*seen);
  }

  /// Error of the table: its rays against those of a table thirty times finer, in double on the host. Error of the
  /// layers: the device's rays against those in double by steps through the same table.
  void measure_table() {
    const std::size_t row = plan_.bent_nm.size() / 2;
    const HostRay through_table = rays_->on_host(row);
    const HostRay through_fine = finer_ray(plan_.bent_nm[row]);
    std::vector<double> elevations;
    for (int i = 0; i < 48; ++i)
      elevations.push_back(to_rad(plan_.first_elevation_deg) +
                           from_arcsec(plan_.spacing_arcsec) * static_cast<double>(plan_.entries - 1) * (i + 0.5) / 48);
    const std::vector<f64::RayEnd> ours = rays_->trace(elevations);
    const auto worse = [](double &worst, const f64::RayEnd &a, const f64::RayEnd &b) {
      if (a.outcome == f64::RAY_SPACE && b.outcome == f64::RAY_SPACE)
        worst = std::max(worst, to_arcsec(std::abs(a.bending_rad - b.bending_rad)));
    };
    for (std::size_t i = 0; i < elevations.size(); ++i) {
      const f64::RayEnd a = through_table(elevations[i]);
      worse(report_.table_arcsec, a, through_fine(elevations[i]));
      if (measures_solver()) worse(report_.solver_arcsec, a, ours[i * plan_.bent_nm.size() + row]);
    }
  }

  /// Steps through layers tell their own error, an upper bound; that of the others is measured.
  bool measures_solver() const { return plan_.method == RayMethod::cells || plan_.section; }

  /// Rays through a much finer table.
  HostRay finer_ray(double wavelength_nm) const {
    const double height_m = scene_.observer.height_m, error_arcsec = rays_->index_error_arcsec() / 30;
    if (!plan_.section)
      return host_ray(build_index_table(air_.at(0), {wavelength_nm}, {flat_, error_arcsec, height_m}), 0, height_m);
    return host_ray(build_section_table(section_medium(air_, flat_), {wavelength_nm}, {error_arcsec, height_m}), 0,
                    {0, height_m}, plan_.azimuth_from_path_rad);
  }

  SkyRayOptions ray_options() const {
    SkyRayOptions rays;
    rays.height_m = scene_.observer.height_m;
    rays.flat = flat_;
    rays.method = plan_.method;
    rays.azimuth_rad = plan_.azimuth_from_path_rad;
    rays.precision = plan_.precision;
    rays.error_arcsec = scene_.tracing.table_arcsec;
    rays.step_rad = scene_.tracing.tolerance;
    rays.max_steps = scene_.tracing.max_steps;
    rays.absorbers = {ozone_peak_m, ozone_width_m, scene_.atmosphere.aerosol_scale_height_m};
    return rays;
  }

  void trace_table() {
    progress("rays", 0);
    const auto begin = Clock::now();
    const double compiled_before = device_->compile_seconds();
    const double low = to_rad(plan_.first_elevation_deg), spacing = from_arcsec(plan_.spacing_arcsec);
    const double high = low + spacing * static_cast<double>(plan_.entries - 1);
    const TransferCurve curve = trace_transfer_curve(*rays_, low, std::min(high, pi / 2), scene_.tracing.table_arcsec);
    report_.curve_entries = curve.elevation_rad.size();
    transfer_ = evenly_spaced(curve, low, spacing, plan_.entries);
    find_sun_in(curve);
    report_.trace = rays_->stats();  // of the picture's own rays; those below are measurements
    probes_ = probe_between(*rays_, transfer_, lookup_probes);
    report_.lookup_arcsec = lookup_error_arcsec(transfer_, probes_);
    light_ = {scene_.sky, sun_, rays_at(sunlight_altitude_deg()), rays_at(10),
              spectral_air(scene_, plan_.wavelengths_nm)};
    share_wavelengths();
    report_.table_in_image = rays_->table_in_image();
    if (!measures_solver()) report_.solver_arcsec = to_arcsec(report_.trace.solver_error_rad);
    compiled_while_tracing_ = device_->compile_seconds() - compiled_before;
    report_.emit_seconds = seconds_since(begin);
  }

  /// Through a duct the Sun may be seen far from where iteration looks for it: then as the curve shows it.
  void find_sun_in(const TransferCurve &curve) {
    if (!plan_.section || !sun_.shines || report_.sun_apparent_altitude_deg) return;
    const std::vector<Image> images = images_of(curve, plan_.bent_nm.size() / 2, sun_.true_altitude_rad);
    if (!images.empty()) report_.sun_apparent_altitude_deg = images.front().apparent_altitude_deg;
  }

  void share_wavelengths() {
    const std::size_t bent = plan_.bent_nm.size(), wanted = plan_.wavelengths_nm.size();
    transfer_.rays = for_all_wavelengths(transfer_.rays, bent, wanted);
    transfer_.edges = for_all_wavelengths(transfer_.edges, bent, wanted);
    probes_.rays = for_all_wavelengths(probes_.rays, bent, wanted);
    transfer_.wavelengths = wanted;
  }

  std::vector<Transfer> rays_at(double altitude_deg) {
    const TransferTable traced = trace_elevations(*rays_, {to_rad(altitude_deg)});
    return for_all_wavelengths(traced.rays, traced.wavelengths, plan_.wavelengths_nm.size());
  }

  /// Where the Sun is seen; below the horizon, just above it: a few arc-seconds, for each wavelength has its own
  /// horizon.
  double sunlight_altitude_deg() const {
    constexpr double clear_of_the_ground_deg = 5.0 / 3600;
    const double seen_deg = report_.sun_apparent_altitude_deg.value_or(to_deg(sun_.true_altitude_rad));
    if (!report_.horizon_altitude_deg) return report_.sun_apparent_altitude_deg.value_or(std::max(seen_deg, 0.0));
    return std::max(seen_deg, *report_.horizon_altitude_deg + clear_of_the_ground_deg);
  }

  f32::SkyView view() const {
    const double altitude = to_rad(scene_.observer.altitude_deg);
    f32::SkyView v{};
    v.sin_altitude = static_cast<float>(std::sin(altitude));
    v.cos_altitude = static_cast<float>(std::cos(altitude));
    v.pixel_tangent = static_cast<float>(2 * std::tan(to_rad(scene_.observer.fov_deg) / 2) / plan_.size[0]);
    v.centre_column = 0.5f * static_cast<float>(plan_.size[0]);
    v.centre_row = 0.5f * static_cast<float>(plan_.size[1]);
    v.first_elevation_rad = static_cast<float>(transfer_.first_elevation_rad);
    v.entries_per_rad = static_cast<float>(1 / transfer_.spacing_rad);
    v.sun_azimuth_rad = static_cast<float>(sun_.azimuth_rad);
    v.sun_sin_altitude = static_cast<float>(std::sin(sun_.true_altitude_rad));
    v.sun_cos_altitude = static_cast<float>(std::cos(sun_.true_altitude_rad));
    v.sun_radius_rad = static_cast<float>(sun_.radius_rad);
    v.phase_asymmetry = static_cast<float>(aerosol_asymmetry);
    v.entries = static_cast<int>(transfer_.entries);
    v.width = plan_.crop[2] - plan_.crop[0];
    v.first_column = plan_.crop[0];
    v.seed = static_cast<unsigned int>(options_.seed ^ (options_.seed >> 32));
    return v;
  }

  void shade() {
    const auto begin = Clock::now();
    const double compiled_before = device_->compile_seconds();
    const int waves = padded_waves(*device_, static_cast<int>(plan_.wavelengths_nm.size()));
    const SkyTable sky = make_sky_table(light_, transfer_, waves);
    const std::size_t middle = light_.air.size() / 2;
    if (sun_.shines) report_.sun_optical_depth = optical_depth(light_.towards_sun[middle], light_.air[middle]);
    measure_bias(sky, waves);
    SkyPicture picture(plan_);
    if (plan_.per_pixel) shade_per_pixel(picture);
    else shade_from_table(sky, picture);
    picture.describe(view(), transfer_);
    report_.noise_rms = picture.noise_rms();
    image_ = picture.take();
    report_.gather_seconds = seconds_since(begin) - (device_->compile_seconds() - compiled_before);
  }

  void shade_per_pixel(SkyPicture &picture) {
    report_.spp = plan_.spp;
    shade_with_own_rays(*rays_, light_, view(), plan_, picture, [&](double done) { progress("picture", done); });
    report_.trace = rays_->stats();
    report_.lookup_arcsec = report_.bias = 0;
  }

  void shade_from_table(const SkyTable &sky, SkyPicture &picture) {
    const int rows = rows_of_band(sky, picture);
    SkyShader shader(device_, sky, picture.width(), rows);
    f32::SkyView v = view();
    for (int first = 0; first < picture.height(); first += rows) {
      v.first_row = plan_.crop[1] + first;
      v.rows = std::min(rows, picture.height() - first);
      shade_band(shader, v, picture);
    }
  }

  bool adaptive() const { return plan_.error_pct || plan_.minutes; }

  /// As many rows as the device has memory for; with a fixed number of samples no more than its caches like.
  int rows_of_band(const SkyTable &sky, const SkyPicture &picture) const {
    const std::size_t row_bytes = SkyShader::band_bytes(picture.width(), 1, sky.waves);
    const std::size_t fixed = (sky.values.size() + sky.limb.size()) * sizeof(float) + device_->used_bytes();
    const std::size_t left = device_->budget_bytes() > fixed ? (device_->budget_bytes() - fixed) / 10 * 9 : 0;
    std::size_t most = std::min(left, device_->info().largest_buffer_bytes);
    if (!adaptive() && device_->info().is_cpu) most = std::min(most, cached_bytes);
    return static_cast<int>(std::clamp<std::size_t>(most / row_bytes, 1, static_cast<std::size_t>(picture.height())));
  }

  /// Passes of a few samples until enough, good enough or late enough; each band decides for itself.
  void shade_band(SkyShader &shader, const f32::SkyView &v, SkyPicture &picture) {
    shader.begin(v);
    const int first_row = v.first_row - plan_.crop[1], wanted = plan_.spp;
    const double before = static_cast<double>(first_row) / picture.height();
    const double share = static_cast<double>(v.rows) / picture.height();
    const auto begin = Clock::now();
    int samples = 0;
    double noise = 0;
    while (samples < wanted) {
      const int pass = std::min(adaptive() ? std::max(4, samples / 2) : 8, wanted - samples);
      shader.add_samples(samples, pass, stop_if_asked);
      samples += pass;
      if (adaptive()) {
        shader.with_sums([&](const SkySums &sums) { noise = relative_noise(sums, samples); });
        if (plan_.error_pct && noise * 100 <= *plan_.error_pct) break;
        if (plan_.minutes && seconds_since(begin) >= *plan_.minutes * 60 * share) break;
      }
      progress("picture", before + share * samples / wanted, noise);
    }
    report_.spp = std::max(report_.spp, samples);
    shader.with_sums([&](const SkySums &sums) { picture.keep(sums, first_row, v.rows, samples); });
  }

  /// Relative RMS error of radiance (Sun and glow) that interpolating the table half way causes.
  void measure_bias(const SkyTable &sky, int waves) {
    TransferTable between = transfer_;
    between.entries = probes_.below.size();
    between.rays = probes_.rays;
    const SkyTable truth = make_sky_table(light_, between, waves);
    const auto n = static_cast<std::size_t>(waves), entry = n * f32::SKY_CHANNEL_COUNT;
    double error = 0, light = 0;
    for (std::size_t k = 0; k < between.entries; ++k)
      for (std::size_t w = 0; w < light_.air.size(); ++w) {
        const float *a = &sky.values[probes_.below[k] * entry + w], *b = a + entry, *t = &truth.values[k * entry + w];
        if (a[f32::SKY_JOINED * n] < 1.0f) continue;
        for (std::size_t c : {f32::SKY_SUN * n, f32::SKY_GLOW * n}) {
          const double difference = 0.5 * (static_cast<double>(a[c]) + b[c]) - t[c];
          error += difference * difference;
          light += static_cast<double>(t[c]) * t[c];
        }
      }
    report_.bias = light > 0 ? std::sqrt(error / light) : 0;
  }

  const Scene &scene_;
  const RenderPlan &plan_;
  const RenderOptions &options_;
  std::shared_ptr<Device> device_;
  AirSection air_;
  bool flat_;
  HostRay reference_;
  std::optional<SkyRays> rays_;
  SunPlace sun_;
  TransferTable transfer_;
  TransferProbes probes_;
  SkyLight light_;
  SpectralImage image_;
  RenderReport report_;
  double compiled_while_tracing_ = 0;
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
