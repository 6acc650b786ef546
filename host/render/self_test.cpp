#include "render/self_test.hpp"

#include <cmath>
#include <sstream>

#include "compute/probe.hpp"
#include "render/launch.hpp"
#include "render/refraction.hpp"
#include "support/angle.hpp"

namespace greenray {
namespace {

/// US76, Born & Wolf index, 589.3 nm, R = 6371 km, eye at sea level: refraction [arcsec] at the apparent altitude
/// [deg]. Computed once with two independent methods (tests/data/reference/README.md).
constexpr double known_altitude_deg[] = {45, 20, 10, 5, 2, 1, 0};
constexpr double known_refraction[] = {57.0683, 155.6097, 312.8009, 578.8521, 1065.2681, 1410.1253, 1977.0497};

SelfTestResult test_layout(const std::shared_ptr<Device> &device) {
  const bool ok = device_layout(device, false) == host_layout(false) &&
                  (!device->info().has_double || device_layout(device, true) == host_layout(true));
  return {"struct layouts", ok, ok ? "host and device agree" : "host and device lay out structs differently"};
}

/// Known answers of Philox 4x32-10 published with Random123 (kat_vectors).
SelfTestResult test_random(const std::shared_ptr<Device> &device) {
  const std::array<std::uint32_t, 6> rows[] = {
      {0, 0, 0, 0, 0, 0},
      {0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff},
      {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0}};
  const std::vector<std::array<std::uint32_t, 4>> expected{{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8},
                                                           {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd},
                                                           {0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}};
  const bool ok = random_words(device, rows) == expected;
  return {"random numbers", ok, ok ? "three published Philox vectors" : "Philox differs from its published vectors"};
}

SelfTestResult test_refraction(const std::shared_ptr<Device> &device, Precision precision, double allowed_arcsec) {
  RefractionRequest request;
  request.altitudes_deg.assign(std::begin(known_altitude_deg), std::end(known_altitude_deg));
  request.wavelengths_nm = {589.3};
  request.precision = precision;
  request.tolerance_arcsec = allowed_arcsec / 4;
  const RefractionTable table = refraction_table(Profile(ProfileSpec{}), request, device);
  double worst = 0;
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    worst = std::max(worst, std::abs(table.rows[i].refraction_arcsec.value_or(1e9) - known_refraction[i]));
  std::ostringstream detail;
  detail << "7 known refractions, largest error " << worst << " arcsec (allowed " << allowed_arcsec << ")";
  return {precision == Precision::double_ ? "curved rays, double" : "curved rays, float", worst <= allowed_arcsec,
          detail.str()};
}

SelfTestResult test_storage(const std::shared_ptr<Device> &device) {
  if (!device->info().has_images) return {"table as image", true, "no images on this device: buffer only"};
  const IndexTable table = build_index_table(Profile(ProfileSpec{}), {450, 650}, {});
  std::vector<f64::RayStart> starts;
  for (int i = 0; i < 64; ++i) starts.push_back(launch(table, static_cast<std::size_t>(i % 2), 2, to_rad(0.05 * i)));
  std::vector<double> bending[2];
  for (int image = 0; image < 2; ++image) {
    TraceOptions options;
    options.storage = image ? TableStorage::image : TableStorage::buffer;
    for (const f64::RayEnd &end : RayTracer(device, table, options).trace(starts))
      bending[image].push_back(end.bending_rad);
  }
  const bool ok = bending[0] == bending[1];
  return {"table as image", ok, ok ? "same bits as from a buffer" : "differs from the buffer"};
}

}  // namespace

std::vector<SelfTestResult> self_test(const std::shared_ptr<Device> &device) {
  std::vector<SelfTestResult> results{test_layout(device), test_random(device),
                                      test_refraction(device, Precision::single_, 0.02), test_storage(device)};
  if (device->info().has_double) results.push_back(test_refraction(device, Precision::double_, 1e-3));
  return results;
}

}  // namespace greenray
