#include "render/room_error.hpp"

#include <algorithm>
#include <cmath>

#include "support/angle.hpp"

namespace greenray {
namespace {

/// n^2 of the table's first wavelength, in double.
double index2_at(const AirTable &table, double height_m) {
  const surface64::Air air{table.layers.data(),
                           table.rows.data(),
                           {static_cast<int>(table.layers.size()), static_cast<int>(table.cells), 0, 0}};
  return surface64::air_index2(&air, 0, height_m);
}

}  // namespace

double room_solver_error_arcsec(RoomTracer &tracer, const AirTable &air, const CameraScene &camera) {
  if (air.is_straight()) return 0;
  constexpr int paths = 64;
  const double index = std::sqrt(index2_at(air, camera.from[2]));
  std::vector<surface32::PathStart> starts(paths);
  for (int i = 0; i < paths; ++i) {
    const double up = 2 * (i + 0.5) / paths - 1, level = std::sqrt(1 - up * up), turn = 2.399963229728653 * i;
    const double momentum[3] = {index * level * std::cos(turn), index * level * std::sin(turn), index * up};
    for (std::size_t a = 0; a < 3; ++a) {
      starts[static_cast<std::size_t>(i)].place[a] = static_cast<float>(camera.from[a]);
      starts[static_cast<std::size_t>(i)].momentum[a] = static_cast<float>(momentum[a]);
    }
  }
  double worst = 0;
  for (const surface32::PathEnd &end : tracer.trace(starts)) {
    double momentum2 = 0;
    for (const float p : end.momentum) momentum2 += static_cast<double>(p) * static_cast<double>(p);
    const double index2 = index2_at(air, static_cast<double>(end.place[2]));
    if (std::isfinite(momentum2)) worst = std::max(worst, std::abs(momentum2 / index2 - 1) / 2);
  }
  return to_arcsec(worst);
}

double room_table_error_arcsec(const AirTable &air, double reach_m) {
  return reach_m > 0 ? to_arcsec(air.error_m / reach_m) : 0;
}

}  // namespace greenray
