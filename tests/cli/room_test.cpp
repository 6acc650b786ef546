// Rooms as a user renders them: stopped at any moment and taken up again, or refused.
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

namespace greenray::cli_tests {
namespace {

using Json = nlohmann::json;

const Words render{"render", "cornell", "-q", "--size", "24x18", "--photons", "600000", "--checkpoint", "0", "-o"};

class Rooms : public ToolTest {
 protected:
  Words words(const std::string &output, const Words &more = {}) const {
    Words all = render;
    all.push_back(output);
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Runs and sends the signal when the checkpoint is there (again: when it has changed).
  Outcome stopped(const Words &all, const fs::path &checkpoint, int signal) const {
    How how = here();
    how.meanwhile = [&](pid_t child) {
      const std::string before = contents(checkpoint);
      for (int i = 0; i < 20000 && (contents(checkpoint).empty() || contents(checkpoint) == before); ++i) {
        if (::kill(child, 0) != 0) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
      ::kill(child, signal);
    };
    return run_tool(all, how);
  }
};

// oracle: the promise of the user's page: a resumed run equals one run; nothing is left over
// tolerance: none, byte for byte
TEST_F(Rooms, StoppedAtAnyMomentTheySurvive) {
  ASSERT_EQ(run(words("whole.exr")).code, 0);
  const fs::path checkpoint = folder / "part.grck";
  EXPECT_EQ(stopped(words("part.exr"), checkpoint, SIGKILL).code, 1000 + SIGKILL);
  const Outcome interrupted = stopped(words("part.exr"), checkpoint, SIGINT);
  if (interrupted.code != 0) {  // unless it was done before the signal came
    EXPECT_EQ(interrupted.code, 130);
    EXPECT_NE(interrupted.err.find("part.grck"), std::string::npos) << interrupted.err;
    ASSERT_TRUE(fs::exists(checkpoint));
    const Outcome refused = run(words("part.exr", {"--resume", "-D", "camera.fov_deg=44"}));
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.err.find("camera.fov_deg was 39, is 44"), std::string::npos) << refused.err;
    EXPECT_EQ(run(words("part.exr")).code, 0);
    EXPECT_GT(Json::parse(contents(folder / "part.json"))["passes"]["from_checkpoint"], 0);
  }
  EXPECT_EQ(contents(folder / "part.exr"), contents(folder / "whole.exr"));
  EXPECT_EQ(contents(folder / "part.png"), contents(folder / "whole.png"));
  EXPECT_EQ(listing(folder).size(), 8U) << "four files each, and no other";
}

TEST_F(Rooms, ResumeWantsACheckpoint) {
  const Outcome none = run(words("a.exr", {"--resume"}));
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("a.grck:1:1: expected a checkpoint"), std::string::npos) << none.err;
  EXPECT_EQ(run(words("a.exr", {"--resume", "--no-resume"})).code, 2);
  EXPECT_TRUE(listing(folder).empty());
}

// oracle: the contract's keys; sums
TEST_F(Rooms, ReportsErrorsAndWhereItStopped) {
  ASSERT_EQ(
      run({"render", "cornell", "-q", "--size", "32x24", "--error", "20", "--crop", "4,2,30,20", "-o", "e.exr"}).code,
      0);
  const Json report = Json::parse(contents(folder / "e.json"));
  const Json &error = report["error"];
  EXPECT_LE(error["total_rms"], 0.2);
  const double noise = error["noise_rms"], bias = error["bias"], total = error["total_rms"];
  EXPECT_NEAR(std::hypot(noise, bias), total, 1e-9);
  EXPECT_EQ(report["plan"]["crop"], Json({4, 2, 30, 20}));
  std::uint64_t outcomes = 0;
  for (const auto &[name, count] : report["outcomes"].items()) outcomes += count.get<std::uint64_t>();
  EXPECT_EQ(outcomes, report["rays_launched"].get<std::uint64_t>());
  EXPECT_EQ(run({"render", "cornell", "--crop", "0,0,500,3", "-o", "f.exr"}).code, 2);
  EXPECT_EQ(run({"render", "cornell", "--crop", "0,0,5", "-o", "f.exr"}).code, 2);
}

// oracle: what `develop` makes of the same radiances; a camera's picture is another one.  tolerance: none
TEST_F(Rooms, TheEyeSeesWhatItSeesOfTheFile) {
  const Words size{"-q", "--size", "40x30", "--photons", "40000", "--report", "off", "-o"};
  const auto rendered = [&](const std::string &name, const Words &more) {
    Words all{"render", "cornell"};
    all.insert(all.end(), size.begin(), size.end());
    all.push_back(name + ".exr");
    all.insert(all.end(), more.begin(), more.end());
    const Outcome out = run(all);
    EXPECT_EQ(out.code, 0) << out.err;
    return contents(folder / (name + ".png"));
  };
  const std::string camera = rendered("camera", {}), eye = rendered("eye", {"-D", "eye.model=human"}),
                    steady = rendered("steady", {"-D", "eye.model=human", "-D", "eye.bleaching.steady=true"});
  EXPECT_EQ(contents(folder / "camera.exr"), contents(folder / "eye.exr")) << "radiances have no observer";
  EXPECT_NE(camera, eye);
  EXPECT_NE(steady, eye);
  ASSERT_EQ(run({"develop", "eye.exr", "--observer", "human", "--fov", "39", "-o", "eye-again.png"}).code, 0);
  ASSERT_EQ(run({"develop", "eye.exr", "--bleaching", "steady", "--fov", "39", "-o", "steady-again.png"}).code, 0);
  EXPECT_EQ(contents(folder / "eye-again.png"), eye);
  EXPECT_EQ(contents(folder / "steady-again.png"), steady);
  EXPECT_TRUE(Json::parse(contents(folder / "eye.json")).contains("eye"));
}

// oracle: the process's own peak memory: what more photons take, on a device that is this machine
// tolerance: a factor of 1.6: the host's own copies, and the photons that really land
TEST_F(Rooms, CheckTellsTheMemory) {
  const Words few{"--photons", "200000", "--size", "64x48", "--spp", "1"},
      many{"--photons", "4000000", "--size", "64x48", "--spp", "1"};
  const auto promised = [&](const Words &flags) {
    Words all{"check", "cornell", "--json"};
    all.insert(all.end(), flags.begin(), flags.end());
    const Json plan = Json::parse(run(all).out)["plan"];
    EXPECT_GT(plan["seconds_estimated"], 0);
    return plan["device_bytes"].get<double>();
  };
  const auto taken = [&](const Words &flags) {
    Words all{"render", "cornell", "-q", "--report", "off", "-o", "room.exr"};
    all.insert(all.end(), flags.begin(), flags.end());
    return run(all).peak_bytes;
  };
  const double difference = promised(many) - promised(few);
  EXPECT_GT(difference, 50e6);
  EXPECT_LT(std::abs(std::log((taken(many) - taken(few)) / difference)), std::log(1.6));
  EXPECT_EQ(listing(folder).size(), 3U);
}

}  // namespace
}  // namespace greenray::cli_tests
