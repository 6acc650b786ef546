// A report as one self-contained page: well-formed XHTML text, pictures as data, no script, no network.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "image/png.hpp"
#include "image/svg.hpp"

namespace greenray {

class Page {
 public:
  Page(const std::string &title, const std::string &subtitle);
  void section(const std::string &title);
  void text(const std::string &words);
  void warning(const std::string &words);
  /// pixelated: enlarged without smoothing to width_px.
  void picture(const Raster &pixels, const std::string &caption, int width_px, bool pixelated = false);
  void figure(const std::vector<Plot> &plots);
  void facts(const std::vector<std::pair<std::string, std::string>> &rows);
  /// The first row is the head; cells of the others that are numbers stand right.
  void table(const std::vector<std::vector<std::string>> &rows);
  void code(const std::string &line);
  std::string finish() const;

 private:
  std::string body_, title_;
  int figures_ = 0;
};

/// A number for a cell: "-" where it is not finite.
std::string cell(double value, int digits = 4);

}  // namespace greenray
