#include "atmosphere/section_table.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>

#include "atmosphere/gauss_cubic.hpp"
#include "atmosphere/refractivity.hpp"
#include "support/angle.hpp"
#include "support/parallel.hpp"

namespace greenray {
namespace {

constexpr double reference_nm = 550;
constexpr std::array<double, 5> probe{1e-9, 0.18, 0.5, 0.75, 1 - 1e-9};
constexpr std::array<double, 2> place_probe{0.18, 0.5};  // of a column; the cubic is worst between its nodes
constexpr std::size_t most_cells = 4000000;
constexpr double narrowest_column_m = 1e-3;

/// One stack of cells: over a place where nothing varies (one node), or over a column (four).
class ColumnBuilder {
 public:
  ColumnBuilder(const SectionMedium &medium, double wavelength_nm, const SectionTableOptions &options, double left_m,
                double right_m)
      : medium_(medium),
        wavelength_nm_(wavelength_nm),
        wanted_rad_(from_arcsec(options.error_arcsec)),
        curvature_per_m_(medium.radius_m > 0 ? 1 / medium.radius_m : 0),
        width_m_(right_m - left_m) {
    if (width_m_ <= 0) {
      strata_.push_back(medium.at(left_m));
    } else {
      for (double s : gauss_place) strata_.push_back(medium.at(left_m + s * width_m_));
      for (double s : place_probe) between_.push_back(medium.at(left_m + s * width_m_));
    }
  }

  /// Does the cubic through the four nodes give the gradient between them, at every height where something happens?
  bool is_narrow_enough() const {
    if (width_m_ <= 2 * narrowest_column_m) return true;
    const std::vector<double> heights = watched_heights();
    for (std::size_t i = 0; i + 1 < heights.size(); ++i) {
      const double dz = heights[i + 1] - heights[i], h = heights[i] + 0.5 * dz;
      const double path_m = std::min(width_m_, longest_path_m(dz));
      std::array<double, 4> at_nodes{};
      for (std::size_t j = 0; j < 4; ++j) at_nodes[j] = slope(strata_[j], h);
      const Cubic c = cubic_through(at_nodes);
      for (std::size_t k = 0; k < place_probe.size(); ++k)
        if (std::abs(evaluate(c, place_probe[k]) - slope(between_[k], h)) * path_m > wanted_rad_) return false;
    }
    return true;
  }

  std::vector<SectionCellData> build(double observer_m) {
    std::vector<double> edges{0.0, medium_.top_m};
    for (const LayeredMedium &stratum : strata_)
      for (double kink : stratum.kinks_m)
        if (kink > 0 && kink < medium_.top_m) edges.push_back(kink);
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) place(edges[i], edges[i + 1]);
    if (observer_m > medium_.top_m) cells_.push_back(vacuum(observer_m + 0.01));
    return std::move(cells_);
  }

  double worst_rad() const { return worst_rad_; }

 private:
  double flattened(double h) const {
    return curvature_per_m_ > 0 ? std::log1p(h * curvature_per_m_) / curvature_per_m_ : h;
  }
  double geometric(double z) const {
    return curvature_per_m_ > 0 ? std::expm1(z * curvature_per_m_) / curvature_per_m_ : z;
  }
  double longest_path_m(double dz) const {
    return std::max(dz, std::sqrt(8 * dz * (medium_.radius_m > 0 ? medium_.radius_m : 1e7)));
  }

  double value(const LayeredMedium &stratum, double h) const { return stratum.refractivity(h, wavelength_nm_).value; }
  double slope(const LayeredMedium &stratum, double h) const {
    return stratum.refractivity(h, wavelength_nm_).slope * (1 + h * curvature_per_m_);
  }

  /// Heights near which any of the nodes changes quickly, their kinks, and a coarse ladder.
  std::vector<double> watched_heights() const {
    std::vector<double> heights{0, medium_.top_m};
    for (const LayeredMedium &stratum : strata_)
      for (const std::vector<double> *some : {&stratum.features_m, &stratum.kinks_m})
        for (double h : *some)
          if (h > 0 && h < medium_.top_m) heights.push_back(h);
    for (double h = medium_.top_m / 2; h > 1e-5 * medium_.top_m; h /= 2) heights.push_back(h);
    std::sort(heights.begin(), heights.end());
    heights.erase(std::unique(heights.begin(), heights.end()), heights.end());
    return heights;
  }

  using Bicubic = std::array<double, 16>;  // [power of t][power of s]

  Bicubic fit(double z0, double dz) const {
    std::array<Cubic, 4> in_t{};  // of each node of x
    for (std::size_t j = 0; j < strata_.size(); ++j) {
      std::array<double, 4> y{};
      for (std::size_t i = 0; i < 4; ++i) y[i] = slope(strata_[j], geometric(z0 + dz * gauss_place[i]));
      in_t[j] = cubic_through(y);
    }
    Bicubic b{};
    for (std::size_t k = 0; k < 4; ++k) put(&b[4 * k], {in_t[0][k], in_t[1][k], in_t[2][k], in_t[3][k]});
    return b;
  }

  /// Coefficients in s from the values at the nodes of x; constant over a single one.
  void put(double *into, const std::array<double, 4> &at_nodes) const {
    into[0] = at_nodes[0];
    if (strata_.size() < 4) return;
    const Cubic c = cubic_through(at_nodes);
    std::copy(c.begin(), c.end(), into);
  }

  static double evaluate_at(const Bicubic &b, double t, double s) {
    Cubic c{};
    for (std::size_t k = 0; k < 4; ++k) c[k] = evaluate({b[4 * k], b[4 * k + 1], b[4 * k + 2], b[4 * k + 3]}, s);
    return evaluate(c, t);
  }

  double residual(const Bicubic &b, double z0, double dz) const {
    double worst = 0;
    const auto hold = [&](const LayeredMedium &stratum, double s) {
      for (double t : probe)
        worst = std::max(worst, std::abs(evaluate_at(b, t, s) - slope(stratum, geometric(z0 + dz * t))));
    };
    hold(strata_.front(), gauss_place.front());
    if (strata_.size() > 1) {
      hold(strata_.back(), gauss_place.back());
      hold(between_.back(), place_probe.back());
    }
    return worst;
  }

  void place(double bottom_h, double top_h) {
    const double width = top_h - bottom_h, z0 = flattened(bottom_h), dz = flattened(top_h) - z0;
    const bool coarse = width > medium_.top_m / 15 || hides_features(bottom_h, top_h);
    const Bicubic b = coarse ? Bicubic{} : fit(z0, dz);
    const double residual_rad = coarse ? 1e9 : residual(b, z0, dz) * longest_path_m(dz);
    if (residual_rad > wanted_rad_ && width > 1e-7 * std::max(1.0, bottom_h)) {
      const double middle = 0.5 * (bottom_h + top_h);
      place(bottom_h, middle);
      place(middle, top_h);
      return;
    }
    worst_rad_ = std::max(worst_rad_, residual_rad);
    cells_.push_back(make_cell(b, bottom_h, z0, dz));
    if (cells_.size() > most_cells) throw InputError(medium_.place, "expected a smoother profile or a larger error");
  }

  bool hides_features(double bottom_h, double top_h) const {
    return std::any_of(strata_.begin(), strata_.end(), [&](const LayeredMedium &stratum) {
      const auto &f = stratum.features_m;
      return std::lower_bound(f.begin(), f.end(), top_h) - std::lower_bound(f.begin(), f.end(), bottom_h) > 6;
    });
  }

  SectionCellData make_cell(const Bicubic &b, double bottom_h, double z0, double dz) const {
    SectionCellData c{};
    std::copy(b.begin(), b.end(), c.slope);
    c.bottom_m = z0;
    c.thickness_m = dz;
    std::array<double, 4> base{}, rho{};
    for (std::size_t j = 0; j < strata_.size(); ++j) base[j] = value(strata_[j], bottom_h);
    put(c.base, base);
    const LayeredMedium &middle = between_.empty() ? strata_.front() : between_.back();
    for (std::size_t i = 0; i < 4; ++i) {
      const double h = geometric(z0 + dz * gauss_place[i]), u = value(middle, h);
      rho[i] = u != 0 ? middle.density_kg_m3(h) / u : 0;
    }
    const Cubic d = cubic_through(rho);
    std::copy(d.begin(), d.end(), c.density);
    double steepest = 1e-9;  // a longer path could leave the cell by curvature alone and come back unseen
    for (double t : probe)
      for (double s : {0.0, 0.5, 1.0}) steepest = std::max(steepest, std::abs(evaluate_at(b, t, s) + curvature_per_m_));
    c.step_cap_m = std::max(2 * dz, std::sqrt(8 * dz / steepest));
    return c;
  }

  SectionCellData vacuum(double to_h) const {
    SectionCellData c{};
    c.bottom_m = flattened(medium_.top_m);
    c.thickness_m = flattened(to_h) - c.bottom_m;
    c.step_cap_m = std::max(2 * c.thickness_m, std::sqrt(8 * c.thickness_m / std::max(curvature_per_m_, 1e-9)));
    return c;
  }

  const SectionMedium &medium_;
  double wavelength_nm_, wanted_rad_, curvature_per_m_, width_m_;
  std::vector<LayeredMedium> strata_, between_;  // at the nodes, and at the probes
  std::vector<SectionCellData> cells_;
  double worst_rad_ = 0;
};

struct Interval {
  double left_m, right_m;
};

/// The columns between the points, halved until each is narrow enough; all of one width of halving side by side.
std::vector<Interval> place_columns(const SectionMedium &medium, double wavelength_nm,
                                    const SectionTableOptions &options) {
  std::vector<Interval> open, done;
  for (std::size_t i = 0; i + 1 < medium.points_m.size(); ++i)
    open.push_back({medium.points_m[i], medium.points_m[i + 1]});
  while (!open.empty()) {
    std::vector<char> good(open.size());
    for_pieces(open.size(), 1, host_threads(), [&](std::size_t from, std::size_t to) {
      for (std::size_t i = from; i < to; ++i)
        good[i] = ColumnBuilder(medium, wavelength_nm, options, open[i].left_m, open[i].right_m).is_narrow_enough();
    });
    std::vector<Interval> halves;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const double middle = 0.5 * (open[i].left_m + open[i].right_m);
      if (good[i]) {
        done.push_back(open[i]);
      } else {
        halves.push_back({open[i].left_m, middle});
        halves.push_back({middle, open[i].right_m});
      }
    }
    open = std::move(halves);
    if (open.size() + done.size() > most_cells / 20)
      throw InputError(medium.place, "the profile needs more than " + std::to_string(most_cells / 20) +
                                         " columns along the surface for an error of " +
                                         std::to_string(options.error_arcsec) +
                                         " arcsec: expected layers that move more slowly or a larger error");
  }
  std::sort(done.begin(), done.end(), [](const Interval &a, const Interval &b) { return a.left_m < b.left_m; });
  return done;
}

/// One section: columns and cells appended to the table. Returns the number of columns.
std::size_t add_section(SectionTable &table, const SectionMedium &medium, double wavelength_nm,
                        const SectionTableOptions &options) {
  std::vector<Interval> columns;
  const bool varies = medium.points_m.size() >= 2;
  const double first_m = varies ? medium.points_m.front() : 0, last_m = varies ? medium.points_m.back() : 0;
  columns.push_back({first_m, first_m});
  if (varies) {
    const std::vector<Interval> inner = place_columns(medium, wavelength_nm, options);
    columns.insert(columns.end(), inner.begin(), inner.end());
    columns.push_back({last_m, last_m});
  }
  std::vector<std::vector<SectionCellData>> stacks(columns.size());
  std::vector<double> worst(columns.size());
  std::atomic<std::size_t> cells{table.cells.size()};
  for_pieces(columns.size(), 1, host_threads(), [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      ColumnBuilder builder(medium, wavelength_nm, options, columns[i].left_m, columns[i].right_m);
      stacks[i] = builder.build(options.observer_m);
      worst[i] = builder.worst_rad();
      if ((cells += stacks[i].size()) > most_cells)
        throw InputError(medium.place, "the profile needs more than " + std::to_string(most_cells) +
                                           " table cells for an error of " + std::to_string(options.error_arcsec) +
                                           " arcsec: expected a smoother profile or a larger error");
    }
  });
  for (std::size_t i = 0; i < columns.size(); ++i) {
    table.columns.push_back(
        {columns[i].left_m, columns[i].right_m - columns[i].left_m, table.cells.size(), stacks[i].size()});
    table.cells.insert(table.cells.end(), stacks[i].begin(), stacks[i].end());
    table.bound_arcsec = std::max(table.bound_arcsec, to_arcsec(worst[i]));
  }
  return columns.size();
}

}  // namespace

SectionMedium section_medium(const AirSection &air, bool flat) {
  SectionMedium medium;
  medium.at = [&air, flat](double x_m) {
    const auto profile = std::make_shared<Profile>(air.at(x_m));
    LayeredMedium stratum = layered_medium(*profile, flat);
    stratum.refractivity = [profile](double h, double nm) { return profile->refractivity(h, nm); };
    stratum.density_kg_m3 = [profile](double h) { return profile->density_kg_m3(h); };
    return stratum;
  };
  medium.points_m = air.points_m();
  if (air.is_separable())
    medium.factor = [model = air.spec().index](double nm) {
      return reference_refractivity(model, nm) / reference_refractivity(model, reference_nm);
    };
  medium.top_m = air.at(0).top_m(flat);
  medium.radius_m = flat ? 0 : air.spec().earth_radius_m;
  medium.place = air.spec().place;
  return medium;
}

SectionTable build_section_table(const SectionMedium &medium, const std::vector<double> &wavelength_nm,
                                 const SectionTableOptions &options) {
  SectionTable table;
  table.wavelength_nm = wavelength_nm;
  table.curvature_per_m = medium.radius_m > 0 ? 1 / medium.radius_m : 0;
  if (medium.factor) {
    const std::size_t columns = add_section(table, medium, reference_nm, options);
    for (double nm : wavelength_nm) table.rows.push_back({medium.factor(nm), 0, columns});
    return table;
  }
  for (double nm : wavelength_nm) {
    const std::size_t first = table.columns.size();
    table.rows.push_back({1, first, add_section(table, medium, nm, options)});
  }
  return table;
}

std::size_t SectionTable::find_column(std::size_t row, double x_m) const {
  const std::size_t columns_of_row = rows[row].columns;
  if (columns_of_row == 1 || x_m < column(row, 0).left_m) return 0;
  std::size_t low = 1, high = columns_of_row - 1;
  while (low < high) {
    const std::size_t middle = (low + high + 1) / 2;
    if (column(row, middle).left_m <= x_m) low = middle;
    else high = middle - 1;
  }
  return low;
}

std::size_t SectionTable::find_cell(const SectionColumnData &column, double z_m) const {
  const auto begin = cells.begin() + static_cast<std::ptrdiff_t>(column.first_cell);
  const auto end = begin + static_cast<std::ptrdiff_t>(column.cells);
  const auto above =
      std::upper_bound(begin, end, z_m, [](double z, const SectionCellData &c) { return z < c.bottom_m; });
  return above == begin ? 0 : static_cast<std::size_t>(above - begin) - 1;
}

double SectionTable::refractivity(std::size_t row, double z_m, double x_m) const {
  const SectionColumnData &c = column(row, find_column(row, x_m));
  const SectionCellData &cell = cells[c.first_cell + find_cell(c, z_m)];
  const double s = c.width_m > 0 ? (x_m - c.left_m) / c.width_m : 0, t = (z_m - cell.bottom_m) / cell.thickness_m;
  const auto in_s = [s](const double *k) { return k[0] + s * (k[1] + s * (k[2] + s * k[3])); };
  const double integral = t * (in_s(cell.slope) + t * (in_s(cell.slope + 4) / 2 +
                                                       t * (in_s(cell.slope + 8) / 3 + t * in_s(cell.slope + 12) / 4)));
  return rows[row].factor * (in_s(cell.base) + cell.thickness_m * integral);
}

}  // namespace greenray
