// libFuzzer's entry: GREENRAY_FUZZ=NAME chooses the reader. Built and run by tools/fuzz.
//   fuzz_readers --list          names of the readers
//   fuzz_readers --seeds DIR     writes good files of the chosen one
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "fuzz/readers.hpp"

using namespace greenray::fuzz;

static const Reader *chosen = nullptr;

static void write_seeds(const std::filesystem::path &folder) {
  int number = 0;
  for (const Bytes &seed : chosen->seeds())
    std::ofstream(folder / ("seed-" + std::to_string(number++)), std::ios::binary) << seed;
}

extern "C" int LLVMFuzzerInitialize(int *count, char ***words) {
  const std::string first = *count > 1 ? (*words)[1] : "";
  const char *name = std::getenv("GREENRAY_FUZZ");
  for (const Reader &reader : readers()) {
    if (first == "--list") std::printf("%s\n", reader.name.c_str());
    if (name && reader.name == name) chosen = &reader;
  }
  if (first == "--list") std::exit(0);
  if (!chosen) {
    std::fprintf(stderr, "GREENRAY_FUZZ: expected a name of --list\n");
    std::exit(2);
  }
  if (first == "--seeds" && *count > 2) {
    write_seeds((*words)[2]);
    std::exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
  (void)feed(*chosen, {reinterpret_cast<const char *>(data), size});
  return 0;
}
