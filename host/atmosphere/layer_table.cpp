#include "atmosphere/layer_table.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "atmosphere/far_nodes.hpp"
#include "atmosphere/gauss_legendre.hpp"
#include "support/angle.hpp"
#include "twin/twin.hpp"

namespace greenray {
namespace {

/// What the table says at one flattened height.
struct Point {
  double gradient, potential, density;  // d(ln n)/dz, ln N, kg/m^3
};

class Medium {
 public:
  Medium(const IndexTable &table, std::size_t row) : table_(table), row_(row) {}

  Point at(double z_m, std::size_t cell) const {
    const IndexCellData &c = table_.cell(row_, cell);
    const double t = (z_m - c.bottom_m) / c.thickness_m;
    const auto &g = c.gradient, &d = c.density;
    const double ln_n = c.log_index + c.thickness_m * t * (g[0] + t * (g[1] / 2 + t * (g[2] / 3 + t * g[3] / 4)));
    return {g[0] + t * (g[1] + t * (g[2] + t * g[3])), ln_n + z_m * table_.curvature_per_m,
            d[0] + t * (d[1] + t * (d[2] + t * d[3]))};
  }
  double potential(double z_m) const { return at(z_m, table_.find(z_m)).potential; }
  const IndexTable &table() const { return table_; }

 private:
  const IndexTable &table_;
  std::size_t row_;
};

/// Weights of all quantities at a height, per dz / sin e (kernels/shared/layers.h).
std::array<double, layer_quantities> weights(const Point &p, double z_m, double eye_potential, double curvature_per_m,
                                             const LayerAbsorbers &a) {
  const double shrink = std::exp(eye_potential - p.potential);  // cos e / cos e0
  const double stretch = std::exp(z_m * curvature_per_m);
  const double ozone = (z_m - a.ozone_peak_m) / a.ozone_width_m;
  return {-p.gradient * shrink,
          shrink,
          std::exp(p.potential),
          p.density * stretch,
          std::exp(-0.5 * ozone * ozone) * stretch,
          std::exp(-z_m / a.aerosol_scale_m) * stretch};
}

/// One layer from near to far. Mean and tilt are the first two Legendre moments of the weights.
LayerData weigh(const Medium &medium, double near_m, double far_m, double eye_potential,
                const LayerAbsorbers &absorbers) {
  const IndexTable &table = medium.table();
  LayerData layer{};
  layer.far_m = far_m;
  const auto lift = [&](double z) { return -std::expm1(-2 * (medium.potential(z) - eye_potential)); };
  const double near_lift = lift(near_m);
  layer.lift = lift(far_m);
  const auto off_line = [&](double t) {
    return lift(near_m + t * (far_m - near_m)) - near_lift - t * (layer.lift - near_lift);
  };
  layer.bulge = -4 * off_line(0.5);
  layer.skew = 32.0 / 3 * (off_line(0.75) - off_line(0.25));
  const double low = std::min(near_m, far_m), high = std::max(near_m, far_m), thickness = high - low;
  for (double from = low; from < high;) {  // panel by panel of the table: its cubics are smooth inside a cell only
    std::size_t cell = table.find(from);
    const IndexCellData &c = table.cell(0, cell);
    double to = std::min(high, c.bottom_m + c.thickness_m);
    if (to <= from) to = high;
    const double half = 0.5 * (to - from), centre = 0.5 * (from + to);
    for (std::size_t i = 0; i < 2 * legendre_node.size(); ++i) {
      const double z = centre + (i % 2 ? half : -half) * legendre_node[i / 2];
      const double share = half * legendre_weight[i / 2];
      const double t = std::abs(z - near_m) / thickness;
      const auto w = weights(medium.at(z, cell), z, eye_potential, table.curvature_per_m, absorbers);
      for (std::size_t q = 0; q < w.size(); ++q) {
        layer.mean[q] += share * w[q];
        layer.tilt[q] += 12 * share * w[q] * (t - 0.5);
        layer.bow[q] += 5 * share * w[q] * (6 * t * t - 6 * t + 1);
      }
    }
    from = to;
  }
  return layer;
}

/// The closed form over one layer for a ray with these sines squared at its edges; cos^2 at the eye is 1.
double closed_form(const LayerData &layer, double near2, double far2, std::size_t q = f64::LAYER_BENDING) {
  const f64::LayerFactors f = f64::layer_factors(std::sqrt(near2), std::sqrt(far2), layer.bulge, layer.skew);
  return layer.mean[q] * f.mean + layer.tilt[q] * f.tilt + layer.bow[q] * f.bow;
}

constexpr double air_mass_error = 4e-5;  // relative, of one layer's share

/// Allowed to the distance across a layer without air, relatively: nothing else could be wrong there.
double vacuum_error(double error_arcsec) { return std::clamp(1e-2 * error_arcsec, 1e-10, 3e-7); }

class Placer {
 public:
  Placer(const IndexTable &fine, std::size_t row, double error_rad) : medium_(fine, row), error_rad_(error_rad) {}

  void place(double low, double high, std::vector<double> &edges, int depth = 0) const {
    if (depth < 40 && high - low > 1e-4 && disagreement(low, high) > error_rad_) {
      const double middle = 0.5 * (low + high);
      place(low, middle, edges, depth + 1);
      place(middle, high, edges, depth + 1);
    } else {
      edges.push_back(high);
    }
  }

 private:
  /// Largest difference between the layer and its halves over rays that are level at the lower or the upper edge
  /// (whichever side they stay on) and at some heights beyond, where the layer is crossed steeply.
  double disagreement(double low, double high) const {
    const double middle = 0.5 * (low + high), reference = medium_.potential(low);
    const LayerAbsorbers none;
    const LayerData whole = weigh(medium_, low, high, reference, none);
    const LayerData first = weigh(medium_, low, middle, reference, none);
    const LayerData second = weigh(medium_, middle, high, reference, none);
    const double lift_middle = first.lift, lift_high = whole.lift;
    const double lowest = std::min({0.0, lift_middle, lift_high});
    double worst = 0;
    for (double extra : {0.0, 0.02, 0.1, 0.4, 1.6}) {
      const double spread = std::max({std::abs(lift_middle), std::abs(lift_high), 1e-15});
      const double sine2 = extra * spread - lowest;  // sin^2 at the lower edge: level somewhere, or steeper
      const double near2 = std::max(sine2, 0.0), mid2 = sine2 + lift_middle, far2 = sine2 + lift_high;
      if (mid2 < 0 || far2 < 0 || (near2 == 0 && mid2 == 0) || (far2 == 0 && mid2 == 0)) continue;
      const auto halves = [&](double more) {
        return closed_form(first, near2 + more, mid2 + more) + closed_form(second, mid2 + more, far2 + more);
      };
      const double two = halves(0), one = closed_form(whole, near2, far2);
      // Where a ray is nearly level at a height of balance, refraction changes faster than the direction it is seen in:
      // an error is as good as a direction off by error / |dR/da|, so it may be that much larger.
      const double sine = std::sqrt(near2), turn = 1e-3 * sine + 1e-9;
      const double stretch = std::abs(halves((2 * sine + turn) * turn) - two) / turn;
      worst = std::max(worst, std::abs(one - two) / std::max(1.0, stretch));
      const double air =
          closed_form(first, near2, mid2, f64::LAYER_AIR) + closed_form(second, mid2, far2, f64::LAYER_AIR);
      const double off = std::abs(closed_form(whole, near2, far2, f64::LAYER_AIR) - air);
      if (air > 0) worst = std::max(worst, off / air * error_rad_ / air_mass_error);
      if (whole.mean[f64::LAYER_BENDING] != 0) continue;
      const double way =
          closed_form(first, near2, mid2, f64::LAYER_DISTANCE) + closed_form(second, mid2, far2, f64::LAYER_DISTANCE);
      const double miss = std::abs(closed_form(whole, near2, far2, f64::LAYER_DISTANCE) - way) / way;
      worst = std::max(worst, miss * error_rad_ / vacuum_error(to_arcsec(error_rad_)));
    }
    return worst;
  }

  Medium medium_;
  double error_rad_;
};

}  // namespace

namespace {

/// Heights inside cell i where N is level, d(ln N)/dz = gradient + 1/R = 0: there a ray may turn between two edges
/// unseen.
void add_extremes(const IndexTable &fine, std::size_t row, std::size_t i, std::vector<double> &edges) {
  const IndexCellData &c = fine.cell(row, i);
  const auto slope = [&](double t) {
    return c.gradient[0] + t * (c.gradient[1] + t * (c.gradient[2] + t * c.gradient[3])) + fine.curvature_per_m;
  };
  constexpr int pieces = 8;
  for (int k = 0; k < pieces; ++k) {
    double low = k / double(pieces), high = (k + 1) / double(pieces);
    if ((slope(low) < 0) == (slope(high) < 0)) continue;
    const bool falls = slope(low) > 0;
    for (int step = 0; step < 50; ++step) {
      const double middle = 0.5 * (low + high);
      ((slope(middle) > 0) == falls ? low : high) = middle;
    }
    edges.push_back(c.bottom_m + 0.5 * (low + high) * c.thickness_m);
  }
}

}  // namespace

std::vector<double> place_layers(const IndexTable &fine, std::size_t row, double eye_m, double error_arcsec) {
  std::vector<double> fixed;  // where the gradient jumps, the eye, bottom and top
  for (std::size_t i = 0; i + 1 < fine.cells_per_row; ++i) {
    const IndexCellData &c = fine.cell(row, i), &n = fine.cell(row, i + 1);
    const double end = c.gradient[0] + c.gradient[1] + c.gradient[2] + c.gradient[3];
    if (std::abs(end - n.gradient[0]) > 1e-4 * (std::abs(end) + std::abs(n.gradient[0])) + 1e-18)
      fixed.push_back(n.bottom_m);
  }
  for (std::size_t i = 0; i < fine.cells_per_row; ++i) add_extremes(fine, row, i, fixed);
  const double top = fine.top_m();
  if (eye_m > 0 && eye_m < top) fixed.push_back(eye_m);
  fixed.push_back(top);
  std::sort(fixed.begin(), fixed.end());
  std::vector<double> edges{0};
  const Placer placer(fine, row, from_arcsec(error_arcsec));
  for (double end : fixed) {
    const double start = edges.back();
    if (end - start < 1e-9) continue;
    // A layer never spans a thin feature unseen: at first no more than six cells of the fine table.
    std::size_t cell = fine.find(start);
    double from = start;
    while (from < end) {
      cell = std::min(cell + 6, fine.cells_per_row);
      const double to = cell < fine.cells_per_row ? std::min(end, fine.cell(row, cell).bottom_m) : end;
      if (to > from) placer.place(from, to, edges);
      from = std::max(to, from);
      if (cell >= fine.cells_per_row) break;
    }
  }
  return edges;
}

LayerTable build_layer_table(const IndexTable &fine, const std::vector<double> &edges_m, double eye_m,
                             const LayerAbsorbers &absorbers) {
  LayerTable table;
  table.eye_m = eye_m;
  table.wavelength_nm = fine.wavelength_nm;
  for (std::size_t row = 0; row < fine.wavelength_nm.size(); ++row) {
    const Medium medium(fine, row);
    const double eye_potential = medium.potential(eye_m);
    table.index_eye.push_back(std::exp(eye_potential));
    table.level_rises.push_back(medium.at(eye_m, fine.find(eye_m)).gradient + fine.curvature_per_m >= 0);
    LayerSide above, below;
    const auto add = [&](LayerSide &side, double near_m, double far_m) {
      side.layers.push_back(weigh(medium, near_m, far_m, eye_potential, absorbers));
      side.lowest_lift = std::min(side.lowest_lift, side.layers.back().lift);
    };
    for (std::size_t i = 0; i + 1 < edges_m.size(); ++i)
      if (edges_m[i] >= eye_m - 1e-9) add(above, edges_m[i], edges_m[i + 1]);
    for (std::size_t i = edges_m.size() - 1; i > 0; --i)
      if (edges_m[i] <= eye_m + 1e-9) add(below, edges_m[i], edges_m[i - 1]);
    table.above.push_back(std::move(above));
    table.below.push_back(std::move(below));
  }
  table.near_above = table.above.front().layers.size();
  table.far.resize(table.above.size());
  return table;
}

namespace {

/// The medium above from_m, in panels thin against their distance from the eye, for there the lift tends to 0. Nothing
/// if some of it has a lift that is not above 0.
std::optional<FarMedium> far_medium(const IndexTable &fine, std::size_t row, double eye_m, double from_m,
                                    const LayerAbsorbers &absorbers) {
  const Medium medium(fine, row);
  const double eye_potential = medium.potential(eye_m), top_m = fine.top_m();
  FarMedium far;
  for (double from = from_m; from < top_m;) {
    const std::size_t cell = fine.find(from);
    const IndexCellData &c = fine.cell(row, cell);
    double to = std::min({c.bottom_m + c.thickness_m, from + 0.4 * (from - eye_m), top_m});
    if (to <= from) to = std::min(top_m, from + 1e-9 * (1 + from));
    const double half = 0.5 * (to - from), centre = 0.5 * (from + to);
    for (std::size_t i = 0; i < 2 * legendre_node.size(); ++i) {
      const double z = centre + (i % 2 ? half : -half) * legendre_node[i / 2];
      const Point p = medium.at(z, cell);
      far.lift.push_back(-std::expm1(-2 * (p.potential - eye_potential)));
      if (far.lift.back() <= 0) return std::nullopt;
      far.weight.push_back(weights(p, z, eye_potential, fine.curvature_per_m, absorbers));
      for (double &w : far.weight.back()) w *= half * legendre_weight[i / 2];
    }
    from = to;
  }
  if (far.lift.empty()) return std::nullopt;
  return compressed(far);
}

constexpr std::size_t layer_cost = 3;  // of one layer, in nodes
constexpr std::size_t most_nodes = 48;

}  // namespace

void merge_far_layers(LayerTable &table, const IndexTable &fine, const LayerAbsorbers &absorbers, double error_arcsec,
                      bool bending_only) {
  const std::vector<LayerData> &layers = table.above.front().layers;
  const double error_rad = from_arcsec(error_arcsec), relative = error_arcsec / 1000;
  std::size_t best_cost = layer_cost * layers.size(), best_near = layers.size(), best_count = 0;
  for (std::size_t near = 1; near < layers.size() && layer_cost * near + 4 < best_cost; near += 1 + near / 4) {
    if (layers[near - 1].lift <= 0) continue;
    const auto far = far_medium(fine, 0, table.eye_m, layers[near - 1].far_m, absorbers);
    if (!far) continue;
    const std::size_t affordable = std::min(most_nodes, best_cost - layer_cost * near - 1);
    const std::size_t count = merge_far(*far, error_rad, relative, bending_only, affordable / 4 * 4).size();
    if (count == 0 || layer_cost * near + count >= best_cost) continue;
    best_cost = layer_cost * near + count, best_near = near, best_count = count;
  }
  if (best_count == 0) return;
  std::vector<std::vector<FarNode>> all;
  double worst_rad = 0;
  for (std::size_t row = 0; row < table.above.size(); ++row) {
    const auto far = far_medium(fine, row, table.eye_m, table.above[row].layers[best_near - 1].far_m, absorbers);
    if (!far) return;  // a wavelength for which it cannot be done: leave all as it is
    FarFit fit = fit_far(*far, best_count, bending_only);
    if (fit.nodes.size() != best_count || fit.bending_error_rad > 2 * error_rad) return;
    worst_rad = std::max(worst_rad, fit.bending_error_rad);
    all.push_back(std::move(fit.nodes));
  }
  table.near_above = best_near;
  table.far = std::move(all);
  table.far_error_arcsec = to_arcsec(worst_rad);
}

}  // namespace greenray
