#include "atmosphere/air_table.hpp"

#include <algorithm>
#include <cmath>

#include "atmosphere/air_table_error.hpp"
#include "support/error.hpp"

namespace greenray {
namespace {

constexpr double huge_m = 1e30;

/// n^2 and its slope; constant beyond the ends of the medium.
Dual index2(const LayeredMedium &medium, double height_m, double nm) {
  const double top = medium.top_m > 0 ? medium.top_m : huge_m;
  const double within = std::clamp(height_m, 0.0, top);
  const Dual r = medium.refractivity(within, nm);
  const Dual n{1 + r.value, r.slope};
  const Dual squared = n * n;
  return within == height_m ? squared : Dual{squared.value, 0};
}

/// d2z/dsigma2 = (d n^2/dz)/2
double lift(const LayeredMedium &medium, double height_m, double nm) {
  return 0.5 * index2(medium, height_m, nm).slope;
}

/// Heights between which the medium is smooth.
struct Band {
  double low_m, high_m;
  bool starts_at_kink;
  /// Slopes at a kink are those of its inner side.
  double inside(double z_m) const {
    const double hair_m = 1e-9 * (high_m - low_m);
    return std::clamp(z_m, low_m + hair_m, high_m - hair_m);
  }
};

/// How well the table is to follow the medium and arcs are to follow paths.
struct Precision {
  double lift_per_m;  // error of d2z/dsigma2
  double arc_m;       // distance of an arc from its path
};

class Builder {
 public:
  Builder(const LayeredMedium &medium, const std::vector<double> &wavelength_nm, const AirTableOptions &options)
      : medium_(medium), options_(options) {
    table_.wavelength_nm = wavelength_nm;
  }

  std::vector<Band> bands() const {
    const double top = medium_.top_m > 0 ? medium_.top_m : options_.high_m;
    const double low = std::max(options_.low_m, 0.0), high = std::min(std::max(options_.high_m, low + 1e-3), top);
    std::vector<double> edges{std::min(low, high)};
    for (const double kink : medium_.kinks_m)
      if (kink > low && kink < high) edges.push_back(kink);
    if (high > low) edges.push_back(high);
    std::vector<Band> all;
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) part({edges[i], edges[i + 1], true}, 0, all);
    return all;
  }

  AirTable build(const std::vector<Band> &bands, const Precision &precision, int finer) {
    AirTable out;
    out.wavelength_nm = table_.wavelength_nm;
    const double bottom = bands.empty() ? 0 : bands.front().low_m, top = bands.empty() ? 0 : bands.back().high_m;
    out.cells = 0;
    out.layers.push_back(endless(-huge_m, 0));
    int first = 1;
    for (const Band &b : bands) {
      surface64::AirLayer layer{};
      layer.bottom_m = b.low_m;
      layer.first = first;
      layer.cells = cells_of(b, precision.lift_per_m, first) * finer;
      layer.cells_per_m = layer.cells / (b.high_m - b.low_m);
      first += layer.cells;
      out.layers.push_back(layer);
    }
    out.layers.push_back(endless(top, first));
    out.cells = static_cast<std::size_t>(first) + 1;
    for (const double nm : out.wavelength_nm) {
      out.rows.push_back({{index2(medium_, bottom, nm).value, 0, 0, 0}});
      for (std::size_t i = 0; i < bands.size(); ++i) add_cells(bands[i], out.layers[i + 1].cells, nm, out.rows);
      out.rows.push_back({{index2(medium_, top, nm).value, 0, 0, 0}});
    }
    for (surface64::AirLayer &layer : out.layers) set_steps(out, precision.arc_m, layer);
    return out;
  }

 private:
  static surface64::AirLayer endless(double bottom_m, int first) {
    surface64::AirLayer layer{};
    layer.bottom_m = bottom_m, layer.first = first, layer.cells = 1;
    return layer;
  }

  /// Largest |d lift/dz| at 64 heights.
  double largest_change(const Band &b) const {
    double most = 0;
    constexpr int samples = 64;
    const double step = (b.high_m - b.low_m) / samples, nm = table_.wavelength_nm[table_.wavelength_nm.size() / 2];
    double before = lift(medium_, b.inside(b.low_m), nm);
    for (int i = 1; i <= samples; ++i) {
      const double here = lift(medium_, b.inside(b.low_m + i * step), nm);
      most = std::max(most, std::abs(here - before) / step);
      before = here;
    }
    return most;
  }

  /// Halves a band when arcs could be twice as long in one half, and are shorter than the band.
  void part(const Band &b, int depth, std::vector<Band> &all) const {
    const double middle = 0.5 * (b.low_m + b.high_m);
    const Band low{b.low_m, middle, b.starts_at_kink}, high{middle, b.high_m, false};
    const double below = largest_change(low), above = largest_change(high), both = std::max(below, above);
    if (depth < 10 && 8 * std::min(below, above) < both &&
        steep_step(0.5 * options_.error_m, both, 1) < b.high_m - b.low_m) {
      part(low, depth + 1, all);
      part(high, depth + 1, all);
    } else {
      all.push_back(b);
    }
  }

  /// Cells of even thickness, halved until the cubics' slopes are good.
  int cells_of(const Band &b, double most_error, int before) const {
    int cells = 1;
    while (!is_good(b, cells, most_error)) {
      cells *= 2;
      if (before + cells > options_.most_cells)
        throw InputError(medium_.place, "this medium needs more than " +
                                            std::to_string(static_cast<int>(options_.most_cells)) +
                                            " cells for paths among surfaces: smooth it, or ask for a larger error");
    }
    return cells;
  }

  bool is_good(const Band &b, int cells, double most_error) const {
    const double nm = table_.wavelength_nm[table_.wavelength_nm.size() / 2], thickness = (b.high_m - b.low_m) / cells;
    // Below this the difference is rounding: n^2 itself is good to 1e-16.
    if (most_error * thickness < 1e-14) return true;
    std::vector<surface64::AirCell> row;
    add_cells(b, cells, nm, row);
    const auto error = [&](double z) {
      const double at = std::clamp((z - b.low_m) / thickness, 0.0, cells - 1e-9);
      const double t = at - std::floor(at);
      const auto &c = row[static_cast<std::size_t>(at)].index2;
      return std::abs(0.5 * (c[1] + t * (2 * c[2] + t * 3 * c[3])) / thickness - lift(medium_, b.inside(z), nm));
    };
    for (int i = 0; i < cells; ++i)
      for (const double t : {0.1, 0.25, 0.5, 0.75, 0.9})
        if (error(b.low_m + (i + t) * thickness) > most_error) return false;
    return std::none_of(medium_.features_m.begin(), medium_.features_m.end(),
                        [&](double z) { return z > b.low_m && z < b.high_m && error(z) > most_error; });
  }

  void add_cells(const Band &b, int cells, double nm, std::vector<surface64::AirCell> &row) const {
    const double thickness = (b.high_m - b.low_m) / cells;
    const auto knot = [&](int i) {
      const double z = i == cells ? b.high_m : b.low_m + i * thickness;
      return Dual{index2(medium_, z, nm).value, index2(medium_, b.inside(z), nm).slope * thickness};
    };
    Dual low = knot(0);
    for (int i = 0; i < cells; ++i) {
      const Dual high = knot(i + 1);
      const double rise = high.value - low.value;
      row.push_back({{low.value, low.slope, 3 * rise - 2 * low.slope - high.slope, low.slope + high.slope - 2 * rise}});
      low = high;
    }
  }

  /* An arc is off a path whose height has the third derivative l p, l = d lift/dz, by l p sigma^3 / (72 sqrt(3)) =
     0.008 l p sigma^3 (a cubic against the parabola through its ends, of its mean bend). p is at most n, at most p0 +
     lift sigma. */
  static double steep_step(double off_m, double change, double momentum) {
    return std::cbrt(off_m / (0.016 * change * momentum));
  }

  void set_steps(const AirTable &table, double off_m, surface64::AirLayer &layer) const {
    double change = 0, lift = 0, index2 = 1;
    const std::size_t rows = table.wavelength_nm.size(), first = static_cast<std::size_t>(layer.first);
    for (std::size_t w = 0; w < rows; ++w)
      for (std::size_t i = 0; i < static_cast<std::size_t>(layer.cells); ++i) {
        const auto &c = table.rows[w * table.cells + first + i].index2;
        const double scale = 0.5 * layer.cells_per_m;
        for (const double t : {0.0, 1.0}) {
          change = std::max(change, std::abs(2 * c[2] + 6 * c[3] * t) * scale * layer.cells_per_m);
          lift = std::max(lift, std::abs(c[1] + t * (2 * c[2] + t * 3 * c[3])) * scale);
        }
        index2 = std::max(index2, c[0]);
      }
    const double n = std::sqrt(index2), length = options_.length_m;
    layer.linear = change * n * length * length * length / 6 < 0.25 * off_m;
    layer.steep_step = layer.level_step = huge_m;
    if (layer.linear) return;
    layer.steep_step = steep_step(off_m, change, n) * std::sqrt(std::sqrt(n));
    // No longer than what one turn of an oscillation about a duct would take, divided by 2 pi.
    layer.level_step =
        std::min(std::sqrt(std::sqrt(off_m / (0.016 * change * std::max(lift, 1e-300)))), 1 / std::sqrt(change));
  }

  const LayeredMedium &medium_;
  const AirTableOptions &options_;
  AirTable table_;
};

/// Kinks and the top.
std::vector<double> edges_of(const std::vector<Band> &bands) {
  std::vector<double> edges;
  for (const Band &b : bands)
    if (b.starts_at_kink) edges.push_back(b.low_m);
  if (!bands.empty()) edges.push_back(bands.back().high_m);
  return edges;
}

}  // namespace

AirTable build_air_table(const LayeredMedium &medium, const std::vector<double> &wavelength_nm,
                         const AirTableOptions &options) {
  Builder builder(medium, wavelength_nm, options);
  const std::vector<Band> bands = builder.bands();
  const std::vector<TestPath> fan = test_fan(edges_of(bands));
  Precision precision{0.5 * options.error_m / (options.length_m * options.length_m), 0.5 * options.error_m};
  const double least = 1e-4 * options.error_m;
  AirTable table;
  for (;; precision.lift_per_m /= 4, precision.arc_m /= 4) {
    table = builder.build(bands, precision, 1);
    const AirTable finer = builder.build(bands, {precision.lift_per_m, precision.arc_m / 256}, 4);
    table.error_m = largest_difference_m(table, finer, fan, options.length_m);
    if (table.error_m <= options.error_m || precision.arc_m < least) break;
  }
  for (std::size_t l = 0; l < table.layers.size(); ++l)
    for (std::size_t w = 0; w < wavelength_nm.size(); ++w)
      for (int i = 0; i < table.layers[l].cells; ++i) {
        const auto &c = table.rows[w * table.cells + static_cast<std::size_t>(table.layers[l].first + i)].index2;
        for (const double t : {0.0, 1.0})
          table.largest_bend_per_m =
              std::max(table.largest_bend_per_m,
                       0.25 * table.layers[l].cells_per_m * std::abs(c[1] + t * (2 * c[2] + t * 3 * c[3])));
      }
  return table;
}

AirTable uniform_air(double refractivity, const std::vector<double> &wavelength_nm) {
  AirTable table;
  table.wavelength_nm = wavelength_nm;
  surface64::AirLayer all{};
  all.bottom_m = -huge_m, all.cells = 1, all.linear = 1, all.steep_step = all.level_step = huge_m;
  table.layers = {all};
  const double n = 1 + refractivity;
  table.rows.assign(wavelength_nm.size(), surface64::AirCell{{n * n, 0, 0, 0}});
  return table;
}

double AirTable::parting_per_m() const {
  if (layers.size() < 3) return 0;
  double parting = 0;
  for (std::size_t l = 1; l + 1 < layers.size(); ++l)
    for (int i = 0; i < layers[l].cells; ++i) {
      double low = 1e300, high = -1e300;
      for (std::size_t w = 0; w < wavelength_nm.size(); ++w) {
        const auto &c = rows[w * cells + static_cast<std::size_t>(layers[l].first + i)].index2;
        const double rise = c[1] + c[2] + c[3];  // of n^2 over the cell
        low = std::min(low, rise), high = std::max(high, rise);
      }
      parting += 0.25 * (high - low);
    }
  return parting / (layers.back().bottom_m - layers[1].bottom_m);
}

std::vector<surface32::AirLayer> AirTable::narrowed_layers() const {
  std::vector<surface32::AirLayer> out;
  for (const surface64::AirLayer &l : layers)
    out.push_back({static_cast<float>(l.bottom_m), static_cast<float>(l.cells_per_m), l.first, l.cells,
                   static_cast<float>(l.steep_step), static_cast<float>(l.level_step), l.linear, 0});
  return out;
}

std::vector<surface32::AirCell> AirTable::narrowed() const {
  std::vector<surface32::AirCell> out;
  for (const surface64::AirCell &c : rows) {
    surface32::AirCell narrow{};
    for (std::size_t k = 0; k < 4; ++k) narrow.index2[k] = static_cast<float>(c.index2[k]);
    out.push_back(narrow);
  }
  return out;
}

}  // namespace greenray
