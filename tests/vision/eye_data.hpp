// Tables of tests/data/eye.
#pragma once
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/csv_table.hpp"

namespace greenray::vision {

inline std::string eye_path(const std::string &name) { return std::string(GREENRAY_TEST_DATA) + "/eye/" + name; }

/// A table, with some words replaced by numbers.
inline CsvTable eye_table(const std::string &name, const std::vector<std::pair<std::string, std::string>> &words = {}) {
  std::ifstream file(eye_path(name));
  if (!file) throw std::runtime_error("no table " + name);
  std::string text{std::istreambuf_iterator<char>(file), {}}, header;
  // golden_pupil and golden_bleach have commas in their comments only
  for (const auto &[from, to] : words)
    for (std::size_t at = text.find("," + from + "\n"); at != std::string::npos; at = text.find("," + from + "\n"))
      text.replace(at + 1, from.size(), to);
  return CsvTable::parse(text, name);
}

/// Two columns without a header.
inline std::pair<std::vector<double>, std::vector<double>> eye_columns(const std::string &name) {
  std::ifstream file(eye_path(name));
  if (!file) throw std::runtime_error("no table " + name);
  std::pair<std::vector<double>, std::vector<double>> columns;
  for (double a = 0, b = 0; file >> a >> b;) columns.first.push_back(a), columns.second.push_back(b);
  return columns;
}

}  // namespace greenray::vision
