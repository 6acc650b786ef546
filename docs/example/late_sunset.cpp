// How much later does the Sun set than straight light would have it?  late-sunset PROFILE HEIGHT_M
//
// The horizon of an eye over the sea is where its lowest free ray touches the surface; that ray is bisected for among
// rows of the refraction table, which the device makes in batches.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "atmosphere/profile.hpp"
#include "atmosphere/profile_file.hpp"
#include "compute/device.hpp"
#include "render/refraction.hpp"
#include "support/error.hpp"

using namespace greenray;

namespace {

/// The lowest of 1001 rays between two altitudes that reaches space, as a row of the table.
RefractionRow lowest_free_ray(const Profile &air, const std::shared_ptr<Device> &device, double height_m,
                              double low_deg, double high_deg) {
  RefractionRequest request;
  request.height_m = height_m;
  request.wavelengths_nm = {550};
  for (int i = 0; i <= 1000; ++i) request.altitudes_deg.push_back(low_deg + (high_deg - low_deg) * i / 1000);
  for (const RefractionRow &row : refraction_table(air, request, device).rows)
    if (row.outcome == f64::RAY_SPACE) return row;
  throw RunError("no ray between these altitudes reaches space");
}

int late_sunset(const std::string &name, double height_m) {
  const Profile air(load_profile(name, ".", {"command line", 1, 1}));
  const auto device = open_device({});
  const double dip_deg = std::acos(6371e3 / (6371e3 + height_m)) * 180 / M_PI;
  double low = -1.5 * dip_deg - 0.5, high = 2;  // a duct may lift the horizon
  RefractionRow horizon{};
  for (int finer = 0; finer < 3; ++finer) {
    horizon = lowest_free_ray(air, device, height_m, low, high);
    const double step = (high - low) / 1000;
    high = horizon.apparent_altitude_deg, low = high - step;
  }
  const double straight_deg = -dip_deg, seen_deg = *horizon.true_altitude_deg;
  std::printf("n-1 at the ground, 550 nm   %.4e\n", air.refractivity(0, 550).value);
  std::printf("horizon                     %.4f deg, straight %.4f\n", horizon.apparent_altitude_deg, straight_deg);
  std::printf("refraction there            %.2f arcmin, good to %.1g\"\n", *horizon.refraction_arcsec / 60,
              horizon.error_arcsec);
  std::printf("the Sun sets later by       %.0f s at the equator, at the equinox\n", (straight_deg - seen_deg) * 240);
  return 0;
}

}  // namespace

int main(int count, char **words) {
  try {
    return late_sunset(count > 1 ? words[1] : "us76", count > 2 ? std::atof(words[2]) : 2);
  } catch (const std::exception &error) {
    std::fprintf(stderr, "late-sunset: %s\n", error.what());
    return 1;
  }
}
