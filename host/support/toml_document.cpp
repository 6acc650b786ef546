// TomlDocument: parsing, overrides, and the complaints at the end. The getters are in toml_reader.cpp.
#include "support/toml_reader.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <charconv>
#include <climits>
#include <sstream>

namespace greenray {

/// Length of the UTF-8 sequence at the start of `text`; 0 when it is broken, overlong, a surrogate or beyond U+10FFFF.
static std::size_t utf8_length(std::string_view text) {
  const auto byte = [text](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  const unsigned second = byte(1);  // narrower after the first bytes of the ranges that Unicode leaves out
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f)) return 0;
  if ((first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) return 0;
  return length;
}

/// Follows strings and comments, the only places where TOML allows characters outside ASCII.
class TextScanner {
 public:
  /// Takes the character at the start of `rest`, with what belongs to it (an escaped character, further quotes).
  /// Returns its length in bytes.
  std::size_t take(std::string_view rest) {
    const char c = rest[0];
    if (c == '\n') {
      comment_ = false;
      if (quotes_ == 1) quotes_ = 0;  // left open: the parser will say so
    }
    if (comment_) return 1;
    if (quotes_ == 0) {
      comment_ = c == '#';
      if (c == '.') ++dots_;
      if (std::string_view(",=[]{}#\n").find(c) != std::string_view::npos) dots_ = 0;
      return c == '"' || c == '\'' ? open(rest) : 1;
    }
    if (c == '\\' && quote_ == '"') return rest.size() > 1 && (rest[1] == '"' || rest[1] == '\\') ? 2 : 1;
    return c == quote_ ? close(rest) : 1;
  }
  bool in_text() const { return comment_ || quotes_ != 0; }
  int dots() const { return dots_; }  // of the key or number we are in

 private:
  std::size_t run(std::string_view rest) const {
    return std::min(rest.substr(0, 5).find_first_not_of(quote_), std::min<std::size_t>(rest.size(), 5));
  }
  std::size_t open(std::string_view rest) {
    quote_ = rest[0];
    const std::size_t count = run(rest);
    if (count == 2) return 2;  // an empty string
    quotes_ = count >= 3 ? 3 : 1;
    return quotes_;
  }
  std::size_t close(std::string_view rest) {
    const std::size_t count = run(rest);
    if (count < quotes_) return count;
    const std::size_t taken = quotes_ == 3 ? std::min<std::size_t>(count, 5) : 1;  // two may precede the closing three
    quotes_ = 0;
    return taken;
  }
  bool comment_ = false;
  int dots_ = 0;
  char quote_ = '"';
  std::size_t quotes_ = 0;  // that opened the string we are in: 0, 1 or 3
};

/// Refuses broken UTF-8 at its very place (the parser points at the character before it), and characters outside ASCII
/// where text is not allowed (toml++ 3.3 has undefined behaviour on some of them), and keys of very many parts (it
/// would destroy their tables by recursion, and run out of stack).
static void check_characters(const std::string &file, std::string_view text) {
  SourcePlace place{file, 1, 1};
  TextScanner scanner;
  std::size_t i = text.substr(0, 3) == "\xef\xbb\xbf" ? 3 : 0;  // byte order mark
  while (i < text.size()) {
    const std::string_view rest = text.substr(i);
    const std::size_t length = utf8_length(rest);
    if (length == 0)
      throw InputError(place, "not valid UTF-8: expected text, found a byte that belongs to no character");
    if (length > 1 && !scanner.in_text())
      throw InputError(place, "not valid TOML: '" + std::string(rest.substr(0, length)) +
                                  "' is expected only inside quotes or a comment");
    const std::size_t taken = length > 1 ? length : scanner.take(rest);
    if (scanner.dots() > 16) throw InputError(place, "not valid here: expected keys of at most 16 parts");
    if (rest[0] == '\n') ++place.line, place.column = 1;
    else place.column += length > 1 ? 1 : static_cast<int>(taken);
    i += taken;
  }
}

/// The table in `text`.
/// errors: InputError at the first mistake
static toml::table parse(const std::string &file, std::string_view text) {
  check_characters(file, text);
  try {
    return toml::parse(text, std::string_view(file));
  } catch (const toml::parse_error &error) {
    const toml::source_position at = error.source().begin;
    throw InputError({file, static_cast<int>(at.line), static_cast<int>(at.column)},
                     "not valid TOML: " + std::string(error.description()));
  }
}

TomlDocument::TomlDocument(const std::string &file, std::string_view text) : file_(file) {
  if (text.size() > max_toml_bytes)
    throw InputError({file, 1, 1}, "expected at most 16 MiB of text, found " + std::to_string(text.size()) + " bytes");
  root_ = std::make_unique<toml::table>(parse(file, text));
  opened_.emplace(root_.get(), "");
}

TomlDocument::~TomlDocument() = default;

TomlTable TomlDocument::root() { return {this, root_.get(), "", SourcePlace{file_, 1, 1}}; }

/// `KEY="VALUE"` for a value that is no TOML but reads as a bare word; nothing when it was meant as TOML.
static std::optional<std::string> quoted(const std::string &assignment, std::size_t equals) {
  const std::size_t begin = std::min(assignment.find_first_not_of(" \t", equals + 1), assignment.size());
  const std::string value = assignment.substr(begin);
  if (!value.empty() && std::string("[{\"'").find(value[0]) != std::string::npos) return std::nullopt;
  std::string text = assignment.substr(0, begin) + "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

static toml::table parse_assignment(const std::string &file, const std::string &assignment, std::size_t equals) {
  try {
    return parse(file, assignment);
  } catch (const InputError &) {
    const std::optional<std::string> as_text = quoted(assignment, equals);
    if (!as_text) throw;
    return parse(file, *as_text);
  }
}

static void merge(toml::table &into, toml::table &from);

/// light.0.power_W: the first of the rows begun by [[light]].
static void merge_rows(toml::array &rows, toml::table &from) {
  for (auto &&[key, node] : from) {
    const std::string number(key.str());
    std::size_t row = rows.size();
    const bool whole =
        std::from_chars(number.data(), number.data() + number.size(), row).ptr == number.data() + number.size();
    if (!whole || row >= rows.size() || !node.is_table()) {
      const toml::source_region &source = key.source();
      throw InputError({*source.path, static_cast<int>(source.begin.line), static_cast<int>(source.begin.column)},
                       "expected the number of a row, 0 to " + std::to_string(rows.size() - 1) +
                           ", and a key of it, found '" + number + "'");
    }
    merge(*rows[row].as_table(), *node.as_table());
  }
}

/// Moves the values of `from` into `into`, table by table. Moving keeps their places in the text; copying would not.
static void merge(toml::table &into, toml::table &from) {
  for (auto &&[key, node] : from) {
    toml::node *old = into.get(key.str());
    if (old && old->is_table() && node.is_table()) {
      merge(*old->as_table(), *node.as_table());
      continue;
    }
    if (old && old->is_array_of_tables() && node.is_table()) {
      merge_rows(*old->as_array(), *node.as_table());
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
  try {
    toml::table parsed = parse_assignment(file, assignment, equals);
    merge(*root_, parsed);
  } catch (const InputError &error) {
    complain(error);
  }
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

static void list_values(const std::string &path, const toml::node &node, std::map<std::string, std::string> &into) {
  if (const toml::table *table = node.as_table()) {
    for (auto &&[key, value] : *table)
      list_values(path.empty() ? std::string(key.str()) : path + "." + std::string(key.str()), value, into);
    return;
  }
  const toml::array *array = node.as_array();
  if (array && array->is_array_of_tables()) {
    for (std::size_t i = 0; i < array->size(); ++i)
      list_values(path + "[" + std::to_string(i) + "]", (*array)[i], into);
    return;
  }
  std::ostringstream text;
  node.visit([&](const auto &value) { text << value; });
  into[path] = text.str();
}

std::map<std::string, std::string> TomlDocument::values() const {
  std::map<std::string, std::string> all;
  list_values("", *root_, all);
  return all;
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
      if (hint.empty()) hint = "; expected one of " + comma_list(here);
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
  constexpr std::size_t most = 100;  // a file of another kind may be wrong a million times
  if (const std::size_t count = diagnostics_.size(); count > most) {
    diagnostics_.resize(most);
    diagnostics_.back().message += "\nand " + std::to_string(count - most) + " more";
  }
  throw InputError(std::move(diagnostics_));
}

}  // namespace greenray
