// How things go wrong, one type per exit code. `main` prints what() and returns exit_code().
#pragma once
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace greenray {

/// Documented exit codes of every command (docs/contract).
enum class ExitCode {
  done = 0,
  run_failed = 1,
  bad_input = 2,
  no_device = 3,
  out_of_memory = 4,
  stopped_early = 5,
  different = 6,
  interrupted = 130
};

class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string &message) : std::runtime_error(message), code_(code) {}
  ExitCode exit_code() const { return code_; }

 private:
  ExitCode code_;
};

/// Disk, driver, kernel: the run failed and nothing half-written is left.
struct RunError : Error {
  explicit RunError(const std::string &message) : Error(ExitCode::run_failed, message) {}
};
struct DeviceError : Error {
  explicit DeviceError(const std::string &message) : Error(ExitCode::no_device, message) {}
};
struct MemoryError : Error {
  explicit MemoryError(const std::string &message) : Error(ExitCode::out_of_memory, message) {}
};
struct Interrupted : Error {
  Interrupted() : Error(ExitCode::interrupted, "interrupted: nothing was written") {}
  explicit Interrupted(const std::string &message) : Error(ExitCode::interrupted, message) {}
};

/// Where a wrong value stands. line and column count from 1; 0 means unknown and prints as 1.
struct SourcePlace {
  std::string file;
  int line = 1;
  int column = 1;
};

/// One complaint about an input, printed as `file:line:column: what was expected`.
struct Diagnostic {
  SourcePlace place;
  std::string message;
  std::string text() const;
};

/// Wrong flag, scene, profile or sounding: all complaints at once; nothing has been written. Exit code 2.
class InputError : public Error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  InputError(SourcePlace place, const std::string &message)
      : InputError(std::vector<Diagnostic>{{std::move(place), message}}) {}
  const std::vector<Diagnostic> &diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// " (did you mean 'x'?)" for the candidate nearest to `word` within a third of its length, else "".
std::string did_you_mean(const std::string &word, const std::vector<std::string> &candidates);

}  // namespace greenray
