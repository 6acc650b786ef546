#include "scene/obj_check.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

namespace greenray {
namespace {

constexpr std::size_t most_complaints = 20;

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r'; }

using Words = std::vector<std::string_view>;

Words words_of(std::string_view line) {
  Words words;
  for (std::size_t i = 0; i < line.size();) {
    while (i < line.size() && is_space(line[i])) ++i;
    const std::size_t begin = i;
    while (i < line.size() && !is_space(line[i])) ++i;
    if (i > begin) words.push_back(line.substr(begin, i - begin));
  }
  return words;
}

std::optional<double> number_of(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  const bool whole = code == std::errc() && end == word.data() + word.size() && std::isfinite(value);
  return whole ? std::optional(value) : std::nullopt;
}

/// A corner of a face: V, V/T, V//N or V/T/N, whole numbers other than 0 that fit an int.
bool is_corner(std::string_view word) {
  for (int part = 0; part < 3; ++part) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::string_view text = word.substr(0, slash);
    int value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_left_out = part == 1 && text.empty();
    if (!is_left_out && (code != std::errc() || end != text.data() + text.size() || value == 0)) return false;
    if (slash == word.size()) return !is_left_out;
    word.remove_prefix(slash + 1);
  }
  return false;
}

class Checker {
 public:
  Checker(const std::string &file, std::vector<Diagnostic> &diagnostics) : file_(file), diagnostics_(diagnostics) {}

  template <class F>
  void each_line(const std::string &text, const F &look) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      ++line_;
      if (line.find('\0') != std::string::npos) complain("expected text, found a zero byte");
      if (const Words words = words_of(line); !words.empty() && words[0][0] != '#') look(words);
    }
  }
  int line() const { return line_; }

  void complain(const std::string &message) {
    if (diagnostics_.size() < most_complaints) diagnostics_.push_back({{file_, line_, 1}, message});
  }
  void numbers(const Words &words, std::size_t needed) {
    bool right = words.size() > needed;
    for (std::size_t i = 1; right && i <= needed; ++i) right = number_of(words[i]).has_value();
    if (!right) complain("expected " + std::to_string(needed) + " number(s) after '" + std::string(words[0]) + "'");
  }
  void face(const Words &words) {
    const auto corners_end =
        std::find_if(words.begin() + 1, words.end(), [](std::string_view word) { return word[0] == '#'; });
    if (corners_end - words.begin() < 4)
      return complain("expected a face of at least three corners, found " +
                      std::to_string(corners_end - words.begin() - 1));
    for (auto word = words.begin() + 1; word != corners_end; ++word)
      if (!is_corner(*word))
        return complain("expected corners such as 1, 1/2, 1//3 or 1/2/3, found '" + std::string(*word) + "'");
  }
  /// `values` numbers from `low` to `high` after the keyword.
  void range(const Words &words, std::size_t values, double low, double high, const char *what) {
    for (std::size_t i = 1; i <= values; ++i) {
      const std::optional<double> value = i < words.size() ? number_of(words[i]) : std::nullopt;
      if (value && *value >= low && *value <= high) continue;
      const std::string found = i < words.size() ? std::string(words[i]) : "nothing";
      return complain("expected " + std::string(what) + " after '" + std::string(words[0]) + "', found " + found);
    }
  }

 private:
  const std::string &file_;
  std::vector<Diagnostic> &diagnostics_;
  int line_ = 0;
};

}  // namespace

ObjLines check_obj(const std::string &file, const std::string &text, std::vector<Diagnostic> &diagnostics) {
  ObjLines lines;
  Checker checker(file, diagnostics);
  checker.each_line(text, [&](const Words &words) {
    if (words[0] == "f") lines.faces.push_back(checker.line()), checker.face(words);
    if (words[0] == "usemtl") lines.uses.push_back(checker.line());
    if (words[0] == "mtllib") lines.libraries.push_back(checker.line());
    if (words[0] == "v" || words[0] == "vn") checker.numbers(words, 3);
    if (words[0] == "vt") checker.numbers(words, 1);
  });
  return lines;
}

std::map<std::string, int> check_mtl(const std::string &file, const std::string &text,
                                     std::vector<Diagnostic> &diagnostics) {
  std::map<std::string, int> lines;
  Checker checker(file, diagnostics);
  checker.each_line(text, [&](const Words &words) {
    if (words[0] == "newmtl" && words.size() > 1) lines.emplace(std::string(words[1]), checker.line());
    if (words[0] == "Kd" || words[0] == "Ks") checker.range(words, 3, 0, 1, "three reflectances from 0 to 1");
    if (words[0] == "Ke") checker.range(words, 3, 0, 1e12, "three radiances of 0 or more");
    if (words[0] == "Ni") checker.range(words, 1, 1, 10, "an index of refraction from 1 to 10");
    if (words[0] == "d" || words[0] == "Tr") checker.range(words, 1, 0, 1, "a number from 0 to 1");
  });
  return lines;
}

}  // namespace greenray
