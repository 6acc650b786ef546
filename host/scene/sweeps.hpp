// The pictures that `greenray batch` makes of one scene.
#pragma once
#include <string>
#include <vector>

#include "support/toml_reader.hpp"

namespace greenray {

struct SweepScene {
  std::string key;
  double from = 0, to = 0, step = 0;  // key `range`; all 0 when `values` was given instead
  std::vector<double> values;         // the pictures to make, in order: as listed, or the range written out
  SourcePlace place;
};

/// [[sweep]] of a scene; to be called after all other keys were read, as it may name any of them.
std::vector<SweepScene> read_sweeps(const TomlDocument &document, const TomlTable &root);

/* Overrides of each picture: every value of every sweep with every one of the others, the last sweep fastest.
   [picture][sweep] "KEY=VALUE". errors: more than a million pictures -> InputError at the first sweep */
std::vector<std::vector<std::string>> pictures_of(const std::vector<SweepScene> &sweeps);

}  // namespace greenray
