#include "support/toml_reader.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <climits>
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

static std::string list(const std::vector<std::string> &words) {
  std::string all;
  for (const std::string &word : words) all += (all.empty() ? "" : ", ") + word;
  return all;
}

// ---- TomlTable

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
  if (const auto *number = node.as_floating_point())
    value = number->get();
  else if (const auto *integer = node.as_integer())
    value = static_cast<double>(integer->get());
  else
    return wrong(key, node, limits.text()), false;
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
  if (const auto *integer = node->as_integer())
    value = static_cast<double>(integer->get());
  else if (const auto *number = node->as_floating_point())
    value = number->get();
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

std::optional<std::size_t> TomlTable::word_index(const std::string &key, const std::vector<std::string> &names) const {
  const toml::node *node = find(key);
  if (!node) return std::nullopt;
  const std::string expected = "one of " + list(names);
  if (!node->is_string()) return wrong(key, *node, expected), std::nullopt;
  const std::string &word = node->as_string()->get();
  const auto at = std::find(names.begin(), names.end(), word);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  document_->complain(place_of(*node), "'" + full(key) + "': expected " + expected + ", found " + describe(*node) +
                                           did_you_mean(word, names));
  return std::nullopt;
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

// ---- TomlDocument

static SourcePlace place_of(const toml::parse_error &error, const std::string &file) {
  return {file, static_cast<int>(error.source().begin.line), static_cast<int>(error.source().begin.column)};
}

TomlDocument::TomlDocument(const std::string &file, std::string_view text) : file_(file) {
  if (text.size() > max_toml_bytes)
    throw InputError({file, 1, 1}, "expected at most 16 MiB of text, found " + std::to_string(text.size()) + " bytes");
  try {
    root_ = std::make_unique<toml::table>(toml::parse(text, std::string_view(file_)));
  } catch (const toml::parse_error &error) {
    throw InputError(place_of(error, file_), "not valid TOML: " + std::string(error.description()));
  }
  opened_.emplace(root_.get(), "");
}

TomlDocument::~TomlDocument() = default;

TomlTable TomlDocument::root() { return {this, root_.get(), "", SourcePlace{file_, 1, 1}}; }

/// `KEY="VALUE"` for a value that is no TOML but reads as a bare word; nothing when it was meant as TOML.
static std::optional<std::string> quoted(const std::string &assignment, std::size_t equals) {
  const std::string value = assignment.substr(equals + 1);
  if (!value.empty() && std::string("[{\"'").find(value[0]) != std::string::npos) return std::nullopt;
  std::string text = assignment.substr(0, equals + 1) + "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

/// Moves the values of `from` into `into`, table by table. Moving keeps their places in the text; copying would not.
static void merge(toml::table &into, toml::table &from) {
  for (auto &&[key, node] : from) {
    toml::node *old = into.get(key.str());
    if (old && old->is_table() && node.is_table()) {
      merge(*old->as_table(), *node.as_table());
      continue;
    }
    node.visit([&into, &k = key](auto &value) { into.insert_or_assign(k, std::move(value)); });
  }
}

void TomlDocument::override_with(const std::string &assignment) {
  const std::string file = "-D " + assignment;
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0 || assignment.find_first_of("\r\n#") < equals ||
      assignment.find_first_of("\r\n") != std::string::npos || assignment[0] == '[')
    return complain({file, 1, 1}, "expected KEY=VALUE, as in sun.altitude_deg=-0.5");
  toml::table parsed;
  try {
    parsed = toml::parse(assignment, std::string_view(file));
  } catch (const toml::parse_error &error) {
    const std::optional<std::string> as_text = quoted(assignment, equals);
    try {
      if (!as_text) throw toml::parse_error(error);
      parsed = toml::parse(*as_text, std::string_view(file));
    } catch (const toml::parse_error &last) {
      return complain(place_of(last, file), "not a TOML value: " + std::string(last.description()));
    }
  }
  merge(*root_, parsed);
}

void TomlDocument::prefer_overridden(const std::string &table, const std::string &key, const std::string &rival) {
  toml::table *at = root_->at_path(table).as_table();
  const toml::node *first = at ? at->get(key) : nullptr;
  const toml::node *second = at ? at->get(rival) : nullptr;
  if (!first || !second) return;
  const auto from_file = [this](const toml::node &node) { return node.source().path && *node.source().path == file_; };
  if (from_file(*first) == from_file(*second)) return;
  at->erase(from_file(*first) ? key : rival);
}

void TomlDocument::complain(SourcePlace place, const std::string &message) {
  diagnostics_.push_back({std::move(place), message});
}

void TomlDocument::complain(const InputError &error) {
  diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
}

std::vector<std::string> TomlDocument::known_below(const std::string &path) const {
  const std::string prefix = path.empty() ? "" : path + ".";
  std::vector<std::string> names;
  for (const std::string &known : known_)
    if (known.compare(0, prefix.size(), prefix) == 0 && known.find('.', prefix.size()) == std::string::npos)
      names.push_back(known.substr(prefix.size()));
  return names;
}

void TomlDocument::complain_about_unread() {
  for (const auto &[table, path] : opened_) {
    const std::vector<std::string> here = known_below(path);
    for (auto &&[key, node] : *table) {
      const std::string name(key.str());
      if (std::find(here.begin(), here.end(), name) != here.end()) continue;
      const toml::source_region &source = key.source();
      std::string hint = did_you_mean(name, here);
      if (hint.empty()) hint = "; expected one of " + list(here);
      complain({source.path ? *source.path : file_, static_cast<int>(source.begin.line),
                static_cast<int>(source.begin.column)},
               "unknown key '" + (path.empty() ? name : path + "." + name) + "'" + hint);
    }
  }
}

void TomlDocument::finish() {
  complain_about_unread();
  if (diagnostics_.empty()) return;
  const auto rank = [this](const Diagnostic &d) {  // this file in reading order, then the others as they came
    return d.place.file == file_ ? std::pair(d.place.line, d.place.column) : std::pair(INT_MAX, INT_MAX);
  };
  std::stable_sort(diagnostics_.begin(), diagnostics_.end(),
                   [&](const Diagnostic &a, const Diagnostic &b) { return rank(a) < rank(b); });
  throw InputError(std::move(diagnostics_));
}

}  // namespace greenray
