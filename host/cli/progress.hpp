// Progress: a line that rewrites itself on a terminal, one line per 10 % elsewhere, or JSON lines.
#pragma once
#include <chrono>
#include <string>

namespace greenray::cli {

class Progress {
 public:
  enum class Style { text, json, quiet };
  explicit Progress(Style style);
  void show(const std::string &phase, double fraction, double noise);
  void end();

 private:
  std::string line(const std::string &phase, double fraction, double noise) const;
  Style style_;
  bool terminal_;
  bool open_ = false;
  int last_tenth_ = -1;
  std::string last_phase_;
  std::chrono::steady_clock::time_point begin_;
};

}  // namespace greenray::cli
