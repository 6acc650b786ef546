#include "vision/human_eye.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <stdexcept>

#include "support/error.hpp"
#include "support/parallel.hpp"
#include "vision/acuity.hpp"
#include "vision/acuity_filter.hpp"
#include "vision/adaptation.hpp"
#include "vision/glare_filter.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

namespace {

/// Luminances of a plane at evenly scattered places.
std::vector<float> scattered_values(const Plane &plane, std::size_t count) {
  if (plane.value.size() <= count) return plane.value;
  std::vector<float> values;
  const double stride = static_cast<double>(plane.value.size()) / static_cast<double>(count);
  constexpr double golden = 0.6180339887498949;  // a different place in each stretch
  for (std::size_t i = 0; i < count; ++i) {
    const double place = (static_cast<double>(i) + std::fmod(golden * static_cast<double>(i), 1.0)) * stride;
    values.push_back(plane.value[std::min(static_cast<std::size_t>(place), plane.value.size() - 1)]);
  }
  return values;
}

constexpr std::array<float, 5> d65_light{0.9505F, 1.0F, 1.0891F, 1.0F, static_cast<float>(scotopic_per_photopic_d65)};

}  // namespace

/// One picture on its way through the eye.
class Development {
 public:
  Development(HumanEye &eye, PictureSource &source, PictureSink &sink, const GreenerSinks &greener)
      : eye_(eye),
        options_(eye.options_),
        source_(source),
        facts_(source.facts()),
        sink_(sink),
        greener_(greener),
        store_(source, options_.memory_bytes),
        channels_(store_.converter().planes()),
        luminance_plane_(store_.converter().luminance_plane()),
        view_(view_geometry(facts_.width, facts_.height, options_.fov_deg ? options_.fov_deg : facts_.fov_deg,
                            options_.magnification)) {}

  EyeReport run() {
    look();
    scatter_light();
    adapt();
    prepare_retina();
    constexpr int rows = 2 * rows_per_piece;
    for_pieces(static_cast<std::size_t>(facts_.height), rows, options_.threads,
               [&](std::size_t first, std::size_t last) { band(static_cast<int>(first), static_cast<int>(last)); });
    report_.greener = greener_sums_.stats();
    return report_;
  }

 private:
  /// Light of a band of rows, with what lies around it.
  struct BandLight {
    Planes planes;
    int first_row = 0;
  };
  /// The rows of a band that are in work, one array for each quantity.
  struct RowBuffers {
    std::vector<float> colour[3], luminance, scotopic, unbleached[3], levels, before[3], luminance_before;
    std::vector<SelfScreening> screening;
    explicit RowBuffers(std::size_t width) : luminance(width), scotopic(width), luminance_before(width) {
      for (std::size_t c = 0; c < 3; ++c) colour[c].resize(width), unbleached[c].resize(width), before[c].resize(width);
    }
  };

  bool bleaches() const { return options_.bleaching.exposure != BleachingOptions::Exposure::off; }

  void look() {
    const std::array<int, 2> foveal = foveal_size(view_);
    point_count_ = std::clamp<std::size_t>(
        16 * static_cast<std::size_t>(foveal[0]) * static_cast<std::size_t>(foveal[1]), 4096, 1U << 20U);
    survey_ = survey_picture(store_, facts_, point_count_, options_.threads);
    surround_ = surround_of(survey_, luminance_plane_);
    if (options_.surround_cd_m2) {
      const float own = surround_[luminance_plane_], wanted = static_cast<float>(*options_.surround_cd_m2);
      for (std::size_t c = 0; c < channels_; ++c) surround_[c] = wanted * (own > 0 ? surround_[c] / own : d65_light[c]);
    }
    report_.faults = survey_.faults;
    report_.pixels = facts_.pixels();
    report_.least_cd_m2 = static_cast<double>(survey_.least_cd_m2);
    report_.most_cd_m2 = static_cast<double>(survey_.most_cd_m2);
    report_.mean_cd_m2 = survey_.mean_cd_m2;
    report_.surround_cd_m2 = static_cast<double>(surround_[luminance_plane_]);
    report_.kept_in_memory = store_.in_memory();
    report_.fov_deg = view_.fov_deg;
    report_.fov_assumed = view_.assumed;
  }

  /// Glare over the cells: the veil that bands take from there, and the cells as the retina gets them.
  void scatter_light() {
    retinal_cells_ = survey_.cells;
    report_.glare_applied = options_.glare && survey_.most_cd_m2 > 0;
    if (!report_.glare_applied) return;
    filter_.emplace(facts_.width, facts_.height, survey_.levels, view_.pixel_deg, options_.eye);
    veils_.resize(channels_);
    for_pieces(channels_, 1, options_.threads, [&](std::size_t c, std::size_t) {
      const float around = surround_[c];
      Plane light = survey_.cells[c];
      for (std::size_t i = 0; i < light.value.size(); ++i)
        light.value[i] = (light.value[i] - around) * survey_.coverage.value[i];
      veils_[c] = filter_->veil(light);
      const auto kept = static_cast<float>(filter_->kept_by_cells());
      for (std::size_t i = 0; i < light.value.size(); ++i) {
        float &cell = retinal_cells_[c].value[i];
        cell = std::max(0.0F, around + kept * (cell - around) + veils_[c].value[i]);
      }
    });
  }

  void adapt() {
    const Plane &luminance = retinal_cells_[luminance_plane_];
    const Plane foveal = foveal_samples(luminance, view_);
    report_.foveal = {foveal.width, foveal.height};
    const std::vector<float> points =
        report_.glare_applied ? scattered_values(luminance, point_count_) : survey_.points;
    const BrightnessHistogram histogram =
        histogram_from_samples(foveal.value, std::vector<float>(foveal.value.size(), 1.0F), points);
    const ToneCurve curve(histogram, options_.display, options_.sensitivity);
    tone_.emplace(curve);
    report_.linear = curve.is_linear();
    report_.linear_scale = curve.linear_scale();
    report_.tone_passes = curve.passes();
    if (histogram.dark()) return;
    report_.histogram_low_cd_m2 = std::exp(histogram.low);
    report_.histogram_high_cd_m2 = std::exp(histogram.high);
    report_.adaptation_cd_m2 = std::exp(histogram.mean);
    const double fifth_cd_m2 = report_.fifth_percentile_cd_m2 = histogram.percentile_cd_m2(0.05);
    if (options_.rods != RodVision::off && fifth_cd_m2 < top_of_mesopic_cd_m2) rods_ = options_.rods;
    report_.rods_applied = rods_ != RodVision::off;
    if (options_.acuity && acuity_cycles_deg(fifth_cd_m2) * view_.pixel_deg < 1) {
      acuity_.emplace(foveal, view_);
      if (acuity_->resolves_everything()) acuity_.reset();
    }
    if (!acuity_) return;
    report_.acuity_applied = true;
    report_.coarsest_sample_pixels = std::exp2(static_cast<double>(acuity_->coarsest()));
    for (std::size_t c = 0; c < used_planes(); ++c) pyramids_.emplace_back(retinal_cells_[c], survey_.levels);
  }

  /// Without rods the last plane of a spectral picture is not needed.
  std::size_t used_planes() const { return channels_ == 5 && rods_ == RodVision::off ? 4 : channels_; }

  void prepare_retina() {
    const PupilField field = pupil_field(view_, survey_.mean_cd_m2, report_.surround_cd_m2, options_);
    report_.field_cd_m2 = field.luminance_cd_m2;
    report_.field_deg2 = field.area_deg2;
    report_.pupil_mm = pupil_diameter_mm(options_.pupil, field);
    report_.effectivity = effectivity(report_.pupil_mm);
    report_.td_per_cd_m2 = trolands(1, report_.pupil_mm);
    retina_.options = options_.bleaching;
    for (std::size_t i = 0; i < 3; ++i)
      retina_.td_per_lms[i] = static_cast<float>(report_.td_per_cd_m2 * cone_troland_factors()[i]);
    if (!bleaches()) return;
    expose_pool();
    if (options_.bleaching.model != BleachModel::shape) return;
    if (facts_.spectral()) spectral_screening_.emplace(facts_.wavelength_nm);
    else band_screening_.emplace(), report_.spectra_assumed = true;
  }

  Lms cell_response(std::size_t i) const {
    const auto plane = [&](std::size_t c) { return static_cast<double>(retinal_cells_[c].value[i]); };
    return lms_from_xyz({plane(0), plane(1), plane(2)});
  }

  /// Mean unbleached fraction of the pigment where light falls, weighted by the light; or that of the disk as a whole.
  void expose_pool() {
    const std::size_t cells = retinal_cells_[0].value.size();
    const float brightest =
        *std::max_element(retinal_cells_[luminance_plane_].value.begin(), retinal_cells_[luminance_plane_].value.end());
    if (eye_.cell_state_[0].size() != cells)
      for (std::vector<float> &state : eye_.cell_state_) state.assign(cells, 1.0F);
    Lms light{0, 0, 0}, left{0, 0, 0}, disk{0, 0, 0};
    double disk_cells = 0;
    for (std::size_t i = 0; i < cells; ++i) {
      const Lms response = cell_response(i);
      const bool in_disk = brightest > 0 && retinal_cells_[luminance_plane_].value[i] >= 0.5F * brightest;
      disk_cells += in_disk ? 1 : 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double td = std::max(0.0, response[k]) * static_cast<double>(retina_.td_per_lms[k]);
        float &state = eye_.cell_state_[k][i];
        state = static_cast<float>(retina_.after(static_cast<double>(state), td));
        light[k] += td;
        left[k] += td * static_cast<double>(state);
        if (in_disk) disk[k] += td;
      }
    }
    std::array<float, 3> shared{1, 1, 1};
    for (std::size_t k = 0; k < 3; ++k) {
      if (options_.bleaching.pooled && disk_cells > 0) {
        double &state = eye_.disk_state_[k];
        state = retina_.after(state, disk[k] / disk_cells);
        shared[k] = static_cast<float>(state);
      }
      const double pool = options_.bleaching.pooled ? static_cast<double>(shared[k])
                          : light[k] > 0            ? left[k] / light[k]
                                                    : 1;
      retina_.pool[k] = static_cast<float>(pool);
      report_.pool_unbleached[k] = pool;
    }
    if (options_.bleaching.pooled) retina_.shared = shared;
  }

  /// Retinal light of rows [first, last) and some around them.
  BandLight band_light(int first, int last) {
    const int cell = 1 << survey_.levels, beyond = acuity_ ? cell : 0;
    const int halo = filter_ ? filter_->halo_rows() : 0;
    const int width = (facts_.width + cell - 1) / cell * cell;
    const int top = first - beyond - halo, bottom = (last + cell - 1) / cell * cell + beyond + halo;
    const int inside_top = std::max(top, 0), inside_bottom = std::min(bottom, facts_.height);
    std::vector<float> loaded;
    if (!store_.in_memory()) store_.load(inside_top, inside_bottom - inside_top, loaded);
    BandLight band{{}, first - beyond};
    for (std::size_t c = 0; c < used_planes(); ++c) {
      Plane light(width, bottom - top, filter_ ? 0.0F : surround_[c]);
      fill(c, inside_top, inside_bottom, loaded, top, light);
      if (filter_) {
        light = filter_->spread(light, top, veils_[c]);
        light.value.erase(light.value.begin(), light.value.begin() + static_cast<std::ptrdiff_t>(width) * halo);
        light.height -= 2 * halo;
        light.value.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(light.height));
      }
      if (filter_)
        for (float &value : light.value) value = std::max(0.0F, value + surround_[c]);
      band.planes.push_back(std::move(light));
    }
    return band;
  }

  /// With glare, differences to the light around, which is 0 outside the picture; else the light as it is, to the bit.
  void fill(std::size_t c, int inside_top, int inside_bottom, const std::vector<float> &loaded, int top,
            Plane &light) const {
    const auto width = static_cast<std::size_t>(facts_.width);
    const auto rows = static_cast<std::size_t>(inside_bottom - inside_top);
    for (int y = inside_top; y < inside_bottom; ++y) {
      float *to = light.row(y - top);
      if (store_.in_memory()) store_.copy(c, y, 1, to);
      else std::copy_n(loaded.data() + (c * rows + static_cast<std::size_t>(y - inside_top)) * width, width, to);
      if (!filter_) continue;
      for (std::size_t x = 0; x < width; ++x) to[x] -= surround_[c];
    }
  }

  void band(int first, int last) {
    const BandLight light = band_light(first, last);
    std::vector<Pyramid::Band> seen;
    if (acuity_)
      for (std::size_t c = 0; c < light.planes.size(); ++c)
        seen.emplace_back(pyramids_[c], light.planes[c], light.first_row);
    const auto width = static_cast<std::size_t>(facts_.width), rows = static_cast<std::size_t>(last - first);
    std::vector<float> rgb(3 * width * rows), overlay, map;
    const bool compare = options_.map_greener;
    if (compare) overlay.resize(3 * width * rows), map.resize(4 * width * rows);
    std::vector<float> spectra;
    if (spectral_screening_) source_.read(first, last - first, spectra);
    RowBuffers row(width);
    BandSums sums;
    for (int y = first; y < last; ++y) {
      const auto line = static_cast<std::size_t>(y - first);
      resolve(light, seen, y, row);
      if (compare)
        for (std::size_t c = 0; c < 3; ++c) row.before[c] = row.colour[c];
      row.luminance_before = row.luminance;
      if (bleaches()) bleach(y, line * width, rows * width, spectra, row, sums);
      display(row, rgb.data() + 3 * width * line);
      if (compare)
        sums.greener.add(compare_row(row, rgb.data() + 3 * width * line, overlay.data() + 3 * width * line,
                                     map.data() + 4 * width * line));
      sums.gamut_moved += gamut_rows(width, rgb.data() + 3 * width * line);
    }
    sink_.put(first, last - first, std::move(rgb));
    if (compare && greener_.overlay) greener_.overlay->put(first, last - first, std::move(overlay));
    if (compare && greener_.map) greener_.map->put(first, last - first, std::move(map));
    join(sums, first);
  }

  struct BandSums {
    std::uint64_t gamut_moved = 0;
    std::array<double, 3> least{1, 1, 1};
    GreenerSums greener;
  };

  /// Sums of reals are joined in the order of the bands, so that they do not depend on which thread was first.
  void join(const BandSums &sums, int first) {
    const std::lock_guard<std::mutex> guard(lock_);
    waiting_[first] = sums;
    for (auto it = waiting_.find(next_); it != waiting_.end(); it = waiting_.find(next_)) {
      report_.gamut_moved += it->second.gamut_moved;
      greener_sums_.add(it->second.greener);
      for (std::size_t k = 0; k < 3; ++k)
        report_.least_unbleached[k] = std::min(report_.least_unbleached[k], it->second.least[k]);
      next_ += 2 * rows_per_piece;
      waiting_.erase(it);
    }
  }

  /// One row as the eye resolves it.
  void resolve(const BandLight &light, const std::vector<Pyramid::Band> &seen, int y, RowBuffers &row) const {
    const auto width = static_cast<std::size_t>(facts_.width);
    if (acuity_) acuity_->levels_of_row(y, row.levels);
    const auto plane_row = [&](std::size_t c, std::vector<float> &to) {
      if (!acuity_) {
        std::copy_n(light.planes[c].row(y - light.first_row), width, to.begin());
        return;
      }
      for (std::size_t x = 0; x < width; ++x) to[x] = seen[c].at(static_cast<int>(x), y, row.levels[x]);
    };
    for (std::size_t c = 0; c < 3; ++c) plane_row(c, row.colour[c]);
    if (channels_ == 5) plane_row(3, row.luminance);
    else row.luminance = row.colour[1];
    if (rods_ == RodVision::off) return;
    if (channels_ == 5) return plane_row(4, row.scotopic);
    for (std::size_t x = 0; x < width; ++x)
      row.scotopic[x] = static_cast<float>(scotopic_from_xyz(static_cast<double>(row.colour[0][x]),
                                                             static_cast<double>(row.colour[1][x]),
                                                             static_cast<double>(row.colour[2][x])));
  }

  void bleach(int y, std::size_t begin, std::size_t count, const std::vector<float> &spectra, RowBuffers &row,
              BandSums &sums) {
    const auto width = static_cast<std::size_t>(facts_.width);
    std::array<float *, 3> u{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (options_.carry_state) {
        u[k] = eye_.state_[k].data() + static_cast<std::size_t>(y) * width;
      } else {
        std::fill(row.unbleached[k].begin(), row.unbleached[k].end(), 1.0F);
        u[k] = row.unbleached[k].data();
      }
    }
    if (options_.bleaching.model == BleachModel::shape) screen(begin, count, spectra, row);
    bleach_rows(retina_, width, row.colour[0].data(), row.colour[1].data(), row.colour[2].data(), row.luminance.data(),
                u, row.screening);
    for (std::size_t k = 0; k < 3; ++k) {
      sums.least[k] = std::min(sums.least[k], static_cast<double>(*std::min_element(u[k], u[k] + width)));
      if (options_.carry_state) std::copy_n(u[k], width, row.unbleached[k].begin());
    }
  }

  /// Self-screening of each pixel of the row, from its own spectrum or from three bands that make its colour.
  void screen(std::size_t begin, std::size_t count, const std::vector<float> &spectra, RowBuffers &row) const {
    const auto width = static_cast<std::size_t>(facts_.width);
    row.screening.assign(width, {});
    for (std::size_t x = 0; x < width; ++x) {
      if (!spectral_screening_) {
        row.screening[x] = band_screening_->of(
            lms_from_xyz({static_cast<double>(row.colour[0][x]), static_cast<double>(row.colour[1][x]),
                          static_cast<double>(row.colour[2][x])}));
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) {
        float whole = 0, half = 0, none = 0;
        for (std::size_t w = 0; w < facts_.wavelength_nm.size(); ++w) {
          const float radiance = spectra[w * count + begin + x];
          if (!(radiance > 0) || std::isinf(radiance)) continue;
          whole += radiance * spectral_screening_->whole[k][w];
          half += radiance * spectral_screening_->half[k][w];
          none += radiance * spectral_screening_->none[k][w];
        }
        if (whole > 0) row.screening[x].at_none[k] = none / whole, row.screening[x].at_half[k] = half / whole;
      }
    }
  }

  void display(RowBuffers &row, float *rgb) const {
    display_rows(*tone_, rods_, row.luminance.size(), row.colour[0].data(), row.colour[1].data(), row.colour[2].data(),
                 row.luminance.data(), row.scotopic.data(), rgb);
  }

  GreenerSums compare_row(RowBuffers &row, const float *with, float *overlay, float *map) const {
    const std::size_t width = row.luminance.size();
    std::vector<float> without(3 * width), differences(2 * width);
    display_rows(*tone_, rods_, width, row.before[0].data(), row.before[1].data(), row.before[2].data(),
                 row.luminance_before.data(), row.scotopic.data(), without.data());
    const GreenerSums sums = compare_rows(width, without.data(), with, overlay, differences.data());
    for (std::size_t x = 0; x < width; ++x) {
      map[4 * x] = differences[2 * x], map[4 * x + 1] = differences[2 * x + 1];
      for (std::size_t k = 0; k < 2; ++k) map[4 * x + 2 + k] = bleaches() ? row.unbleached[k][x] : 1.0F;
    }
    return sums;
  }

  HumanEye &eye_;
  const EyeOptions &options_;
  PictureSource &source_;
  const PictureFacts &facts_;
  PictureSink &sink_;
  GreenerSinks greener_;
  LightStore store_;
  std::size_t channels_, luminance_plane_;
  ViewGeometry view_;
  std::size_t point_count_ = 0;
  Survey survey_;
  std::vector<float> surround_;
  std::optional<GlareFilter> filter_;
  Planes veils_, retinal_cells_;
  std::optional<AcuityMap> acuity_;
  std::vector<Pyramid> pyramids_;
  std::optional<ToneTable> tone_;
  RodVision rods_ = RodVision::off;
  Retina retina_;
  std::optional<SpectralScreening> spectral_screening_;
  std::optional<BandScreening> band_screening_;
  EyeReport report_;
  std::mutex lock_;
  std::map<int, BandSums> waiting_;
  int next_ = 0;
  GreenerSums greener_sums_;
};

HumanEye::HumanEye(EyeOptions options) : options_(std::move(options)) {
  if (options_.threads == 0) options_.threads = host_threads();
}

EyeReport HumanEye::develop(PictureSource &picture, PictureSink &sink, const GreenerSinks &greener) {
  const PictureFacts &facts = picture.facts();
  const SourcePlace place{facts.name, 1, 1};
  if (!facts.absolute)
    throw InputError(place,
                     "this picture does not say its luminance (no whiteLuminance): give --unit CDM2, what RGB (1,1,1) "
                     "or Y = 1 is in cd/m2");
  if (options_.carry_state) {
    if (width_ != 0 && (facts.width != width_ || facts.height != height_))
      throw InputError(place, "expected a picture of " + std::to_string(width_) + "x" + std::to_string(height_) +
                                  " pixels like the first of the sequence, found " + std::to_string(facts.width) + "x" +
                                  std::to_string(facts.height));
    if (width_ == 0 && options_.bleaching.exposure != BleachingOptions::Exposure::off)
      for (std::vector<float> &state : state_) state.assign(facts.pixels(), 1.0F);
    width_ = facts.width, height_ = facts.height;
  } else {
    for (std::vector<float> &state : cell_state_) state.clear();
    disk_state_ = {1, 1, 1};
  }
  const EyeReport report = Development(*this, picture, sink, greener).run();
  sink.finish();
  if (greener.overlay) greener.overlay->finish();
  if (greener.map) greener.map->finish();
  return report;
}

}  // namespace greenray::vision
