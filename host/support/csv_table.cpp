#include "support/csv_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <optional>

#include "support/embedded.hpp"
#include "support/error.hpp"

namespace greenray {

namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

struct Cell {
  std::string_view text;
  int column;  // from 1, where its text begins in the line
};

std::vector<Cell> split(std::string_view line) {
  std::vector<Cell> cells;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = line.find(',', begin);
    const std::string_view raw = line.substr(begin, comma == std::string_view::npos ? comma : comma - begin);
    const std::string_view text = trimmed(raw);
    const std::size_t at = text.empty() ? begin : static_cast<std::size_t>(text.data() - line.data());
    cells.push_back({text, static_cast<int>(at) + 1});
    if (comma == std::string_view::npos) return cells;
    begin = comma + 1;
  }
}

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<std::string> header(std::string_view line, const SourcePlace &place, std::vector<Diagnostic> &wrong) {
  std::vector<std::string> names;
  for (const Cell &cell : split(line)) {
    const SourcePlace here{place.file, place.line, cell.column};
    if (cell.text.empty()) wrong.push_back({here, "a column name is missing"});
    else if (number(cell.text)) wrong.push_back({here, "expected column names before the first row of numbers"});
    else if (std::find(names.begin(), names.end(), cell.text) != names.end())
      wrong.push_back({here, "column '" + std::string(cell.text) + "' appears twice"});
    names.emplace_back(cell.text);
  }
  return names;
}

void append_row(std::string_view line, const SourcePlace &place, std::vector<std::vector<double>> &columns,
                std::vector<Diagnostic> &wrong) {
  const std::vector<Cell> cells = split(line);
  if (cells.size() != columns.size()) {
    wrong.push_back(
        {place, "expected " + std::to_string(columns.size()) + " columns, found " + std::to_string(cells.size())});
    return;
  }
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const std::optional<double> value = number(cells[c].text);
    if (!value)
      wrong.push_back(
          {{place.file, place.line, cells[c].column}, "expected a number, found '" + std::string(cells[c].text) + "'"});
    columns[c].push_back(value.value_or(0.0));
  }
}

}  // namespace

CsvTable CsvTable::parse(std::string_view text, const std::string &name) {
  CsvTable table;
  table.name_ = name;
  std::vector<Diagnostic> wrong;
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  for (int line_number = 1; !text.empty(); ++line_number) {
    const std::size_t newline = text.find('\n');
    std::string_view line = text.substr(0, newline);
    text.remove_prefix(newline == std::string_view::npos ? text.size() : newline + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#') continue;
    const SourcePlace place{name, line_number, 1};
    if (table.names_.empty()) {
      table.header_line_ = line_number;
      table.names_ = header(line, place, wrong);
      table.columns_.resize(table.names_.size());
    } else {
      append_row(line, place, table.columns_, wrong);
    }
  }
  if (table.names_.empty()) wrong.push_back({{name, 1, 1}, "expected a header row of column names"});
  if (!wrong.empty()) throw InputError(std::move(wrong));
  return table;
}

CsvTable CsvTable::embedded(const std::string &path) {
  const std::optional<std::string_view> text = embedded_file(path);
  if (!text) throw RunError("the table " + path + " is missing from this build of greenray");
  return parse(*text, path);
}

bool CsvTable::has(std::string_view column) const {
  return std::find(names_.begin(), names_.end(), column) != names_.end();
}

const std::vector<double> &CsvTable::column(const std::string &name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end())
    throw InputError(SourcePlace{name_, header_line_, 1}, "no column '" + name + "'" + did_you_mean(name, names_));
  return columns_[static_cast<std::size_t>(found - names_.begin())];
}

double CsvTable::interpolate(const std::string &x_column, const std::string &y_column, double x,
                             Outside outside) const {
  const std::vector<double> &xs = column(x_column);
  const std::vector<double> &ys = column(y_column);
  const SourcePlace place{name_, header_line_, 1};
  if (xs.empty()) throw InputError(place, "expected at least one row of numbers");
  if (std::adjacent_find(xs.begin(), xs.end(), std::greater_equal<>()) != xs.end())
    throw InputError(place, "column '" + x_column + "' is not strictly ascending");
  if (!(x >= xs.front() && x <= xs.back())) {  // also NaN
    if (std::isnan(x) || outside == Outside::zero) return std::isnan(x) ? x : 0.0;
    return x < xs.front() ? ys.front() : ys.back();
  }
  const auto above = std::lower_bound(xs.begin(), xs.end(), x);
  const auto i = static_cast<std::size_t>(above - xs.begin());
  if (*above == x) return ys[i];
  const double fraction = (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
  return ys[i - 1] + fraction * (ys[i] - ys[i - 1]);
}

}  // namespace greenray
