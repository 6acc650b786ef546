// A program that uses greenray as a library, as its users would: find_package, one header, one number.
#include <cstdio>

#include "atmosphere/profile.hpp"
#include "support/version.hpp"

int main() {
  const greenray::Profile air{greenray::ProfileSpec{}};
  std::printf("greenray %s: n-1 at sea level, 550 nm: %.4e\n", greenray::version(), air.refractivity(0, 550).value);
  return 0;
}
