// Comma-separated soundings: the Wyoming download (13 columns) and the plain profile with units in its column names.
#include <algorithm>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {
namespace {

std::vector<Cell> split_cells(const TextLine &line) {
  std::vector<Cell> cells;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = std::min(line.text.find(',', begin), line.text.size());
    const std::string_view raw = line.text.substr(begin, end - begin);
    const std::string_view text = trimmed(raw);
    const std::size_t blanks = text.empty() ? 0 : static_cast<std::size_t>(text.data() - raw.data());
    cells.push_back({line.number, static_cast<int>(begin + blanks) + 1, text});
    if (end == line.text.size()) return cells;
    begin = end + 1;
  }
}

bool is_content(const TextLine &line) { return !is_blank(line.text) && !trimmed(line.text).starts_with('#'); }

/// A column this reader knows: its name, the member it fills and how.
struct Known {
  const char *name;
  std::optional<double> RawLevel::*member;
  Quantity quantity;
};

const std::vector<Known> &plain_columns() {
  static const std::vector<Known> known = {{"height_m", &RawLevel::height_m, height_in(1)},
                                           {"height_km", &RawLevel::height_m, height_in(1000)},
                                           {"height_ft", &RawLevel::height_m, height_in(0.3048)},
                                           {"temperature_C", &RawLevel::temperature_K, temperature_in(1, 273.15)},
                                           {"temperature_K", &RawLevel::temperature_K, temperature_in(1, 0)},
                                           {"pressure_hPa", &RawLevel::pressure_Pa, pressure_in(100)},
                                           {"pressure_Pa", &RawLevel::pressure_Pa, pressure_in(1)},
                                           {"relative_humidity_pct", &RawLevel::relative_humidity, humidity_in(0.01)},
                                           {"relative_humidity", &RawLevel::relative_humidity, humidity_in(1)},
                                           {"dew_point_C", &RawLevel::dew_point_K, dew_point_in(1, 273.15)},
                                           {"dew_point_K", &RawLevel::dew_point_K, dew_point_in(1, 0)}};
  return known;
}

const std::vector<Known> &wyoming_columns() {
  static const std::vector<Known> known = {{"pressure_hPa", &RawLevel::pressure_Pa, pressure_in(100)},
                                           {"geopotential height_m", &RawLevel::height_m, height_in(1)},
                                           {"temperature_C", &RawLevel::temperature_K, temperature_in(1, 273.15)},
                                           {"dew point temperature_C", &RawLevel::dew_point_K, dew_point_in(1, 273.15)},
                                           {"relative humidity_%", &RawLevel::relative_humidity, humidity_in(0.01)}};
  return known;
}

std::vector<std::string> names_of(const std::vector<Known> &known) {
  std::vector<std::string> names;
  for (const Known &column : known) names.emplace_back(column.name);
  return names;
}

/// For each column of the header the known one, or null for a column without use here.
std::vector<const Known *> read_header(const Source &source, const std::vector<Cell> &header,
                                       const std::vector<Known> &known, std::vector<std::string> &notes) {
  std::vector<const Known *> columns;
  for (const Cell &cell : header) {
    const auto found = std::find_if(known.begin(), known.end(), [&](const Known &k) { return cell.text == k.name; });
    columns.push_back(found == known.end() ? nullptr : &*found);
    if (columns.back()) {
      for (std::size_t i = 0; i + 1 < columns.size(); ++i)
        if (columns[i] && columns[i]->member == columns.back()->member)
          source.fail(cell, "one column for the " + std::string(found->quantity.name),
                      "it stands in " + quoted(header[i].text) + " already");
      continue;
    }
    const std::string lower = lower_case(cell.text), guess = did_you_mean(std::string(cell.text), names_of(known));
    const bool near = !guess.empty() || lower.starts_with("height") || lower.starts_with("temp") ||
                      lower.starts_with("press") || lower.starts_with("altitude");
    if (&known == &plain_columns() && near)
      source.fail(cell, "a known column" + guess,
                  "columns are height_m, temperature_C or _K, pressure_hPa or _Pa, relative_humidity_pct, dew_point_C");
    if (&known == &plain_columns()) notes.push_back("ignored column " + quoted(cell.text));
  }
  return columns;
}

/// The header has a column for `member`, or an error says which names would do.
void need_column(const Source &source, const std::vector<Cell> &header, const std::vector<const Known *> &columns,
                 std::optional<double> RawLevel::*member, const std::string &names) {
  const bool there =
      std::any_of(columns.begin(), columns.end(), [&](const Known *k) { return k && k->member == member; });
  if (there) return;
  std::string found;
  for (const Cell &cell : header) found.append(found.empty() ? "" : ",").append(cell.text);
  source.fail(header.front().line, 1, "a column " + names + " in the header", quoted(found),
              "names and units must match, separated by commas");
}

RawLevel read_row(const Source &source, const std::vector<Cell> &cells, const std::vector<const Known *> &columns) {
  if (cells.size() != columns.size()) {
    const Cell &last = cells.back();
    source.fail(last.line, last.column, count_of(columns.size(), "field") + " as in the header",
                std::to_string(cells.size()), "the row is cut off or a comma is missing; use . in numbers");
  }
  RawLevel level;
  level.line = cells.front().line;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!columns[i]) continue;
    level.*(columns[i]->member) = read_quantity(source, cells[i], columns[i]->quantity);
    if (columns[i]->member == &RawLevel::pressure_Pa) level.pressure_column = cells[i].column;
    if (columns[i]->member == &RawLevel::height_m) level.height_column = cells[i].column;
  }
  return level;
}

std::vector<RawLevel> read_rows(const Source &source, const Entry &entry, const std::vector<const Known *> &columns) {
  std::vector<RawLevel> levels;
  for (std::size_t i = entry.begin + 1; i < entry.end; ++i)
    if (is_content(source.lines[i])) levels.push_back(read_row(source, split_cells(source.lines[i]), columns));
  return levels;
}

/// "2024-06-21 23:02:01"; blank gives none.
std::optional<Moment> read_time(const Source &source, const Cell &cell) {
  if (cell.text.empty()) return std::nullopt;
  const auto part = [&](std::size_t i, std::size_t n) {
    const std::string_view digits = cell.text.substr(i, n);
    const bool good = digits.size() == n && digits.find_first_not_of("0123456789") == digits.npos;
    return good ? static_cast<int>(*to_number(digits)) : -1;
  };
  std::optional<Moment> moment;
  const bool shape = cell.text.size() >= 16 && cell.text[4] == '-' && cell.text[7] == '-' && cell.text[13] == ':';
  if (shape && part(11, 2) >= 0 && part(14, 2) >= 0 && part(14, 2) < 60)
    moment = make_moment(part(0, 4), part(5, 2), part(8, 2), part(11, 2) * 60 + part(14, 2));
  if (!moment) source.fail(cell, "a time like 2024-06-21 23:02:01", "");
  return moment;
}

}  // namespace

/// A repeated header begins another sounding.
std::vector<Entry> index_wyoming_csv(const Source &source) {
  std::vector<Entry> entries;
  std::size_t time_column = std::string::npos;  // none
  for (std::size_t i = 0; i < source.lines.size(); ++i) {
    const TextLine &line = source.lines[i];
    if (!is_content(line)) continue;
    const std::vector<Cell> cells = split_cells(line);
    const auto is_header = [](const Cell &cell) {
      return cell.text == "geopotential height_m" || cell.text == "pressure_hPa";
    };
    if (entries.empty() || std::any_of(cells.begin(), cells.end(), is_header)) {
      const auto time = std::find_if(cells.begin(), cells.end(), [](const Cell &cell) { return cell.text == "time"; });
      time_column = time == cells.end() ? std::string::npos : static_cast<std::size_t>(time - cells.begin());
      entries.push_back({});
      entries.back().line = line.number;
      entries.back().begin = i;
    } else if (Entry &entry = entries.back(); time_column < cells.size() && !entry.release) {
      entry.release = read_time(source, cells[time_column]);
      if (entry.release) {  // nearest of 00, 06, 12, 18 UTC
        const int quarter = (entry.release->minute + 180) / 360;
        entry.nominal = Moment{entry.release->day + std::chrono::days{quarter / 4}, quarter % 4 * 360};
      }
    }
    entries.back().end = i + 1;
  }
  return entries;
}

std::vector<RawLevel> read_wyoming_csv(const Source &source, const Entry &entry) {
  std::vector<std::string> unused;
  const std::vector<Cell> header = split_cells(source.lines[entry.begin]);
  const std::vector<const Known *> columns = read_header(source, header, wyoming_columns(), unused);
  need_column(source, header, columns, &RawLevel::pressure_Pa, "pressure_hPa");
  need_column(source, header, columns, &RawLevel::height_m, "'geopotential height_m'");
  need_column(source, header, columns, &RawLevel::temperature_K, "temperature_C");
  return read_rows(source, entry, columns);
}

std::vector<Entry> index_plain_csv(const Source &source) {
  Entry entry;
  const auto first = std::find_if(source.lines.begin(), source.lines.end(), is_content);
  if (first == source.lines.end())
    source.fail(1, 1, "a header like height_m,temperature_C,pressure_hPa,relative_humidity_pct", "only comments", "");
  entry.line = first->number;
  entry.begin = static_cast<std::size_t>(first - source.lines.begin());
  entry.end = source.lines.size();
  return {entry};
}

std::vector<RawLevel> read_plain_csv(const Source &source, const Entry &entry, std::vector<std::string> &notes) {
  const std::vector<Cell> header = split_cells(source.lines[entry.begin]);
  const std::vector<const Known *> columns = read_header(source, header, plain_columns(), notes);
  need_column(source, header, columns, &RawLevel::height_m, "height_m");
  need_column(source, header, columns, &RawLevel::temperature_K, "temperature_C or temperature_K");
  return read_rows(source, entry, columns);
}

}  // namespace greenray::sounding
