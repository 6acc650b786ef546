#include "scene/eye_file.hpp"

namespace greenray {
namespace {

/// One of a few words, kept as text.
void read_name(const TomlTable &table, const std::string &key, std::string &into,
               const std::vector<const char *> &names) {
  TomlTable::Words<std::string> words;
  for (const char *name : names) words.emplace_back(name, name);
  table.read_word(key, into, words);
}

}  // namespace

void read_eye_scene(const TomlTable &table, EyeScene &eye) {
  table.read_word(
      "model", eye.model,
      {{"human", EyeScene::Model::human}, {"camera", EyeScene::Model::camera}, {"none", EyeScene::Model::none}});
  table.read("exposure_ev", eye.exposure_ev, {-50, 50, "stops"});
  const TomlTable bleaching = table.table("bleaching");
  bleaching.read("seconds", eye.bleaching_seconds, {0, 1e6, "s"});
  bleaching.read("steady", eye.bleaching_steady);
  if (eye.bleaching_steady && bleaching.has("seconds"))
    bleaching.complain("steady", "expected either seconds or steady = true, found both");
  read_name(bleaching, "model", eye.bleaching_model, {"catch", "shape", "threshold", "adapted"});
  read_name(bleaching, "pool", eye.bleaching_pool, {"pixel", "disk"});
  read_name(table, "pupil", eye.pupil, {"watson-yellott", "de-groot", "moon-spencer", "g04"});
  table.read("glare", eye.glare);
  table.read("acuity", eye.acuity);
  table.read("colour", eye.colour);
  table.read("sensitivity", eye.sensitivity);
  table.read("ldmax_cd_m2", eye.ldmax_cd_m2, {1e-3, 1e6, "cd/m2"});
  table.read("contrast", eye.contrast, {1.01, 1e9});
  table.read("magnification", eye.magnification, {1e-3, 1e4});
  table.read("age_years", eye.age_years, {20, 83, "years"});
}

}  // namespace greenray
