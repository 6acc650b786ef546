// The text of kernels/ray as C++ for this processor: NATIVE_LANES rays side by side in the compiler's vector types.
// Compiled once per lane count and precision, each in its own namespace.
#include "native_rays.hpp"

#include <cmath>

#include "bench/race.hpp"

#define LANES NATIVE_LANES
#define REAL_IS_DOUBLE NATIVE_IS_DOUBLE
#define TABLE_IS_IMAGE 0
#define WITH_COLUMNS 0
#define INTEGRATOR_IS_RICHARDSON 0

namespace greenray::bench::NATIVE_NAMESPACE {
namespace {
namespace text {
// Includes in the order of ray/ray.h, which must stay.
// clang-format off
#include "lib/language.h"
#include "shared/index_table.h"
#include "shared/ray.h"
#if LANES > 1
inline mask operator==(mask a, RayOutcome b) { return a == static_cast<lane_int>(b); }  // g++ has none for vector and enum
#endif
#include "medium/refractivity_lookup.h"
#include "ray/equation.h"
#include "ray/dormand_prince.h"
#include "ray/richardson.h"
#include "ray/trace.h"
// clang-format on
}  // namespace text

class NativeRunner : public Runner {
 public:
  NativeRunner(const IndexTable &table, std::span<const f64::RayStart> starts, double tolerance_rad, unsigned threads)
      : threads_(threads), ends_(starts.size()) {
    using text::scalar;
    settings_ = {static_cast<scalar>(tolerance_rad), 1000000, static_cast<int>(table.cells_per_row)};
    absorbers_ = {static_cast<scalar>(table.curvature_per_m), 22000, 5000, 1200};
    for (const IndexCellData &c : table.cells) {
      text::IndexCell cell{};
      for (int k = 0; k < 4; ++k) cell.gradient[k] = static_cast<scalar>(c.gradient[k]);
      cell.bottom_m = static_cast<scalar>(c.bottom_m), cell.thickness_m = static_cast<scalar>(c.thickness_m);
      cell.log_index = static_cast<scalar>(c.log_index), cell.step_cap_m = static_cast<scalar>(c.step_cap_m);
      cells_.push_back(cell);
    }
    for (const f64::RayStart &s : starts)
      starts_.push_back({static_cast<scalar>(s.above_m), static_cast<scalar>(s.run), static_cast<scalar>(s.rise),
                         static_cast<scalar>(s.sigma_end_m), s.row, s.cell});
  }

  void run() override {
    on_threads(starts_.size(), 64 * LANES, threads_, [this](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; i += LANES) {
        text::March march;
        const int ray = static_cast<int>(i), end = static_cast<int>(last) - 1;
        text::start_march(&march, cells_.data(), starts_.data(), ray, end, &settings_, absorbers_);
        text::trace(&march, cells_.data(), &settings_);
        text::record(&march, ends_.data(), ray, end);
      }
    });
  }
  Bent result(std::size_t ray) const override {
    return {static_cast<double>(ends_[ray].bending_rad), ends_[ray].outcome, ends_[ray].steps};
  }

 private:
  unsigned threads_;
  text::TraceSettings settings_;
  text::Absorbers absorbers_;
  std::vector<text::IndexCell> cells_;
  std::vector<text::RayStart> starts_;
  std::vector<text::RayEnd> ends_;
};

}  // namespace

std::unique_ptr<Runner> prepare(const IndexTable &table, std::span<const f64::RayStart> starts, double tolerance_rad,
                                unsigned threads) {
  return std::make_unique<NativeRunner>(table, starts, tolerance_rad, threads);
}

}  // namespace greenray::bench::NATIVE_NAMESPACE
