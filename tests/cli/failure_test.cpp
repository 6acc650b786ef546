// What goes wrong outside the input: no device, no cache, no room on the disk or in memory, an interrupt.
#include <sys/mount.h>

#include "cli/tool.hpp"

namespace greenray::cli_tests {
namespace {

bool has(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

}  // namespace

class Failure : public ToolTest {
 protected:
  void SetUp() override {
    ToolTest::SetUp();
    write(folder / "s.toml", small_scene);
  }
  Words render(const Words &more = {}) const {
    Words words{"render", "s.toml", "-o", "new/x.exr"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  void expect_nothing_new() const {
    const auto left = listing(folder);
    EXPECT_EQ(left.size(), 1U) << "left behind: " << left.begin()->first;
  }
};

// oracle: the contract: exit 3 with the install hint.  tolerance: none
TEST_F(Failure, NoDriverAtAll) {
  How how = here();
  how.environment = {{"OCL_ICD_VENDORS", "/nonexistent-folder"}, {"OCL_ICD_FILENAMES", std::nullopt}};
  for (const Words &words :
       {render(), Words{"devices"}, Words{"devices", "--test"}, Words{"devices", "--json"},
        Words{"refraction", "us76", "--height=2", "--altitudes=0", "--wavelengths=550"},
        Words{"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "--distances=9"}}) {
    const Outcome result = run_tool(words, how);
    EXPECT_EQ(result.code, 3) << words[0] << result.err;
    EXPECT_TRUE(has(result.err, "apt-get install pocl-opencl-icd")) << result.err;
    EXPECT_EQ(result.out, "");
    expect_nothing_new();
  }
}

// oracle: what needs no device works without one.  tolerance: none
TEST_F(Failure, NoDriverNeeded) {
  How how = here();
  how.environment = {{"OCL_ICD_VENDORS", "/nonexistent-folder"}};
  EXPECT_EQ(run_tool({"check", "s.toml"}, how).code, 0);
  EXPECT_EQ(run_tool({"scenes"}, how).code, 0);
  EXPECT_EQ(run_tool({"profile", "us76", "--heights=0", "--wavelengths=550"}, how).code, 0);
}

// oracle: the contract.  tolerance: none
TEST_F(Failure, NoSuchDevice) {
  const Outcome result = run(render({"--device", "nosuch"}));
  EXPECT_EQ(result.code, 3);
  EXPECT_TRUE(has(result.err, "no OpenCL device matches 'nosuch'; there are:") && has(result.err, "0:0")) << result.err;
  EXPECT_TRUE(has(result.err, "apt-get install pocl-opencl-icd")) << result.err;
  How how = here();
  how.environment = {{"GREENRAY_DEVICE", "nosuch"}};
  EXPECT_EQ(run_tool(render(), how).code, 3);
  expect_nothing_new();
}

// oracle: PoCL aborts where its cache or its linker is out of reach; we must not.  tolerance: none
TEST_F(Failure, PoorEnvironmentStillRenders) {
  const std::string cache = (folder.string() + "-cache");
  for (const auto &environment : std::vector<decltype(How::environment)>{
           {{"POCL_CACHE_DIR", "/dev/null"}, {"TMPDIR", cache}},
           {{"POCL_CACHE_DIR", std::nullopt},
            {"XDG_CACHE_HOME", std::nullopt},
            {"HOME", std::nullopt},
            {"TMPDIR", cache}},
           {{"PATH", std::nullopt}, {"POCL_CACHE_DIR", "/dev/null"}, {"TMPDIR", cache}}}) {
    How how = here();
    how.environment = environment;
    const Outcome result = run_tool(render({"--quiet"}), how);
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_TRUE(fs::exists(folder / "new/x.exr"));
    fs::remove_all(folder / "new");
  }
  How how = here();
  how.environment = {{"POCL_CACHE_DIR", "/dev/null"}, {"TMPDIR", "/dev/null"}};
  const Outcome nowhere = run_tool(render(), how);
  EXPECT_EQ(nowhere.code, 3) << nowhere.err;
  EXPECT_TRUE(has(nowhere.err, "set POCL_CACHE_DIR")) << nowhere.err;
  expect_nothing_new();
  fs::remove_all(cache);
}

// oracle: the contract: exit 1 before the work is done, the reason and the path named.  tolerance: none
TEST_F(Failure, OutputBelowARegularFile) {
  for (const Words &words :
       {Words{"render", "s.toml", "-o", "s.toml/x.exr"}, Words{"profile", "us76", "-o", "s.toml/deep/x.toml"},
        Words{"new", "s.toml/x.toml"},
        Words{"trace", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "--distances=9",
              "--plot=s.toml/x.svg"},
        Words{"refraction", "us76", "--height=2", "--altitudes=0", "--wavelengths=550", "-o", "s.toml/x.csv"}}) {
    const Outcome result = run(words);
    EXPECT_EQ(result.code, 1) << words[0] << result.err;
    EXPECT_TRUE(has(result.err, "cannot write s.toml/")) << result.err;
    expect_nothing_new();
  }
  fs::create_directories(folder / "x.exr");
  EXPECT_EQ(run({"render", "s.toml", "-o", "x.exr"}).code, 1);
}

// oracle: the old bytes; RLIMIT_FSIZE stands for a full disk.  tolerance: none
TEST_F(Failure, LimitOfFileSizeKeepsTheOldPicture) {
  for (const char *name : {"new/x.exr", "new/x.png", "new/x.json"}) write(folder / name, std::string("old ") + name);
  const auto before = listing(folder);
  How how = here();
  how.largest_file_bytes = 2'000'000;  // PoCL needs some, too
  const Outcome result = run_tool(render({"--size", "640x480"}), how);
  EXPECT_EQ(result.code, 1) << result.err;
  EXPECT_TRUE(has(result.err, "cannot write new/x.exr: File too large")) << result.err;
  EXPECT_TRUE(has(result.err, "the old picture is kept")) << result.err;
  EXPECT_EQ(listing(folder), before);
}

// oracle: the old bytes, on a real file system without room; and on one that is read only.  tolerance: none
TEST_F(Failure, FullAndReadOnlyDisks) {
  const fs::path disk = folder / "disk";
  fs::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=32k") != 0) GTEST_SKIP() << "mounting needs rights";
  for (const char *name : {"x.exr", "x.png", "x.json"}) write(disk / name, std::string("old ") + name);
  const auto before = listing(folder);
  const Outcome full = run({"render", "s.toml", "-o", "disk/x.exr", "--size", "64x48"});
  EXPECT_EQ(full.code, 1) << full.err;
  EXPECT_TRUE(has(full.err, "No space left on device (needs at least") && has(full.err, "the old picture is kept"))
      << full.err;
  EXPECT_EQ(listing(folder), before);
  ASSERT_EQ(::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, nullptr), 0);
  const Outcome read_only = run({"render", "s.toml", "-o", "disk/x.exr"});
  EXPECT_EQ(read_only.code, 1) << read_only.err;
  EXPECT_TRUE(has(read_only.err, "Read-only file system")) << read_only.err;
  EXPECT_EQ(listing(folder), before);
  ::umount(disk.c_str());
}

// oracle: /dev/full refuses every byte.  tolerance: none
TEST_F(Failure, FullStandardOutput) {
  How how = here();
  how.output = "/dev/full";
  for (const Words &words : {Words{"profile", "us76", "--heights=0", "--wavelengths=550"}, Words{"scenes"},
                             Words{"check", "s.toml"}, Words{"compare", "--help"}}) {
    const Outcome result = run_tool(words, how);
    EXPECT_EQ(result.code, 1) << words[0] << result.err;
    EXPECT_TRUE(has(result.err, "cannot write to standard output")) << result.err;
  }
}

// oracle: the contract: exit 4; needs X, has Y, try Z.  tolerance: none
TEST_F(Failure, OutOfMemory) {
  const Outcome result = run(render({"--mem", "1k", "--size", "400x300"}));
  EXPECT_EQ(result.code, 4) << result.out << result.err;
  EXPECT_TRUE(has(result.err, "needs") && has(result.err, "has") && has(result.err, "try")) << result.err;
  expect_nothing_new();
  const Outcome table = run(render({"--mem", "1M", "-D", "observer.fov_deg=60", "-D", "spectrum.samples=16"}));
  EXPECT_EQ(table.code, 4) << table.out << table.err;
  expect_nothing_new();
}

// oracle: the contract: exit 130, nothing written; the old picture stays.  tolerance: none
TEST_F(Failure, Interrupt) {
  write(folder / "new/x.exr", "old");
  const auto before = listing(folder);
  for (const int signal : {SIGINT, SIGTERM}) {
    How how = here();
    how.output = folder.string() + ".out";
    how.meanwhile = [&](pid_t child) {
      for (int i = 0; i < 5000 && !has(contents(how.output), "plan  "); ++i)  // printed as rendering begins
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      std::this_thread::sleep_for(std::chrono::milliseconds(500));
      ::kill(child, signal);
    };
    const auto begin = std::chrono::steady_clock::now();
    const Outcome result = run_tool(render({"--size", "800x600", "--spp", "100000"}), how);
    EXPECT_EQ(result.code, 130) << result.err;
    EXPECT_TRUE(has(result.err, "interrupted: nothing was written")) << result.err;
    EXPECT_EQ(listing(folder), before);
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20)) << "must stop between passes";
    fs::remove(how.output);
  }
}

// oracle: the contract: exit 130, no table.  tolerance: none
TEST_F(Failure, InterruptOfALongTable) {
  How how = here();
  how.meanwhile = [](pid_t child) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    ::kill(child, SIGINT);
  };
  const Outcome result = run_tool(
      {"refraction", "us76", "--height=2", "--altitudes=0:80:2e-5", "--wavelengths=550", "-o", "new/long.csv"}, how);
  EXPECT_EQ(result.code, 130) << result.err;
  expect_nothing_new();
}

}  // namespace greenray::cli_tests
