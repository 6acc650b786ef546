// A checked view on a TOML file: typed getters that know the range and unit of each key, remember which keys were
// asked for, and gather every complaint, so that a user sees all mistakes of a file at once with their places.
#pragma once
#ifndef TOML_ASSERT
#define TOML_ASSERT(expr) static_cast<void>(0)  // toml++ 3.3 asserts on "[.a]" a line before it reports the mistake
#endif
#include <toml++/impl/forward_declarations.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/error.hpp"
#include "support/utc_time.hpp"

namespace greenray {

/// Limits of a number and its unit, as told to the user: "a number above 0 and at most 1000 km".
struct Limits {
  double low;
  double high;
  const char *unit = "";
  bool low_open = false;
  bool high_open = false;
  bool hold(double value) const;  // false for NaN and infinities
  std::string text(const char *noun = "a number") const;
};

/// Largest TOML text that is read; more is an error rather than a machine out of memory.
constexpr std::size_t max_toml_bytes = 16u << 20;

/// Shortest decimal text that reads back to the same double, valid as a TOML float ("6371000.0").
std::string exact_decimal(double value);

/// "a, b, c"
std::string comma_list(const std::vector<std::string> &words);

class TomlDocument;

/// One table of the document, or the place where an absent one would be (exists() is false, getters leave the default).
/// Every getter returns true when the key was present and right; it complains to the document when it is wrong.
class TomlTable {
 public:
  bool exists() const { return table_ != nullptr; }
  SourcePlace place() const { return place_; }
  SourcePlace place(const std::string &key) const;  // of the key's value; of the table when the key is absent
  const std::string &path() const { return path_; }

  bool has(const std::string &key) const;  // present, whatever its type
  bool read(const std::string &key, double &into, const Limits &limits) const;
  bool read(const std::string &key, std::optional<double> &into, const Limits &limits) const;
  bool read(const std::string &key, int &into, const Limits &limits) const;
  bool read(const std::string &key, std::optional<int> &into, const Limits &limits) const;
  bool read(const std::string &key, bool &into) const;
  bool read(const std::string &key, std::string &into) const;
  /// A date, time and offset from UTC, such as 2024-06-21T20:31:05Z; in UTC.
  bool read(const std::string &key, UtcTime &into) const;
  /// All numbers of an array; wrong elements are complained about one by one.
  bool read(const std::string &key, std::vector<double> &into, const Limits &limits) const;
  /// All pairs of an array [[x, y], ..]; wrong elements are complained about one by one.
  bool read_pairs(const std::string &key, std::vector<std::array<double, 2>> &into, const Limits &limits) const;

  /// All words of an array; those not allowed are complained about one by one.
  bool read(const std::string &key, std::vector<std::string> &into, const std::vector<std::string> &allowed) const;

  template <class Value>
  using Words = std::vector<std::pair<const char *, Value>>;
  template <class Value>
  bool read_word(const std::string &key, Value &into, const Words<Value> &words) const {
    std::vector<std::string> names;
    for (const auto &[word, value] : words) names.emplace_back(word);
    const std::optional<std::size_t> chosen = word_index(key, names);
    if (chosen) into = words[*chosen].second;
    return chosen.has_value();
  }

  TomlTable table(const std::string &key) const;
  bool holds_table(const std::string &key) const;
  bool holds_array(const std::string &key) const;
  std::vector<TomlTable> rows(const std::string &key) const;  // [[key]] or key = [{..}, ..]

  /// Complains at the table when `key` is absent. expected: "a number from 0 to 5 m" or another noun phrase.
  bool require(const std::string &key, const std::string &expected) const;
  void complain(const std::string &key, const std::string &message) const;  // "'path.key': message" at its value

 private:
  friend class TomlDocument;
  TomlTable(TomlDocument *document, const toml::table *table, std::string path, SourcePlace place)
      : document_(document), table_(table), path_(std::move(path)), place_(std::move(place)) {}
  const toml::node *find(const std::string &key) const;  // marks the key as known
  std::string full(const std::string &key) const { return path_.empty() ? key : path_ + "." + key; }
  void wrong(const std::string &key, const toml::node &node, const std::string &expected) const;
  SourcePlace place_of(const toml::node &node) const;
  bool to_number(const std::string &key, const toml::node &node, double &into, const Limits &limits) const;
  std::optional<std::size_t> word_index(const std::string &key, const std::vector<std::string> &names) const;

  TomlDocument *document_;
  const toml::table *table_;
  std::string path_;
  SourcePlace place_;
};

/// A parsed TOML text with the complaints gathered so far.
class TomlDocument {
 public:
  /// Throws InputError at the place of the first syntax or UTF-8 error, or when the text is over max_toml_bytes.
  TomlDocument(const std::string &file, std::string_view text);
  ~TomlDocument();
  TomlDocument(const TomlDocument &) = delete;
  TomlDocument &operator=(const TomlDocument &) = delete;

  TomlTable root();
  /// Replaces one value by "KEY=VALUE": KEY dotted, VALUE in TOML syntax or a bare word taken as a string.
  /// Complaints about it are placed at `-D KEY=VALUE:1:COLUMN`.
  void override_with(const std::string &assignment);
  /// Of two keys that exclude each other, drops the one from the file when only the other was overridden.
  void prefer_overridden(const std::string &table, const std::string &key, const std::string &rival);

  void complain(SourcePlace place, const std::string &message);
  void complain(const InputError &error);
  bool knows(const std::string &path) const { return known_.count(path) != 0; }
  std::vector<std::string> known_below(const std::string &path) const;
  /// Every value of the document, overrides included, as TOML text by its dotted path; rows of tables are numbered.
  std::map<std::string, std::string> values() const;
  std::vector<std::string> known() const { return {known_.begin(), known_.end()}; }

  /// Adds a complaint for each key nobody asked for; throws one InputError if there is any complaint.
  void finish();

 private:
  friend class TomlTable;
  void complain_about_unread();

  std::string file_;
  std::unique_ptr<toml::table> root_;
  std::set<std::string> known_;
  std::map<const toml::table *, std::string> opened_;
  std::vector<Diagnostic> diagnostics_;
};

}  // namespace greenray
