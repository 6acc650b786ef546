// A moment in UTC, as a calendar has it.
#pragma once

namespace greenray {

/// second: may reach 61 in a leap second.
struct UtcTime {
  int year = 2000, month = 1, day = 1, hour = 0, minute = 0;
  double second = 0;
};

}  // namespace greenray
