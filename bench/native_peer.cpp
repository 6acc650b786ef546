// The same source as the device's, without OpenCL: what PoCL costs or gains.
#include <sstream>
#include <string>

#include "native_rays.hpp"

namespace greenray::bench {
namespace {

using Prepare = std::unique_ptr<Runner> (*)(const IndexTable &, std::span<const f64::RayStart>, double, unsigned);

/// setting: step tolerance [rad] of rk45, layer error [arcsec] of the closed form; both are what `prepare` takes.
void add(std::vector<Method> &methods, const std::string &solver, const std::string &precision, int lanes,
         Prepare prepare, double table_arcsec, double setting, unsigned threads) {
  const bool steps = solver == "rk45";
  std::ostringstream text;
  text << "native C++ " << solver << " " << precision << " " << lanes << (lanes == 1 ? " lane" : " lanes");
  if (steps) text << ", table " << table_arcsec << "\", step " << setting;
  else text << ", layers " << setting << "\"";
  methods.push_back({{"native C++", __VERSION__, solver, precision, lanes},
                     text.str(),
                     "host, " + std::to_string(threads) + " threads",
                     table_arcsec,
                     steps ? setting : 0,
                     [=](const IndexTable &table, std::span<const f64::RayStart> starts) {
                       return prepare(table, starts, setting, threads);
                     }});
}

}  // namespace

std::vector<Method> native_methods(unsigned threads, bool few) {
  std::vector<Method> methods;
  const auto rays = [&](const std::string &precision, int lanes, Prepare prepare, double table, double tolerance) {
    add(methods, "rk45", precision, lanes, prepare, table, tolerance, threads);
  };
  const auto layers = [&](const std::string &precision, int lanes, Prepare prepare, double error_arcsec) {
    add(methods, "closed form", precision, lanes, prepare, error_arcsec / layers_per_table, error_arcsec, threads);
  };
  rays("float", 1, native_1_0::prepare, 0.01, 3e-8);
  layers("float", 8, native_8_0::prepare_layers, 0.01);
  if (few) return methods;
  rays("float", 8, native_8_0::prepare, 0.01, 3e-8);
  rays("float", 8, native_8_0::prepare, 0.003, 1e-8);
  rays("double", 1, native_1_1::prepare, 0.01, 3e-8);
  rays("double", 1, native_1_1::prepare, 1e-4, 1e-10);
  layers("float", 8, native_8_0::prepare_layers, 0.003);
  layers("float", 1, native_1_0::prepare_layers, 0.01);
  layers("double", 1, native_1_1::prepare_layers, 0.001);
  return methods;
}

}  // namespace greenray::bench
