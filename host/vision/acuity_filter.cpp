#include "vision/acuity_filter.hpp"

#include <algorithm>
#include <cmath>

#include "support/fast_math.hpp"
#include "vision/acuity.hpp"

namespace greenray::vision {

namespace {

/// Where a row of `size` coarse ones is read: the row above, the share of the row below.
struct Between {
  int above, below;
  float share;
};

Between between_rows(float at, int size) {
  const float kept = std::clamp(at, 0.0F, static_cast<float>(size - 1));
  const int above = static_cast<int>(kept);
  return {above, std::min(above + 1, size - 1), kept - static_cast<float>(above)};
}

template <int Side>
[[gnu::always_inline]] inline void stretch(const float *from, int pieces, int side, float *to) {
  const int n = Side > 0 ? Side : side;
  for (int i = 0; i < pieces; ++i)
    for (int k = 0; k < n; ++k) {
      const float t = (static_cast<float>(k) + 0.5F) / static_cast<float>(n);
      to[i * n + k] = from[i] + t * (from[i + 1] - from[i]);
    }
}

/// `side` values from each of from[0 .. pieces] to the next, straight between.
GREENRAY_VECTOR_CLONES void stretch_row(const float *from, int pieces, int side, float *to) {
  switch (side) {
    case 2:
      return stretch<2>(from, pieces, side, to);
    case 4:
      return stretch<4>(from, pieces, side, to);
    case 8:
      return stretch<8>(from, pieces, side, to);
    default:
      return stretch<0>(from, pieces, side, to);
  }
}

/// to[x] = row at step (x + 0.5) - 0.5, straight between values, ends repeated. row: size + 1 values, the last twice.
GREENRAY_VECTOR_CLONES void sample_row(const float *row, int size, float step, int width, float *to) {
  const float last = static_cast<float>(size - 1);
  for (int x = 0; x < width; ++x) {
    const float at = (static_cast<float>(x) + 0.5F) * step - 0.5F;
    const float kept = at > 0 ? (at < last ? at : last) : 0.0F;
    const int i = static_cast<int>(kept);
    to[x] = row[i] + (kept - static_cast<float>(i)) * (row[i + 1] - row[i]);
  }
}

/// to += (coarse - fine) x how far the level is on the way from `level` to the next.
GREENRAY_VECTOR_CLONES void move_towards(const float *fine, const float *coarse, const float *levels, float level,
                                         int width, float *to) {
  for (int x = 0; x < width; ++x) {
    const float way = levels[x] - level;
    to[x] += (way > 0 ? (way < 1 ? way : 1.0F) : 0.0F) * (coarse[x] - fine[x]);
  }
}

}  // namespace

AcuityMap::AcuityMap(const Plane &foveal_cd_m2, const ViewGeometry &view)
    : width_(view.width), height_(view.height), level_(foveal_cd_m2.width, foveal_cd_m2.height) {
  for (std::size_t i = 0; i < level_.value.size(); ++i) {
    const double sample_deg = 1 / acuity_cycles_deg(static_cast<double>(foveal_cd_m2.value[i]));
    level_.value[i] = static_cast<float>(std::max(0.0, std::log2(sample_deg / view.pixel_deg)));
    coarsest_ = std::max(coarsest_, level_.value[i]);
  }
}

void AcuityMap::levels_of_row(int y, RowLevels &levels) const {
  const float step_x = static_cast<float>(level_.width) / static_cast<float>(width_);
  const float step_y = static_cast<float>(level_.height) / static_cast<float>(height_);
  const Between rows = between_rows((static_cast<float>(y) + 0.5F) * step_y - 0.5F, level_.height);
  std::vector<float> mixed(static_cast<std::size_t>(level_.width + 1));
  mix_rows(level_.row(rows.above), level_.row(rows.below), rows.share, level_.width, mixed.data());
  mixed.back() = mixed[static_cast<std::size_t>(level_.width - 1)];
  const auto [least, most] = std::minmax_element(mixed.begin(), mixed.end());
  levels.least = *least, levels.most = *most;
  levels.level.resize(static_cast<std::size_t>(width_));
  sample_row(mixed.data(), level_.width, step_x, width_, levels.level.data());
}

Pyramid::Pyramid(const Plane &cells, int levels) : levels_(levels), coarse_{cells} {
  while (std::max(coarse_.back().width, coarse_.back().height) > 1)
    coarse_.push_back(halved(coarse_.back(), Beyond::edge));
}

Pyramid::Band::Band(const Pyramid &whole, Plane rows, int first_row) : whole_(whole), first_row_(first_row) {
  fine_.push_back(std::move(rows));
  while (static_cast<int>(fine_.size()) < whole.levels_) fine_.push_back(halved(fine_.back(), Beyond::edge));
}

void Pyramid::Band::row_of_level(int y, int level, int width, std::vector<float> &to) const {
  const bool fine = level < static_cast<int>(fine_.size());
  const auto coarse =
      std::min(static_cast<std::size_t>(std::max(0, level - whole_.levels_)), whole_.coarse_.size() - 1);
  const Plane &plane = fine ? fine_[static_cast<std::size_t>(level)] : whole_.coarse_[coarse];
  const int side = 1 << (fine ? level : whole_.levels_ + static_cast<int>(coarse)), row = fine ? y - first_row_ : y;
  const Between rows = between_rows((static_cast<float>(row) + 0.5F) / static_cast<float>(side) - 0.5F, plane.height);
  std::vector<float> mixed(static_cast<std::size_t>(plane.width + 2));
  mix_rows(plane.row(rows.above), plane.row(rows.below), rows.share, plane.width, mixed.data() + 1);
  mixed.front() = mixed[1], mixed.back() = mixed[static_cast<std::size_t>(plane.width)];
  to.resize(std::max(static_cast<std::size_t>((plane.width + 1) * side), static_cast<std::size_t>(width + side / 2)));
  stretch_row(mixed.data(), plane.width + 1, side, to.data());
  // the first piece begins half a coarse pixel before the picture
  std::copy_n(to.begin() + side / 2, width, to.begin());
}

void Pyramid::Band::seen_row(int y, const RowLevels &levels, float *to) const {
  const auto width = static_cast<int>(levels.level.size());
  const int first = static_cast<int>(levels.least), last = static_cast<int>(std::ceil(levels.most));
  std::vector<float> fine, coarse;
  if (first == 0) fine.assign(fine_[0].row(y - first_row_), fine_[0].row(y - first_row_) + width);
  else row_of_level(y, first, width, fine);
  std::copy_n(fine.begin(), width, to);
  for (int level = first; level < last; ++level) {
    row_of_level(y, level + 1, width, coarse);
    move_towards(fine.data(), coarse.data(), levels.level.data(), static_cast<float>(level), width, to);
    fine.swap(coarse);
  }
}

}  // namespace greenray::vision
