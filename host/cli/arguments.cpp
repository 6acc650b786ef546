#include "cli/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace greenray::cli {
namespace {

const char *const source = "command line";

std::optional<double> parse_number(const std::string &text) {
  double value = 0;
  const char *first = text.c_str(), *last = first + text.size();
  if (first != last && *first == '+') ++first;
  const auto [end, status] = std::from_chars(first, last, value);
  if (status != std::errc() || end != last || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string shown(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

std::size_t wanted_positionals(const std::string &positional) {
  return positional.empty() || positional[0] == '['
             ? 0
             : 1 + static_cast<std::size_t>(std::count(positional.begin(), positional.end(), ' '));
}
std::size_t most_positionals(const std::string &positional) {
  if (positional.find("...") != std::string::npos) return 100000;
  return positional.empty() ? 0 : 1 + static_cast<std::size_t>(std::count(positional.begin(), positional.end(), ' '));
}

/// A word that starts like a flag but is a number ("-0.5,0") is a value.
bool is_flag(const std::string &word) {
  return word.size() > 1 && word[0] == '-' && !(std::isdigit(static_cast<unsigned char>(word[1])) || word[1] == '.');
}

}  // namespace

std::vector<Flag> common_flags() {
  return {{"--device", "-d", "LIST", "pocl (default) | auto | all | gpu | cpu | 2 | 0:1 | part of a name"},
          {"--threads", "-t", "N", "CPU devices only: use N compute units"},
          {"--mem", "", "SIZE", "memory budget on the device, e.g. 6G"},
          {"--lanes", "", "N", "rays side by side in a work-item: 1, 4 or 8 (default: 8 on CPUs, 1 on GPUs)"},
          {"--kernel-dir", "", "DIR", "read kernels from this folder instead of from the binary"},
          {"--show-build", "", "", "print build options and logs of the kernels"},
          {"--quiet", "-q", "", "no progress"},
          {"--verbose", "-v", "", "more about what is done"},
          {"--json", "", "", "JSON in place of text where it prints"},
          {"--help", "-h", "", "this text"}};
}

Arguments::Arguments(const CommandSpec &spec, const std::vector<std::string> &words) {
  std::vector<Diagnostic> wrong;
  int column = static_cast<int>(std::string("greenray ").size() + spec.name.size() + 2);
  std::vector<std::string> names;
  for (const Flag &flag : spec.flags) names.push_back(flag.name);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const SourcePlace here{source, 1, column};
    std::string word = words[i], attached;
    column += static_cast<int>(words[i].size()) + 1;
    if (!is_flag(word)) {
      positional_.push_back(word);
      positional_places_.push_back(here);
      if (positional_.size() > most_positionals(spec.positional))
        wrong.push_back({here, "'" + word + "' is one word too many: expected `greenray " + spec.name +
                                   (spec.positional.empty() ? "" : " " + spec.positional) + "` and flags"});
      continue;
    }
    const std::size_t equals = word.find('=');
    const bool has_attached = word.rfind("--", 0) == 0 && equals != std::string::npos;
    if (has_attached) attached = word.substr(equals + 1), word = word.substr(0, equals);
    const auto flag = std::find_if(spec.flags.begin(), spec.flags.end(),
                                   [&](const Flag &f) { return f.name == word || f.short_name == word; });
    if (flag == spec.flags.end()) {
      wrong.push_back({here, "unknown flag '" + word + "'" + did_you_mean(word, names) + "; see `greenray " +
                                 spec.name + " --help`"});
      continue;
    }
    Given &given = values_[flag->name];
    if (!given.values.empty() && !flag->repeatable)
      wrong.push_back({here, flag->name + " is given twice: expected it once"});
    given.place = here;
    if (flag->value.empty()) {
      if (has_attached) wrong.push_back({here, flag->name + " is a switch: expected no value"});
      given.values.push_back("on");
    } else if (has_attached) {
      given.values.push_back(attached);
    } else if (i + 1 < words.size() && !is_flag(words[i + 1])) {
      given.place.column = column;
      column += static_cast<int>(words[++i].size()) + 1;
      given.values.push_back(words[i]);
    } else {
      wrong.push_back(
          {here, flag->name + " needs a value: expected " + flag->name + " " + flag->value + ", " + flag->help});
    }
  }
  end_ = {source, 1, column};
  if (!has("--help")) {
    const SourcePlace &end = end_;
    if (positional_.size() < wanted_positionals(spec.positional))
      wrong.push_back({end, "expected " + spec.positional + ": `greenray " + spec.name + " " + spec.positional + "`"});
    for (const Flag &flag : spec.flags)
      if (flag.required && !has(flag.name))
        wrong.push_back({end, "missing " + flag.name + " " + flag.value + ": " + flag.help});
  }
  if (!wrong.empty()) throw InputError(wrong);
}

std::string Arguments::text(const std::string &flag, const std::string &otherwise) const {
  const auto found = values_.find(flag);
  return found == values_.end() ? otherwise : found->second.values.back();
}

const std::vector<std::string> &Arguments::all(const std::string &flag) const {
  static const std::vector<std::string> none;
  const auto found = values_.find(flag);
  return found == values_.end() ? none : found->second.values;
}

SourcePlace Arguments::place(const std::string &flag) const {
  const auto found = values_.find(flag);
  return found == values_.end() ? SourcePlace{source, 1, 1} : found->second.place;
}

void Arguments::fail(const std::string &flag, const std::string &message) const {
  throw InputError(place(flag), flag + " " + text(flag) + ": " + message);
}

double Arguments::number(const std::string &flag, double low, double high, const std::string &unit) const {
  const auto value = parse_number(text(flag));
  if (!value || *value < low || *value > high)
    fail(flag, "expected a number from " + shown(low) + " to " + shown(high) + (unit.empty() ? "" : " [" + unit + "]"));
  return *value;
}

std::optional<double> Arguments::optional_number(const std::string &flag, double low, double high,
                                                 const std::string &unit) const {
  if (!has(flag)) return std::nullopt;
  return number(flag, low, high, unit);
}

std::vector<double> Arguments::list(const std::string &flag, double low, double high, const std::string &unit) const {
  const std::string given = text(flag);
  const std::string expected =
      "expected a,b,c or FROM:TO:STEP with numbers from " + shown(low) + " to " + shown(high) + " [" + unit + "]";
  constexpr std::size_t most = 10'000'000;
  const bool range = given.find(':') != std::string::npos;
  std::vector<double> parts;
  std::istringstream words(given);
  for (std::string word; std::getline(words, word, range ? ':' : ',');) {
    const auto value = parse_number(word);
    if (!value) fail(flag, expected);
    parts.push_back(*value);
  }
  if (parts.empty() || (!given.empty() && (given.back() == ',' || given.back() == ':'))) fail(flag, expected);
  if (range) {
    if (parts.size() != 3 || parts[2] == 0 || (parts[1] - parts[0]) * parts[2] < 0)
      fail(flag, expected + "; the step must lead from FROM to TO");
    const double from = parts[0], to = parts[1], step = parts[2];
    const double steps = std::floor((to - from) / step + 1e-9);
    if (steps > static_cast<double>(most)) fail(flag, "expected at most 10000000 values");
    parts.clear();
    for (double k = 0; k <= steps; ++k) {
      const double value = step > 0 ? std::min(from + k * step, to) : std::max(from + k * step, to);
      parts.push_back(std::abs(value) < std::abs(step) * 1e-9 ? 0.0 : value);
    }
  }
  for (double value : parts)
    if (value < low || value > high) fail(flag, shown(value) + " is out of range: " + expected);
  return parts;
}

std::string Arguments::choice(const std::string &flag, const std::vector<std::string> &words,
                              const std::string &otherwise) const {
  if (!has(flag)) return otherwise;
  const std::string given = text(flag);
  if (std::find(words.begin(), words.end(), given) != words.end()) return given;
  std::string list;
  for (const std::string &word : words) list += (list.empty() ? "" : " | ") + word;
  fail(flag, "expected " + list + did_you_mean(given, words));
}

std::string Arguments::file(const std::string &flag, const std::string &extension) const {
  const std::string name = text(flag);
  if (std::filesystem::path(name).extension() != extension)
    fail(flag, "expected a file name that ends in " + extension);
  return name;
}

std::string usage(const CommandSpec &spec) {
  std::ostringstream text;
  text << "greenray " << spec.name << (spec.positional.empty() ? "" : " " + spec.positional) << " [flags]\n"
       << spec.summary << "\n\n";
  for (const Flag &flag : spec.flags) {
    std::string left = "  " + (flag.short_name.empty() ? "" : flag.short_name + ", ") + flag.name +
                       (flag.value.empty() ? "" : " " + flag.value);
    left.resize(std::max<std::size_t>(left.size() + 2, 30), ' ');
    text << left << flag.help << (flag.required ? " (required)" : "") << "\n";
  }
  return text.str();
}

std::optional<std::size_t> parse_size(const std::string &text) {
  double scale = 1;
  std::string digits = text;
  if (!digits.empty() && std::isalpha(static_cast<unsigned char>(digits.back()))) {
    const char unit = static_cast<char>(std::toupper(static_cast<unsigned char>(digits.back())));
    scale = unit == 'K' ? 1e3 : unit == 'M' ? 1e6 : unit == 'G' ? 1e9 : unit == 'T' ? 1e12 : 0;
    digits.pop_back();
  }
  const auto value = parse_number(digits);
  if (!value || *value <= 0 || scale == 0 || *value * scale > 1e15) return std::nullopt;
  return static_cast<std::size_t>(*value * scale);
}

}  // namespace greenray::cli
