#include "support/toml_reader.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>

namespace greenray {

static std::string short_number(double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return std::string(text, end.ptr);
}

std::string exact_decimal(double value) {
  std::string text = short_number(value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";  // "n": nan, inf
  return text;
}

std::string comma_list(const std::vector<std::string> &words) {
  std::string all;
  for (const std::string &word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

bool Limits::hold(double value) const {
  return std::isfinite(value) && (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Limits::text(const char *noun) const {
  const std::string unit_text = *unit ? std::string(" ") + unit : "";
  if (!low_open && !high_open)
    return std::string(noun) + " from " + short_number(low) + " to " + short_number(high) + unit_text;
  return std::string(noun) + (low_open ? " above " : " at least ") + short_number(low) +
         (high_open ? " and below " : " and at most ") + short_number(high) + unit_text;
}

/// What the user wrote, in a few words: `text "abc"`, `-3`, `a table`.
static std::string describe(const toml::node &node) {
  if (const auto *text = node.as_string()) {
    const std::string &value = text->get();
    return "text \"" + (value.size() > 40 ? value.substr(0, 40) + "..." : value) + "\"";
  }
  if (const auto *number = node.as_floating_point()) return short_number(number->get());
  if (const auto *integer = node.as_integer()) return std::to_string(integer->get());
  if (const auto *flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  return "a date or time";
}

const toml::node *TomlTable::find(const std::string &key) const {
  document_->known_.insert(full(key));
  return table_ ? table_->get(key) : nullptr;
}

SourcePlace TomlTable::place_of(const toml::node &node) const {
  const toml::source_region &source = node.source();
  if (source.begin.line == 0) return place_;
  return {source.path ? *source.path : place_.file, static_cast<int>(source.begin.line),
          static_cast<int>(source.begin.column)};
}

SourcePlace TomlTable::place(const std::string &key) const {
  const toml::node *node = table_ ? table_->get(key) : nullptr;
  return node ? place_of(*node) : place_;
}

bool TomlTable::has(const std::string &key) const { return find(key) != nullptr; }

void TomlTable::complain(const std::string &key, const std::string &message) const {
  document_->complain(place(key), "'" + full(key) + "': " + message);
}

void TomlTable::wrong(const std::string &key, const toml::node &node, const std::string &expected) const {
  document_->complain(place_of(node), "'" + full(key) + "': expected " + expected + ", found " + describe(node));
}

bool TomlTable::require(const std::string &key, const std::string &expected) const {
  if (find(key)) return true;
  if (table_) document_->complain(place_, "missing key '" + full(key) + "': expected " + expected);
  return false;
}

bool TomlTable::to_number(const std::string &key, const toml::node &node, double &into, const Limits &limits) const {
  double value = 0;
  if (const auto *number = node.as_floating_point()) value = number->get();
  else if (const auto *integer = node.as_integer()) value = static_cast<double>(integer->get());
  else return wrong(key, node, limits.text()), false;
  if (!limits.hold(value)) return wrong(key, node, limits.text()), false;
  into = value;
  return true;
}

bool TomlTable::read(const std::string &key, double &into, const Limits &limits) const {
  const toml::node *node = find(key);
  return node && to_number(key, *node, into, limits);
}

bool TomlTable::read(const std::string &key, std::optional<double> &into, const Limits &limits) const {
  double value = 0;
  if (!read(key, value, limits)) return false;
  into = value;
  return true;
}

bool TomlTable::read(const std::string &key, int &into, const Limits &limits) const {
  const toml::node *node = find(key);
  if (!node) return false;
  double value = NAN;  // a sweep hands over 24.0: whole is whole
  if (const auto *integer = node->as_integer()) value = static_cast<double>(integer->get());
  else if (const auto *number = node->as_floating_point()) value = number->get();
  if (!limits.hold(value) || value != std::floor(value)) return wrong(key, *node, limits.text("a whole number")), false;
  into = static_cast<int>(value);
  return true;
}

bool TomlTable::read(const std::string &key, std::optional<int> &into, const Limits &limits) const {
  int value = 0;
  if (!read(key, value, limits)) return false;
  into = value;
  return true;
}

bool TomlTable::read(const std::string &key, bool &into) const {
  const toml::node *node = find(key);
  if (!node) return false;
  if (!node->is_boolean()) return wrong(key, *node, "true or false"), false;
  into = node->as_boolean()->get();
  return true;
}

bool TomlTable::read(const std::string &key, std::string &into) const {
  const toml::node *node = find(key);
  if (!node) return false;
  if (!node->is_string()) return wrong(key, *node, "text in quotes"), false;
  into = node->as_string()->get();
  return true;
}

/// Seconds are left alone: a leap second is one anywhere.
static UtcTime in_utc(const toml::date_time &local) {
  using namespace std::chrono;
  const year_month_day date{year{local.date.year}, month{local.date.month}, day{local.date.day}};
  const auto moment = sys_days{date} + hours{local.time.hour} + minutes{local.time.minute - local.offset->minutes};
  const sys_days midnight = floor<days>(moment);
  const year_month_day utc{midnight};
  const auto minute = static_cast<int>(duration_cast<minutes>(moment - midnight).count());
  return {static_cast<int>(utc.year()),
          static_cast<int>(static_cast<unsigned>(utc.month())),
          static_cast<int>(static_cast<unsigned>(utc.day())),
          minute / 60,
          minute % 60,
          local.time.second + 1e-9 * local.time.nanosecond};
}

bool TomlTable::read(const std::string &key, UtcTime &into) const {
  const toml::node *node = find(key);
  if (!node) return false;
  const auto *moment = node->as_date_time();
  if (!moment || !moment->get().offset)
    return wrong(key, *node, "a date and time with its offset from UTC, such as 2024-06-21T20:31:05Z"), false;
  into = in_utc(moment->get());
  return true;
}

bool TomlTable::read(const std::string &key, std::vector<double> &into, const Limits &limits) const {
  const toml::node *node = find(key);
  if (!node) return false;
  const toml::array *array = node->as_array();
  if (!array) return wrong(key, *node, "an array, each " + limits.text()), false;
  std::vector<double> values(array->size());
  bool right = true;
  for (std::size_t i = 0; i < values.size(); ++i) right &= to_number(key, *array->get(i), values[i], limits);
  if (right) into = std::move(values);
  return right;
}

bool TomlTable::read_pairs(const std::string &key, std::vector<std::array<double, 2>> &into,
                           const Limits &limits) const {
  const toml::node *node = find(key);
  if (!node) return false;
  const std::string expected = "an array of pairs [x, y], each " + limits.text();
  const toml::array *array = node->as_array();
  if (!array) return wrong(key, *node, expected), false;
  std::vector<std::array<double, 2>> pairs;
  bool right = true;
  for (const toml::node &element : *array) {
    const toml::array *pair = element.as_array();
    if (!pair || pair->size() != 2) {
      wrong(key, element, expected);
      right = false;
      continue;
    }
    std::array<double, 2> values{};
    for (std::size_t i = 0; i < 2; ++i) right &= to_number(key, *pair->get(i), values[i], limits);
    pairs.push_back(values);
  }
  if (right) into = std::move(pairs);
  return right;
}

std::optional<std::size_t> TomlTable::word_index(const std::string &key, const std::vector<std::string> &names) const {
  const toml::node *node = find(key);
  if (!node) return std::nullopt;
  const std::string expected = "one of " + comma_list(names);
  if (!node->is_string()) return wrong(key, *node, expected), std::nullopt;
  const std::string &word = node->as_string()->get();
  const auto at = std::find(names.begin(), names.end(), word);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  document_->complain(place_of(*node), "'" + full(key) + "': expected " + expected + ", found " + describe(*node) +
                                           did_you_mean(word, names));
  return std::nullopt;
}

bool TomlTable::read(const std::string &key, std::vector<std::string> &into,
                     const std::vector<std::string> &allowed) const {
  const toml::node *node = find(key);
  if (!node) return false;
  const std::string expected = "an array of words, each one of " + comma_list(allowed);
  const toml::array *array = node->as_array();
  if (!array) return wrong(key, *node, expected), false;
  std::vector<std::string> words;
  bool right = true;
  for (const toml::node &element : *array) {
    const bool is_allowed =
        element.is_string() && std::find(allowed.begin(), allowed.end(), element.as_string()->get()) != allowed.end();
    if (is_allowed) words.push_back(element.as_string()->get());
    else wrong(key, element, expected), right = false;
  }
  if (right) into = std::move(words);
  return right;
}

bool TomlTable::holds_array(const std::string &key) const {
  const toml::node *node = find(key);
  return node && node->is_array();
}

bool TomlTable::holds_table(const std::string &key) const {
  const toml::node *node = find(key);
  return node && node->is_table();
}

TomlTable TomlTable::table(const std::string &key) const {
  const toml::node *node = find(key);
  if (!node) return {document_, nullptr, full(key), place_};
  const toml::table *inner = node->as_table();
  if (!inner) return wrong(key, *node, "a table"), TomlTable{document_, nullptr, full(key), place_of(*node)};
  document_->opened_.emplace(inner, full(key));
  return {document_, inner, full(key), place_of(*node)};
}

std::vector<TomlTable> TomlTable::rows(const std::string &key) const {
  std::vector<TomlTable> all;
  const toml::node *node = find(key);
  if (!node) return all;
  const std::string expected = "rows, each begun by [[" + full(key) + "]]";
  const toml::array *array = node->as_array();
  if (!array) return wrong(key, *node, expected), all;
  for (const toml::node &row : *array) {
    const toml::table *inner = row.as_table();
    if (!inner) {
      wrong(key, row, expected);
      continue;
    }
    document_->opened_.emplace(inner, full(key));
    all.push_back(TomlTable{document_, inner, full(key), place_of(row)});
  }
  return all;
}

}  // namespace greenray
