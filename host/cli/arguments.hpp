// Command lines: flags known beforehand, all complaints at once, each with its place: `command line:1:COLUMN: ...`.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "support/error.hpp"

namespace greenray::cli {

struct Flag {
  std::string name;        // "--height"
  std::string short_name;  // "-d" or ""
  std::string value;       // "M", "LIST"; "" for a switch
  std::string help;
  bool required = false;
  bool repeatable = false;
};

struct CommandSpec {
  std::string name;
  std::string positional;  // "PROFILE"; "" for none; "A.exr B.exr" for two; "[SUITE]" for an optional one
  std::string summary;
  std::vector<Flag> flags;
};

/// Flags every command takes.
std::vector<Flag> common_flags();

class Arguments {
 public:
  /// Throws InputError with every unknown flag, missing value, missing required flag and surplus word.
  Arguments(const CommandSpec &spec, const std::vector<std::string> &words);

  bool wants_help() const { return has("--help"); }
  const std::vector<std::string> &positional() const { return positional_; }
  SourcePlace positional_place(std::size_t i) const { return positional_places_.at(i); }
  bool has(const std::string &flag) const { return values_.count(flag) > 0; }
  std::string text(const std::string &flag, const std::string &otherwise = "") const;
  const std::vector<std::string> &all(const std::string &flag) const;
  /// Number in [low, high]; throws InputError naming the range and unit.
  double number(const std::string &flag, double low, double high, const std::string &unit) const;
  std::optional<double> optional_number(const std::string &flag, double low, double high,
                                        const std::string &unit) const;
  /// LIST: a,b,c or FROM:TO:STEP, each within [low, high].
  std::vector<double> list(const std::string &flag, double low, double high, const std::string &unit) const;
  /// One of the words; did-you-mean otherwise.
  std::string choice(const std::string &flag, const std::vector<std::string> &words,
                     const std::string &otherwise) const;
  /// A file name with this extension (".svg"); so that a picture is not written over a text by mistake.
  std::string file(const std::string &flag, const std::string &extension) const;
  SourcePlace place(const std::string &flag) const;
  /// Behind the last word, where a missing one would stand.
  const SourcePlace &end_place() const { return end_; }
  [[noreturn]] void fail(const std::string &flag, const std::string &message) const;

 private:
  struct Given {
    std::vector<std::string> values;
    SourcePlace place;
  };
  std::map<std::string, Given> values_;
  std::vector<std::string> positional_;
  std::vector<SourcePlace> positional_places_;
  SourcePlace end_;
};

std::string usage(const CommandSpec &spec);

/// "6G", "512M" -> bytes.
std::optional<std::size_t> parse_size(const std::string &text);

}  // namespace greenray::cli
