#include "render/renderer.hpp"

#include <atomic>
#include <chrono>
#include <cmath>

#include "render/host_rays.hpp"
#include "render/sky.hpp"
#include "render/sun_place.hpp"
#include "render/transfer_curve.hpp"
#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::atomic<bool> stop_flag{false};

constexpr std::size_t lookup_probes = 64;

class Renderer {
 public:
  Renderer(const Scene &scene, const RenderPlan &plan, const RenderOptions &options, std::shared_ptr<Device> device)
      : scene_(scene),
        plan_(plan),
        options_(options),
        device_(std::move(device)),
        profile_(spec_for(scene, options)),
        flat_(scene.atmosphere.surface == Surface::flat) {}

  Rendered run() {
    const auto begin = Clock::now();
    progress("table", 0);
    reference_ = reference_table(scene_, profile_);
    rays_.emplace(profile_, plan_.bent_nm, ray_options(), device_);
    report_.table_cells = rays_->cells();
    report_.table_bound_arcsec = rays_->table().bound_arcsec;
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
    const std::optional<double> horizon = horizon_rad(reference_, scene_.observer.height_m);
    if (horizon) report_.horizon_altitude_deg = to_deg(*horizon);
    sun_ = place_of_sun(scene_, reference_);
    if (!sun_.shines) return;
    report_.sun_true_altitude_deg = to_deg(sun_.true_altitude_rad);
    if (const auto seen = apparent_altitude_rad(reference_, scene_.observer.height_m, sun_.true_altitude_rad, horizon))
      report_.sun_apparent_altitude_deg = to_deg(*seen);
  }

  /// Error of the table: its rays against those of a table thirty times finer, in double on the host. Error of the
  /// layers: the device's rays against those in double by steps through the same table.
  void measure_table() {
    const std::size_t row = plan_.bent_nm.size() / 2;
    const IndexTable &table = rays_->table();
    const IndexTable fine = build_index_table(profile_, {plan_.bent_nm[row]},
                                              {flat_, scene_.tracing.table_arcsec / 30, scene_.observer.height_m});
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
      const f64::RayEnd a = trace_on_host(table, row, scene_.observer.height_m, elevations[i]);
      worse(report_.table_arcsec, a, trace_on_host(fine, 0, scene_.observer.height_m, elevations[i]));
      if (plan_.method == RayMethod::cells) worse(report_.solver_arcsec, a, ours[i * plan_.bent_nm.size() + row]);
    }
  }

  SkyRayOptions ray_options() const {
    SkyRayOptions rays;
    rays.height_m = scene_.observer.height_m;
    rays.flat = flat_;
    rays.method = plan_.method;
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
    report_.trace = rays_->stats();  // of the picture's own rays; those below are measurements
    probes_ = probe_between(*rays_, transfer_, lookup_probes);
    report_.lookup_arcsec = lookup_error_arcsec(transfer_, probes_);
    towards_sun_ = for_all_wavelengths(trace_elevations(*rays_, {to_rad(sunlight_altitude_deg())}).rays);
    at_10_degrees_ = for_all_wavelengths(trace_elevations(*rays_, {to_rad(10)}).rays);
    share_wavelengths();
    report_.table_in_image = rays_->table_in_image();
    if (plan_.method != RayMethod::cells) report_.solver_arcsec = to_arcsec(report_.trace.solver_error_rad);
    compiled_while_tracing_ = device_->compile_seconds() - compiled_before;
    report_.emit_seconds = seconds_since(begin);
  }

  /// Where one wavelength's rays serve all: as many copies.
  template <class Value>
  std::vector<Value> for_all_wavelengths(const std::vector<Value> &values) const {
    if (plan_.bent_nm.size() == plan_.wavelengths_nm.size()) return values;
    std::vector<Value> all;
    all.reserve(values.size() * plan_.wavelengths_nm.size());
    for (const Value &value : values) all.insert(all.end(), plan_.wavelengths_nm.size(), value);
    return all;
  }

  void share_wavelengths() {
    transfer_.rays = for_all_wavelengths(transfer_.rays);
    transfer_.edges = for_all_wavelengths(transfer_.edges);
    probes_.rays = for_all_wavelengths(probes_.rays);
    transfer_.wavelengths = plan_.wavelengths_nm.size();
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
    const std::vector<SpectralAir> air = spectral_air(scene_, plan_.wavelengths_nm);
    const int waves = padded_waves(*device_, static_cast<int>(plan_.wavelengths_nm.size()));
    const SkyTable sky = make_sky_table(scene_, transfer_, towards_sun_, at_10_degrees_, air, sun_, waves);
    if (sun_.shines) report_.sun_optical_depth = optical_depth(towards_sun_[air.size() / 2], air[air.size() / 2]);
    measure_bias(sky, air, waves);
    if (plan_.per_pixel) {
      shade_per_pixel(air);
      report_.gather_seconds = seconds_since(begin) - (device_->compile_seconds() - compiled_before);
      return;
    }
    const int width = plan_.crop[2] - plan_.crop[0], height = plan_.crop[3] - plan_.crop[1];
    const std::size_t row_bytes = SkyShader::band_bytes(width, 1, waves);
    const std::size_t fixed = (sky.values.size() + sky.limb.size()) * sizeof(float) + device_->used_bytes();
    const std::size_t left = device_->budget_bytes() > fixed ? (device_->budget_bytes() - fixed) / 10 * 9 : 0;
    const std::size_t largest = std::min(left, device_->info().largest_buffer_bytes);
    const int rows =
        static_cast<int>(std::clamp<std::size_t>(largest / row_bytes, 1, static_cast<std::size_t>(height)));
    SkyShader shader(device_, sky, width, rows);

    size_image();
    f32::SkyView v = view();
    for (int first = 0; first < height; first += rows) {
      v.first_row = plan_.crop[1] + first;
      v.rows = std::min(rows, height - first);
      shade_band(shader, v, static_cast<double>(first) / height, static_cast<double>(v.rows) / height);
    }
    finish_image();
    report_.gather_seconds = seconds_since(begin) - (device_->compile_seconds() - compiled_before);
  }

  void size_image() {
    image_.width = plan_.crop[2] - plan_.crop[0];
    image_.height = plan_.crop[3] - plan_.crop[1];
    image_.wavelength_nm = plan_.wavelengths_nm;
    image_.radiance.resize(image_.pixels() * plan_.wavelengths_nm.size());
    image_.channels["variance"].resize(image_.pixels());
  }

  void finish_image() {
    describe_pixels();
    const double pixels = static_cast<double>(image_.pixels());
    report_.noise_rms = band_sum_ > 0 ? std::sqrt(variance_sum_ / pixels) / (band_sum_ / pixels) : 0;
  }

  /// For comparison with the transfer table: every sample of every pixel traces its own rays on the device.
  void shade_per_pixel(const std::vector<SpectralAir> &air) {
    size_image();
    report_.spp = plan_.spp;
    f32::SkyView v = view();
    v.rows = 1;
    for (int row = 0; row < image_.height; ++row) {
      v.first_row = plan_.crop[1] + row;
      const std::size_t waves = air.size(), width = static_cast<std::size_t>(image_.width);
      SkyShader::Sums sums{std::vector<float>(width * waves), std::vector<float>(width * 2)};
      for (int sample = 0; sample < plan_.spp; ++sample) add_own_rays(air, v, sample, sums);
      keep(sums, v, plan_.spp);
      progress("picture", static_cast<double>(row + 1) / image_.height);
    }
    report_.trace = rays_->stats();
    report_.lookup_arcsec = report_.bias = 0;
    finish_image();
  }

  /// One sample of one row, each pixel with rays of its own; the same shading text as the kernel, on the host.
  void add_own_rays(const std::vector<SpectralAir> &air, const f32::SkyView &v, int sample, SkyShader::Sums &sums) {
    std::vector<double> elevations;
    std::vector<float> azimuths;
    for (int column = 0; column < v.width; ++column) {
      float x, y;
      f32::sample_place(&v, v.first_column + column, v.first_row, sample, &x, &y);
      const f32::SkyDirection d = f32::view_direction(&v, x, y);
      elevations.push_back(static_cast<double>(d.elevation_rad));
      azimuths.push_back(d.azimuth_rad);
    }
    elevations.push_back(elevations.back());  // look-up reads one entry further
    TransferTable own = trace_elevations(*rays_, elevations);
    own.rays = for_all_wavelengths(own.rays);
    own.wavelengths = air.size();
    const int waves = static_cast<int>(air.size());
    const SkyTable sky = make_sky_table(scene_, own, towards_sun_, at_10_degrees_, air, sun_, waves);
    for (int column = 0; column < v.width; ++column) {
      float band = 0;
      for (int w = 0; w < waves; ++w) {
        const float radiance = f32::sky_radiance(&v, sky.values.data(), sky.limb.data(), waves, w, column, 0,
                                                 azimuths[static_cast<std::size_t>(column)]);
        sums.spectra[static_cast<std::size_t>(column * waves + w)] += radiance;
        band += radiance;
      }
      sums.moments[static_cast<std::size_t>(2 * column)] += band;
      sums.moments[static_cast<std::size_t>(2 * column + 1)] += band * band;
    }
  }

  /// Passes of a few samples until enough, good enough or late enough; each band decides for itself.
  void shade_band(SkyShader &shader, const f32::SkyView &v, double done_before, double share) {
    shader.begin(v);
    int samples = 0;
    SkyShader::Sums sums;
    const auto begin = Clock::now();
    const int wanted = plan_.spp;
    const bool adaptive = plan_.error_pct || plan_.minutes;
    double noise = 0;
    while (samples < wanted) {
      const int pass = std::min(adaptive ? std::max(4, samples / 2) : 8, wanted - samples);
      shader.add_samples(samples, pass, stop_if_asked);
      samples += pass;
      if (adaptive) {
        noise = relative_noise(shader.read(), samples);
        if (plan_.error_pct && noise * 100 <= *plan_.error_pct) break;
        if (plan_.minutes && seconds_since(begin) >= *plan_.minutes * 60 * share) break;
      }
      progress("picture", done_before + share * samples / wanted, noise);
    }
    report_.spp = std::max(report_.spp, samples);
    keep(shader.read(), v, samples);
  }

  static double relative_noise(const SkyShader::Sums &sums, int samples) {
    double variance = 0, band = 0;
    for (std::size_t i = 0; i < sums.moments.size() / 2; ++i) {
      variance += variance_of_mean(sums, i, samples);
      band += sums.moments[2 * i] / static_cast<double>(samples);
    }
    const double pixels = static_cast<double>(sums.moments.size()) / 2;
    return band > 0 ? std::sqrt(variance / pixels) / (band / pixels) : 0;
  }

  static double variance_of_mean(const SkyShader::Sums &sums, std::size_t pixel, int samples) {
    if (samples < 2) return 0;
    const double mean = sums.moments[2 * pixel] / static_cast<double>(samples);
    const double square = sums.moments[2 * pixel + 1] / static_cast<double>(samples);
    return std::max(0.0, square - mean * mean) / (samples - 1);
  }

  void keep(const SkyShader::Sums &sums, const f32::SkyView &v, int samples) {
    const std::size_t waves = plan_.wavelengths_nm.size(), pixels = static_cast<std::size_t>(v.width * v.rows);
    const std::size_t padded = sums.spectra.size() / pixels;
    const std::size_t first = static_cast<std::size_t>(v.first_row - plan_.crop[1]) * static_cast<std::size_t>(v.width);
    const float scale = 1.0f / static_cast<float>(samples);
    std::vector<float> &variances = image_.channels["variance"];
    const double bands = static_cast<double>(waves);
    for_pieces(pixels, 4096, host_threads(), [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) {
        for (std::size_t w = 0; w < waves; ++w)
          image_.radiance[(first + i) * waves + w] = sums.spectra[i * padded + w] * scale;
        variances[first + i] = static_cast<float>(variance_of_mean(sums, i, samples) / (bands * bands));
      }
    });
    for (std::size_t i = 0; i < pixels; ++i) {  // in one order, for the same bits
      variance_sum_ += variance_of_mean(sums, i, samples);
      band_sum_ += sums.moments[2 * i] * scale;
    }
  }

  /// Relative RMS error of radiance (Sun and glow) that interpolating the table half way causes.
  void measure_bias(const SkyTable &sky, const std::vector<SpectralAir> &air, int waves) {
    TransferTable between = transfer_;
    between.entries = probes_.below.size();
    between.rays = probes_.rays;
    const SkyTable truth = make_sky_table(scene_, between, towards_sun_, at_10_degrees_, air, sun_, waves);
    const auto n = static_cast<std::size_t>(waves), entry = n * f32::SKY_CHANNEL_COUNT;
    double error = 0, light = 0;
    for (std::size_t k = 0; k < between.entries; ++k)
      for (std::size_t w = 0; w < air.size(); ++w) {
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

  /// Channels for the pixel centres at the middle wavelength: bending, distance, lowest point.
  void describe_pixels() {
    auto &bending = image_.channels["bending_arcsec"], &distance = image_.channels["distance_m"],
         &lowest = image_.channels["min_height_m"];
    bending.resize(image_.pixels());
    distance.resize(image_.pixels());
    lowest.resize(image_.pixels());
    const f32::SkyView v = view();
    const std::size_t wave = plan_.wavelengths_nm.size() / 2;
    const auto describe = [&](std::size_t i) {
      const int x = static_cast<int>(i) % image_.width, y = static_cast<int>(i) / image_.width;
      const f32::SkyDirection d = f32::view_direction(&v, static_cast<float>(x + plan_.crop[0]) + 0.5f,
                                                      static_cast<float>(y + plan_.crop[1]) + 0.5f);
      const double at = (static_cast<double>(d.elevation_rad) - transfer_.first_elevation_rad) / transfer_.spacing_rad;
      const auto entry = static_cast<std::size_t>(std::clamp(std::round(at), 0.0, double(transfer_.entries - 1)));
      const Transfer &t = transfer_.at(entry, wave);
      bending[i] = static_cast<float>(to_arcsec(t.bending_rad));
      distance[i] = static_cast<float>(t.distance_m);
      lowest[i] = static_cast<float>(t.min_height_m);
    };
    for_pieces(image_.pixels(), 4096, host_threads(), [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i) describe(i);
    });
  }

  const Scene &scene_;
  const RenderPlan &plan_;
  const RenderOptions &options_;
  std::shared_ptr<Device> device_;
  Profile profile_;
  bool flat_;
  IndexTable reference_;
  std::optional<SkyRays> rays_;
  SunPlace sun_;
  TransferTable transfer_;
  TransferProbes probes_;
  std::vector<Transfer> towards_sun_, at_10_degrees_;
  SpectralImage image_;
  RenderReport report_;
  double variance_sum_ = 0, band_sum_ = 0, compiled_while_tracing_ = 0;
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
