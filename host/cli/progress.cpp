#include "cli/progress.hpp"

#include <unistd.h>

#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

namespace greenray::cli {

Progress::Progress(Style style)
    : style_(style), terminal_(isatty(STDOUT_FILENO)), begin_(std::chrono::steady_clock::now()) {}

static std::string minutes(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%d:%02d", static_cast<int>(seconds) / 60, static_cast<int>(seconds) % 60);
  return text;
}

std::string Progress::line(const std::string &phase, double fraction, double noise) const {
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  std::string bar(24, '-');
  for (int i = 0; i < static_cast<int>(24 * fraction); ++i) bar[static_cast<std::size_t>(i)] = '#';
  std::string text = phase;
  text.resize(9, ' ');
  text += "[" + bar + "] " + std::to_string(static_cast<int>(100 * fraction)) + " %  " + minutes(elapsed) + " elapsed";
  if (fraction > 0.02) text += ", " + minutes(elapsed / fraction - elapsed) + " left";
  if (noise > 0) {
    char extra[32];
    std::snprintf(extra, sizeof extra, "   noise %.2g %%", 100 * noise);
    text += extra;
  }
  return text;
}

void Progress::show(const std::string &phase, double fraction, double noise) {
  if (style_ == Style::quiet) return;
  if (style_ == Style::json) {
    std::cout
        << nlohmann::json{{"event", "progress"}, {"phase", phase}, {"fraction", fraction}, {"noise", noise}}.dump()
        << std::endl;
    return;
  }
  if (terminal_) {
    std::cout << "\r\033[K" << line(phase, fraction, noise) << std::flush;
    open_ = true;
    return;
  }
  const int tenth = static_cast<int>(fraction * 10);
  if (phase == last_phase_ && tenth == last_tenth_) return;
  if (fraction > 0) std::cout << line(phase, fraction, noise) << std::endl;
  last_phase_ = phase;
  last_tenth_ = tenth;
}

void Progress::end() {
  if (open_) std::cout << "\r\033[K" << std::flush;
  open_ = false;
}

}  // namespace greenray::cli
