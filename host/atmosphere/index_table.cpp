#include "atmosphere/index_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "atmosphere/gauss_cubic.hpp"
#include "atmosphere/standard_atmosphere.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

constexpr std::array<double, 10> probe{0, 0.02, 0.18, 0.25, 0.5, 0.6, 0.75, 0.85, 0.98, 1};
constexpr std::size_t most_cells = 100000;

class Builder {
 public:
  Builder(const LayeredMedium &medium, const std::vector<double> &wavelength_nm, const IndexTableOptions &options)
      : medium_(medium), options_(options) {
    table_.wavelength_nm = wavelength_nm;
    table_.curvature_per_m = medium.radius_m > 0 ? 1 / medium.radius_m : 0;
    reference_nm_ = *std::min_element(wavelength_nm.begin(), wavelength_nm.end());
  }

  IndexTable build() {
    const double top_m = medium_.top_m;
    std::vector<double> edges{0.0};
    for (double kink : medium_.kinks_m)
      if (kink < top_m) edges.push_back(kink);
    edges.push_back(top_m);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) place(edges[i], edges[i + 1]);
    if (options_.observer_m > top_m) knots_.push_back({top_m, options_.observer_m + 0.01});
    table_.cells_per_row = knots_.size();
    for (double wavelength : table_.wavelength_nm) fill_row(wavelength);
    table_.bound_arcsec = to_arcsec(worst_rad_);
    return std::move(table_);
  }

 private:
  struct Knot {
    double bottom_h_m, top_h_m;
  };

  double flattened(double h) const {
    return table_.curvature_per_m > 0 ? std::log1p(h * table_.curvature_per_m) / table_.curvature_per_m : h;
  }
  double geometric(double z) const {
    return table_.curvature_per_m > 0 ? std::expm1(z * table_.curvature_per_m) / table_.curvature_per_m : z;
  }

  /// d(ln n)/dz; at the edges of the interval from inside, so that a kink belongs to the right side.
  double gradient(double h, double wavelength_nm) const {
    const Dual v = medium_.refractivity(h, wavelength_nm);
    return v.slope / (1 + v.value) * (1 + h * table_.curvature_per_m);
  }

  Cubic fit_gradient(const Knot &k, double wavelength_nm) const {
    const double z0 = flattened(k.bottom_h_m), dz = flattened(k.top_h_m) - z0;
    std::array<double, 4> y{};
    for (std::size_t i = 0; i < 4; ++i) y[i] = gradient(geometric(z0 + dz * gauss_place[i]), wavelength_nm);
    return cubic_through(y);
  }

  /// Bending [rad] that the residual causes over the longest path in the cell: sqrt(8 dz R) when it grazes, dz at
  /// least.
  double residual_rad(const Knot &k) const {
    const double z0 = flattened(k.bottom_h_m), dz = flattened(k.top_h_m) - z0;
    const Cubic c = fit_gradient(k, reference_nm_);
    double worst = 0;
    for (double t : probe) {
      const double inside = std::clamp(t, 1e-9, 1 - 1e-9);
      worst = std::max(worst, std::abs(evaluate(c, inside) - gradient(geometric(z0 + dz * inside), reference_nm_)));
    }
    const double radius_m = medium_.radius_m > 0 ? medium_.radius_m : 1e7;
    return worst * std::max(dz, std::sqrt(8 * dz * radius_m));
  }

  void place(double bottom_h, double top_h) {
    const double wanted_rad = from_arcsec(options_.error_arcsec);
    const double width = top_h - bottom_h;
    const Knot knot{bottom_h, top_h};
    const bool hides_a_feature = feature_inside(bottom_h, top_h);
    const double residual = width > medium_.top_m / 15 || hides_a_feature ? 1e9 : residual_rad(knot);
    if (residual > wanted_rad && width > 1e-7 * std::max(1.0, bottom_h)) {
      const double middle = 0.5 * (bottom_h + top_h);
      place(bottom_h, middle);
      place(middle, top_h);
      return;
    }
    worst_rad_ = std::max(worst_rad_, residual);
    knots_.push_back(knot);
    if (knots_.size() > most_cells)
      throw InputError(medium_.place, "the profile needs more than 100000 table cells for an error of " +
                                          std::to_string(options_.error_arcsec) +
                                          " arcsec: expected a smoother profile or a larger error");
  }

  /// A thin layer could hide between the probes of a wide cell: halve until the cell is no wider than the gap of the
  /// hints.
  bool feature_inside(double bottom_h, double top_h) const {
    const auto &f = medium_.features_m;
    const auto first = std::lower_bound(f.begin(), f.end(), bottom_h);
    const auto last = std::lower_bound(f.begin(), f.end(), top_h);
    return last - first > 6;
  }

  void fill_row(double wavelength_nm) {
    const double q_top = std::log1p(medium_.refractivity(medium_.top_m, wavelength_nm).value);
    std::vector<IndexCellData> row;
    for (const Knot &k : knots_) row.push_back(make_cell(k, wavelength_nm));
    // ln n is summed downwards from its value at the top, where it is smallest.
    double log_index = q_top;
    for (std::size_t i = row.size(); i-- > 0;) {
      IndexCellData &c = row[i];
      if (k_is_vacuum(knots_[i])) log_index = 0;
      const double integral = c.gradient[0] + c.gradient[1] / 2 + c.gradient[2] / 3 + c.gradient[3] / 4;
      c.log_index = log_index - c.thickness_m * integral;
      log_index = k_is_vacuum(knots_[i]) ? q_top : c.log_index;
    }
    table_.cells.insert(table_.cells.end(), row.begin(), row.end());
  }

  bool k_is_vacuum(const Knot &k) const { return k.bottom_h_m >= medium_.top_m; }

  IndexCellData make_cell(const Knot &k, double wavelength_nm) const {
    IndexCellData c{};
    c.bottom_m = flattened(k.bottom_h_m);
    c.thickness_m = flattened(k.top_h_m) - c.bottom_m;
    if (!k_is_vacuum(k)) {
      const Cubic g = fit_gradient(k, wavelength_nm);
      std::copy(g.begin(), g.end(), c.gradient);
      std::array<double, 4> rho{};
      for (std::size_t i = 0; i < 4; ++i)
        rho[i] = medium_.density_kg_m3(geometric(c.bottom_m + c.thickness_m * gauss_place[i]));
      const Cubic d = cubic_through(rho);
      std::copy(d.begin(), d.end(), c.density);
    }
    c.step_cap_m = step_cap(c);
    return c;
  }

  /// A path longer than this could leave the cell by curvature alone and come back unseen.
  double step_cap(const IndexCellData &c) const {
    double steepest = 1e-9;
    for (double t : probe) {
      const double g = c.gradient[0] + t * (c.gradient[1] + t * (c.gradient[2] + t * c.gradient[3]));
      steepest = std::max(steepest, std::abs(g + table_.curvature_per_m));
    }
    return std::max(2 * c.thickness_m, std::sqrt(8 * c.thickness_m / steepest));
  }

  const LayeredMedium &medium_;
  IndexTableOptions options_;
  IndexTable table_;
  double reference_nm_ = 550;
  std::vector<Knot> knots_;
  double worst_rad_ = 0;
};

}  // namespace

LayeredMedium layered_medium(const Profile &profile, bool flat) {
  LayeredMedium medium;
  medium.refractivity = [&profile](double h, double nm) { return profile.refractivity(h, nm); };
  medium.density_kg_m3 = [&profile](double h) { return profile.density_kg_m3(h); };
  medium.kinks_m = profile.kinks_m();
  medium.features_m = profile.features_m();
  medium.top_m = profile.top_m(flat);
  medium.radius_m = flat ? 0 : profile.spec().earth_radius_m;
  medium.place = profile.spec().place;
  return medium;
}

IndexTable build_index_table(const LayeredMedium &medium, const std::vector<double> &wavelength_nm,
                             const IndexTableOptions &options) {
  return Builder(medium, wavelength_nm, options).build();
}

IndexTable build_index_table(const Profile &profile, const std::vector<double> &wavelength_nm,
                             const IndexTableOptions &options) {
  return build_index_table(layered_medium(profile, options.flat), wavelength_nm, options);
}

std::size_t IndexTable::find(double z_m) const {
  const auto begin = cells.begin(), end = begin + static_cast<std::ptrdiff_t>(cells_per_row);
  const auto above = std::upper_bound(begin, end, z_m, [](double z, const IndexCellData &c) { return z < c.bottom_m; });
  return above == begin ? 0 : static_cast<std::size_t>(above - begin) - 1;
}

double IndexTable::log_index(std::size_t row, double z_m) const {
  const IndexCellData &c = cell(row, find(z_m));
  const double t = (z_m - c.bottom_m) / c.thickness_m;
  return c.log_index + c.thickness_m * t *
                           (c.gradient[0] + t * (c.gradient[1] / 2 + t * (c.gradient[2] / 3 + t * c.gradient[3] / 4)));
}

}  // namespace greenray
