// A device that fails under way: allocation, compiler, launch, transfer, nonsense in its answers.
#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

namespace greenray::cli_tests {
namespace {

class Faults : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(folder / "s.toml", small_scene);
  }
  Outcome struck(const std::string &fault, const Words &words) const {
    How how = here();
    how.environment = {{"GREENRAY_FAULT", fault}, {"LD_PRELOAD", GREENRAY_FAULTY_DEVICE}};
    return run_tool(words, how);
  }
  static std::vector<Words> jobs() {
    return {{"render", "s.toml", "-q", "-o", "x.exr"},
            {"render", "cornell", "-q", "--size", "20x15", "--photons", "20000", "-o", "x.exr"},
            {"render", "cross-room", "-q", "--size", "20x15", "--photons", "20000", "-o", "x.exr"},
            {"refraction", "us76", "--height", "2", "--altitudes", "0,1", "--wavelengths", "550", "-o", "x.csv"},
            {"trace", "us76", "--height", "2", "--altitudes", "0", "--wavelengths", "550", "--distances", "9", "-o",
             "x.csv"}};
  }
  /// One message, a documented code, and nothing but the input left.
  void expect_clear_end(const std::string &fault, const Words &words, int code, const std::string &part) const {
    const Outcome result = struck(fault, words);
    const std::string what = fault + ", " + words[0] + " " + words[1] + ": " + result.err;
    EXPECT_EQ(result.code, code) << what;
    EXPECT_EQ(("\n" + result.err).find("\ngreenray: "), ("\n" + result.err).rfind("\ngreenray: ")) << what;
    EXPECT_NE(("\n" + result.err).find("\ngreenray: "), std::string::npos) << what;  // compilers speak before it
    EXPECT_NE(result.err.find(part), std::string::npos) << what;
    EXPECT_EQ(result.out, "") << what;
    const auto left = listing(folder);
    EXPECT_EQ(left.size(), 1U) << what << " left behind: " << left.rbegin()->first;
  }
};

// oracle: the contract's exit codes; OpenCL 1.2's names of the errors.  tolerance: none
TEST_F(Faults, NoMemory) {
  for (const Words &job : jobs())
    for (const char *number : {"1", "2", "5"})
      expect_clear_end(std::string("buffer:") + number + ":-4", job, 4, "CL_MEM_OBJECT_ALLOCATION_FAILURE");
}
TEST_F(Faults, KernelsDoNotCompile) {
  for (const Words &job : jobs()) expect_clear_end("build:1:-11", job, 1, "CL_BUILD_PROGRAM_FAILURE");
}
TEST_F(Faults, KernelsDoNotStart) {
  for (const Words &job : jobs()) expect_clear_end("launch:1:-5", job, 1, "CL_OUT_OF_RESOURCES");
  for (const char *number : {"2", "4", "7"})
    expect_clear_end(std::string("launch:") + number + ":-5", jobs()[1], 1, "CL_OUT_OF_RESOURCES");
}
TEST_F(Faults, TheDeviceDisappears) {
  for (const Words &job : jobs())
    for (const char *call : {"read:1", "write:1", "write:3", "finish:1"})
      expect_clear_end(std::string(call) + ":-2", job, 1, "CL_DEVICE_NOT_AVAILABLE");
}

// oracle: bytes of ones are no ray, no count and no number: from the N-th answer on, none may end as a result
TEST_F(Faults, NonsenseIsNotTakenForAnAnswer) {
  for (const Words &job : jobs())
    for (int number = 1; number <= (job[0] == "render" ? 3 : 1); ++number) {
      const std::string fault = "read:" + std::to_string(number) + ":garbage";
      const Outcome result = struck(fault, job);
      EXPECT_EQ(result.code, 1) << fault << ", " << job[0] << " " << job[1] << result.err;
      EXPECT_NE(result.err.find("devices --test"), std::string::npos) << fault << ", " << job[1] << ": " << result.err;
      EXPECT_EQ(listing(folder).size(), 1U);
      for (const char *file : {"x.exr", "x.png", "x.json", "x.html", "x.csv"}) fs::remove(folder / file);
    }
  expect_clear_end("map:1:garbage", jobs()[0], 1, "devices --test");
}

// oracle: the picture of an undisturbed run: a batch tells what failed, and makes it the next time
TEST_F(Faults, ABatchGoesOnAfterwards) {
  write(folder / "jobs.csv", "scene,name\ns.toml,a\ns.toml,b\n");
  const Outcome failed = struck("launch:1:-5", {"batch", "jobs.csv", "-q", "-o", "out"});
  EXPECT_EQ(failed.code, 1) << failed.err;
  EXPECT_NE(failed.err.find("CL_OUT_OF_RESOURCES"), std::string::npos) << failed.err;
  EXPECT_FALSE(fs::exists(folder / "out/a.exr"));
  EXPECT_EQ(run({"batch", "jobs.csv", "-q", "-o", "out"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "out/a.exr") && fs::exists(folder / "out/b.exr"));
}

}  // namespace
}  // namespace greenray::cli_tests
