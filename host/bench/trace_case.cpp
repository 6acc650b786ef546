#include "bench/trace_case.hpp"

#include <algorithm>
#include <cmath>

#include "bench/race.hpp"
#include "render/host_rays.hpp"
#include "render/launch.hpp"
#include "support/angle.hpp"

namespace greenray::bench {
namespace {

constexpr double wavelength_nm = 550;
constexpr std::size_t reference_stride = 17;
constexpr double reference_table_arcsec = 1e-8, reference_step_rad = 1e-13;

Bent twin_ray(const std::vector<f64::IndexCell> &cells, const f64::Absorbers &absorbers, const f64::RayStart &start,
              double tolerance_rad) {
  const f64::TraceSettings settings{tolerance_rad, 1000000, static_cast<int>(cells.size())};
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

std::vector<CaseAir> trace_cases() {
  CaseAir standard{"us76", {}, 2, 1e-4, 5};
  CaseAir thin{"thin-5K", {}, 2, 0.01, 5};
  thin.air.name = "us76 with an inversion of 5 K, 3 m thick, at 50 m";
  InversionSpec inversion;
  inversion.delta_T_K = 5.0;
  inversion.height_m = 50.0;
  inversion.diffuseness_m = 3.0 / 4;  // the steepest slope, delta_T/(4 a), then spans 3 m
  thin.air.inversions.push_back(inversion);
  return {standard, thin};
}

TraceCase::TraceCase(CaseAir air, std::size_t timed_rays, unsigned threads)
    : air_(std::move(air)), profile_(air_.air), threads_(threads) {
  lowest_deg_ = to_deg(horizon_rad(table(1e-4), air_.eye_m).value_or(0));
  const double first = to_rad(lowest_deg_ + air_.margin_deg), last = to_rad(air_.highest_deg);
  for (std::size_t i = 0; i < timed_rays; ++i)
    altitudes_rad_.push_back(first + (last - first) * static_cast<double>(i) / static_cast<double>(timed_rays - 1));
  for (std::size_t i = 0; i < timed_rays; i += reference_stride) reference_altitudes_rad_.push_back(altitudes_rad_[i]);

  reference_ = trace_finely(reference_table_arcsec, reference_step_rad);
  const std::vector<Bent> coarser = trace_finely(10 * reference_table_arcsec, 10 * reference_step_rad);
  for (std::size_t i = 0; i < reference_.size(); ++i)
    reference_error_arcsec_ =
        std::max(reference_error_arcsec_, to_arcsec(std::abs(reference_[i].bending_rad - coarser[i].bending_rad)));
  const double spacing_rad = reference_altitudes_rad_[1] - reference_altitudes_rad_[0];
  for (std::size_t i = 0; i < reference_.size(); ++i) {
    const std::size_t a = i == 0 ? 0 : i - 1, b = std::min(i + 1, reference_.size() - 1);
    const double slope =
        (reference_[b].bending_rad - reference_[a].bending_rad) / (spacing_rad * static_cast<double>(b - a));
    amplification_.push_back(std::max(1.0, std::abs(slope)));
  }
}

const IndexTable &TraceCase::table(double error_arcsec) {
  std::unique_ptr<IndexTable> &known = tables_[error_arcsec];
  if (!known)
    known = std::make_unique<IndexTable>(
        build_index_table(profile_, {wavelength_nm}, IndexTableOptions{false, error_arcsec, air_.eye_m}));
  return *known;
}

std::vector<f64::RayStart> TraceCase::starts(const IndexTable &table, std::size_t count) const {
  std::vector<f64::RayStart> rays;
  if (count == 0)
    for (double altitude : reference_altitudes_rad_) rays.push_back(launch(table, 0, air_.eye_m, altitude));
  for (std::size_t i = 0; i < count; ++i)
    rays.push_back(launch(table, 0, air_.eye_m, altitudes_rad_[i * altitudes_rad_.size() / count]));
  return rays;
}

std::vector<Bent> TraceCase::trace_finely(double table_arcsec, double tolerance_rad) {
  const IndexTable &fine = table(table_arcsec);
  const std::vector<f64::IndexCell> cells = twin_cells(fine);
  const f64::Absorbers absorbers{fine.curvature_per_m, 22000, 5000, 1200};
  const std::vector<f64::RayStart> rays = starts(fine, 0);
  std::vector<Bent> ends(rays.size());
  on_threads(rays.size(), 16, threads_, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) ends[i] = twin_ray(cells, absorbers, rays[i], tolerance_rad);
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
