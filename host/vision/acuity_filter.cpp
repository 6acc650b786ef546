#include "vision/acuity_filter.hpp"

#include <algorithm>
#include <cmath>

#include "vision/acuity.hpp"

namespace greenray::vision {

AcuityMap::AcuityMap(const Plane &foveal_cd_m2, const ViewGeometry &view)
    : view_(view), level_(foveal_cd_m2.width, foveal_cd_m2.height) {
  for (std::size_t i = 0; i < level_.value.size(); ++i) {
    const double sample_deg = 1 / acuity_cycles_deg(static_cast<double>(foveal_cd_m2.value[i]));
    level_.value[i] = static_cast<float>(std::max(0.0, std::log2(sample_deg / view.pixel_deg)));
    coarsest_ = std::max(coarsest_, level_.value[i]);
  }
}

void AcuityMap::levels_of_row(int y, std::vector<float> &levels) const {
  levels.resize(static_cast<std::size_t>(view_.width));
  const float step_x = static_cast<float>(level_.width) / static_cast<float>(view_.width);
  const float step_y = static_cast<float>(level_.height) / static_cast<float>(view_.height);
  const float at_y = (static_cast<float>(y) + 0.5F) * step_y - 0.5F;
  for (int x = 0; x < view_.width; ++x)
    levels[static_cast<std::size_t>(x)] = bilinear(level_, (static_cast<float>(x) + 0.5F) * step_x - 0.5F, at_y);
}

Pyramid::Pyramid(const Plane &cells, int levels) : levels_(levels), coarse_{cells} {
  while (std::max(coarse_.back().width, coarse_.back().height) > 1)
    coarse_.push_back(halved(coarse_.back(), Beyond::edge));
}

Pyramid::Band::Band(const Pyramid &whole, Plane rows, int first_row)
    : whole_(whole), fine_{std::move(rows)}, first_row_(first_row) {
  while (static_cast<int>(fine_.size()) < whole.levels_) fine_.push_back(halved(fine_.back(), Beyond::edge));
}

float Pyramid::Band::at_level(int x, int y, int level) const {
  const float scale = std::ldexp(1.0F, -level);
  const float across = (static_cast<float>(x) + 0.5F) * scale - 0.5F;
  if (level < static_cast<int>(fine_.size()))
    return bilinear(fine_[static_cast<std::size_t>(level)], across,
                    (static_cast<float>(y - first_row_) + 0.5F) * scale - 0.5F);
  const auto coarse = std::min(static_cast<std::size_t>(level - whole_.levels_), whole_.coarse_.size() - 1);
  return bilinear(whole_.coarse_[coarse], across, (static_cast<float>(y) + 0.5F) * scale - 0.5F);
}

float Pyramid::Band::at(int x, int y, float level) const {
  const int lower = static_cast<int>(level);
  const float t = level - static_cast<float>(lower);
  if (lower == 0 && t <= 0) return fine_[0].row(y - first_row_)[x];
  const float fine = lower == 0 ? fine_[0].row(y - first_row_)[x] : at_level(x, y, lower);
  return t > 0 ? fine + t * (at_level(x, y, lower + 1) - fine) : fine;
}

}  // namespace greenray::vision
