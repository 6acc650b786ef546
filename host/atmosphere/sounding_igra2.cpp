// NOAA IGRA version 2 station files: header records (#) and level records in fixed columns, which count from 1.
#include <algorithm>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {
namespace {

constexpr std::size_t level_columns = 51;  // a level record without trailing blanks
constexpr std::size_t header_columns = 36;

Cell cut(const TextLine &line, std::size_t first, std::size_t last) {
  const std::string_view raw = line.text.substr(std::min(first - 1, line.text.size()), last - first + 1);
  const std::string_view text = trimmed(raw);
  const std::size_t blanks = text.empty() ? 0 : static_cast<std::size_t>(text.data() - raw.data());
  return {line.number, static_cast<int>(first + blanks), text};
}

/// A whole number in columns first..last, right-aligned there.
int whole(const Source &source, const TextLine &line, std::size_t first, std::size_t last, const char *name) {
  const Cell cell = cut(line, first, last);
  const std::string columns = " in columns " + std::to_string(first) + "-" + std::to_string(last);
  std::string_view digits = cell.text;
  if (digits.starts_with('-')) digits.remove_prefix(1);
  const bool good =
      !digits.empty() && std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (!good || line.text[last - 1] == ' ')
    source.fail(cell, "a whole number for the " + std::string(name) + columns,
                "IGRA version 2 has fixed columns; -9999 is missing");
  return static_cast<int>(*to_number(cell.text));
}

/// -9999 (missing) and -8888 (removed by quality checks) give none.
std::optional<double> value(const Source &source, const TextLine &line, std::size_t first, std::size_t last,
                            const Quantity &quantity) {
  const int number = whole(source, line, first, last, quantity.name);
  if (number == -9999 || number == -8888) return std::nullopt;
  return read_quantity(source, cut(line, first, last), quantity);
}

void check_level_shape(const Source &source, const TextLine &line) {
  if (line.text.size() < level_columns)
    source.fail(
        line.number, static_cast<int>(line.text.size()) + 1, "a level of " + std::to_string(level_columns) + " columns",
        "only " + count_of(line.text.size(), "column"), "the file is truncated or not an IGRA version 2 data file");
  if (line.text.size() > level_columns + 1 && !is_blank(line.text.substr(level_columns)))
    source.fail(line.number, static_cast<int>(level_columns) + 1, "the end of the level",
                quoted(line.text.substr(level_columns)),
                "derived (-drvd) files have another layout: use the -data file");
}

Entry read_header(const Source &source, const TextLine &line) {
  if (line.text.size() < header_columns)
    source.fail(line.number, static_cast<int>(line.text.size()) + 1, "an IGRA header of at least 36 columns",
                "only " + count_of(line.text.size(), "column"), "the file is truncated");
  Entry entry;
  entry.line = line.number;
  entry.stations.emplace_back(trimmed(line.text.substr(1, 11)));
  const int year = whole(source, line, 14, 17, "year"), month = whole(source, line, 19, 20, "month");
  const int day = whole(source, line, 22, 23, "day"), hour = whole(source, line, 25, 26, "nominal hour");
  const int release = whole(source, line, 28, 31, "release time");
  entry.nominal = make_moment(year, month, day, hour == 99 ? -1 : hour * 60);
  if (!entry.nominal)
    source.fail(line.number, 14, "a date and an hour 0-23 or 99", quoted(line.text.substr(13, 13)), "");
  if (release == 9999) return entry;
  const int minute = release % 100 == 99 ? 0 : release % 100;  // HH99: only the hour is known
  if (release < 0 || release / 100 > 23 || minute > 59)
    source.fail(cut(line, 28, 31), "a release time HHMM or 9999", "");
  entry.release = make_moment(year, month, day, release / 100 * 60 + minute);
  // The header's day is that of the nominal hour; the balloon may have left before midnight.
  const int later = hour == 99 ? 0 : entry.release->minute - entry.nominal->minute;
  if (later > 720) entry.release->day -= std::chrono::days{1};
  if (later < -720) entry.release->day += std::chrono::days{1};
  return entry;
}

RawLevel read_level(const Source &source, const TextLine &line) {
  const char type = line.text[0], minor = line.text[1];
  if (type < '1' || type > '3' || minor < '0' || minor > '2')
    source.fail(line.number, 1, "a level type 1-3 and 0-2", quoted(line.text.substr(0, 2)),
                "a line may be damaged or shifted");
  for (const std::size_t column : {3U, 9U, 34U, 40U, 46U})
    if (line.text[column - 1] != ' ')
      source.fail(line.number, static_cast<int>(column), "a blank in column " + std::to_string(column),
                  quoted(line.text.substr(column - 1, 1)), "a line may be damaged or shifted");
  for (const std::size_t column : {16U, 22U, 28U})
    if (const char flag = line.text[column - 1]; flag != ' ' && flag != 'A' && flag != 'B')
      source.fail(line.number, static_cast<int>(column), "a flag A, B or blank",
                  quoted(line.text.substr(column - 1, 1)), "a line may be damaged or shifted");
  RawLevel level;
  level.line = line.number;
  level.pressure_column = 10, level.height_column = 17;
  whole(source, line, 4, 8, "elapsed time");
  level.pressure_Pa = value(source, line, 10, 15, pressure_in(1));
  level.height_m = value(source, line, 17, 21, height_in(1));
  level.temperature_K = value(source, line, 23, 27, temperature_in(0.1, 2731.5));
  level.relative_humidity = value(source, line, 29, 33, humidity_in(0.001));
  constexpr Quantity depression = {"dew-point depression", 0.1, 0, 0, 120, "0 to 120 K"};
  const std::optional<double> depression_K = value(source, line, 35, 39, depression);
  if (depression_K && level.temperature_K) level.dew_point_K = *level.temperature_K - *depression_K;
  whole(source, line, 41, 45, "wind direction");
  whole(source, line, 47, 51, "wind speed");
  return level;
}

}  // namespace

bool is_igra2_header(std::string_view line) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  const auto name = [&](char c) { return digit(c) || (c >= 'A' && c <= 'Z'); };
  if (line.size() < 17 || line[0] != '#' || line[12] != ' ') return false;
  return std::all_of(line.begin() + 1, line.begin() + 12, name) &&
         std::any_of(line.begin() + 13, line.begin() + 17, digit);
}

/// Checks the shape of the whole file: every record has as many levels as its header says, and whole ones.
std::vector<Entry> index_igra2(const Source &source) {
  std::vector<Entry> entries;
  std::size_t i = 0;
  int last_line = 1;
  while (i < source.lines.size()) {
    const TextLine &header = source.lines[i++];
    if (is_blank(header.text)) continue;
    if (!header.text.starts_with('#')) {
      const std::string which = entries.empty() ? "an IGRA header record starting with #"
                                                : "the next header (#) after the levels counted in line " +
                                                      std::to_string(entries.back().line);
      source.fail(header.number, 1, which, quoted(header.text), "a level was added, or a header lost or damaged");
    }
    Entry entry = read_header(source, header);
    const int stated = whole(source, header, 33, 36, "number of levels");
    entry.begin = i;
    int found = 0;
    last_line = header.number;
    for (; found < stated && i < source.lines.size(); ++i) {
      if (is_blank(source.lines[i].text)) continue;
      if (source.lines[i].text.starts_with('#')) break;
      check_level_shape(source, source.lines[i]);
      last_line = source.lines[i].number;
      ++found;
    }
    if (found < stated)
      source.fail(last_line, 1,
                  count_of(static_cast<std::size_t>(stated), "level") + " after the header in line " +
                      std::to_string(header.number),
                  std::to_string(found), "the file is truncated or levels were removed");
    entry.end = i;
    entries.push_back(entry);
  }
  return entries;
}

std::vector<RawLevel> read_igra2(const Source &source, const Entry &entry) {
  std::vector<RawLevel> levels;
  for (std::size_t i = entry.begin; i < entry.end; ++i)
    if (!is_blank(source.lines[i].text)) levels.push_back(read_level(source, source.lines[i]));
  return levels;
}

}  // namespace greenray::sounding
