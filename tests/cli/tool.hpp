// Runs the built tool as users do: another process, in a folder of its own, with what it prints and leaves behind.
#pragma once
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace greenray::cli_tests {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

inline std::string contents(const fs::path &file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
inline void write(const fs::path &file, const std::string &bytes) {
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << bytes;
}

/// What lies below a folder: relative path -> bytes ("/" for a folder).
inline std::map<std::string, std::string> listing(const fs::path &folder) {
  std::map<std::string, std::string> found;
  for (const auto &entry : fs::recursive_directory_iterator(folder))
    found[fs::relative(entry.path(), folder).string()] = entry.is_directory() ? "/" : contents(entry.path());
  return found;
}

struct Outcome {
  int code = -1;  // exit code; 1000 + N when killed by signal N
  std::string out, err;
  double peak_bytes = 0;  // of its memory
};

/// How to run: folder, changed variables (nothing: removed), limit of written files, and what to do while it runs.
struct How {
  fs::path folder;
  std::vector<std::pair<std::string, std::optional<std::string>>> environment;
  std::optional<rlim_t> largest_file_bytes;
  std::function<void(pid_t)> meanwhile;
  fs::path output;  // of the tool's standard output; a file to be read back, if not given
};

[[noreturn]] inline void become_tool(const Words &words, const How &how, const fs::path &out, const fs::path &err) {
  const auto redirect = [](const fs::path &file, int to) {
    const int from = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (from < 0 || ::dup2(from, to) < 0) ::_exit(97);
  };
  redirect(out, STDOUT_FILENO);
  redirect(err, STDERR_FILENO);
  if (::chdir(how.folder.c_str()) != 0) ::_exit(98);
  for (const auto &[name, value] : how.environment)
    value ? ::setenv(name.c_str(), value->c_str(), 1) : ::unsetenv(name.c_str());
  if (how.largest_file_bytes) {
    const rlimit limit{*how.largest_file_bytes, *how.largest_file_bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::vector<char *> arguments;
  Words all = words;
  all.insert(all.begin(), "greenray");
  for (std::string &word : all) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::execv(GREENRAY_TOOL, arguments.data());
  ::_exit(99);
}

inline Outcome run_tool(const Words &words, const How &how) {
  static int number = 0;
  const fs::path beside =
      fs::temp_directory_path() / ("greenray-said-" + std::to_string(::getpid()) + "-" + std::to_string(number++));
  const fs::path out = how.output.empty() ? fs::path(beside.string() + ".out") : how.output,
                 err = beside.string() + ".err";
  const pid_t child = ::fork();
  if (child == 0) become_tool(words, how, out, err);
  if (how.meanwhile) how.meanwhile(child);
  int status = 0;
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  rusage used{};
  while (::wait4(child, &status, WNOHANG, &used) == 0) {
    if (std::chrono::steady_clock::now() > end) ::kill(child, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  Outcome result;
  result.code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
  result.peak_bytes = 1024.0 * static_cast<double>(used.ru_maxrss);
  if (how.output.empty()) result.out = contents(out);
  result.err = contents(err);
  if (how.output.empty()) fs::remove(out);
  fs::remove(err);
  return result;
}

/// A test with an empty folder of its own.
class ToolTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "greenray-cli-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }

  Outcome run(const Words &words) const { return run_tool(words, {folder, {}, {}, {}, {}}); }
  How here() const { return {folder, {}, {}, {}, {}}; }

  fs::path folder;
};

inline std::vector<std::string> lines_of(const std::string &text) {
  std::vector<std::string> lines{""};
  for (char c : text) {
    if (c == '\n') lines.emplace_back();
    else lines.back() += c;
  }
  if (lines.back().empty()) lines.pop_back();
  return lines;
}

/// A small right scene: 16x12 pixels, two wavelengths; lines count from 1.
inline const char *const small_scene = R"(greenray = 1
title = "A small low Sun"
[atmosphere]
profile = "us76"
[observer]
height_m = 2.0
altitude_deg = 0.2
fov_deg = 0.8
resolution = [16, 12]
[sun]
apparent_altitude_deg = 0.2
[spectrum]
samples = 2
[tracing]
quality = { spp = 4 }
)";

}  // namespace greenray::cli_tests
