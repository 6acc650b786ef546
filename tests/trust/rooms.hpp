// Small rooms in several passes, a folder to leave files in, and what must be alike of two pictures.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "render/room_share.hpp"
#include "support/error.hpp"
#include "support/ranks.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {

namespace fs = std::filesystem;

inline RoomScene shipped_room(const std::string &name, const std::vector<std::string> &overrides) {
  const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/" + name + ".toml";
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse_room(file, text, overrides);
}

/// A prism's caustic: both maps, edges of light and of a lamp. 40 x 30 pixels.
inline RoomScene prism() { return shipped_room("prism-caustic", {"photons.emitted=24000"}); }
inline RoomOptions in_passes(int passes) {
  RoomOptions o;
  o.size = {24, 18};
  o.passes = passes, o.spp = passes;
  return o;
}

/// Every number of the picture, and of the report all but seconds.
inline void expect_same(const RoomPicture &a, const RoomPicture &b) {
  EXPECT_EQ(a.image.radiance, b.image.radiance);
  EXPECT_EQ(a.image.channels, b.image.channels);
  const RoomReport &r = a.report, &s = b.report;
  EXPECT_EQ(r.photons.stored, s.photons.stored);
  EXPECT_EQ(r.photons.outcome, s.photons.outcome);
  EXPECT_EQ(r.photons.emitted, s.photons.emitted);
  EXPECT_EQ(r.photons.absorbed, s.photons.absorbed);
  EXPECT_EQ(r.error_rms, s.error_rms);
  EXPECT_EQ(r.bias_mean, s.bias_mean);
  EXPECT_EQ(r.passes, s.passes);
  EXPECT_EQ(r.lamp_pixels, s.lamp_pixels);
  EXPECT_EQ(r.edge_pixels, s.edge_pixels);
  EXPECT_EQ(r.aimed_cells, s.aimed_cells);
}

inline RoomOptions stopped_at(RoomOptions options, int call) {
  options.progress = [count = 0, call](const std::string &, double, double) mutable {
    if (++count == call) throw Interrupted();
  };
  return options;
}

/// A folder of its own, removed at the end.
class TrustTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "greenray-trust-XXXXXX").string();
    ASSERT_TRUE(::mkdtemp(name.data()));
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }

  std::vector<fs::path> make_shares(const RoomScene &scene, const RoomOptions &of, int count) const {
    std::vector<fs::path> parts;
    for (int i = 0; i < count; ++i) {
      RoomOptions options = of;
      options.checkpoint = part_path(folder / "a.exr", {i, count});
      PartHead head;
      head.command = {"scene"};
      render_room_share(scene, options, shared_device(), {i, count}, head);
      parts.push_back(options.checkpoint);
    }
    return parts;
  }
  fs::path folder;
};

inline std::string what_is_wrong(const std::function<void()> &work) {
  try {
    work();
  } catch (const InputError &error) {
    return error.what();
  }
  return "";
}

}  // namespace greenray
