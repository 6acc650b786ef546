#include "vision/seen_rows.hpp"

#include <algorithm>
#include <cmath>

#include "vision/acuity.hpp"

namespace greenray::vision {

void BandSums::add(const BandSums &other) {
  gamut_moved += other.gamut_moved;
  greener.add(other.greener);
  for (std::size_t k = 0; k < 3; ++k) least_unbleached[k] = std::min(least_unbleached[k], other.least_unbleached[k]);
}

RowObserver::Row::Row(std::size_t width) : luminance(width), scotopic(width), luminance_before(width) {
  for (std::size_t c = 0; c < 3; ++c)
    colour[c].resize(width), unbleached[c].resize(width, 1.0F), before[c].resize(width);
}

RowObserver::RowObserver(const EyeOptions &options, PictureSource &source, const RetinalLight &light,
                         const Adaptation &adaptation, const Retina &retina, PigmentHistory &pigment)
    : options_(options),
      source_(source),
      light_(light),
      adaptation_(adaptation),
      retina_(retina),
      pigment_(pigment),
      width_(static_cast<std::size_t>(source.facts().width)),
      channels_(light.cells().size()) {
  for (std::size_t c = 0; c < used_planes(); ++c) pyramids_.emplace_back(light.cells()[c], light.survey().levels);
  if (!retina.bleaches() || options.bleaching.model != BleachModel::shape) return;
  if (source.facts().spectral()) spectral_screening_.emplace(source.facts().wavelength_nm);
  else band_screening_.emplace();
}

/// Without rods the last plane of a spectral picture is not needed.
std::size_t RowObserver::used_planes() const {
  return channels_ == 5 && adaptation_.rods == RodVision::off ? 4 : channels_;
}

SeenBand RowObserver::see(int first, int last) {
  const int beyond = adaptation_.acuity ? 1 << light_.survey().levels : 0;
  Planes planes = light_.band(first, last, beyond, used_planes());
  std::vector<Pyramid::Band> light;
  for (std::size_t c = 0; c < planes.size(); ++c)
    light.emplace_back(pyramids_[c], std::move(planes[c]), first - beyond);
  const std::size_t rows = static_cast<std::size_t>(last - first), count = rows * width_;
  SeenBand band;
  band.rgb.resize(3 * count);
  if (options_.map_greener) band.overlay.resize(3 * count), band.map.resize(4 * count);
  std::vector<float> spectra;
  if (spectral_screening_) source_.read(first, last - first, spectra);
  Row row(width_);
  for (int y = first; y < last; ++y) {
    const std::size_t begin = static_cast<std::size_t>(y - first) * width_;
    float *rgb = band.rgb.data() + 3 * begin;
    resolve(light, y, row);
    if (options_.map_greener) {
      for (std::size_t c = 0; c < 3; ++c) row.before[c] = row.colour[c];
      row.luminance_before = row.luminance;
    }
    if (retina_.bleaches()) bleach(y, spectra.data() + begin, count, row, band.sums);
    display_rows(adaptation_.tone, adaptation_.rods, width_, row.colour[0].data(), row.colour[1].data(),
                 row.colour[2].data(), row.luminance.data(), row.scotopic.data(), rgb);
    if (options_.map_greener)
      compare(rgb, row, band.overlay.data() + 3 * begin, band.map.data() + 4 * begin, band.sums);
    band.sums.gamut_moved += gamut_rows(width_, rgb);
  }
  return band;
}

/// One row as the eye resolves it.
void RowObserver::resolve(std::vector<Pyramid::Band> &light, int y, Row &row) const {
  if (adaptation_.acuity) adaptation_.acuity->levels_of_row(y, row.levels);
  const auto plane_row = [&](std::size_t c, std::vector<float> &to) {
    if (adaptation_.acuity) light[c].seen_row(y, row.levels, to.data());
    else std::copy_n(light[c].row(y), width_, to.begin());
  };
  for (std::size_t c = 0; c < 3; ++c) plane_row(c, row.colour[c]);
  if (channels_ == 5) plane_row(3, row.luminance);
  else row.luminance = row.colour[1];
  if (adaptation_.rods == RodVision::off) return;
  if (channels_ == 5) return plane_row(4, row.scotopic);
  for (std::size_t x = 0; x < width_; ++x)
    row.scotopic[x] = static_cast<float>(scotopic_from_xyz(static_cast<double>(row.colour[0][x]),
                                                           static_cast<double>(row.colour[1][x]),
                                                           static_cast<double>(row.colour[2][x])));
}

/// spectra: radiance of the row's first pixel; of the next wavelength `spacing` further on.
void RowObserver::bleach(int y, const float *spectra, std::size_t spacing, Row &row, BandSums &sums) {
  std::array<float *, 3> u{};
  for (std::size_t k = 0; k < 3; ++k) {
    u[k] =
        pigment_.keeps_pixels() ? pigment_.pixels(k, static_cast<std::size_t>(y) * width_) : row.unbleached[k].data();
    if (!pigment_.keeps_pixels()) std::fill_n(u[k], width_, 1.0F);
  }
  if (options_.bleaching.model == BleachModel::shape) screen(spectra, spacing, row);
  bleach_rows(retina_, width_, row.colour[0].data(), row.colour[1].data(), row.colour[2].data(), row.luminance.data(),
              u, row.screening);
  for (std::size_t k = 0; k < 3; ++k) {
    sums.least_unbleached[k] =
        std::min(sums.least_unbleached[k], static_cast<double>(*std::min_element(u[k], u[k] + width_)));
    if (options_.map_greener && pigment_.keeps_pixels()) std::copy_n(u[k], width_, row.unbleached[k].begin());
  }
}

/// Self-screening of each pixel of the row, from its own spectrum or from three bands that make its colour.
void RowObserver::screen(const float *spectra, std::size_t spacing, Row &row) const {
  row.screening.assign(width_, {});
  for (std::size_t x = 0; x < width_; ++x) {
    if (!spectral_screening_) {
      row.screening[x] = band_screening_->of(
          lms_from_xyz({static_cast<double>(row.colour[0][x]), static_cast<double>(row.colour[1][x]),
                        static_cast<double>(row.colour[2][x])}));
      continue;
    }
    row.screening[x] = spectral_screening_->of(spectra + x, spacing);
  }
}

void RowObserver::compare(const float *with, Row &row, float *overlay, float *map, BandSums &sums) const {
  std::vector<float> without(3 * width_), differences(2 * width_);
  display_rows(adaptation_.tone, adaptation_.rods, width_, row.before[0].data(), row.before[1].data(),
               row.before[2].data(), row.luminance_before.data(), row.scotopic.data(), without.data());
  sums.greener.add(compare_rows(width_, without.data(), with, overlay, differences.data()));
  for (std::size_t x = 0; x < width_; ++x) {
    map[4 * x] = differences[2 * x], map[4 * x + 1] = differences[2 * x + 1];
    for (std::size_t k = 0; k < 2; ++k) map[4 * x + 2 + k] = row.unbleached[k][x];
  }
}

}  // namespace greenray::vision
