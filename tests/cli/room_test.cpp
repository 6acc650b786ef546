// Rooms as a user renders them: stopped at any moment and taken up again, or refused.
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

}  // namespace
}  // namespace greenray::cli_tests
