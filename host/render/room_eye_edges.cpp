// More paths where few are not enough: at the edges of lamps, and where light and dark meet within a pixel.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "render/room_eye.hpp"

namespace greenray {
namespace {

constexpr float contrast = 4;                  // of a pixel and those around it, where light has an edge
constexpr int first_edge_sample = 1 << 20;     // of the sequence in a pixel: later than any pass's own
constexpr std::size_t none = ~std::size_t{0};  // no neighbour

/// Smallest and largest value within `reach` pixels along one axis: `step` from one to the next, `count` in a line.
void spread_along(std::vector<float> &low, std::vector<float> &high, std::size_t lines, std::size_t line_step,
                  int count, std::size_t step, int reach) {
  std::vector<float> lows(static_cast<std::size_t>(count)), highs(lows.size());
  for (std::size_t line = 0; line < lines; ++line) {
    const auto at = [&](int i) { return line * line_step + static_cast<std::size_t>(i) * step; };
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      lows[k] = low[at(i)], highs[k] = high[at(i)];
      for (int j = std::max(i - reach, 0); j <= std::min(i + reach, count - 1); ++j)
        lows[k] = std::min(lows[k], low[at(j)]), highs[k] = std::max(highs[k], high[at(j)]);
    }
    for (int i = 0; i < count; ++i)
      low[at(i)] = lows[static_cast<std::size_t>(i)], high[at(i)] = highs[static_cast<std::size_t>(i)];
  }
}

/// Smallest and largest within a square around each pixel.
void spread_around(std::vector<float> &low, std::vector<float> &high, int width, int height, int reach) {
  const auto columns = static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
  spread_along(low, high, rows, columns, width, 1, reach);
  spread_along(low, high, columns, 1, height, columns, reach);
}

}  // namespace

std::vector<int> RoomEye::lamp_edges() const {
  std::vector<float> low(plan_.pixels());
  for (std::size_t i = 0; i < lamps_.size(); ++i) low[i / waves_] += lamps_[i];
  std::vector<float> high = low;
  spread_around(low, high, plan_.width(), plan_.height(), RoomPlan::margin);
  std::vector<int> found;
  for (std::size_t i = 0; i < low.size(); ++i)
    if (high[i] - low[i] > 0.01f * high[i]) found.push_back(static_cast<int>(i));
  return found;
}

void RoomEye::add_lamp_pixels(const std::vector<int> &found, int passes) {
  std::vector<int> all;
  std::set_union(found.begin(), found.end(), lamp_pixels_.begin(), lamp_pixels_.end(), std::back_inserter(all));
  set_lamp_pixels(std::move(all), std::max(lamps_of_, passes));
}

void RoomEye::catch_up(int pass, RoomTracer &tracer) {
  for (int earlier = lamps_of_; earlier < std::min(pass, lamp_passes); ++earlier) {
    lamps_.assign(plan_.pixels() * waves_, 0.0f);
    std::size_t i = 0;  // samples before this band's
    for (const Box &box : bands_of(plan_.region)) {
      const EyeBand band = see_band(box, earlier, tracer);
      const auto samples = static_cast<std::size_t>(plan_.samples);
      const float share = 1 / static_cast<float>(samples);
      for (std::size_t k = 0; k < band.samples.size(); ++k, ++i)
        for (std::size_t w = 0; w < waves_; ++w)
          lamps_[i / samples * waves_ + w] += share * band.radiance[k * waves_ + w];
    }
    add_lamp_pixels(lamp_edges(), earlier + 1);
  }
}

std::vector<int> RoomEye::light_edges(const RoomPass &pass) const {
  std::vector<float> low(plan_.pixels());
  for (std::size_t i = 0; i < lamps_.size(); ++i) low[i / waves_] += pass.radiance[i] - lamps_[i];
  std::vector<float> high = low;
  spread_around(low, high, plan_.width(), plan_.height(), 1);
  std::vector<int> found;
  for (int y = plan_.crop[1]; y < plan_.crop[3]; ++y)
    for (int x = plan_.crop[0]; x < plan_.crop[2]; ++x) {
      const int pixel = (y - plan_.region[1]) * plan_.width() + x - plan_.region[0];
      const auto i = static_cast<std::size_t>(pixel);
      if (high[i] > contrast * std::max(low[i], 0.0f)) found.push_back(pixel);
    }
  return found;
}

/// All samples of the pixels around each path: where its radius must not be much larger than theirs.
std::vector<std::size_t> RoomEye::around(std::span<const int> pixels) const {
  const auto samples = static_cast<std::size_t>(plan_.samples);
  std::vector<std::size_t> all;
  for (const int pixel : pixels)
    for (int k = 0; k < edge_samples; ++k)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int x = pixel % plan_.width() + dx, y = pixel / plan_.width() + dy;
          const bool inside = x >= 0 && y >= 0 && x < plan_.width() && y < plan_.height();
          for (std::size_t s = 0; s < samples; ++s)
            all.push_back(inside ? static_cast<std::size_t>(y * plan_.width() + x) * samples + s : none);
        }
  return all;
}

void RoomEye::resample_edges(int pass, RoomTracer &tracer, PhotonMapper &mapper, RoomPass &out) {
  const std::size_t own = plan_.pixels() * static_cast<std::size_t>(plan_.samples);
  const std::size_t at_once = most_samples / edge_samples;
  room_twin::EyeCamera camera = camera_for(plan_.region, pass);
  camera.first_sample = first_edge_sample + pass * edge_samples, camera.samples = edge_samples;
  for (std::size_t first = 0; first < edge_pixels_.size(); first += at_once) {
    stop_if_asked();
    const std::span<const int> pixels =
        std::span(edge_pixels_).subspan(first, std::min(at_once, edge_pixels_.size() - first));
    const EyeBand band = tracer.see(camera, pixels);
    std::vector<GatherPoint> points(band.samples.size());
    std::transform(band.samples.begin(), band.samples.end(), points.begin(), point_of);
    const std::size_t first_place = own + first * edge_samples;
    if (pass == 0) mapper.find_radii(points), mapper.limit_radii(first_place, points, out.ends, around(pixels));
    const PassIrradiance light = mapper.ask(first_place, points);
    gather_seconds_ += light.gather_seconds;
    mix(pixels, band, light, out);
  }
}

/// The mean of a pixel's own samples and of those of its edge.
void RoomEye::mix(std::span<const int> pixels, const EyeBand &band, const PassIrradiance &light, RoomPass &out) {
  const float whole = static_cast<float>(plan_.samples + edge_samples);
  const float own = static_cast<float>(plan_.samples) / whole;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const auto p = static_cast<std::size_t>(pixels[i]);
    for (std::size_t w = 0; w < waves_; ++w) out.radiance[p * waves_ + w] *= own, lamps_[p * waves_ + w] *= own;
    out.variance[p] = std::sqrt(out.variance[p]);
    for (std::vector<float> *values : {&out.narrower, &out.variance, &out.depth_m, &out.bend_mrad, &out.photon_count})
      (*values)[p] *= own;
    for (std::size_t k = 0; k < edge_samples; ++k) add_sample(band, light, i * edge_samples + k, p, 1 / whole, out);
    out.variance[p] *= out.variance[p];
  }
}

/// In place of the lamps that the pass's few samples saw: the mean of many more.
void RoomEye::resample_lamps(int pass, RoomTracer &tracer, RoomPass &out) {
  if (lamp_pixels_.empty()) return;
  room_twin::EyeCamera camera = camera_for(plan_.region, pass);
  // Each pass has shifts of its own, so that the spread of the passes tells their error.
  camera.seed = seed_ ^ (0x9e3779b9u * static_cast<std::uint32_t>(pass + 1));
  camera.first_sample = 0, camera.samples = lamp_samples;
  const std::vector<float> seen = tracer.see_lamps(camera, lamp_pixels_);
  for (std::size_t i = 0; i < lamp_pixels_.size(); ++i) {
    const auto pixel = static_cast<std::size_t>(lamp_pixels_[i]);
    for (std::size_t w = 0; w < waves_; ++w) {
      const float more = seen[i * waves_ + w] - lamps_[pixel * waves_ + w];
      out.radiance[pixel * waves_ + w] = std::max(0.0f, out.radiance[pixel * waves_ + w] + more);
      out.narrower[pixel] += more;
    }
  }
}

}  // namespace greenray
