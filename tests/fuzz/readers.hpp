// Everything that reads a file somebody else wrote, each behind one call that takes bytes: what libFuzzer and the
// replaying test feed.
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace greenray::fuzz {

using Bytes = std::string;

struct Reader {
  std::string name;
  std::vector<std::string> words;  // of its formats, for mutations: keys and marks
  /// Reads to the last row and throws what the reader throws.
  void (*read)(const Bytes &bytes);
  /// Good files to begin with.
  std::vector<Bytes> (*seeds)();
};

const std::vector<Reader> &readers();

enum class Answer { read, refused };

/* Reads; an answer is a success or an error of greenray's own, which exits with a documented code and says something.
   Anything else leaves: another exception, a signal, a sanitizer's complaint.
   refusal: what was said */
Answer feed(const Reader &reader, const Bytes &bytes, std::string *refusal = nullptr);

}  // namespace greenray::fuzz
