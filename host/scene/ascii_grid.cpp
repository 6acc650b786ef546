// read_ascii_grid: heights as plain text.
#include <cctype>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>

#include "atmosphere/profile_file.hpp"
#include "scene/height_tile.hpp"
#include "support/embedded.hpp"

namespace greenray {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 28;

class AsciiGrid {
 public:
  AsciiGrid(const std::string &path, std::string_view text) : path_(path), text_(text) {}

  HeightTile read() {
    read_header();
    tile_.name = std::filesystem::path(path_).filename().string();
    const std::size_t count = static_cast<std::size_t>(tile_.rows) * static_cast<std::size_t>(tile_.columns);
    for (std::size_t i = 0; i < count; ++i) {
      skip_blanks();
      if (at_ == text_.size())
        fail("expected " + std::to_string(count) + " heights (nrows x ncols), found " + std::to_string(i) +
             ": cut short?");
      const double height = number("a height in metres");
      tile_.height_m.push_back(height == no_data_ ? std::numeric_limits<float>::quiet_NaN()
                                                  : static_cast<float>(height));
    }
    skip_blanks();
    if (at_ != text_.size()) fail("expected the end after " + std::to_string(count) + " heights (nrows x ncols)");
    tile_.fingerprint = fingerprint_of(text_.data(), text_.size());
    require_earthly(tile_, path_, {path_, 1, 1});
    return std::move(tile_);
  }

 private:
  [[noreturn]] void fail(const std::string &what) const {
    SourcePlace place{path_, 1, 1};
    for (std::size_t i = 0; i < at_; ++i) text_[i] == '\n' ? (++place.line, place.column = 1) : ++place.column;
    throw InputError(place, what);
  }

  void skip_blanks() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
  }

  double number(const char *what) {
    skip_blanks();
    double value = 0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) fail(std::string("expected ") + what);
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }

  /// The next word in small letters, if one stands there.
  std::string word() {
    skip_blanks();
    std::string letters;
    while (at_ < text_.size() && (std::isalpha(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_'))
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(text_[at_++])));
    return letters;
  }

  int count(const std::map<std::string, double> &header, const char *key) const {
    const double value = header.count(key) ? header.at(key) : 0;
    if (!(value >= 2 && value <= 40000 && value == std::floor(value)))
      fail(std::string("expected a header with '") + key + "', a whole number from 2 to 40000");
    return static_cast<int>(value);
  }

  void read_header() {
    std::map<std::string, double> header;
    while (true) {
      skip_blanks();
      const std::size_t before = at_;
      const std::string key = word();
      if (key.empty()) break;
      static const std::string known = " ncols nrows xllcorner yllcorner xllcenter yllcenter cellsize nodata_value ";
      if (known.find(" " + key + " ") == std::string::npos) {
        at_ = before;
        fail("expected one of" + known + "or a height, found '" + key + "'");
      }
      header[key] = number(("a number after '" + key + "'").c_str());
    }
    tile_.columns = count(header, "ncols"), tile_.rows = count(header, "nrows");
    const double cell = header.count("cellsize") ? header.at("cellsize") : 0;
    if (!(cell > 0 && cell < 90)) fail("expected a header with 'cellsize', above 0 and below 90 degrees");
    tile_.row_deg = tile_.column_deg = cell;
    tile_.west_deg = corner(header, "xll", cell), tile_.south_deg = corner(header, "yll", cell);
    if (std::abs(tile_.south_deg) > 91 || std::abs(tile_.north_deg()) > 91 || std::abs(tile_.west_deg) > 361)
      fail("expected a grid in degrees of latitude and longitude, found places outside the Earth");
    if (header.count("nodata_value")) no_data_ = header.at("nodata_value");
  }

  /// Of the first node: half a cell within the corner.
  double corner(const std::map<std::string, double> &header, const std::string &key, double cell) const {
    if (header.count(key + "center")) return header.at(key + "center");
    if (!header.count(key + "corner")) fail("expected a header with '" + key + "corner' or '" + key + "center'");
    return header.at(key + "corner") + cell / 2;
  }

  const std::string &path_;
  std::string_view text_;
  std::size_t at_ = 0;
  double no_data_ = -9999;
  HeightTile tile_;
};

}  // namespace

HeightTile read_ascii_grid(const std::string &path, const SourcePlace &asked_at) {
  if (const auto text = file_contents(path, most_bytes, asked_at)) return AsciiGrid(path, *text).read();
  if (const auto shipped = embedded_file(path)) return AsciiGrid(path, *shipped).read();
  throw InputError(asked_at, "no such terrain file: '" + path + "'");
}

}  // namespace greenray
