#include "image/svg.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "image/colour.hpp"
#include "image/svg_scale.hpp"

namespace greenray {
namespace {

constexpr double margin_left = 66, margin_right = 22, margin_top = 64, margin_bottom = 92, margin_bottom_bare = 50,
                 gap = 76;
const char *const font = "font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\"";

/// Of words that may stand on a line.
const char *const halo = " paint-order=\"stroke\" stroke=\"#fbfbf9\" stroke-width=\"3\" stroke-opacity=\"0.8\"";

std::string escaped(const std::string &text) {
  std::string safe;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '&') safe += "&amp;";
    else if (c == '<') safe += "&lt;";
    else if (c == '>') safe += "&gt;";
    else if (c == '"') safe += "&quot;";
    else if (byte < 0x20 || byte == 0x7f) safe += ' ';  // XML 1.0 has no control characters
    else safe += c;
  }
  return safe;
}

/// `text` with anything that is not UTF-8 replaced by '?': file names may hold any bytes.
std::string valid_utf8(const std::string &text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t length = byte < 0x80 ? 1 : byte >= 0xc2 && byte < 0xe0 ? 2 : byte >= 0xe1 && byte < 0xed ? 3 : 0;
    bool good = length > 0 && i + length <= text.size();
    for (std::size_t k = 1; good && k < length; ++k) good = (static_cast<unsigned char>(text[i + k]) & 0xc0) == 0x80;
    out += good ? text.substr(i, length) : "?";
    i += good ? length : 1;
  }
  return out;
}

std::string clean(const std::string &text) { return escaped(valid_utf8(text)); }

/// Pixels, to a hundredth.
std::string px(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%.2f", std::clamp(std::isfinite(value) ? value : 0.0, -1e5, 1e5));
  std::string s = text;
  s.erase(s.find_last_not_of('0') + 1);
  if (s.back() == '.') s.pop_back();
  return s == "-0" ? "0" : s;
}

std::string text_at(double x, double y, const std::string &text, const std::string &style) {
  return "<text x=\"" + px(x) + "\" y=\"" + px(y) + "\" " + style + ">" + clean(text) + "</text>\n";
}

std::size_t letters_of(const std::string &text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

/// `text` cut to a width in pixels, for letters of `size` pixels.
std::string shortened(const std::string &text, double width, double size) {
  const auto fit = static_cast<std::size_t>(std::max(1.0, width / (0.56 * size)));
  std::size_t letters = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins_letter = (static_cast<unsigned char>(text[i]) & 0xc0) != 0x80;
    if (begins_letter && ++letters > fit) return text.substr(0, i) + "…";
  }
  return text;
}

std::string line_at(double x1, double y1, double x2, double y2, const std::string &style) {
  return "<line x1=\"" + px(x1) + "\" y1=\"" + px(y1) + "\" x2=\"" + px(x2) + "\" y2=\"" + px(y2) + "\" " + style +
         "/>\n";
}

/// The marker's outline around a point; `inside` is put between its tags.
std::string marker_at(const PlotLine &line, double x, double y, const std::string &inside = "") {
  const std::string paint = " fill=\"" + (line.hollow ? "white" : clean(line.colour)) + "\" stroke=\"" +
                            (line.hollow ? clean(line.colour) : "white") + "\" stroke-width=\"" +
                            (line.hollow ? "1.6" : "0.8") + "\"";
  const auto polygon = [&](const std::vector<std::array<double, 2>> &corners) {
    std::string points;
    for (const auto &[dx, dy] : corners) points += (points.empty() ? "" : " ") + px(x + dx) + "," + px(y + dy);
    return "<polygon points=\"" + points + "\"" + paint + ">" + inside + "</polygon>\n";
  };
  switch (line.marker) {
    case PlotMarker::none:
      return "";
    case PlotMarker::disc:
      return "<circle cx=\"" + px(x) + "\" cy=\"" + px(y) + "\" r=\"4\"" + paint + ">" + inside + "</circle>\n";
    case PlotMarker::square:
      return polygon({{-3.6, -3.6}, {3.6, -3.6}, {3.6, 3.6}, {-3.6, 3.6}});
    case PlotMarker::diamond:
      return polygon({{0, -5}, {5, 0}, {0, 5}, {-5, 0}});
    case PlotMarker::triangle:
      return polygon({{0, -5}, {4.8, 3.6}, {-4.8, 3.6}});
  }
  return "";
}

/// A short piece of a line, with its marker in the middle.
std::string sample_of(const PlotLine &line, double x, double y, double width) {
  const std::string dashes = line.dashed ? " stroke-dasharray=\"6 4\"" : "";
  const std::string stroke = "stroke=\"" + clean(line.colour) + "\" stroke-width=\"2.4\"" + dashes;
  return (line.width > 0 ? line_at(x, y, x + width, y, stroke) : "") + marker_at(line, x + width / 2, y);
}

/// One panel at its place in the picture.
class PanelDrawing {
 public:
  PanelDrawing(const Plot &plot, const PlotPanel &panel, std::size_t index)
      : panel_(panel),
        index_(index),
        id_(plot.id),
        with_legend_(plot.legend),
        left_(margin_left + static_cast<double>(index) * (plot.panel_width + gap)),
        width_(plot.panel_width),
        height_(plot.panel_height),
        x_(panel.x, collect(&PlotLine::x)),
        y_(panel.y, collect(&PlotLine::y)) {}

  std::string draw() const {
    const std::string clip = id_ + "panel" + std::to_string(index_);
    const std::string frame = " x=\"" + px(left_) + "\" y=\"" + px(margin_top) + "\" width=\"" + px(width_) +
                              "\" height=\"" + px(height_) + "\"";
    std::string svg = "<clipPath id=\"" + clip + "\"><rect" + frame + "/></clipPath>\n<rect" + frame +
                      " fill=\"#fbfbf9\"/>\n<g clip-path=\"url(#" + clip + ")\">\n" + bands() + grid();
    for (const PlotLine &line : panel_.lines) svg += path(line);
    svg += levels() + "</g>\n<rect" + frame + " fill=\"none\" stroke=\"#444\"/>\n";
    for (const PlotLine &line : panel_.lines) svg += markers(line);
    return svg + notes() + labels() + (with_legend_ ? legend() : "");
  }

 private:
  std::vector<double> collect(std::vector<double> PlotLine::*values) const {
    std::vector<double> all;
    for (const PlotLine &line : panel_.lines) all.insert(all.end(), (line.*values).begin(), (line.*values).end());
    return all;
  }
  double px_x(double fraction) const { return left_ + width_ * fraction; }
  double px_y(double fraction) const { return margin_top + height_ * (1 - fraction); }

  std::string bands() const {
    std::string svg;
    for (const PlotBand &band : panel_.bands) {
      const double low = std::clamp(y_.at(band.low), -1.0, 2.0), high = std::clamp(y_.at(band.high), -1.0, 2.0);
      if (!(high > low) || high < 0 || low > 1) continue;
      const double tall = std::max(height_ * (high - low), 1.0);
      svg += "<rect x=\"" + px(left_) + "\" y=\"" + px(px_y(high)) + "\" width=\"" + px(width_) + "\" height=\"" +
             px(tall) + "\" fill=\"" + clean(band.colour) + "\" fill-opacity=\"0.22\"/>\n";
      if (!band.name.empty() && tall > 12)
        svg += text_at(left_ + width_ - 5, px_y(std::min(high, 1.0)) + 11, band.name,
                       std::string(font) + halo + " font-size=\"9.5\" fill=\"#7a4d00\" text-anchor=\"end\"");
    }
    return svg;
  }

  std::string grid() const {
    std::string svg;
    const auto style = [](const PlotTick &t) {
      return std::string("stroke=\"") + (t.label.empty() ? "#eeeeea" : "#dcdcd6") + "\" stroke-width=\"0.8\"";
    };
    for (const PlotTick &t : x_.ticks())
      svg += line_at(px_x(x_.at(t.value)), margin_top, px_x(x_.at(t.value)), margin_top + height_, style(t));
    for (const PlotTick &t : y_.ticks())
      svg += line_at(left_, px_y(y_.at(t.value)), left_ + width_, px_y(y_.at(t.value)), style(t));
    return svg;
  }

  /// Those inside the frame, whole even where they cross it.
  std::string markers(const PlotLine &line) const {
    std::string svg;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
      const double x = x_.at(line.x[i]), y = y_.at(line.y[i]);
      if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) continue;
      const std::string note = i < line.notes.size() ? "<title>" + clean(line.notes[i]) + "</title>" : "";
      svg += marker_at(line, px_x(x), px_y(y), note);
    }
    return svg;
  }

  std::string path(const PlotLine &line) const {
    if (!(line.width > 0)) return "";
    std::string points;
    bool broken = true;
    for (std::size_t i = 0; i < std::min(line.x.size(), line.y.size()); ++i) {
      const double x = x_.at(line.x[i]), y = y_.at(line.y[i]);
      if (!std::isfinite(x) || !std::isfinite(y)) {
        broken = true;
        continue;
      }
      points += std::string(points.empty() ? "" : " ") + (broken ? "M" : "L") + px(px_x(x)) + " " + px(px_y(y));
      broken = false;
    }
    if (points.empty()) return "";
    return "<path d=\"" + points + "\" fill=\"none\" stroke=\"" + clean(line.colour) + "\" stroke-width=\"" +
           px(line.width) + "\" stroke-linejoin=\"round\"" + (line.dashed ? " stroke-dasharray=\"6 4\"" : "") + "/>\n";
  }

  std::string levels() const {
    std::string svg;
    for (const PlotLevel &level : panel_.levels) {
      const double y = y_.at(level.y);
      if (!(y >= 0 && y <= 1)) continue;
      const double at = px_y(y);
      svg += line_at(left_, at, left_ + width_, at,
                     "stroke=\"" + clean(level.colour) + "\" stroke-width=\"1.2\" stroke-dasharray=\"2 3\"");
      svg += text_at(left_ + 5, y > 0.94 ? at + 11 : at - 4, level.name,
                     std::string(font) + halo + " font-size=\"9.5\" fill=\"" + clean(level.colour) + "\"");
    }
    return svg;
  }

  /// Labels of points: each at the nearest of some places around its point where it covers no other one.
  std::string notes() const {
    struct Box {
      double x, y, half;  // centre, half of the width
    };
    constexpr double half_high = 7;
    std::vector<Box> taken;
    for (const PlotLine &line : panel_.lines)
      for (std::size_t i = 0; line.marker != PlotMarker::none && i < std::min(line.x.size(), line.y.size()); ++i)
        taken.push_back({px_x(x_.at(line.x[i])), px_y(y_.at(line.y[i])), 5});
    std::string svg;
    for (const PlotLabel &label : panel_.labels) {
      const double x = x_.at(label.x), y = y_.at(label.y);
      if (!(x >= 0 && x <= 1 && y >= 0 && y <= 1)) continue;
      const double at_x = px_x(x), at_y = px_y(y), half = 4 + 3.4 * static_cast<double>(letters_of(label.text));
      const auto free = [&](const Box &b) {
        return b.x - half > left_ && b.x + half < left_ + width_ && b.y - half_high > margin_top &&
               b.y + half_high < margin_top + height_ && std::none_of(taken.begin(), taken.end(), [&](const Box &t) {
                 return std::abs(t.x - b.x) < t.half + half && std::abs(t.y - b.y) < 2 * half_high;
               });
      };
      Box box{at_x, at_y - 13, half};
      for (int k = 0; k < 96 && !free(box); ++k) {
        const double around = (k % 16) * 0.3926990817 - 1.5707963268, away = 14 + half * 0.5 + 12 * (k / 16);
        box = {at_x + away * std::cos(around), at_y + away * std::sin(around), half};
      }
      if (!free(box)) continue;
      taken.push_back(box);
      svg += line_at(at_x, at_y, box.x, box.y, "stroke=\"" + clean(label.colour) + "\" stroke-width=\"0.6\"");
      svg += "<rect x=\"" + px(box.x - half) + "\" y=\"" + px(box.y - half_high) + "\" width=\"" + px(2 * half) +
             "\" height=\"" + px(2 * half_high) + "\" rx=\"4\" fill=\"white\" fill-opacity=\"0.85\" stroke=\"" +
             clean(label.colour) + "\" stroke-width=\"0.6\"/>\n";
      svg += text_at(
          box.x, box.y + 3.8, label.text,
          std::string(font) + " font-size=\"10.5\" text-anchor=\"middle\" fill=\"" + clean(label.colour) + "\"");
    }
    return svg;
  }

  std::string labels() const {
    const std::string small = std::string(font) + " font-size=\"11\" fill=\"#333\"";
    std::string svg;
    for (const PlotTick &t : x_.ticks())
      if (!t.label.empty())
        svg += text_at(px_x(x_.at(t.value)), margin_top + height_ + 16, t.label, small + " text-anchor=\"middle\"");
    for (const PlotTick &t : y_.ticks())
      if (!t.label.empty())
        svg += text_at(left_ - 7, px_y(y_.at(t.value)) + 4, t.label, small + " text-anchor=\"end\"");
    const std::string title = std::string(font) + " font-size=\"12\" fill=\"#111\" text-anchor=\"middle\"";
    svg += text_at(left_ + width_ / 2, margin_top + height_ + 36, x_.title(), title);
    if (!panel_.y.label.empty()) {
      const double x = left_ - 50, y = margin_top + height_ / 2;
      svg += text_at(x, y, y_.title(), title + " transform=\"rotate(-90 " + px(x) + " " + px(y) + ")\"");
    }
    return svg;
  }

  /// Below the axis, left to right; as many as fit in two rows, then how many more there are.
  std::string legend() const {
    std::vector<const PlotLine *> named;
    for (const PlotLine &line : panel_.lines)
      if (!line.name.empty() && std::none_of(named.begin(), named.end(), [&](const PlotLine *other) {
            return other->name == line.name && other->colour == line.colour;
          }))
        named.push_back(&line);
    std::string svg;
    double x = left_, y = margin_top + height_ + 56;
    for (std::size_t i = 0; i < named.size(); ++i) {
      const PlotLine &line = *named[i];
      const double wide = 32 + 6.4 * static_cast<double>(line.name.size());
      if (x > left_ && x + wide > left_ + width_) x = left_, y += 16;
      if (y > margin_top + height_ + 73) {
        svg += text_at(left_ + width_, y - 16, "+ " + std::to_string(named.size() - i),
                       std::string(font) + " font-size=\"10.5\" fill=\"#333\" text-anchor=\"end\"");
        break;
      }
      svg += sample_of(line, x, y - 4, 20);
      svg += text_at(x + 25, y, line.name, std::string(font) + " font-size=\"10.5\" fill=\"#333\"");
      x += wide;
    }
    return svg;
  }

  const PlotPanel &panel_;
  std::size_t index_;
  std::string id_;
  bool with_legend_;
  double left_, width_, height_;
  PlotScale x_, y_;
};

}  // namespace

std::string wavelength_colour(double wavelength_nm) {
  const Xyz seen = colour_matching(std::clamp(std::isfinite(wavelength_nm) ? wavelength_nm : 550.0, 410.0, 670.0));
  OkLab lab = oklab_from_rgb(rgb_from_xyz(seen));
  const double chroma = std::hypot(lab[1], lab[2]), wanted = 0.2;
  if (chroma > 0) lab[1] *= wanted / chroma, lab[2] *= wanted / chroma;
  lab[0] = 0.58;
  Rgb rgb = rgb_from_oklab(lab);
  map_into_gamut(rgb);
  char text[16];
  const auto byte = [](double v) {
    return static_cast<unsigned>(std::lround(255 * std::clamp(srgb_encode(v), 0.0, 1.0)));
  };
  std::snprintf(text, sizeof text, "#%02x%02x%02x", byte(rgb[0]), byte(rgb[1]), byte(rgb[2]));
  return text;
}

std::string svg_swatch(const PlotLine &line) {
  return "<svg width=\"36\" height=\"12\" viewBox=\"0 0 36 12\" aria-hidden=\"true\">" + sample_of(line, 0, 6, 36) +
         "</svg>";
}

namespace {

struct Extent {
  double width, height;
};

Extent extent_of(const Plot &plot) {
  const double panels = static_cast<double>(plot.panels.size());
  return {margin_left + margin_right + panels * plot.panel_width + std::max(0.0, panels - 1) * gap,
          margin_top + plot.panel_height + (plot.legend ? margin_bottom : margin_bottom_bare)};
}

std::string opening_tag(const Extent &extent, double y) {
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\"" + (y > 0 ? " y=\"" + px(y) + "\"" : "") +
         " width=\"" + px(extent.width) + "\" height=\"" + px(extent.height) + "\" viewBox=\"0 0 " + px(extent.width) +
         " " + px(extent.height) + "\">\n";
}

std::string contents_of(const Plot &plot) {
  const double width = extent_of(plot).width;
  std::string svg = "<title>" + clean(plot.title) + "</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  svg += text_at(margin_left, 26, shortened(plot.title, width - margin_left - 20, 17),
                 std::string(font) + " font-size=\"16\" font-weight=\"bold\" fill=\"#111\"");
  svg += text_at(margin_left, 46, shortened(plot.subtitle, width - margin_left - 20, 11.5),
                 std::string(font) + " font-size=\"11.5\" fill=\"#555\"");
  for (std::size_t i = 0; i < plot.panels.size(); ++i) svg += PanelDrawing(plot, plot.panels[i], i).draw();
  return svg;
}

const char *const xml_line = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

}  // namespace

std::string draw_svg(const Plot &plot) {
  return xml_line + opening_tag(extent_of(plot), 0) + contents_of(plot) + "</svg>\n";
}

std::string draw_svg(std::vector<Plot> plots) {
  Extent all{0, 0};
  for (const Plot &plot : plots)
    all = {std::max(all.width, extent_of(plot).width), all.height + extent_of(plot).height};
  std::string svg = xml_line + opening_tag(all, 0) + "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  double y = 0;
  for (std::size_t i = 0; i < plots.size(); ++i) {
    plots[i].id += "plot" + std::to_string(i);
    svg += opening_tag(extent_of(plots[i]), y) + contents_of(plots[i]) + "</svg>\n";
    y += extent_of(plots[i]).height;
  }
  return svg + "</svg>\n";
}

}  // namespace greenray
