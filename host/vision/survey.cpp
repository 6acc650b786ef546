#include "vision/survey.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "support/fast_math.hpp"
#include "support/parallel.hpp"

namespace greenray::vision {

namespace {

constexpr double deg = std::numbers::pi / 180;

/// Cells of 4x4 pixels, larger where they would still be many, single pixels where they would be few.
int cell_levels(int width, int height) {
  if (std::min(width, height) < 256) return 0;
  const double pixels = static_cast<double>(width) * height;
  int levels = 2;
  while (levels < 5 && pixels / std::exp2(2.0 * levels) > 4.2e6) ++levels;
  return levels;
}

/// Rows [first, last) of the points; columns by row.
std::vector<std::vector<int>> scatter(int width, int height, std::size_t count) {
  std::vector<std::vector<int>> columns(static_cast<std::size_t>(height));
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (count >= pixels) {
    for (auto &row : columns) {
      row.resize(static_cast<std::size_t>(width));
      std::iota(row.begin(), row.end(), 0);
    }
    return columns;
  }
  const double across = 0.7548776662466927, down = 0.5698402909980532;  // R2: powers of 1/1.32471..
  for (std::size_t i = 1; i <= count; ++i) {
    const double x = std::fmod(0.5 + across * static_cast<double>(i), 1.0);
    const double y = std::fmod(0.5 + down * static_cast<double>(i), 1.0);
    columns[std::min(static_cast<std::size_t>(y * height), columns.size() - 1)].push_back(
        std::min(static_cast<int>(x * width), width - 1));
  }
  return columns;
}

/// A line of ones, halved smoothly, with a cell more on either side.
std::vector<float> smooth_ones(int size, int levels) {
  const int cell = 1 << levels;
  std::vector<double> line(static_cast<std::size_t>((size + cell - 1) / cell * cell + 2 * cell), 0.0);
  std::fill_n(line.begin() + cell, size, 1.0);
  for (int level = 0; level < levels; ++level) {
    std::vector<double> coarse(line.size() / 2);
    const auto at = [&line](std::size_t i) { return i < line.size() ? line[i] : 0.0; };
    for (std::size_t i = 0; i < coarse.size(); ++i)
      coarse[i] = 0.125 * ((i > 0 ? at(2 * i - 1) : 0.0) + at(2 * i + 2)) + 0.375 * (at(2 * i) + at(2 * i + 1));
    line = coarse;
  }
  return {line.begin(), line.end()};
}

GREENRAY_VECTOR_CLONES void add_values(const float *from, std::size_t count, float *to) {
  for (std::size_t i = 0; i < count; ++i) to[i] += from[i];
}

struct Extent {
  float least, most;
};

/// Eight at a time.
GREENRAY_VECTOR_CLONES Extent extent_of(const float *values, std::size_t count) {
  float least[8], most[8];
  for (float &value : least) value = values[0];
  for (float &value : most) value = values[0];
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8)
    for (std::size_t k = 0; k < 8; ++k) {
      least[k] = values[i + k] < least[k] ? values[i + k] : least[k];
      most[k] = values[i + k] > most[k] ? values[i + k] : most[k];
    }
  for (; i < count; ++i) least[0] = std::min(least[0], values[i]), most[0] = std::max(most[0], values[i]);
  return {*std::min_element(least, least + 8), *std::max_element(most, most + 8)};
}

class Surveyor {
 public:
  Surveyor(LightStore &store, const PictureFacts &facts, std::size_t points, bool smooth)
      : store_(store),
        width_(facts.width),
        height_(facts.height),
        columns_(scatter(facts.width, facts.height, points)) {
    survey_.levels = cell_levels(width_, height_);
    const int cell = 1 << survey_.levels;
    const int w = (width_ + cell - 1) / cell, h = (height_ + cell - 1) / cell;
    survey_.cells.assign(store.converter().planes(), Plane(w, h));
    if (smooth) survey_.smooth.assign(store.converter().planes(), Plane(w + 2, h + 2));
    survey_.smooth_across = smooth_ones(width_, survey_.levels);
    survey_.smooth_down = smooth_ones(height_, survey_.levels);
    std::size_t count = 0;
    for (const auto &row : columns_) first_point_.push_back(count), count += row.size();
    survey_.points.resize(count);
  }

  Survey run(unsigned threads) {
    sums_.assign(static_cast<std::size_t>((height_ + rows_per_piece - 1) / rows_per_piece), 0.0);
    survey_.least_cd_m2 = std::numeric_limits<float>::max();
    for_pieces(static_cast<std::size_t>(height_), rows_per_piece, threads, [&](std::size_t first, std::size_t last) {
      piece(static_cast<int>(first), static_cast<int>(last - first));
    });
    survey_.mean_cd_m2 = std::accumulate(sums_.begin(), sums_.end(), 0.0) / (static_cast<double>(width_) * height_);
    return survey_;
  }

 private:
  void piece(int first, int rows) {
    std::vector<float> light;
    const LightFaults faults = store_.load(first, rows, light);
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(rows);
    const std::size_t luminance_plane = store_.converter().luminance_plane();
    const float *luminance = light.data() + luminance_plane * count;
    const Extent extent = extent_of(luminance, count);
    for (std::size_t plane = 0; plane < survey_.cells.size(); ++plane) {
      const double sum = average(light.data() + plane * count, first, rows, survey_.cells[plane]);
      // added in order later: the same sum for any threads
      if (plane == luminance_plane) sums_[static_cast<std::size_t>(first / rows_per_piece)] = sum;
    }
    share_smoothly(light, first, rows);
    for (int y = 0; y < rows; ++y) {
      const auto row = static_cast<std::size_t>(first + y);
      for (std::size_t i = 0; i < columns_[row].size(); ++i)
        survey_.points[first_point_[row] + i] =
            luminance[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                      static_cast<std::size_t>(columns_[row][i])];
    }
    const std::lock_guard<std::mutex> guard(lock_);
    survey_.faults.add(faults);
    survey_.least_cd_m2 = std::min(survey_.least_cd_m2, extent.least);
    survey_.most_cd_m2 = std::max(survey_.most_cd_m2, extent.most);
  }

  /// Means of the cells of some rows. returns: the sum of all pixels.
  double average(const float *light, int first, int rows, Plane &cells) {
    const int cell = 1 << survey_.levels;
    const auto width = static_cast<std::size_t>(width_);
    std::vector<float> columns(width);
    double whole = 0;
    for (int top = 0; top < rows; top += cell) {
      const int height = std::min(cell, rows - top);
      const float *row = light + static_cast<std::size_t>(top) * width;
      std::copy_n(row, width, columns.begin());
      for (int y = 1; y < height; ++y) add_values(row + static_cast<std::size_t>(y) * width, width, columns.data());
      float *to = cells.row((first + top) >> survey_.levels);
      for (int c = 0; c < cells.width; ++c) {
        const int from = c * cell, end = std::min(from + cell, width_);
        float sum = 0;
        for (int x = from; x < end; ++x) sum += columns[static_cast<std::size_t>(x)];
        to[c] = sum / static_cast<float>(height * (end - from));
        whole += static_cast<double>(sum);
      }
    }
    return whole;
  }

  /* What the rows of a piece give to the smooth cells, those just above and below the piece included. A cell gets a
     share from two pieces at most: their sum does not depend on which was first. */
  void share_smoothly(const std::vector<float> &light, int first, int rows) {
    const int cell = 1 << survey_.levels;
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(rows);
    for (std::size_t c = 0; c < survey_.smooth.size(); ++c) {
      Plane &cells = survey_.smooth[c];
      const float *values = light.data() + c * count;
      Plane share(width_ + 2, rows + 2);
      if (survey_.levels > 0) share = halved_smoothly(values, width_, rows, cell / 2);
      else
        for (int y = 0; y < rows; ++y) std::copy_n(values + y * width_, width_, share.row(y + 1) + 1);
      for (int level = 1; level < survey_.levels; ++level) share = halved_smoothly(share);
      const int top = first / cell;  // in the frame
      const std::lock_guard<std::mutex> guard(lock_);
      for (int y = 0; y < std::min(share.height, cells.height - top); ++y)
        add_values(share.row(y), static_cast<std::size_t>(cells.width), cells.row(top + y));
    }
  }

  LightStore &store_;
  int width_, height_;
  std::vector<std::vector<int>> columns_;
  std::vector<std::size_t> first_point_;
  std::vector<double> sums_;
  Survey survey_;
  std::mutex lock_;
};

}  // namespace

double ViewGeometry::area_deg2() const {
  const double sr = 4 * std::asin(half_width * half_height /
                                  std::sqrt((1 + half_width * half_width) * (1 + half_height * half_height)));
  return sr / (deg * deg);
}

ViewGeometry view_geometry(int width, int height, std::optional<double> fov_deg, double magnification) {
  ViewGeometry view;
  view.width = width, view.height = height;
  view.assumed = !fov_deg.has_value();
  const double smaller = std::tan(20 * deg);
  constexpr double widest_assumed_deg = 170;  // a strip of pixels is no fish eye
  const double assumed_deg = std::min(2 / deg * std::atan(smaller * std::max(1.0, static_cast<double>(width) / height)),
                                      widest_assumed_deg / std::max(1.0, magnification));
  const double unaided_deg = fov_deg.value_or(assumed_deg);
  view.fov_deg = unaided_deg * magnification;
  if (!(view.fov_deg > 0 && view.fov_deg <= 179))
    throw std::domain_error("expected a field of view, times the magnification, above 0 and up to 179 degrees, found " +
                            std::to_string(view.fov_deg));
  view.half_width = std::tan(0.5 * view.fov_deg * deg);
  view.half_height = view.half_width * height / width;
  view.pixel_deg = 2 * view.half_width / width / deg;
  return view;
}

Survey survey_picture(LightStore &store, const PictureFacts &facts, std::size_t points, bool smooth, unsigned threads) {
  Survey survey = Surveyor(store, facts, points, smooth).run(threads);
  if (survey.faults.infinite == 0) return survey;
  store.set_infinite(survey.most_cd_m2);
  return Surveyor(store, facts, points, smooth).run(threads);
}

std::vector<float> surround_of(const Survey &survey, std::size_t luminance_plane) {
  const Plane &luminance = survey.cells[luminance_plane];
  std::vector<std::size_t> frame;
  for (int y = 0; y < luminance.height; ++y)
    for (int x = 0; x < luminance.width; ++x)
      if (x == 0 || y == 0 || x == luminance.width - 1 || y == luminance.height - 1)
        frame.push_back(static_cast<std::size_t>(y) * static_cast<std::size_t>(luminance.width) +
                        static_cast<std::size_t>(x));
  std::stable_sort(frame.begin(), frame.end(),
                   [&](std::size_t a, std::size_t b) { return luminance.value[a] < luminance.value[b]; });
  frame.resize((3 * frame.size() + 3) / 4);
  std::vector<float> mean;
  for (const Plane &plane : survey.cells) {
    double sum = 0;
    for (const std::size_t i : frame) sum += static_cast<double>(plane.value[i]);
    mean.push_back(static_cast<float>(sum / static_cast<double>(frame.size())));
  }
  return mean;
}

}  // namespace greenray::vision
