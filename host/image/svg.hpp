// Line plots as SVG: panels side by side, one file, no script, no font of its own.
#pragma once
#include <optional>
#include <string>
#include <vector>

namespace greenray {

/// An axis. Without limits it takes those of the lines, rounded outwards to ticks.
struct PlotAxis {
  std::string label;  // "temperature"
  std::string unit;   // "K"; "" for a pure number
  bool log = false;   // values of 0 and less are then left out
  std::optional<double> low = std::nullopt, high = std::nullopt;
};

enum class PlotMarker { none, disc, square, diamond, triangle };

/// Points joined in order; a point that is not finite (or not above 0 on a log axis) breaks the line.
struct PlotLine {
  std::string name;    // in the legend, once for each name and colour; "" for none
  std::string colour;  // "#rrggbb"
  std::vector<double> x, y;
  bool dashed = false;
  double width = 1.6;                    // 0: the points are not joined
  PlotMarker marker = PlotMarker::none;  // at each point
  bool hollow = false;                   // markers white inside
  std::vector<std::string> notes = {};   // of each point: shown when a viewer's pointer rests on its marker
};

/// A shaded stretch of the y axis, over the panel's full width.
struct PlotBand {
  double low = 0, high = 0;
  std::string name = "";  // written inside, once there is room
  std::string colour = "#f2a541";
};

/// A level line, such as the eye's height.
struct PlotLevel {
  double y = 0;
  std::string name;
  std::string colour = "#8a2b2b";
};

/// A word or two at a point, moved aside with a thin leader where it would cover another or leave the frame.
struct PlotLabel {
  double x = 0, y = 0;
  std::string text;
  std::string colour = "#111111";
};

struct PlotPanel {
  PlotAxis x, y;
  std::vector<PlotLine> lines;
  std::vector<PlotBand> bands;
  std::vector<PlotLevel> levels;
  std::vector<PlotLabel> labels = {};
};

struct Plot {
  std::string title, subtitle;
  std::vector<PlotPanel> panels;
  double panel_width = 260, panel_height = 380;  // of the plotting area, in pixels
  std::string id = {};                           // tells several plots in one page apart; letters and digits
  bool legend = true;
};

/// A line as the legend shows it, with its marker; a small SVG element to stand in a page's own text.
std::string svg_swatch(const PlotLine &line);

/* The plot as a standalone SVG 1.1 document, UTF-8. All text is escaped; what cannot be drawn (no finite point, limits
   that coincide) gives an empty or widened panel, never a NaN. The same plot gives the same bytes. */
std::string draw_svg(const Plot &plot);

/// Plots one below the other in one document of the same kind. Their ids are made different.
std::string draw_svg(std::vector<Plot> plots);

/// Ticks of a linear axis: 1, 2 or 5 times a power of ten, `wanted` of them or a few less, inside [low, high].
std::vector<double> linear_ticks(double low, double high, int wanted = 6);

/// A colour for lines of light of this wavelength: its hue, dark enough to be seen on white.
std::string wavelength_colour(double wavelength_nm);

}  // namespace greenray
