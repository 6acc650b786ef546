// Scanlines of an EXR file, decoded by the thread that asks for them.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace greenray {

/* The first part of an EXR file of scanlines through OpenEXR's C library: threads decode chunks of their own at the
   same time, and floats are copied whole, where the C++ library takes them byte by byte and one reader at a time. */
class ExrChunks {
 public:
  /// returns: nothing where the part is tiled, deep, or compressed by B44 or DWA, or the file is not to this library's
  /// liking
  static std::unique_ptr<ExrChunks> open(const std::filesystem::path &path);
  ~ExrChunks();

  /* Rows first_row .. first_row + rows - 1, counted from the top of the data window, into planes [channel][row][x].
     Safe to call from several threads. errors: std::runtime_error with the library's words */
  void read(int first_row, int rows, const std::vector<std::string> &channels, float *planes) const;

 private:
  struct State;
  explicit ExrChunks(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace greenray
