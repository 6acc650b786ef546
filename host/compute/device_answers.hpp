// What comes back from a device is looked at before it is used: a device out of order is told of, not drawn.
#pragma once
#include <span>
#include <string>

namespace greenray {

/// `what`: "rays", as in "the device returned rays that cannot be".  throws RunError
[[noreturn]] void throw_bad_answer(const std::string &what);

/// errors: RunError if one of them is infinite or no number
void require_numbers(std::span<const float> values, const std::string &what);

}  // namespace greenray
