// Lines, cells, numbers and the one way to complain.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "atmosphere/sounding_parts.hpp"

namespace greenray::sounding {

static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\f' || c == '\v'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

bool is_blank(std::string_view text) { return trimmed(text).empty(); }

std::string lower_case(std::string_view text) {
  std::string lower(text);
  for (char &c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::string quoted(std::string_view text) {
  text = trimmed(text);
  if (text.empty()) return "nothing";
  constexpr std::size_t longest = 48;
  std::string shown = "'";
  for (char c : text.substr(0, longest)) shown += c >= ' ' && c <= '~' ? c : '?';
  return shown + (text.size() > longest ? "...'" : "'");
}

std::string count_of(std::size_t n, const std::string &noun) {
  if (n == 1) return "1 " + noun;
  const bool ends_in_y = noun.ends_with('y');
  return std::to_string(n) + " " + (ends_in_y ? noun.substr(0, noun.size() - 1) + "ies" : noun + "s");
}

std::vector<TextLine> split_lines(std::string_view text) {
  std::vector<TextLine> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    lines.push_back({static_cast<int>(lines.size()) + 1, 1, text.substr(0, end)});
    const bool two = text.substr(end, 2) == "\r\n";
    text.remove_prefix(std::min(end + (two ? 2 : 1), text.size()));
  }
  return lines;
}

void Source::fail(int line, int column, const std::string &expected, const std::string &found,
                  const std::string &hint) const {
  throw InputError({file, line, column},
                   "expected " + expected + ", found " + found + (hint.empty() ? "" : "; " + hint));
}

void Source::fail(const Cell &cell, const std::string &expected, const std::string &hint) const {
  fail(cell.line, cell.column, expected, quoted(cell.text), hint);
}

std::optional<double> to_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

std::optional<double> read_quantity(const Source &source, const Cell &cell, const Quantity &quantity) {
  if (cell.text.empty()) return std::nullopt;
  const std::optional<double> number = to_number(cell.text);
  const std::string name = quantity.name;
  if (!number) source.fail(cell, "a number for the " + name, "leave the field blank if it is unknown");
  const double value = (*number + quantity.add) * quantity.times;
  if (!(value >= quantity.low && value <= quantity.high))
    source.fail(cell, "a " + name + " of " + quantity.range, "check the unit and the columns");
  return value;
}

}  // namespace greenray::sounding
