// What the sounding readers share: text with places, quantities with ranges, the index of a file, raw levels.
#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "atmosphere/sounding.hpp"

namespace greenray::sounding {

/// A line, or a piece of one between HTML tags. number and column (of the first character) count from 1.
struct TextLine {
  int number = 1;
  int column = 1;
  std::string_view text;
  int block = 0;  // pages only: odd inside <PRE>, even outside
};

/// A field of a line; text is trimmed, column is where it begins (or where the value should have been).
struct Cell {
  int line = 1;
  int column = 1;
  std::string_view text;
};

/// The file being read. Views in `lines` point into the caller's text.
struct Source {
  std::string file;
  std::vector<TextLine> lines;

  /// Throws `file:line:column: expected .., found ..; hint`.
  [[noreturn]] void fail(int line, int column, const std::string &expected, const std::string &found,
                         const std::string &hint) const;
  [[noreturn]] void fail(const Cell &cell, const std::string &expected, const std::string &hint) const;
};

/// How a file's number becomes SI, and what is believable: SI = (number + add) * times.
struct Quantity {
  const char *name;
  double times;
  double add;
  double low;
  double high;
  const char *range;  // the range in words
};

constexpr double lowest_height_m = -500, highest_height_m = 120000;
constexpr Quantity height_in(double metres) {
  return {"height", metres, 0, lowest_height_m, highest_height_m, "-500 to 120000 m"};
}
constexpr Quantity pressure_in(double pascals) { return {"pressure", pascals, 0, 1e-3, 110000, "0.00001 to 1100 hPa"}; }
constexpr Quantity temperature_in(double kelvins, double add) {
  return {"temperature", kelvins, add, 150, 350, "150 to 350 K (-123.15 to 76.85 C)"};
}
constexpr Quantity dew_point_in(double kelvins, double add) {
  return {"dew point", kelvins, add, 100, 350, "100 to 350 K (-173.15 to 76.85 C)"};
}
constexpr Quantity humidity_in(double fractions) { return {"relative humidity", fractions, 0, 0, 1.05, "0 to 105 %"}; }

std::string_view trimmed(std::string_view text);
std::string lower_case(std::string_view text);
std::string quoted(std::string_view text);  // 'text', printable and short; "nothing" for blanks
bool is_blank(std::string_view text);
std::vector<TextLine> split_lines(std::string_view text);      // \n, \r\n or \r
std::string count_of(std::size_t n, const std::string &noun);  // "1 level", "3 levels"

/// A finite decimal number and nothing else; none otherwise.
std::optional<double> to_number(std::string_view text);

/// Blank: none. Not a number, or outside the quantity's range: throws.
std::optional<double> read_quantity(const Source &source, const Cell &cell, const Quantity &quantity);

/// Day, and minutes after its 00 UTC (-1: hour unknown).
struct Moment {
  std::chrono::sys_days day;
  int minute = -1;
};
std::optional<Moment> make_moment(int year, int month, int day, int minute);  // none if there is no such day or minute
std::string moment_text(const Moment &moment);

/// One sounding of a file, before its levels are read: lines [begin, end) of the source.
struct Entry {
  std::vector<std::string> stations;
  std::optional<Moment> nominal;
  std::optional<Moment> release;
  int line = 1;
  std::size_t begin = 0;
  std::size_t end = 0;
};
std::string entry_text(const Entry &entry);

/// The entry that `choice` means; adds a note where others would have fitted as well.
const Entry &choose(const Source &source, const std::vector<Entry> &entries, const SoundingChoice &choice,
                    std::vector<std::string> &notes);

/// A row as printed, in SI; heights are still of the file's kind.
struct RawLevel {
  int line = 1;
  int pressure_column = 1;
  int height_column = 1;
  std::optional<double> height_m;
  std::optional<double> pressure_Pa;
  std::optional<double> temperature_K;
  std::optional<double> relative_humidity;
  std::optional<double> dew_point_K;
};

/// What clean-up has to know about a file family.
struct Family {
  bool geopotential = true;         // heights are geopotential metres
  bool needs_pressure = true;       // a row without pressure is no use
  bool shows_below_ground = false;  // leading rows with a height alone lie below the station
};

/// Drops, checks, rebuilds and converts; fills levels, surface_pressure_Pa and notes of `profile`.
void clean_levels(const Source &source, const Family &family, std::vector<RawLevel> rows, int line,
                  ProfileSpec &profile);

// One pair for each family: find the soundings, then read one.
std::vector<Entry> index_igra2(const Source &source);
std::vector<RawLevel> read_igra2(const Source &source, const Entry &entry);
/// Is this line an IGRA header record (`#`, 11 letters or digits, a blank, a digit of the year)?
bool is_igra2_header(std::string_view line);

std::vector<Entry> index_wyoming_list(const Source &source);
std::vector<RawLevel> read_wyoming_list(const Source &source, const Entry &entry);
/// Names row of a Wyoming list?
bool is_wyoming_names_row(std::string_view line);
bool is_wyoming_title(std::string_view line);

/// A web page as the pieces of text between its tags; a page that ends inside a tag or <PRE> is an error.
std::vector<TextLine> split_page(const Source &source);
bool looks_like_page(std::string_view text);
/// For a page without a table: throws with what the page says.
[[noreturn]] void fail_page(const Source &page);

std::vector<Entry> index_wyoming_csv(const Source &source);
std::vector<RawLevel> read_wyoming_csv(const Source &source, const Entry &entry);
std::vector<Entry> index_plain_csv(const Source &source);
std::vector<RawLevel> read_plain_csv(const Source &source, const Entry &entry, std::vector<std::string> &notes);

}  // namespace greenray::sounding
