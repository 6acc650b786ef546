// One namespace per way of compiling native_rays.cpp: lanes, and 1 for double.
#pragma once
#include "bench/peer.hpp"

#define DECLARE_NATIVE(name)                                                                      \
  namespace greenray::bench::name {                                                               \
  std::unique_ptr<Runner> prepare(const IndexTable &table, std::span<const f64::RayStart> starts, \
                                  double tolerance_rad, unsigned threads);                        \
  }
DECLARE_NATIVE(native_1_0)
DECLARE_NATIVE(native_8_0)
DECLARE_NATIVE(native_1_1)
#undef DECLARE_NATIVE
