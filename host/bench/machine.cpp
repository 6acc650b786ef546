#include "bench/machine.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

namespace greenray::bench {
namespace {

double seconds(const timeval &t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

/// Busy time of all cores since the start of the system: the first line of /proc/stat without idle and iowait.
double busy_seconds() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0, nice = 0, system = 0, idle = 0, iowait = 0, irq = 0, softirq = 0, steal = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> iowait >> irq >> softirq >> steal)) return 0;
  return (user + nice + system + irq + softirq + steal) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::string cpu_field(const std::string &field) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind(field, 0) == 0 && line.find(": ") != std::string::npos) return line.substr(line.find(": ") + 2);
  return "";
}

}  // namespace

Clocks clocks_now() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(now).count(), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

std::string cpu_name() { return cpu_field("model name"); }

double clock_MHz() {
  double value = 0;
  std::istringstream(cpu_field("cpu MHz")) >> value;
  return value;
}

double load_average() {
  double value = 0;
  std::ifstream("/proc/loadavg") >> value;
  return value;
}

Neighbours::Neighbours() : begin_(clocks_now()), busy_seconds_(busy_seconds()) {}

double Neighbours::cores() const {
  const Clocks now = clocks_now();
  const double ours = now.cpu_seconds - begin_.cpu_seconds, all = busy_seconds() - busy_seconds_;
  return std::max(0.0, (all - ours) / std::max(now.wall_seconds - begin_.wall_seconds, 1e-3));
}

}  // namespace greenray::bench
