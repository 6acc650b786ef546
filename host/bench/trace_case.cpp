#include "bench/trace_case.hpp"

#include <algorithm>
#include <cmath>

#include "bench/pal_air.hpp"
#include "bench/race.hpp"
#include "render/host_rays.hpp"
#include "render/launch.hpp"
#include "support/angle.hpp"

namespace greenray::bench {
namespace {

constexpr double reference_table_arcsec = 1e-8, reference_step_rad = 1e-13;

Bent twin_ray(const std::vector<f64::IndexCell> &cells, std::size_t cells_per_row, const f64::Absorbers &absorbers,
              const f64::RayStart &start, double tolerance_rad) {
  const f64::TraceSettings settings{tolerance_rad, 1000000, static_cast<int>(cells_per_row)};
  f64::March march;
  f64::RayEnd end;
  f64::start_march(&march, cells.data(), &start, 0, 0, &settings, absorbers);
  f64::trace(&march, cells.data(), &settings);
  f64::record(&march, &end, 0, 0);
  return {end.bending_rad, end.outcome, end.steps};
}

}  // namespace

std::vector<f64::IndexCell> twin_cells(const IndexTable &table) {
  std::vector<f64::IndexCell> cells;
  for (const IndexCellData &c : table.cells) {
    f64::IndexCell cell;
    std::copy(c.gradient, c.gradient + 4, cell.gradient);
    std::copy(c.density, c.density + 4, cell.density);
    cell.bottom_m = c.bottom_m, cell.thickness_m = c.thickness_m;
    cell.log_index = c.log_index, cell.step_cap_m = c.step_cap_m;
    cells.push_back(cell);
  }
  return cells;
}

namespace {

/// delta_T at a height, its steepest slope, delta_T/(4 a), spanning thickness_m.
InversionSpec inversion(double delta_T_K, double height_m, double thickness_m) {
  InversionSpec spec;
  spec.delta_T_K = delta_T_K;
  spec.height_m = height_m;
  spec.diffuseness_m = thickness_m / 4;
  return spec;
}

}  // namespace

std::vector<CaseAir> trace_cases() {
  CaseAir standard{"us76", {}, 2, 1e-4, 5};
  CaseAir thin{"thin-5K", {}, 2, 0.01, 5};
  thin.air.name = "us76 with an inversion of 5 K, 3 m thick, at 50 m";
  thin.air.inversions.push_back(inversion(5, 50, 3));
  CaseAir ten{"ten-inversions", {}, 2, 0.01, 5};
  ten.air.name = "us76 with ten inversions of 1 K, 3 m thick, from 50 to 500 m";
  for (int i = 1; i <= 10; ++i) ten.air.inversions.push_back(inversion(1, 50 * i, 3));
  ten.without = {"richardson", "image", "classical", "kinks", "1 lane"};
  CaseAir pal{pal_case, {}, PalSite{}.eye_m, 0, 5};
  pal.without = {"richardson", "image", "odeint", "native", "1 lane"};
  pal.lowest_deg = 0;
  pal.medium = [] { return pal_air(); };
  return {standard, thin, ten, pal};
}

TraceCase::TraceCase(CaseAir air, std::size_t timed_rays, std::size_t reference_rays, unsigned threads)
    : air_(std::move(air)), threads_(threads) {
  if (air_.medium) medium_ = air_.medium();
  else medium_ = layered_medium(profile_.emplace(air_.air), false);
  lowest_deg_ = air_.lowest_deg ? *air_.lowest_deg : to_deg(horizon_rad(table(1e-4), air_.eye_m).value_or(0));
  const double first = to_rad(lowest_deg_ + air_.margin_deg), last = to_rad(air_.highest_deg);
  for (std::size_t i = 0; i < timed_rays; ++i)
    altitudes_rad_.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(timed_rays - 1));
  const std::size_t stride = (timed_rays / reference_rays) | 1;
  for (std::size_t i = 0; i < timed_rays; i += stride) reference_altitudes_rad_.push_back(altitudes_rad_[i]);

  reference_ = trace_finely(reference_table_arcsec, reference_step_rad);
  const std::vector<Bent> coarser = trace_finely(10 * reference_table_arcsec, 10 * reference_step_rad);
  for (std::size_t i = 0; i < reference_.size(); ++i)
    reference_error_arcsec_ =
        std::max(reference_error_arcsec_, to_arcsec(std::abs(reference_[i].bending_rad - coarser[i].bending_rad)));
  weigh_errors();
}

/// max(1, |dR/da|) from each reference ray's neighbours of its own wavelength.
void TraceCase::weigh_errors() {
  const double spacing_rad = reference_altitudes_rad_[1] - reference_altitudes_rad_[0];
  const std::size_t last = reference_altitudes_rad_.size() - 1, waves = wavelengths();
  for (std::size_t i = 0; i <= last; ++i)
    for (std::size_t w = 0; w < waves; ++w) {
      const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, last);
      const double slope = (reference_[b * waves + w].bending_rad - reference_[a * waves + w].bending_rad) /
                           (spacing_rad * static_cast<double>(b - a));
      amplification_.push_back(std::max(1.0, std::abs(slope)));
    }
}

const IndexTable &TraceCase::table(double error_arcsec) {
  std::unique_ptr<IndexTable> &known = tables_[error_arcsec];
  if (!known)
    known = std::make_unique<IndexTable>(
        build_index_table(medium_, air_.wavelengths_nm, IndexTableOptions{false, error_arcsec, air_.eye_m}));
  return *known;
}

std::vector<f64::RayStart> TraceCase::starts(const IndexTable &table, std::size_t count) const {
  std::vector<f64::RayStart> rays;
  const std::vector<double> &all = count == 0 ? reference_altitudes_rad_ : altitudes_rad_;
  const std::size_t wanted = count == 0 ? all.size() : count;
  for (std::size_t i = 0; i < wanted; ++i)
    for (std::size_t row = 0; row < wavelengths(); ++row)
      rays.push_back(launch(table, row, air_.eye_m, all[i * all.size() / wanted]));
  return rays;
}

std::vector<Bent> TraceCase::trace_finely(double table_arcsec, double tolerance_rad) {
  const IndexTable &fine = table(table_arcsec);
  const std::vector<f64::IndexCell> cells = twin_cells(fine);
  const f64::Absorbers absorbers{fine.curvature_per_m, 22000, 5000, 1200};
  const std::vector<f64::RayStart> rays = starts(fine, 0);
  std::vector<Bent> ends(rays.size());
  on_threads(rays.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i)
      ends[i] = twin_ray(cells, fine.cells_per_row, absorbers, rays[i], tolerance_rad);
  });
  return ends;
}

Accuracy TraceCase::accuracy(const Runner &runner) const {
  Accuracy worst;
  for (std::size_t i = 0; i < reference_.size(); ++i) {
    const Bent got = runner.result(i);
    if (got.outcome != reference_[i].outcome) {
      ++worst.wrong_outcomes;
      continue;
    }
    const double error = to_arcsec(std::abs(got.bending_rad - reference_[i].bending_rad));
    worst.error_arcsec = std::max(worst.error_arcsec, error);
    worst.scaled_error_arcsec = std::max(worst.scaled_error_arcsec, error / amplification_[i]);
  }
  return worst;
}

}  // namespace greenray::bench
