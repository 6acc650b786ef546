#include "support/error.hpp"

#include <algorithm>
#include <numeric>

namespace greenray {

std::string Diagnostic::text() const {
  return place.file + ":" + std::to_string(std::max(place.line, 1)) + ":" + std::to_string(std::max(place.column, 1)) +
         ": " + message;
}

static std::string join(const std::vector<Diagnostic> &diagnostics) {
  std::string all;
  for (const Diagnostic &d : diagnostics) all += (all.empty() ? "" : "\n") + d.text();
  return all;
}

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : Error(ExitCode::bad_input, join(diagnostics)), diagnostics_(std::move(diagnostics)) {}

/// Levenshtein distance, two rows.
static std::size_t edit_distance(const std::string &a, const std::string &b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

std::string did_you_mean(const std::string &word, const std::vector<std::string> &candidates) {
  std::size_t best = std::max<std::size_t>(word.size() / 3, 2) + 1;
  std::string nearest;
  for (const std::string &candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best && distance < word.size()) best = distance, nearest = candidate;
  }
  return nearest.empty() ? "" : " (did you mean '" + nearest + "'?)";
}

}  // namespace greenray
