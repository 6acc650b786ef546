// University of Wyoming lists: a title, rules, rows of names and units, levels in fields of 7 characters.
#include <algorithm>
#include <sstream>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {
namespace {

constexpr std::size_t field_width = 7;

/// Field `i` of a row; a value must end at the right edge of its field.
Cell field(const Source &source, const TextLine &line, std::size_t i) {
  const std::size_t begin = std::min(i * field_width, line.text.size());
  const std::string_view raw = line.text.substr(begin, field_width);
  const std::string_view text = trimmed(raw);
  const std::size_t blanks = text.empty() ? 0 : static_cast<std::size_t>(text.data() - raw.data());
  const Cell cell = {line.number, line.column + static_cast<int>(begin + blanks), text};
  const bool right_aligned = text.empty() || blanks + text.size() == field_width;
  if (!right_aligned)
    source.fail(cell,
                "a value ending at column " + std::to_string(line.column - 1 + static_cast<int>((i + 1) * field_width)),
                "fields are 7 characters wide and right-aligned: the row is cut off or shifted");
  return cell;
}

/// Where the quantities stand among the fields.
struct Columns {
  std::size_t pressure = 0, height = 0, temperature = 0, count = 0;
  std::optional<std::size_t> dew_point, humidity;
};

std::vector<std::string> words(const TextLine &line) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i * field_width < line.text.size(); ++i)
    all.emplace_back(trimmed(line.text.substr(i * field_width, field_width)));
  while (!all.empty() && all.back().empty()) all.pop_back();
  return all;
}

/// The place of `name` in the names row, after checking the unit below it; none if there is no such column.
std::optional<std::size_t> find_column(const Source &source, const TextLine &names, const TextLine &units,
                                       const char *name, const char *unit) {
  const std::vector<std::string> name_words = words(names), unit_words = words(units);
  const auto found = std::find(name_words.begin(), name_words.end(), name);
  if (found == name_words.end()) return std::nullopt;
  const std::size_t i = static_cast<std::size_t>(found - name_words.begin());
  const std::string given = i < unit_words.size() ? unit_words[i] : "";
  if (given != unit)
    source.fail(units.number, units.column + static_cast<int>(i * field_width),
                "the unit " + std::string(unit) + " below " + name, quoted(given), "other units are not known");
  return i;
}

Columns read_columns(const Source &source, const TextLine &names, const TextLine &units) {
  const auto need = [&](const char *name, const char *unit) {
    const std::optional<std::size_t> i = find_column(source, names, units, name, unit);
    if (!i)
      source.fail(names.number, names.column, "a column " + std::string(name) + " in the row of names",
                  quoted(names.text), "names are right-aligned in fields of 7 characters");
    return *i;
  };
  Columns columns;
  columns.pressure = need("PRES", "hPa");
  columns.height = need("HGHT", "m");
  columns.temperature = need("TEMP", "C");
  columns.dew_point = find_column(source, names, units, "DWPT", "C");
  columns.humidity = find_column(source, names, units, "RELH", "%");
  columns.count = words(names).size();
  return columns;
}

RawLevel read_row(const Source &source, const TextLine &line, const Columns &columns) {
  std::vector<Cell> cells;
  const std::size_t width = columns.count * field_width;
  for (std::size_t i = 0; i < columns.count; ++i) {
    cells.push_back(field(source, line, i));
    const Cell &cell = cells.back();
    if (!cell.text.empty() && !to_number(cell.text)) source.fail(cell, "a number", "a missing value is seven blanks");
  }
  if (line.text.size() > width && !is_blank(line.text.substr(width)))
    source.fail(line.number, line.column + static_cast<int>(width),
                "the end of the row after " + count_of(columns.count, "field"), quoted(line.text.substr(width)),
                "the row is shifted or two rows were joined");
  RawLevel level;
  level.line = line.number;
  level.pressure_column = cells[columns.pressure].column;
  level.height_column = cells[columns.height].column;
  level.pressure_Pa = read_quantity(source, cells[columns.pressure], pressure_in(100));
  level.height_m = read_quantity(source, cells[columns.height], height_in(1));
  level.temperature_K = read_quantity(source, cells[columns.temperature], temperature_in(1, 273.15));
  if (columns.dew_point) level.dew_point_K = read_quantity(source, cells[*columns.dew_point], dew_point_in(1, 273.15));
  if (columns.humidity) level.relative_humidity = read_quantity(source, cells[*columns.humidity], humidity_in(0.01));
  return level;
}

bool is_rule(std::string_view text) {
  text = trimmed(text);
  return text.size() >= 10 && text.find_first_not_of('-') == text.npos;
}

/// Does the table that began in `block` end before this line? `after_blank`: the line before it was blank.
bool ends_table(const TextLine &line, int block, bool after_blank) {
  const std::string_view text = trimmed(line.text);
  if (line.block != block || text.starts_with("Station information") || is_wyoming_title(text)) return true;
  if (is_wyoming_names_row(text)) return true;
  const bool letter = !text.empty() && ((text[0] >= 'A' && text[0] <= 'Z') || (text[0] >= 'a' && text[0] <= 'z'));
  return after_blank && letter;  // text below a list saved without its headings
}

/// "00Z 22 Jun 2024" or "00 UTC 22 Jun 2024"; none if it reads differently.
std::optional<Moment> title_time(const std::string &text) {
  std::istringstream in(text);
  std::string clock, day, month, year;
  in >> clock >> day;
  if (day == "UTC") in >> day;
  in >> month >> year;
  if (clock.ends_with('Z')) clock.pop_back();
  std::erase(clock, ':');
  static const std::string months = "janfebmaraprmayjunjulaugsepoctnovdec";
  const std::size_t place = month.size() >= 3 ? months.find(lower_case(month.substr(0, 3))) : months.npos;
  const auto number = [](const std::string &digits) {
    const bool good = !digits.empty() && digits.size() <= 4 && digits.find_first_not_of("0123456789") == digits.npos;
    return good ? std::stoi(digits) : -1;
  };
  const int hhmm = clock.size() <= 2 ? number(clock) * 100 : number(clock);
  if (place == months.npos || place % 3 != 0 || hhmm < 0 || hhmm % 100 > 59) return std::nullopt;
  return make_moment(number(year), static_cast<int>(place / 3) + 1, number(day), hhmm / 100 * 60 + hhmm % 100);
}

void read_title(std::string_view title, Entry &entry) {
  const std::size_t key = title.find("Observations");
  const std::size_t at = title.find(" at ", key);
  if (at != title.npos) entry.nominal = title_time(std::string(title.substr(at + 4)));
  const std::size_t newer = title.find("for Station ", key);
  const bool is_newer = newer != title.npos && newer < at;
  std::istringstream in(std::string(is_newer ? title.substr(newer + 12, at - newer - 12) : title.substr(0, key)));
  // Older titles begin with the number, mostly followed by an identifier in capitals; then a name.
  for (std::string word; entry.stations.size() < 2 && in >> word;) {
    const bool capitals = word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") == word.npos;
    const bool identifier = entry.stations.empty() || (capitals && word.size() <= 5);
    if (!identifier) break;
    entry.stations.push_back(word);
  }
}

/// Footer lines `name: value`; unknown values are asterisks or -9999 and are no use.
void read_footer(std::string_view text, Entry &entry) {
  const std::size_t colon = text.find(": ");
  if (colon == text.npos) return;
  const std::string_view key = trimmed(text.substr(0, colon)), value = trimmed(text.substr(colon + 2));
  if (value.empty() || value.starts_with("*") || value.starts_with("-9999")) return;
  const bool names_station = key == "Station identifier" || key == "Station number";
  if (names_station && std::find(entry.stations.begin(), entry.stations.end(), value) == entry.stations.end())
    entry.stations.emplace_back(value);
  const bool time = key == "Observation time" && value.size() == 11 && value[6] == '/';  // yymmdd/hhmm
  if (!time || entry.nominal) return;
  const auto two = [&](std::size_t i) { return static_cast<int>(to_number(value.substr(i, 2)).value_or(-1)); };
  if (two(7) < 0 || two(9) < 0 || two(9) > 59) return;
  entry.nominal = make_moment(two(0) + (two(0) < 40 ? 2000 : 1900), two(2), two(4), two(7) * 60 + two(9));
}

}  // namespace

bool is_wyoming_names_row(std::string_view line) {
  line = trimmed(line);
  const bool name_first = line.starts_with("PRES") || line.starts_with("HGHT") || line.starts_with("TEMP");
  return name_first && (line.find("HGHT", 1) != line.npos || line.find("TEMP", 1) != line.npos);
}

bool is_wyoming_title(std::string_view line) {
  return line.find("Observations at ") != line.npos || line.find("Observations for Station ") != line.npos;
}

std::vector<Entry> index_wyoming_list(const Source &source) {
  std::vector<Entry> entries;
  std::string_view title;
  int title_line = 0;
  bool in_footer = false;
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    const TextLine &line = source.lines[i];
    if (is_wyoming_title(line.text)) {
      title = line.text, title_line = line.number, in_footer = false;
    } else if (is_wyoming_names_row(line.text)) {
      Entry entry;
      entry.line = title_line ? title_line : line.number;
      if (!title.empty()) read_title(title, entry);
      title = {}, title_line = 0;
      entry.begin = i;
      bool after_blank = false;
      for (++i; i < source.lines.size() && !ends_table(source.lines[i], line.block, after_blank); ++i)
        after_blank = is_blank(source.lines[i].text);
      entry.end = i--;
      entries.push_back(entry);
      in_footer = true;
    } else if (in_footer) {
      read_footer(line.text, entries.back());
    }
  }
  if (!entries.empty()) return entries;
  const auto first =
      std::find_if(source.lines.begin(), source.lines.end(), [](const TextLine &line) { return !is_blank(line.text); });
  source.fail(first->number, first->column, "a list with a row of names PRES HGHT TEMP ..", quoted(first->text),
              "the archive sent no sounding, or the rows above the levels are lost");
}

std::vector<RawLevel> read_wyoming_list(const Source &source, const Entry &entry) {
  const TextLine &names = source.lines[entry.begin];
  std::size_t i = entry.begin + 1;
  if (i >= entry.end)
    source.fail(names.number, names.column, "a row of units and levels below the names", "the end",
                "the file is truncated");
  const Columns columns = read_columns(source, names, source.lines[i++]);
  if (i < entry.end && is_rule(source.lines[i].text)) ++i;
  std::vector<RawLevel> levels;
  for (; i < entry.end; ++i)
    if (!is_blank(source.lines[i].text)) levels.push_back(read_row(source, source.lines[i], columns));
  return levels;
}

}  // namespace greenray::sounding
