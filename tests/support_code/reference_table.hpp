// Reads the tables of tests/data/reference: words, numbers and blanks, under `#` comments and one header row.
#pragma once
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "atmosphere/profile.hpp"
#include "atmosphere/profile_file.hpp"

namespace greenray::testing_data {

inline std::string reference_path(const std::string &name) {
  return std::string(GREENRAY_TEST_DATA) + "/reference/" + name;
}

/// One row, cells by column name.
class ReferenceRow {
 public:
  ReferenceRow(const std::vector<std::string> *names, std::vector<std::string> cells)
      : names_(names), cells_(std::move(cells)) {}
  const std::string &text(const std::string &column) const {
    for (std::size_t i = 0; i < names_->size(); ++i)
      if ((*names_)[i] == column) return cells_.at(i);
    throw std::runtime_error("no column " + column);
  }
  double number(const std::string &column) const { return std::stod(text(column)); }
  std::optional<double> number_or_blank(const std::string &column) const {
    const std::string &cell = text(column);
    return cell.empty() ? std::nullopt : std::optional<double>(std::stod(cell));
  }

 private:
  const std::vector<std::string> *names_;
  std::vector<std::string> cells_;
};

class ReferenceTable {
 public:
  explicit ReferenceTable(const std::string &name) {
    std::ifstream file(reference_path(name));
    if (!file) throw std::runtime_error("no reference table " + name);
    for (std::string line; std::getline(file, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::vector<std::string> cells = split(line);
      if (names_.empty()) names_ = std::move(cells);
      else rows_.emplace_back(&names_, std::move(cells));
    }
  }
  ReferenceTable(const ReferenceTable &) = delete;
  ReferenceTable &operator=(const ReferenceTable &) = delete;
  const std::vector<ReferenceRow> &rows() const { return rows_; }
  const std::vector<std::string> &names() const { return names_; }

 private:
  static std::vector<std::string> split(const std::string &line) {
    std::vector<std::string> cells{""};
    for (char c : line) {
      if (c == ',') cells.emplace_back();
      else if (c != '\r') cells.back() += c;
    }
    return cells;
  }
  std::vector<std::string> names_;
  std::vector<ReferenceRow> rows_;
};

/// The profile that a reference row names: `us76` is all defaults, others are files beside the tables.
inline const Profile &reference_profile(const std::string &name) {
  static std::map<std::string, Profile> known;
  const auto found = known.find(name);
  if (found != known.end()) return found->second;
  const ProfileSpec spec =
      name == "us76" ? ProfileSpec{} : load_profile("profiles/" + name + ".toml", reference_path(""), {});
  return known.emplace(name, Profile(spec)).first->second;
}

}  // namespace greenray::testing_data
