#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <sstream>

#include "bench/report.hpp"

namespace greenray::bench {
namespace {

constexpr double worst_error_shown = 1;  // arcsec: settings that miss a thin layer would squeeze all others

bool is_growth(const std::string &case_name) {
  return case_name == "cores" || case_name == "rays" || case_name == "wavelengths";
}

/// In order of appearance, without repetition.
template <class Key>
std::vector<std::string> distinct(const std::vector<const Record *> &records, Key key) {
  std::vector<std::string> all;
  for (const Record *r : records)
    if (std::find(all.begin(), all.end(), key(*r)) == all.end()) all.push_back(key(*r));
  return all;
}

template <class Wanted>
std::vector<const Record *> chosen(const Results &results, Wanted wanted) {
  std::vector<const Record *> some;
  for (const Record &r : results.records)
    if (wanted(r)) some.push_back(&r);
  return some;
}

bool has(const std::string &text, const char *words) { return text.find(words) != std::string::npos; }

/// Colour tells the solver, the marker whose it is, dashes the precision, a hollow marker one lane.
PlotLine style_of(const Record &r) {
  PlotLine line{r.curve(), "#5b6770", {}, {}};
  const std::string &solver = r.kind.solver;
  if (solver == "closed form" || solver == "transfer table") line.colour = "#0b6fa4";
  else if (solver == "rk45" || has(solver, "per pixel")) line.colour = has(r.variant, "image") ? "#e9a98f" : "#c8502b";
  else if (solver == "richardson") line.colour = "#8757a3";
  else if (solver == "quadrature") line.colour = "#1c8a5b";
  line.marker = PlotMarker::disc;
  if (r.kind.by == "native C++") line.marker = PlotMarker::diamond;
  else if (has(r.kind.by, "Boost")) line.marker = PlotMarker::square;
  else if (!r.ours()) line.marker = PlotMarker::triangle;
  line.hollow = r.kind.lanes == 1 && (r.ours() || r.kind.by == "native C++");
  line.dashed = r.kind.precision == "double" && r.ours();
  if (has(r.variant, "classical")) line.dashed = true;
  if (has(r.kind.by, "untuned")) line.colour = "#b0a184";
  return line;
}

/// A colour mixed with white.
std::string faded(const std::string &colour) {
  std::string pale = "#";
  for (std::size_t i = 1; i + 1 < colour.size(); i += 2) {
    char text[4];
    std::snprintf(text, sizeof text, "%02x", (std::stoi(colour.substr(i, 2), nullptr, 16) * 2 + 255 * 3) / 5 & 255);
    pale += text;
  }
  return pale;
}

bool beaten(const Record &r, const std::vector<const Record *> &curve) {
  return std::any_of(curve.begin(), curve.end(), [&](const Record *other) {
    return other != &r && other->error <= r.error && other->rate >= r.rate &&
           (other->error < r.error || other->rate > r.rate);
  });
}

std::string note_of(const Record &r) {
  return r.variant + ": " + short_number(r.rate) + r.rate_unit + ", error " + short_number(r.error) + " " +
         r.error_unit;
}

void add_point(PlotLine &line, const Record &r, double x, double y) {
  line.x.push_back(x), line.y.push_back(y), line.notes.push_back(note_of(r));
}

/// One curve: its best settings joined, the others as pale points.
std::vector<PlotLine> lines_of(std::vector<const Record *> curve, const std::function<double(const Record &)> &x) {
  std::sort(curve.begin(), curve.end(), [](const Record *a, const Record *b) { return a->error < b->error; });
  PlotLine best = style_of(*curve.front());
  best.width = 2;
  PlotLine others = best;
  others.name = "", others.width = 0, others.colour = faded(best.colour);
  for (const Record *r : curve) add_point(beaten(*r, curve) ? others : best, *r, x(*r), r->error);
  return {others, best};
}

/// Room around the points of a log axis.
void widen(PlotAxis &axis, const std::vector<double> &values, double most = 1e300) {
  double low = 1e300, high = 0;
  for (const double v : values) {
    if (!(v > 0) || v > most) continue;
    low = std::min(low, v), high = std::max(high, v);
  }
  if (high > 0) axis.low = low / 1.35, axis.high = std::min(high * 1.35, most);
}

std::vector<double> column(const PlotPanel &panel, std::vector<double> PlotLine::*values) {
  std::vector<double> all;
  for (const PlotLine &line : panel.lines) all.insert(all.end(), (line.*values).begin(), (line.*values).end());
  return all;
}

Figure figure_of(const std::vector<const Record *> &records, const std::function<double(const Record &)> &x) {
  Figure figure;
  PlotPanel panel;
  for (const std::string &name : distinct(records, [](const Record &r) { return r.curve(); })) {
    std::vector<const Record *> curve;
    for (const Record *r : records)
      if (r->curve() == name) curve.push_back(r);
    for (const PlotLine &line : lines_of(curve, x)) panel.lines.push_back(line);
    figure.legend.push_back(panel.lines.back());
  }
  figure.plot.panels.push_back(panel);
  figure.plot.legend = false;
  figure.plot.panel_width = 880, figure.plot.panel_height = 470;
  return figure;
}

std::string air_words(const std::string &case_name) {
  if (case_name == "us76") return "standard air (US76), eye at 2 m, from the horizon to 5°";
  if (case_name == "thin-5K") return "standard air with an inversion of 5 K, 3 m thick, at 50 m";
  if (case_name == "ten-inversions") return "standard air with ten inversions of 1 K, 3 m thick, from 50 to 500 m";
  if (case_name == "pal-air") return "the two-layer air of palRefro, traced by all, from 0 to 5°";
  return case_name;
}

}  // namespace

std::string short_number(double value) {
  std::ostringstream text;
  text.precision(3);
  const double size = std::abs(value);
  if (size >= 1e9) text << value / 1e9 << " G";
  else if (size >= 1e6) text << value / 1e6 << " M";
  else if (size >= 1e4) text << value / 1e3 << " k";
  else if (size >= 1e-4 || size == 0) text << value;
  else {
    static const char *const digit[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    const int power = static_cast<int>(std::floor(std::log10(size)));
    text.precision(2);
    text << value / std::pow(10.0, power) << "·10⁻";
    for (const char c : std::to_string(-power)) text << digit[c - '0'];
  }
  return text.str();
}

std::vector<Figure> work_precision_figures(const Results &results) {
  std::vector<Figure> figures;
  const auto all = chosen(results, [](const Record &r) { return r.suite == "trace" && !is_growth(r.case_name); });
  for (const std::string &name : distinct(all, [](const Record &r) { return r.case_name; })) {
    const auto records = chosen(results, [&](const Record &r) { return r.suite == "trace" && r.case_name == name; });
    Figure figure = figure_of(records, [](const Record &r) { return r.rate; });
    PlotPanel &panel = figure.plot.panels.front();
    panel.x = {"rays per second", "", true};
    panel.y = {"largest error of refraction", "arcsec", true};
    widen(panel.x, column(panel, &PlotLine::x));
    widen(panel.y, column(panel, &PlotLine::y), worst_error_shown);
    const auto outside =
        std::count_if(records.begin(), records.end(), [](const Record *r) { return r->error > worst_error_shown; });
    panel.levels = {{0.01, "0.01″", "#7a7a72"}, {0.003, "0.003″", "#7a7a72"}};
    figure.plot.id = "speed" + std::to_string(figures.size());
    figure.plot.title = name + ": speed against error";
    figure.plot.subtitle = air_words(name) + "; further right and further down is better";
    if (outside > 0)
      figure.caption =
          std::to_string(outside) + (outside == 1 ? " setting" : " settings") + " with an error above 1″ off the plot.";
    figures.push_back(figure);
  }
  return figures;
}

std::vector<Figure> growth_figures(const Results &results) {
  Figure figure;
  const auto add = [&](const std::string &name, const std::string &varied, const std::string &label, bool log) {
    const auto records = chosen(results, [&](const Record &r) { return r.suite == "trace" && r.case_name == name; });
    if (records.empty()) return;
    PlotPanel panel;
    panel.x = {label, "", log};
    panel.y = {"rays per second", "", true};
    for (const std::string &curve : distinct(records, [](const Record &r) { return r.curve(); })) {
      PlotLine line{curve, "", {}, {}};
      for (const Record *r : records) {
        if (r->curve() != curve) continue;
        if (line.x.empty()) line = style_of(*r), line.width = 2;
        add_point(line, *r, r->number(varied), r->rate);
      }
      panel.lines.push_back(line);
    }
    widen(panel.y, column(panel, &PlotLine::y));
    if (figure.legend.empty()) figure.legend = panel.lines;
    figure.plot.panels.push_back(panel);
  };
  add("cores", "threads", "cores", false);
  add("rays", "rays", "rays in one call", true);
  add("wavelengths", "wavelengths", "wavelengths", true);
  if (figure.plot.panels.empty()) return {};
  figure.plot.id = "growth";
  figure.plot.title = "How cost grows";
  figure.plot.subtitle = "standard air, one setting of each method; a level curve is a cost that grows evenly";
  figure.plot.legend = false;
  figure.plot.panel_width = 235, figure.plot.panel_height = 260;
  return {figure};
}

std::vector<Figure> image_figures(const Results &results) {
  std::vector<Figure> figures;
  const auto all = chosen(results, [](const Record &r) { return r.suite == "images"; });
  for (const std::string &name : distinct(all, [](const Record &r) { return r.case_name; })) {
    const auto records = chosen(results, [&](const Record &r) { return r.suite == "images" && r.case_name == name; });
    if (records.size() < 4) continue;  // two points are a row of the table, not a curve
    Figure figure = figure_of(records, [](const Record &r) { return r.wall_seconds; });
    PlotPanel &panel = figure.plot.panels.front();
    panel.x = {"time of the whole picture", "s", true};
    panel.y = {"RMS error, relative", "", true};
    widen(panel.x, column(panel, &PlotLine::x));
    widen(panel.y, column(panel, &PlotLine::y));
    figure.plot.id = "images" + std::to_string(figures.size());
    figure.plot.title = name + ": error of whole pictures against time";
    figure.plot.subtitle =
        "the low Sun in " + short_number(records.front()->number("wavelengths")) +
        " wavelengths; each point a number of samples per pixel; further left and further down is better";
    figure.plot.panel_height = 320;
    figures.push_back(figure);
  }
  return figures;
}

namespace {

/// What the pictures say of themselves, beside the curve of what is true.
void add_claims(Figure &figure, const std::vector<const Record *> &records,
                const std::function<double(const Record &)> &x) {
  PlotPanel &panel = figure.plot.panels.front();
  PlotLine claimed = panel.lines.back();
  claimed.name = "claimed by the picture itself", claimed.width = 0, claimed.colour = faded(claimed.colour);
  claimed.x.clear(), claimed.y.clear(), claimed.notes.clear();
  for (const Record *r : records) {
    claimed.x.push_back(x(*r)), claimed.y.push_back(r->number("claimed_rms"));
    claimed.notes.push_back(r->variant + ": claims " + short_number(r->number("claimed_rms")));
  }
  panel.lines.push_back(claimed);
  figure.legend.push_back(claimed);
}

Figure room_figure(const std::vector<const Record *> &records, const PlotAxis &across,
                   const std::function<double(const Record &)> &x) {
  Figure figure = figure_of(records, x);
  add_claims(figure, records, x);
  PlotPanel &panel = figure.plot.panels.front();
  panel.x = across;
  panel.y = {"RMS error, relative to the mean", "", true};
  widen(panel.x, column(panel, &PlotLine::x));
  widen(panel.y, column(panel, &PlotLine::y));
  figure.plot.panel_height = 320;
  return figure;
}

}  // namespace

std::vector<Figure> room_figures(const Results &results) {
  std::vector<Figure> figures;
  const auto of_rooms = [](const Record &r) { return r.suite == "scenes" && r.more.count("claimed_rms") > 0; };
  for (const std::string &name : distinct(chosen(results, of_rooms), [](const Record &r) { return r.case_name; })) {
    const auto all = chosen(results, [&](const Record &r) { return of_rooms(r) && r.case_name == name; });
    const auto passes =
        chosen(results, [&](const Record &r) { return of_rooms(r) && r.case_name == name && r.more.count("slope"); });
    if (all.size() < 2) continue;
    Figure figure =
        room_figure(all, {"time of the whole picture", "s", true}, [](const Record &r) { return r.wall_seconds; });
    figure.plot.id = "rooms" + std::to_string(figures.size());
    figure.plot.title = name + ": error against time";
    figure.plot.subtitle = short_number(all.front()->number("pixels")) +
                           "pixels; each point a number of photons; further left and further down is better";
    figures.push_back(figure);
    if (passes.size() < 2) continue;
    figure = room_figure(passes, {"photons", "", true}, [](const Record &r) { return r.number("photons"); });
    figure.plot.id = "rooms" + std::to_string(figures.size());
    char slope[24];
    std::snprintf(slope, sizeof slope, "%.2f", passes.front()->number("slope"));
    figure.plot.title = name + ": error falls as photons^(" + slope + ")";
    figure.plot.subtitle =
        "passes of the same number of photons with shrinking radii, fitted by least squares; theory: -1/3 "
        "(Knaus & Zwicker 2011)";
    figures.push_back(figure);
  }
  return figures;
}

}  // namespace greenray::bench
