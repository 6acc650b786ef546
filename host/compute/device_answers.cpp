#include "compute/device_answers.hpp"

#include "support/error.hpp"

namespace greenray {

void throw_bad_answer(const std::string &what) {
  throw RunError("the device returned " + what +
                 " that cannot be: see `greenray devices --test`, and try another --device");
}

void require_numbers(std::span<const float> values, const std::string &what) {
  bool all = true;
  for (const float x : values) all &= x - x == 0;
  if (!all) throw_bad_answer(what);
}

}  // namespace greenray
