#include "vision/retinal_light.hpp"

#include <algorithm>
#include <array>

#include "support/fast_math.hpp"
#include "support/parallel.hpp"
#include "vision/cones.hpp"

namespace greenray::vision {

namespace {

constexpr std::array<float, 5> d65_light{0.9505F, 1.0F, 1.0891F, 1.0F, static_cast<float>(scotopic_per_photopic_d65)};

GREENRAY_VECTOR_CLONES void subtract_from_row(const float *from, float level, std::size_t count, float *to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = from[i] - level;
}

/// Back to light: scattered values + level, not below 0.
GREENRAY_VECTOR_CLONES void add_level(const float *from, float level, std::size_t count, float *to) {
  for (std::size_t i = 0; i < count; ++i) {
    const float light = from[i] + level;
    to[i] = light > 0 ? light : 0.0F;
  }
}

}  // namespace

RetinalLight::RetinalLight(const RetinalLightOptions &options, const ViewGeometry &view, const PictureFacts &facts,
                           LightStore &store, std::size_t points)
    : store_(store),
      width_(facts.width),
      height_(facts.height),
      luminance_plane_(store.converter().luminance_plane()),
      survey_(survey_picture(store, facts, points, options.glare, options.threads)),
      surround_(surround_of(survey_, luminance_plane_)),
      cells_(survey_.cells) {
  if (options.surround_cd_m2) {
    const float own = surround_[luminance_plane_], wanted = static_cast<float>(*options.surround_cd_m2);
    for (std::size_t c = 0; c < surround_.size(); ++c)
      surround_[c] = wanted * (own > 0 ? surround_[c] / own : d65_light[c]);
  }
  if (!options.glare || !(survey_.most_cd_m2 > 0)) return;
  filter_.emplace(width_, height_, survey_.levels, view.pixel_deg, options.eye);
  scatter_cells(options);
}

/// The veil that bands take from the cells, and the cells as the retina gets them.
void RetinalLight::scatter_cells(const RetinalLightOptions &options) {
  veils_.resize(cells_.size());
  const auto kept = static_cast<float>(filter_->kept_by_cells());
  for_pieces(cells_.size(), 1, options.threads, [&](std::size_t c, std::size_t) {
    const float around = surround_[c];
    Plane light = std::move(survey_.smooth[c]);
    for (int y = 0; y < light.height; ++y)
      for (int x = 0; x < light.width; ++x)
        light.row(y)[x] -= around * survey_.smooth_down[static_cast<std::size_t>(y)] *
                           survey_.smooth_across[static_cast<std::size_t>(x)];
    veils_[c] = filter_->veil(light);
    for (int y = 0; y < cells_[c].height; ++y)
      for (int x = 0; x < cells_[c].width; ++x) {
        float &cell = cells_[c].row(y)[x];
        cell = std::max(0.0F, around + kept * (cell - around) + veils_[c].row(y + 1)[x + 1]);
      }
  });
}

Planes RetinalLight::band(int first, int last, int beyond, std::size_t planes) const {
  const int cell = 1 << survey_.levels, halo = filter_ ? filter_->halo_rows() : 0;
  const int width = (width_ + cell - 1) / cell * cell, rows = (last - first + cell - 1) / cell * cell + 2 * beyond;
  const int top = first - beyond - halo, bottom = top + rows + 2 * halo;
  const int inside_top = std::max(top, 0), inside_bottom = std::min(bottom, height_);
  std::vector<float> loaded;
  if (!store_.in_memory()) store_.load(inside_top, inside_bottom - inside_top, loaded);
  Planes band;
  for (std::size_t c = 0; c < planes; ++c) {
    const int frame = filter_ ? cell : 0;
    Plane light(width + 2 * frame, bottom - top, filter_ ? 0.0F : surround_[c]);
    fill(c, inside_top, inside_bottom, loaded, top, frame, light);
    if (!filter_) {
      band.push_back(std::move(light));
      continue;
    }
    const Plane spread = filter_->spread(light, top, veils_[c]);
    light = {};
    Plane seen(width, rows);
    for (int y = 0; y < rows; ++y)
      add_level(spread.row(halo + y) + cell, surround_[c], static_cast<std::size_t>(width), seen.row(y));
    band.push_back(std::move(seen));
  }
  return band;
}

/// With glare, differences to the light around, which is 0 outside the picture; else the light as it is, to the bit.
void RetinalLight::fill(std::size_t plane, int inside_top, int inside_bottom, const std::vector<float> &loaded, int top,
                        int left, Plane &light) const {
  const auto width = static_cast<std::size_t>(width_), rows = static_cast<std::size_t>(inside_bottom - inside_top);
  for (int y = inside_top; y < inside_bottom; ++y) {
    const float *from = store_.in_memory()
                            ? store_.row(plane, y)
                            : loaded.data() + (plane * rows + static_cast<std::size_t>(y - inside_top)) * width;
    if (filter_) subtract_from_row(from, surround_[plane], width, light.row(y - top) + left);
    else std::copy_n(from, width, light.row(y - top) + left);
  }
}

}  // namespace greenray::vision
