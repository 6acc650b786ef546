#include "scene/sweeps.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <sstream>

namespace greenray {
namespace {

constexpr double most_pictures = 1e6;

/// from, from + step, .. as far as to, the end kept against rounding (a millionth of a step).
void read_range(const TomlTable &table, SweepScene &sweep) {
  const Limits any{-1e12, 1e12};
  for (const char *key : {"from", "to", "step"}) table.require(key, any.text());
  const bool right =
      table.read("from", sweep.from, any) & table.read("to", sweep.to, any) & table.read("step", sweep.step, any);
  if (!right) return;
  const double steps = (sweep.to - sweep.from) / sweep.step;
  if (sweep.step == 0 || steps < 0)
    return table.complain("step", "expected a step that leads from `from` to `to`: not 0, and with the right sign");
  if (steps >= most_pictures) return table.complain("step", "expected at most 1000000 pictures");
  const int count = static_cast<int>(std::floor(steps + 1e-6)) + 1;
  for (int i = 0; i < count; ++i) sweep.values.push_back(sweep.from + i * sweep.step);
}

/// light.0.power_W -> light.power_W: what a key of a row is known as.
std::string without_rows(const std::string &key) {
  std::string plain;
  std::istringstream words(key);
  for (std::string word; std::getline(words, word, '.');) {
    const bool row =
        !word.empty() && std::all_of(word.begin(), word.end(), [](unsigned char c) { return std::isdigit(c); });
    if (!row) plain += (plain.empty() ? "" : ".") + word;
  }
  return plain;
}

/// A sweep may change any key of a table; whether the value fits shows when `greenray batch` overrides it.
void check_key(const TomlDocument &document, const TomlTable &row, const std::string &key) {
  std::vector<std::string> keys;
  for (const std::string &known : document.known())
    if (known.find('.') != std::string::npos && known.rfind("sweep.", 0) != 0) keys.push_back(known);
  if (std::find(keys.begin(), keys.end(), without_rows(key)) == keys.end())
    row.complain("key",
                 "expected a scene key such as sun.altitude_deg, found \"" + key + "\"" + did_you_mean(key, keys));
}

/// As TOML: whole numbers without a point, so that they fit keys that count.
std::string toml_number(double value) {
  if (value != std::floor(value) || std::abs(value) > 1e15) return exact_decimal(value);
  return std::to_string(static_cast<long long>(value));
}

}  // namespace

std::vector<SweepScene> read_sweeps(const TomlDocument &document, const TomlTable &root) {
  std::vector<SweepScene> sweeps;
  for (const TomlTable &row : root.rows("sweep")) {
    SweepScene sweep;
    sweep.place = row.place();
    row.require("key", "a scene key such as \"sun.altitude_deg\"");
    if (row.read("key", sweep.key)) check_key(document, row, sweep.key);
    const bool has_range = row.has("range"), has_values = row.has("values");
    if (has_range && has_values) row.complain("values", "expected either range or values, found both");
    if (!has_range && !has_values) row.require("range", "{ from = .., to = .., step = .. }, or values = [..]");
    if (const TomlTable range = row.table("range"); range.exists()) read_range(range, sweep);
    if (row.read("values", sweep.values, {-1e12, 1e12}) && sweep.values.empty())
      row.complain("values", "expected at least one number");
    sweeps.push_back(sweep);
  }
  return sweeps;
}

std::vector<std::vector<std::string>> pictures_of(const std::vector<SweepScene> &sweeps) {
  std::vector<std::vector<std::string>> pictures{{}};
  for (const SweepScene &sweep : sweeps) {
    if (static_cast<double>(pictures.size()) * static_cast<double>(sweep.values.size()) > most_pictures)
      throw InputError(sweeps.front().place, "expected at most 1000000 pictures of all sweeps together");
    std::vector<std::vector<std::string>> more;
    for (const std::vector<std::string> &picture : pictures)
      for (const double value : sweep.values) {
        more.push_back(picture);
        more.back().push_back(sweep.key + "=" + toml_number(value));
      }
    pictures = std::move(more);
  }
  return pictures;
}

}  // namespace greenray
