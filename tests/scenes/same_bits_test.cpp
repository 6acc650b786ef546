// Pictures of rooms do not depend on how the work was cut.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"
#include "compute/device_state.hpp"
#include "image/exr.hpp"
#include "support_code/room_photons.hpp"

namespace greenray {
namespace {

const std::vector<std::string> small{"photons.emitted=120000", "camera.resolution=[60, 45]"};

RoomScene shipped(const std::string &name) {
  const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/" + name + ".toml";
  std::ifstream in(file);
  return parse_room(file, std::string{std::istreambuf_iterator<char>(in), {}}, small);
}

SpectralImage render(const RoomScene &scene, const std::shared_ptr<Device> &device) {
  RoomOptions options;
  options.size = {60, 45};
  return render_room(scene, options, device).image;
}

// oracle: the same seed, the same bits: twice, and with work-groups of 1, 4 and 32
// tolerance: none
TEST(SameBits, RoomsAtAnyWorkGroupSize) {
  for (const char *name : {"cross-room", "prism-caustic"}) {
    const RoomScene scene = shipped(name);
    const SpectralImage first = render(scene, shared_device());
    EXPECT_EQ(render(scene, shared_device()).radiance, first.radiance) << name << ", again";
    for (const int local : {1, 4, 32}) {
      const std::shared_ptr<Device> device = open_device(shared_device()->options());
      device->state().lanes.local_size = local;
      const SpectralImage image = render(scene, device);
      EXPECT_EQ(image.radiance, first.radiance) << name << ", work-groups of " << local;
      EXPECT_EQ(image.channels, first.channels) << name << ", work-groups of " << local;
    }
  }
}

// oracle: photons are the same and filed in the order of emission, however many a work-item follows
// tolerance: none
TEST(SameBits, MapsFromChunksOfAnyLength) {
  const RoomScene scene = shipped("cross-room");
  const LandedPhotons first = land_photons(scene, 60000, false, 3, 64);
  ASSERT_GT(first.count(), 10000u);
  for (const int chunk : {7, 256, 3000}) {
    const LandedPhotons other = land_photons(scene, 60000, false, 3, chunk);
    EXPECT_EQ(other.map.x_m, first.map.x_m) << chunk;
    EXPECT_EQ(other.map.z_m, first.map.z_m) << chunk;
    EXPECT_EQ(other.map.normal, first.map.normal) << chunk;
    EXPECT_EQ(other.map.power_W, first.map.power_W) << chunk;
  }
}

using RoomTool = cli_tests::ToolTest;

// oracle: one thread and two write the same file, byte for byte
// tolerance: none
TEST_F(RoomTool, SameFileFromOneThreadAndTwo) {
  std::vector<std::string> written;
  for (const char *threads : {"1", "2"}) {
    cli_tests::How how = here();
    how.environment = {{"POCL_MAX_PTHREAD_COUNT", threads}};
    const cli_tests::Outcome done = cli_tests::run_tool(
        {"render", "cross-room", "--size", "60x45", "--set", "photons.emitted=120000", "--quiet", "-o", "room.exr"},
        how);
    ASSERT_EQ(done.code, 0) << done.err;
    written.push_back(cli_tests::contents(folder / "room.exr"));
  }
  EXPECT_GT(written[0].size(), 10000u);
  EXPECT_TRUE(written[0] == written[1]);
}

// oracle: output.aovs names the channels that go into the file; contract.md: the keys of OUT.json
// tolerance: none
TEST_F(RoomTool, WritesTheChannelsAskedForAndErrorsThatWereMeasured) {
  const auto parts = [&](const std::string &aovs) {
    cli_tests::Words words{"render",
                           "cross-room",
                           "--size",
                           "20x15",
                           "--set",
                           "photons.emitted=20000",
                           "--quiet",
                           "-o",
                           "room.exr",
                           "--set",
                           "output.aovs=" + aovs};
    EXPECT_EQ(run(words).code, 0);
    std::vector<std::string> names;
    for (const ExrPart &part : read_exr(folder / "room.exr").parts) names.push_back(part.name);
    return names;
  };
  EXPECT_EQ(parts("[\"depth\"]"), (std::vector<std::string>{"picture", "depth_m"}));
  EXPECT_EQ(parts("[\"noise\", \"bend_mrad\"]"), (std::vector<std::string>{"picture", "bend_mrad", "noise"}));
  const auto report = nlohmann::json::parse(cli_tests::contents(folder / "room.json"));
  const double table = report["error"]["table_arcsec"], solver = report["error"]["solver_arcsec"];
  EXPECT_GT(table, 0);
  EXPECT_GT(solver, 0);
  EXPECT_LT(solver, 21) << "the medium is asked for 1 mm across 9.7 m";
}

}  // namespace
}  // namespace greenray
