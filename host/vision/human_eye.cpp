#include "vision/human_eye.hpp"

#include <algorithm>
#include <map>
#include <mutex>

#include "support/error.hpp"
#include "support/parallel.hpp"
#include "vision/adaptation.hpp"
#include "vision/pigment.hpp"
#include "vision/retinal_light.hpp"
#include "vision/seen_rows.hpp"
#include "vision/survey.hpp"

namespace greenray::vision {

namespace {

/// Rows of a band: some 128, and as many bands as keep two or four threads equally busy.
int band_rows_of(int height) {
  constexpr int usual = 2 * rows_per_piece, cell = 32;  // the largest cell
  const int bands = (height + 4 * usual - 1) / (4 * usual) * 4;
  return ((height + bands - 1) / bands + cell - 1) / cell * cell;
}

/// Sums of reals are joined in the order of the bands, so that they do not depend on which thread was first.
class BandLedger {
 public:
  explicit BandLedger(int band_rows) : band_rows_(band_rows) {}
  void enter(const BandSums &sums, int first) {
    const std::lock_guard<std::mutex> guard(lock_);
    waiting_[first] = sums;
    for (auto it = waiting_.find(next_); it != waiting_.end(); it = waiting_.find(next_)) {
      total_.add(it->second);
      next_ += band_rows_;
      waiting_.erase(it);
    }
  }
  const BandSums &total() const { return total_; }

 private:
  std::mutex lock_;
  std::map<int, BandSums> waiting_;
  int band_rows_, next_ = 0;
  BandSums total_;
};

void report_survey(const RetinalLight &light, const ViewGeometry &view, EyeReport &report) {
  const Survey &survey = light.survey();
  report.faults = survey.faults;
  report.pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  report.least_cd_m2 = static_cast<double>(survey.least_cd_m2);
  report.most_cd_m2 = static_cast<double>(survey.most_cd_m2);
  report.mean_cd_m2 = survey.mean_cd_m2;
  report.surround_cd_m2 = light.surround_cd_m2();
  report.glare_applied = light.has_glare();
  report.fov_deg = view.fov_deg;
  report.fov_assumed = view.assumed;
}

/// All bands, as threads get free.
BandSums see_all(RowObserver &observer, int height, unsigned threads, PictureSink &sink, const GreenerSinks &greener) {
  const int band_rows = band_rows_of(height);
  BandLedger ledger(band_rows);
  for_pieces(static_cast<std::size_t>(height), static_cast<std::size_t>(band_rows), threads,
             [&](std::size_t from, std::size_t to) {
               const int first = static_cast<int>(from), rows = static_cast<int>(to - from);
               SeenBand band = observer.see(first, first + rows);
               sink.put(first, rows, std::move(band.rgb));
               if (greener.overlay && !band.overlay.empty()) greener.overlay->put(first, rows, std::move(band.overlay));
               if (greener.map && !band.map.empty()) greener.map->put(first, rows, std::move(band.map));
               ledger.enter(band.sums, first);
             });
  return ledger.total();
}

}  // namespace

HumanEye::HumanEye(EyeOptions options) : options_(std::move(options)), pigment_(std::make_unique<PigmentHistory>()) {
  if (options_.threads == 0) options_.threads = host_threads();
}

HumanEye::~HumanEye() = default;

void HumanEye::check(const PictureFacts &facts, const PictureFacts *first) const {
  const SourcePlace place{facts.name, 1, 1};
  if (!facts.absolute)
    throw InputError(place,
                     "this picture does not say its luminance (no whiteLuminance): give --unit CDM2, what RGB (1,1,1) "
                     "or Y = 1 is in cd/m2");
  if (!first || !carries_pigment() || (facts.width == first->width && facts.height == first->height)) return;
  throw InputError(place, "expected a picture of " + std::to_string(first->width) + "x" +
                              std::to_string(first->height) + " pixels like the first of the sequence, found " +
                              std::to_string(facts.width) + "x" + std::to_string(facts.height));
}

bool HumanEye::carries_pigment() const {
  return options_.carry_state && options_.bleaching.exposure != BleachingOptions::Exposure::off;
}

/// Complains about pictures that an eye cannot see, and makes ready what is carried from picture to picture.
void HumanEye::meet(const PictureFacts &facts) {
  check(facts, first_ ? &*first_ : nullptr);
  if (!carries_pigment()) return pigment_->forget();
  if (!first_) first_ = facts;
  pigment_->keep_pixels(facts.pixels());
}

EyeReport HumanEye::develop(PictureSource &picture, PictureSink &sink, const GreenerSinks &greener) {
  const PictureFacts &facts = picture.facts();
  meet(facts);
  const ViewGeometry view = view_geometry(facts.width, facts.height,
                                          options_.fov_deg ? options_.fov_deg : facts.fov_deg, options_.magnification);
  LightStore store(picture, options_.memory_bytes);
  const RetinalLight light({options_.glare, options_.eye, options_.surround_cd_m2, options_.threads}, view, facts,
                           store, point_count(view));
  EyeReport report;
  report.kept_in_memory = store.in_memory();
  report_survey(light, view, report);
  const Adaptation adaptation = adapt(light, view, options_, report);
  Retina retina = open_pupil(light, view, options_, report);
  if (retina.bleaches()) {
    pigment_->expose(light.cells(), light.luminance_cells(), retina);
    for (std::size_t k = 0; k < 3; ++k) report.pool_unbleached[k] = static_cast<double>(retina.pool[k]);
  }
  RowObserver observer(options_, picture, light, adaptation, retina, *pigment_);
  report.spectra_assumed = observer.assumes_spectra();
  const BandSums sums = see_all(observer, facts.height, options_.threads, sink, greener);
  report.gamut_moved = sums.gamut_moved;
  report.least_unbleached = sums.least_unbleached;
  report.greener = sums.greener.stats();
  sink.finish();
  if (greener.overlay) greener.overlay->finish();
  if (greener.map) greener.map->finish();
  return report;
}

}  // namespace greenray::vision
