#include "render/room.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "atmosphere/profile.hpp"
#include "render/photon_mapper.hpp"
#include "render/room_error.hpp"
#include "render/room_looks.hpp"
#include "scene/bvh.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

double diagonal_m(const surface32::GeometryBounds &b) {
  return std::hypot(static_cast<double>(b.high[0] - b.low[0]), static_cast<double>(b.high[1] - b.low[1]),
                    static_cast<double>(b.high[2] - b.low[2]));
}

double area_m2(const Surfaces &surfaces) {
  double area = 0;
  for (const Triangle &t : surfaces.triangles) area += length(t.area_vector_m2());
  for (const Sphere &s : surfaces.spheres) area += 4 * M_PI * s.radius_m * s.radius_m;
  return area;
}

/// Do wavelengths part on the way through the medium by more than a two-hundredth of the scene? bend, averaged over the
/// heights, times the square of the way.
bool medium_disperses(const AirTable &air, double reach_m) {
  double parting = 0, height_m = 0;
  for (std::size_t c = 1; c + 1 < air.cells; ++c) {
    double low = 1e300, high = -1e300;
    for (std::size_t w = 0; w < air.wavelength_nm.size(); ++w) {
      const double bend = air.rows[w * air.cells + c].bend;
      low = std::min(low, bend), high = std::max(high, bend);
    }
    const double thickness_m = air.rows[c + 1].bottom_m - air.rows[c].bottom_m;
    parting += (high - low) * thickness_m, height_m += thickness_m;
  }
  return height_m > 0 && parting / height_m * reach_m > 5e-3;
}

bool has_specular(const RoomScene &scene) {
  return std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const MaterialScene &m) { return m.kind != MaterialScene::Kind::lambert; });
}

room_twin::EyeCamera camera_of(const RoomScene &scene, const std::array<int, 2> &size) {
  room_twin::EyeCamera c{};
  const CameraScene &from = scene.camera;
  const Triple ahead = unit(from.to - from.from), right = unit(cross(ahead, from.up)), up = cross(right, ahead);
  for (std::size_t a = 0; a < 3; ++a) {
    c.place[a] = static_cast<float>(from.from[a]);
    c.ahead[a] = static_cast<float>(ahead[a]);
    c.right[a] = static_cast<float>(right[a]);
    c.up[a] = static_cast<float>(up[a]);
  }
  c.pixel_tangent = static_cast<float>(2 * std::tan(from.fov_deg * M_PI / 360) / size[0]);
  c.centre_column = 0.5f * static_cast<float>(size[0]);
  c.centre_row = 0.5f * static_cast<float>(size[1]);
  c.width = size[0], c.rows = size[1];
  c.most_bounces = 32;
  return c;
}

/// The state of one render.
class Room {
 public:
  Room(const RoomScene &scene, const RoomOptions &options, const std::shared_ptr<Device> &device)
      : scene_(scene), options_(options), device_(device), size_(options.size), looks_(room_looks(scene)) {
    const auto begin = Clock::now();
    const double compiled = device->compile_seconds();
    air_ = room_air(scene, looks_.wavelength_nm, options.straight);
    tree_ = build_surface_tree(scene.surfaces, SurfaceScene::lanes_for(*device));
    tracer_ = std::make_unique<RoomTracer>(device, tree_, air_, looks_);
    out_.report.table_arcsec = room_table_error_arcsec(air_, diagonal_m(tree_.bounds));
    out_.report.solver_arcsec = room_solver_error_arcsec(*tracer_, air_, scene.camera);
    alone_ = medium_disperses(air_, diagonal_m(tree_.bounds));
    out_.report.triangles = scene.surfaces.triangles.size(), out_.report.spheres = scene.surfaces.spheres.size();
    out_.report.air_cells = air_.cells, out_.report.table_error_m = air_.error_m;
    out_.report.build_seconds = seconds_since(begin) - (device->compile_seconds() - compiled);
    compiled_before_ = compiled;
  }

  RoomPicture render() {
    out_.report.passes = options_.passes;
    out_.report.spp = std::max(options_.spp, options_.passes) / options_.passes * options_.passes;
    samples_ = out_.report.spp / options_.passes;
    begin_picture();
    for (int pass = 0; pass < options_.passes; ++pass) {
      stop_if_asked();
      say("photons", pass, 0);
      trace_photons(pass);
      say("picture", pass, 0.5);
      gather(pass);
    }
    finish();
    out_.report.compile_seconds = device_->compile_seconds() - compiled_before_;
    return std::move(out_);
  }

 private:
  void say(const char *phase, int pass, double part) const {
    if (options_.progress) options_.progress(phase, (pass + part) / options_.passes);
  }

  std::uint32_t photons_of(int pass) const {
    const std::int64_t n = scene_.photons.emitted, p = options_.passes;
    return static_cast<std::uint32_t>((pass + 1) * n / p - pass * n / p);
  }

  PhotonBatch batch_of(int pass) const {
    PhotonBatch batch;
    batch.seed = options_.seed, batch.pass = static_cast<std::uint32_t>(pass), batch.photons = photons_of(pass);
    batch.chunk = chunk_;
    batch.most_bounces = scene_.photons.most_bounces;
    batch.alone = alone_;
    return batch;
  }

  /// Slots for each chunk from sixteen samples of the photons; a chunk that needs more makes the pass be run again.
  std::array<int, 2> slots_for(const PhotonBatch &batch) {
    std::array<int, 2> most{0, 0};
    const std::uint32_t part = std::min<std::uint32_t>(batch.photons, static_cast<std::uint32_t>(4 * batch.chunk));
    for (std::uint32_t i = 0; i < 16; ++i) {
      PhotonBatch sample = batch;
      sample.first = static_cast<std::uint32_t>(static_cast<std::uint64_t>(batch.photons - part) * i / 15);
      sample.photons = part;
      tracer_->count(sample, most);
    }
    std::array<int, 2> slots{most[0] + most[0] / 4 + 16, most[1] + most[1] / 2 + 16};
    if (!has_specular(scene_)) slots[1] = 0;
    return slots;
  }

  void make_mapper(const PhotonBatch &batch) {
    mapper_.reset();
    PhotonMapperOptions o;
    o.waves = static_cast<int>(looks_.waves());
    o.diffuse_photons = (batch.chunks() + most_doublings) * static_cast<std::size_t>(slots_[0]);
    o.caustic_photons = (batch.chunks() + most_doublings) * static_cast<std::size_t>(slots_[1]);
    for (std::size_t a = 0; a < 3; ++a) {
      o.bounds.low_m[a] = static_cast<double>(tree_.bounds.low[a]);
      o.bounds.high_m[a] = static_cast<double>(tree_.bounds.high[a]);
    }
    const int k = std::max(8, (scene_.photons.gather + options_.passes - 1) / options_.passes);
    o.nearest = scene_.photons.radius_m ? 0 : k;
    o.caustic_nearest = scene_.photons.radius_m ? 0 : std::max(8, k / 2);
    // The radius of k photons, were they spread evenly over everything; four times that at most.
    const double even_m = std::sqrt(k * area_m2(scene_.surfaces) / (M_PI * batch.photons));
    o.most_radius_m = scene_.photons.radius_m.value_or(std::min(4 * even_m, 0.2 * diagonal_m(tree_.bounds)));
    o.columns = static_cast<std::size_t>(size_[0]), o.samples = static_cast<std::size_t>(samples_);
    o.cover = [this](std::span<const GatherPoint> places, std::span<const float> radius_m) {
      return find_cover(places, radius_m);
    };
    mapper_ = std::make_unique<PhotonMapper>(device_, o);
    if (!no_caustic_) no_caustic_ = std::make_unique<PhotonMap>(device_, PhotonMapOptions{1, o.waves, 0, 0});
  }

  /// Only of places that ask; the others stand far off.
  std::vector<GatherCover> find_cover(std::span<const GatherPoint> places, std::span<const float> radius_m) {
    const auto begin = Clock::now();
    const double compiled = device_->compile_seconds();
    const PhotonMapperOptions defaults;
    const std::vector<room_twin::Cover> found =
        tracer_->cover(places, radius_m, defaults.flatness, std::cos(defaults.facing_deg * M_PI / 180));
    std::vector<GatherCover> covers;
    for (const room_twin::Cover &c : found) covers.push_back({c.whole, c.inner});
    out_.report.cover_seconds += seconds_since(begin) - (device_->compile_seconds() - compiled);
    return covers;
  }

  void trace_photons(int pass) {
    PhotonBatch batch = batch_of(pass);
    share_photons(looks_, batch.photons);
    tracer_->set_lights(looks_.lights);
    if (!mapper_) {
      slots_ = slots_for(batch);
      make_mapper(batch);
    }
    for (;;) {
      batch.slots = slots_;
      PhotonMap *caustic = mapper_->caustic();
      std::array<int, 2> most{};
      if (tracer_->store(batch, mapper_->diffuse(), caustic ? *caustic : *no_caustic_, out_.report.photons, most))
        break;
      if (pass > 0) {  // the same room in chunks twice as long, which differ less from each other
        if (chunk_ >= first_chunk * static_cast<int>(most_doublings))
          throw RunError("photons of a later pass need more room than those of the first: give more photons a pass");
        chunk_ *= 2, batch.chunk = chunk_;
        for (int &slots : slots_) slots *= 2;
        continue;
      }
      for (std::size_t i = 0; i < 2; ++i) slots_[i] = std::max(slots_[i], most[i] + most[i] / 4);
      make_mapper(batch);
    }
    records_ = {batch.chunks() * static_cast<std::size_t>(slots_[0]),
                batch.chunks() * static_cast<std::size_t>(slots_[1])};
  }

  void begin_picture() {
    out_.image.width = size_[0], out_.image.height = size_[1];
    out_.image.wavelength_nm = looks_.wavelength_nm;
    const std::size_t pixels = out_.image.pixels();
    sum_.assign(pixels * looks_.waves(), 0.0), mean_.assign(pixels, 0.0), square_.assign(pixels, 0.0);
    wide_.assign(pixels, 0.0), narrow_.assign(pixels, 0.0);
    for (const char *name : {"depth_m", "bend_mrad", "photon_count"}) out_.image.channels[name].assign(pixels, 0.0f);
  }

  void gather(int pass) {
    room_twin::EyeCamera camera = camera_of(scene_, size_);
    camera.seed = options_.seed, camera.first_sample = pass * samples_, camera.samples = samples_;
    camera.alone = alone_ ? 1 : 0;
    const EyeBand band = tracer_->see(camera);
    // Every sample keeps its place among the points, so that it keeps its radius; those that ask nothing stand far off.
    std::vector<GatherPoint> points(band.samples.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = {{3e8f, 3e8f, 3e8f}, 0};
      if (!band.samples[i].asks) continue;
      std::copy(std::begin(band.samples[i].point.place_m), std::end(band.samples[i].point.place_m), points[i].place_m);
      points[i].normal = band.samples[i].point.normal;
    }
    const PassIrradiance light = mapper_->gather(pass, records_[0], records_[1], points);
    out_.report.map_seconds += light.build_seconds, out_.report.gather_seconds += light.gather_seconds;
    add(band, light);
  }

  void add(const EyeBand &band, const PassIrradiance &light) {
    const std::size_t waves = looks_.waves();
    auto &depth = out_.image.channels["depth_m"], &bend = out_.image.channels["bend_mrad"],
         &photons = out_.image.channels["photon_count"];
    for (std::size_t pixel = 0; pixel < mean_.size(); ++pixel) {
      double of_pass = 0;
      for (int s = 0; s < samples_; ++s) {
        const std::size_t i = pixel * static_cast<std::size_t>(samples_) + static_cast<std::size_t>(s);
        double irradiance = 0, shown = 0;
        for (std::size_t w = 0; w < waves; ++w) {
          const double e = band.samples[i].asks ? static_cast<double>(light.irradiance[i * waves + w]) : 0;
          const double from_map = static_cast<double>(band.weight[i * waves + w]) * e;
          const double value = static_cast<double>(band.radiance[i * waves + w]) + from_map;
          sum_[pixel * waves + w] += value;
          of_pass += value, irradiance += e, shown += from_map;
        }
        if (band.samples[i].asks && irradiance > 0) {
          wide_[pixel] += shown;
          narrow_[pixel] += shown * static_cast<double>(light.narrower[i]) / irradiance;
          photons[pixel] += static_cast<float>(light.photons[i]);
        }
        depth[pixel] += band.samples[i].depth_m, bend[pixel] += band.samples[i].bend_mrad;
      }
      of_pass /= samples_;
      mean_[pixel] += of_pass, square_[pixel] += of_pass * of_pass;
    }
  }

  void finish() {
    const std::size_t waves = looks_.waves();
    const double all = out_.report.spp;
    for (const double s : sum_) out_.image.radiance.push_back(static_cast<float>(s / all));
    for (const char *name : {"depth_m", "bend_mrad", "photon_count"})
      for (float &x : out_.image.channels[name]) x /= static_cast<float>(all);
    auto &noise = out_.image.channels["noise"];
    const double p = options_.passes;
    double squares = 0, whole = 0;
    for (std::size_t i = 0; i < mean_.size(); ++i) {
      const double variance = p > 1 ? std::max(square_[i] / p - std::pow(mean_[i] / p, 2), 0.0) / (p - 1) : 0;
      noise.push_back(static_cast<float>(std::sqrt(variance) / static_cast<double>(waves)));
      squares += variance, whole += mean_[i] / p;
    }
    const double pixels = static_cast<double>(mean_.size());
    if (whole > 0) out_.report.noise_rms = std::sqrt(squares / pixels) / (whole / pixels);
    out_.report.bias = bias();
    out_.report.emit_seconds = out_.report.photons.seconds, out_.report.eye_seconds = tracer_->eye_seconds();
  }

  /// A kernel of half the area has half the bias, so that twice their difference is the bias; blocks take its noise
  /// away.
  double bias() const {
    constexpr int block = 8;
    double squares = 0, whole = 0;
    for (int row = 0; row + block <= size_[1]; row += block)
      for (int column = 0; column + block <= size_[0]; column += block) {
        double difference = 0, mean = 0;
        for (int y = 0; y < block; ++y)
          for (int x = 0; x < block; ++x) {
            const auto i = static_cast<std::size_t>((row + y) * size_[0] + column + x);
            difference += 2 * (wide_[i] - narrow_[i]), mean += wide_[i];
          }
        squares += difference * difference, whole += mean;
      }
    const double blocks = std::max(1, (size_[0] / block) * (size_[1] / block));
    return whole > 0 ? std::sqrt(squares / blocks) / (whole / blocks) : 0;
  }

  const RoomScene &scene_;
  RoomOptions options_;
  std::shared_ptr<Device> device_;
  std::array<int, 2> size_;
  RoomLooks looks_;
  AirTable air_;
  SurfaceTree tree_;
  std::unique_ptr<RoomTracer> tracer_;
  std::unique_ptr<PhotonMapper> mapper_;
  std::unique_ptr<PhotonMap> no_caustic_;
  static constexpr int first_chunk = 64;             // photons that a work-item follows
  static constexpr std::size_t most_doublings = 32;  // of its length, as a factor
  int chunk_ = first_chunk;
  std::array<int, 2> slots_{};
  std::array<std::size_t, 2> records_{};
  bool alone_ = false;
  int samples_ = 1;
  double compiled_before_ = 0;
  std::vector<double> sum_, mean_, square_, wide_, narrow_;
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
