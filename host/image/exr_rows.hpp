// An EXR file written a few rows at a time.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "support/atomic_file.hpp"

namespace greenray {

class ExrRowWriter {
 public:
  /// channels: FLOAT, in the order of the values; white_luminance_cd_m2: attribute, left out when 0.
  ExrRowWriter(AtomicFile &file, int width, int height, const std::vector<std::string> &channels,
               double white_luminance_cd_m2);
  ~ExrRowWriter();
  /// values: [rows][width][channels]; rows follow one another from the top.
  void append(const std::vector<float> &values, int first_row, int rows);
  void finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace greenray
