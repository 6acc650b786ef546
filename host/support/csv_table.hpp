// Small tables of numbers: `#` comments, one header row, then rows of numbers.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace greenray {

class CsvTable {
 public:
  /// What a table says beyond its first and last row.
  enum class Outside { zero, clamp };

  /* text: the table; name: what complaints call it.
     errors: a missing header, a doubled or empty column name, a row of another length, a cell that is not a finite
             number -> InputError with every place at once */
  static CsvTable parse(std::string_view text, const std::string &name);
  /// A table built into the program ("host/data/rayleigh_5nm.csv"); RunError if this build lacks it.
  static CsvTable embedded(const std::string &path);

  std::size_t rows() const { return columns_.empty() ? 0 : columns_.front().size(); }
  const std::vector<std::string> &names() const { return names_; }
  bool has(std::string_view column) const;
  /// Values of one column, top to bottom; InputError (with the nearest name) if there is none such.
  const std::vector<double> &column(const std::string &name) const;

  /* Linear interpolation of y_column at x.
     errors: x_column not strictly ascending or no rows -> InputError
     returns: 0 or the end value outside the table; exactly the tabulated value at a row */
  double interpolate(const std::string &x_column, const std::string &y_column, double x,
                     Outside outside = Outside::zero) const;

 private:
  std::string name_;
  int header_line_ = 1;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

}  // namespace greenray
