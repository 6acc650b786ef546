// A benchmark run as one page to read: HTML with plots in SVG, without script and without network.
#pragma once
#include <string>
#include <vector>

#include "bench/record.hpp"
#include "image/svg.hpp"

namespace greenray::bench {

/// A plot with the legend that stands under it in the page.
struct Figure {
  std::string caption;
  Plot plot;
  std::vector<PlotLine> legend;  // names and styles; their points are not used
};

/// Error against rays per second for every air of suite trace: a curve for each solver, precision, lane count and peer,
/// through the settings that no other of the same curve beats in both; the others as points.
std::vector<Figure> work_precision_figures(const Results &results);

/// Growth with cores, rays and wavelengths, side by side; nothing when the run has not measured it.
std::vector<Figure> growth_figures(const Results &results);

/// RMS error against seconds of whole pictures.
std::vector<Figure> image_figures(const Results &results);

/// The same of rooms: true error, and the error claimed.
std::vector<Figure> room_figures(const Results &results);

/// The whole page, UTF-8. The same results give the same bytes.
std::string as_html(const Results &results);

/// "14.3 M", "0.00343", "1.2·10⁻⁷": three digits, for people.
std::string short_number(double value);

}  // namespace greenray::bench
