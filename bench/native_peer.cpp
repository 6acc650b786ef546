// The same source as the device's, without OpenCL: what PoCL costs or gains.
#include <sstream>
#include <string>

#include "native_rays.hpp"

namespace greenray::bench {
namespace {

using Prepare = std::unique_ptr<Runner> (*)(const IndexTable &, std::span<const f64::RayStart>, double, unsigned);

void add(std::vector<Method> &methods, const char *name, Prepare prepare, double table_arcsec, double tolerance_rad,
         unsigned threads) {
  std::ostringstream text;
  text << "native C++ rk45 " << name << ", table " << table_arcsec << "\", step " << tolerance_rad;
  methods.push_back({"native", __VERSION__, text.str(), "host, " + std::to_string(threads) + " threads", table_arcsec,
                     tolerance_rad, [=](const IndexTable &table, std::span<const f64::RayStart> starts) {
                       return prepare(table, starts, tolerance_rad, threads);
                     }});
}

}  // namespace

std::vector<Method> native_methods(unsigned threads, bool few) {
  std::vector<Method> methods;
  add(methods, "float 1 lane", native_1_0::prepare, 0.01, 3e-8, threads);
  if (few) return methods;
  add(methods, "float 8 lanes", native_8_0::prepare, 0.01, 3e-8, threads);
  add(methods, "float 8 lanes", native_8_0::prepare, 0.003, 1e-8, threads);
  add(methods, "double 1 lane", native_1_1::prepare, 0.01, 3e-8, threads);
  add(methods, "double 1 lane", native_1_1::prepare, 1e-4, 1e-10, threads);
  return methods;
}

}  // namespace greenray::bench
