#include "render/room_eye.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

namespace greenray {
namespace {

room_twin::EyeCamera camera_of(const CameraScene &from, const std::array<int, 2> &size) {
  room_twin::EyeCamera c{};
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

}  // namespace

GatherPoint point_of(const room_twin::EyeSample &sample) {
  if (!sample.asks) return no_place();
  GatherPoint point{};
  std::copy(std::begin(sample.point.place_m), std::end(sample.point.place_m), point.place_m);
  point.normal = sample.point.normal;
  return point;
}

RoomEye::RoomEye(const CameraScene &camera, int glass, const RoomPlan &plan, std::uint32_t seed, bool alone,
                 std::size_t waves)
    : from_(camera), glass_(glass), plan_(plan), seed_(seed), alone_(alone), waves_(waves) {}

std::vector<RoomEye::Box> RoomEye::bands_of(const Box &box) const {
  const std::size_t row = static_cast<std::size_t>(box[2] - box[0]) * static_cast<std::size_t>(plan_.samples);
  const int rows = std::max(1, static_cast<int>(most_samples / row));
  std::vector<Box> bands;
  for (int y = box[1]; y < box[3]; y += rows) bands.push_back({box[0], y, box[2], std::min(y + rows, box[3])});
  return bands;
}

std::size_t RoomEye::device_bytes() const {
  const Box first = bands_of(plan_.frame())[0];
  const std::size_t samples = static_cast<std::size_t>(first[2] - first[0]) *
                              static_cast<std::size_t>(first[3] - first[1]) * static_cast<std::size_t>(plan_.samples);
  return samples * (sizeof(room_twin::EyeSample) + 2 * sizeof(float) * waves_) +
         PhotonMapper::device_bytes(0, samples, static_cast<int>(waves_));
}

/// Where a few hundred paths spread over the whole picture end, whatever the crop and the resolution.
std::vector<GatherPoint> RoomEye::survey(RoomTracer &tracer) const {
  constexpr int coarse = 40;  // pixels of the longer side
  const int longer = std::max(plan_.size[0], plan_.size[1]);
  const auto part = [&](int side) { return std::max(1, side * coarse / longer); };
  room_twin::EyeCamera camera = camera_of(from_, {part(plan_.size[0]), part(plan_.size[1])});
  camera.glass = glass_, camera.seed = seed_, camera.samples = 1, camera.alone = alone_ ? 1 : 0;
  std::vector<GatherPoint> points;
  for (const room_twin::EyeSample &sample : tracer.see(camera).samples)
    if (sample.asks) points.push_back(point_of(sample));
  return points;
}

room_twin::EyeCamera RoomEye::camera_for(const Box &box, int pass) const {
  room_twin::EyeCamera camera = camera_of(from_, plan_.size);
  camera.glass = glass_, camera.seed = seed_, camera.alone = alone_ ? 1 : 0;
  camera.first_column = box[0], camera.width = box[2] - box[0];
  camera.first_row = box[1], camera.rows = box[3] - box[1];
  camera.first_sample = pass * plan_.samples, camera.samples = plan_.samples;
  return camera;
}

EyeBand RoomEye::see_band(const Box &band, int pass, RoomTracer &tracer) const {
  stop_if_asked();
  return tracer.see(camera_for(band, pass));
}

void RoomEye::find_radii(RoomTracer &tracer, PhotonMapper &mapper) {
  const auto begin = std::chrono::steady_clock::now();
  const double eye_before = tracer.eye_seconds();
  mapper.survey(survey(tracer));
  const Box frame = plan_.frame();
  const std::vector<Box> bands = bands_of(frame);
  std::vector<GatherPoint> all;
  for (const Box &box : bands) {
    EyeBand band = see_band(box, 0, tracer);
    const std::size_t before = all.size();
    std::transform(band.samples.begin(), band.samples.end(), std::back_inserter(all), point_of);
    mapper.find_radii(std::span(all).subspan(before));
    if (bands.size() == 1 && frame == plan_.region) first_band_ = std::move(band);
  }
  const std::size_t samples = static_cast<std::size_t>(plan_.samples);
  mapper.settle_radii(all, static_cast<std::size_t>(frame[2] - frame[0]), samples);
  if (frame != plan_.region) {
    std::vector<std::size_t> kept;
    for (int y = plan_.region[1]; y < plan_.region[3]; ++y)
      for (int x = plan_.region[0]; x < plan_.region[2]; ++x)
        for (std::size_t s = 0; s < samples; ++s)
          kept.push_back(static_cast<std::size_t>((y - frame[1]) * (frame[2] - frame[0]) + x - frame[0]) * samples + s);
    mapper.keep_radii(kept);
  }
  gather_seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() -
                     (tracer.eye_seconds() - eye_before);
}

RoomPass RoomEye::see(int pass, RoomTracer &tracer, PhotonMapper &mapper) {
  RoomPass out;
  out.radiance.assign(plan_.pixels() * waves_, 0.0f);
  for (std::vector<float> *values : {&out.narrower, &out.variance, &out.depth_m, &out.bend_mrad, &out.photon_count})
    values->assign(plan_.pixels(), 0.0f);
  lamps_.assign(plan_.pixels() * waves_, 0.0f);
  for (const Box &box : bands_of(plan_.region)) {
    add_band(box, pass == 0 && first_band_ ? *first_band_ : see_band(box, pass, tracer), mapper, out);
    first_band_.reset();
  }
  // What the pass's own few samples show decides, the same for every crop. Later finds count from the next pass on, so
  // that nothing is chosen by its own outcome.
  std::vector<int> found = lamp_edges();
  if (pass == 0) lamp_pixels_.swap(found), edge_pixels_ = light_edges(out);
  resample_edges(pass, tracer, mapper, out);
  resample_lamps(pass, tracer, out);
  if (pass > 0) add_lamp_pixels(found);
  return out;
}

void RoomEye::add_band(const Box &box, const EyeBand &band, PhotonMapper &mapper, RoomPass &out) {
  // Every sample keeps its place among the points, so that it keeps its radius.
  std::vector<GatherPoint> points(band.samples.size());
  std::transform(band.samples.begin(), band.samples.end(), points.begin(), point_of);
  const std::size_t samples = static_cast<std::size_t>(plan_.samples);
  const std::size_t first_pixel =
      static_cast<std::size_t>(box[1] - plan_.region[1]) * static_cast<std::size_t>(plan_.width());
  const PassIrradiance light = mapper.ask(first_pixel * samples, points);
  gather_seconds_ += light.gather_seconds;
  const float share = 1 / static_cast<float>(samples);
  for (std::size_t i = 0; i < points.size(); ++i) add_sample(band, light, i, first_pixel + i / samples, share, out);
  out.ends.insert(out.ends.end(), points.begin(), points.end());
  // Kernels of one pixel share their photons: standard errors add up, not variances.
  const std::size_t pixels = points.size() / samples;
  for (std::size_t p = first_pixel; p < first_pixel + pixels; ++p) out.variance[p] *= out.variance[p];
}

void RoomEye::add_sample(const EyeBand &band, const PassIrradiance &light, std::size_t i, std::size_t pixel,
                         float share, RoomPass &out) {
  float irradiance = 0, shown = 0, seen = 0;
  for (std::size_t w = 0; w < waves_; ++w) {
    const float e = band.samples[i].asks ? light.irradiance[i * waves_ + w] : 0;
    const float from_map = band.weight[i * waves_ + w] * e, from_lamps = band.radiance[i * waves_ + w];
    out.radiance[pixel * waves_ + w] += share * (from_map + from_lamps);
    lamps_[pixel * waves_ + w] += share * from_lamps;
    irradiance += e, shown += from_map, seen += from_lamps;
  }
  out.narrower[pixel] += share * seen;
  if (irradiance > 0) {
    const float per_irradiance = shown / irradiance;
    out.narrower[pixel] += share * light.narrower[i] * per_irradiance;
    out.variance[pixel] += share * std::sqrt(light.variance[i]) * per_irradiance;
    out.photon_count[pixel] += share * static_cast<float>(light.photons[i]);
  }
  out.depth_m[pixel] += share * band.samples[i].depth_m, out.bend_mrad[pixel] += share * band.samples[i].bend_mrad;
}

}  // namespace greenray
