#include "render/polar_terrain.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <sstream>

#include "support/angle.hpp"
#include "support/parallel.hpp"
#include "support/toml_reader.hpp"

namespace greenray {
namespace {

constexpr std::size_t most_samples = std::size_t{1} << 24;
constexpr int most_in_block = 32;
constexpr double block_over_distance = 0.03;

/// Azimuths of the picture and a little more, on either side of its middle.
double half_width_rad(const Scene &scene, const RenderPlan &plan) {
  const double tangent = std::tan(to_rad(scene.observer.fov_deg) / 2), altitude = to_rad(scene.observer.altitude_deg);
  const double up = tangent * plan.size[1] / plan.size[0];
  double widest = 0;
  for (const double side : {-up, 0.0, up})
    widest = std::max(widest, std::atan2(tangent, std::cos(altitude) - side * std::sin(altitude)));
  return std::min(widest + 3 * from_arcsec(plan.pixel_arcsec), pi);
}

double azimuth_rad(const Scene &scene, double from_middle_rad) {
  return to_rad(scene.observer.azimuth_deg) + from_middle_rad;
}

/// What is wrong with the files, gathered over threads.
class Gaps {
 public:
  void throw_if_any(const TerrainScene &terrain) const {
    std::ostringstream words;
    if (!missing_.empty())
      words << "'terrain.tiles': expected tiles of all that is seen up to farthest_m, found none of "
            << comma_list({missing_.begin(), missing_.end()}) << "; or missing = \"sea\", or a nearer farthest_m";
    else if (voids_ > 0)
      words << "'terrain.tiles': expected heights everywhere that is seen, found void ones, the nearest "
            << std::lround(void_distance_m_) << " m away at " << first_void_.latitude_deg << " N "
            << first_void_.longitude_deg << " E; fill them, or choose a nearer farthest_m";
    if (!words.str().empty()) throw InputError(terrain.place, words.str());
  }
  void add(HeightField::Cover cover, const GeoPlace &place, double distance_m) {
    const std::lock_guard lock(mutex_);
    if (cover == HeightField::Cover::none) missing_.insert(degree_square(place));
    else if (voids_++ == 0 || distance_m < void_distance_m_) first_void_ = place, void_distance_m_ = distance_m;
  }

 private:
  std::mutex mutex_;
  std::set<std::string> missing_;
  std::size_t voids_ = 0;
  GeoPlace first_void_;
  double void_distance_m_ = 0;
};

class PolarMaker {
 public:
  PolarMaker(const Scene &scene, const RenderPlan &plan) : scene_(scene), field_(*scene.terrain.field) {
    const double farthest_m = scene.terrain.farthest_m, half = half_width_rad(scene, plan);
    double apart_m = field_.spacing_m() / 2;
    const double columns = std::max(from_arcsec(plan.pixel_arcsec) / 2, apart_m / farthest_m);
    out_.columns = static_cast<int>(std::ceil(2 * half / columns)) + 2;
    out_.first_azimuth_rad = -half;
    out_.step_rad = 2 * half / (out_.columns - 1);
    const double room = static_cast<double>(most_samples) / out_.columns;
    lay_blocks(std::max(apart_m, farthest_m / room), farthest_m);
  }

  PolarTerrain make() {
    const auto columns = static_cast<std::size_t>(out_.columns), samples = static_cast<std::size_t>(out_.samples);
    out_.heights.resize(columns * samples);
    out_.slopes.resize(2 * columns * samples);
    out_.tops.resize(columns * (out_.blocks.size() - 1));
    for_pieces(columns, 8, host_threads(), [&](std::size_t first, std::size_t last) {
      stop_if_asked();
      for (std::size_t c = first; c < last; ++c) fill(c);
    });
    gaps_.throw_if_any(scene_.terrain);
    out_.highest_m = static_cast<double>(*std::max_element(out_.tops.begin(), out_.tops.end()));
    measure();
    return std::move(out_);
  }

 private:
  /// As long as a share of their distance, no shorter than a sample and no longer than 32.
  void lay_blocks(double apart_m, double farthest_m) {
    double at_m = 0;
    int sample = 0;
    while (at_m < farthest_m * (1 - 1e-9)) {
      const double wanted = std::clamp(block_over_distance * at_m, apart_m, apart_m * most_in_block);
      const double length = std::min(wanted, farthest_m - at_m);
      const int count = std::max(1, static_cast<int>(std::ceil(length / apart_m * (1 - 1e-9))));
      out_.block_m.push_back(at_m);
      out_.blocks.push_back({static_cast<float>(at_m), static_cast<float>(length / count), sample, count});
      at_m += length, sample += count;
    }
    out_.block_m.push_back(farthest_m);
    out_.blocks.push_back({static_cast<float>(farthest_m), 1, sample, 0});
    out_.samples = sample + 1;
  }

  /// Sea where there is nothing.
  Relief relief(const GeoPlace &place, double distance_m, std::size_t &hint) {
    Relief relief;
    const HeightField::Cover cover = field_.relief(place, relief, hint);
    const bool sea = cover == HeightField::Cover::none && scene_.terrain.missing_is_sea;
    if (cover != HeightField::Cover::land && !sea) gaps_.add(cover, place, distance_m);
    if (relief.height_m <= 0) relief = {};
    return relief;
  }

  void fill(std::size_t column) {
    const double azimuth = azimuth_rad(scene_, out_.first_azimuth_rad + static_cast<double>(column) * out_.step_rad);
    const GeodesicLine line(scene_.terrain.eye, azimuth, scene_.terrain.farthest_m);
    const float ahead_north = static_cast<float>(std::cos(azimuth)), ahead_east = static_cast<float>(std::sin(azimuth));
    const std::size_t first = column * static_cast<std::size_t>(out_.samples), blocks = out_.blocks.size() - 1;
    std::size_t hint = 0;
    for (std::size_t b = 0; b <= blocks; ++b) {
      const f32::TerrainBlock &block = out_.blocks[b];
      for (int m = 0; m < std::max(block.count, 1); ++m) {
        const double distance_m = out_.block_m[b] + m * static_cast<double>(block.step_m);
        const Relief at = relief(line.at(std::min(distance_m, out_.block_m.back())), distance_m, hint);
        const std::size_t place = first + static_cast<std::size_t>(block.first + m);
        out_.heights[place] = at.height_m;
        out_.slopes[2 * place] = packed(at.slope_north * ahead_north + at.slope_east * ahead_east);
        out_.slopes[2 * place + 1] = packed(at.slope_east * ahead_north - at.slope_north * ahead_east);
      }
    }
    for (std::size_t b = 0; b < blocks; ++b) {
      const float *from = &out_.heights[first + static_cast<std::size_t>(out_.blocks[b].first)];
      out_.tops[column * blocks + b] = *std::max_element(from, from + out_.blocks[b].count + 1);
    }
  }

  static short packed(float slope) {
    return static_cast<short>(std::lround(std::clamp(slope, -3.9f, 3.9f) * TERRAIN_SLOPE_ONE));
  }

  /// Heights half way between samples and columns against the files, on some columns.
  void measure() {
    constexpr int looked_at = 24;
    double squares = 0, count = 0;
    for (int k = 0; k < looked_at; ++k) {
      const auto column = static_cast<std::size_t>((out_.columns - 2) * (k + 0.5) / looked_at);
      const double aside = (static_cast<double>(column) + 0.5) * out_.step_rad;
      const GeodesicLine line(scene_.terrain.eye, azimuth_rad(scene_, out_.first_azimuth_rad + aside),
                              scene_.terrain.farthest_m);
      std::size_t hint = 0;
      for (std::size_t b = 0; b + 1 < out_.blocks.size(); ++b) {
        const f32::TerrainBlock &block = out_.blocks[b];
        const double distance_m = out_.block_m[b] + 0.5 * static_cast<double>(block.step_m);
        const std::size_t at = column * static_cast<std::size_t>(out_.samples) + static_cast<std::size_t>(block.first);
        const std::size_t beside = at + static_cast<std::size_t>(out_.samples);
        const float ours =
            0.25f * (out_.heights[at] + out_.heights[at + 1] + out_.heights[beside] + out_.heights[beside + 1]);
        const double off = static_cast<double>(ours - relief(line.at(distance_m), distance_m, hint).height_m);
        squares += off * off / (distance_m * distance_m), count += 1;
      }
    }
    out_.error_arcsec = to_arcsec(std::sqrt(squares / count));
  }

  const Scene &scene_;
  const HeightField &field_;
  PolarTerrain out_;
  Gaps gaps_;
};

}  // namespace

PolarTerrain polar_terrain(const Scene &scene, const RenderPlan &plan) { return PolarMaker(scene, plan).make(); }

void require_tiles(const Scene &scene, const RenderPlan &plan) {
  if (scene.terrain.missing_is_sea) return;
  constexpr int columns = 65;
  constexpr double step_m = 1000;
  const double half = half_width_rad(scene, plan), farthest_m = scene.terrain.farthest_m;
  Gaps gaps;
  std::size_t hint = 0;
  for (int c = 0; c < columns; ++c) {
    const GeodesicLine line(scene.terrain.eye, azimuth_rad(scene, half * (2.0 * c / (columns - 1) - 1)), farthest_m);
    for (double distance_m = 0; distance_m < farthest_m; distance_m += step_m) {
      const GeoPlace place = line.at(distance_m);
      float height = 0;
      if (scene.terrain.field->height(place, height, hint) == HeightField::Cover::none)
        gaps.add(HeightField::Cover::none, place, distance_m);
    }
  }
  gaps.throw_if_any(scene.terrain);
}

}  // namespace greenray
