// One namespace per way of compiling native_rays.cpp and native_layers.cpp: lanes, and 1 for double.
#pragma once
#include "bench/device_methods.hpp"
#include "bench/peer.hpp"

#define DECLARE_NATIVE(name)                                                                             \
  namespace greenray::bench::name {                                                                      \
  std::unique_ptr<Runner> prepare(const IndexTable &table, std::span<const f64::RayStart> starts,        \
                                  double tolerance_rad, unsigned threads);                               \
  std::unique_ptr<Runner> prepare_layers(const IndexTable &table, std::span<const f64::RayStart> starts, \
                                         double error_arcsec, unsigned threads);                         \
  }
DECLARE_NATIVE(native_1_0)
DECLARE_NATIVE(native_8_0)
DECLARE_NATIVE(native_1_1)
#undef DECLARE_NATIVE
