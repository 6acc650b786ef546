// The tool's own words for shares, merges, full disks and mpirun: exit codes, messages, what is left behind.
#include <sys/mount.h>

#include "cli/tool.hpp"

namespace greenray::cli_tests {
namespace {

bool has(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

/// A room of four short passes, and a sky, by name.
const Words room{"cornell", "-D", "photons.emitted=60000", "--size", "24x18", "--report", "off", "--quiet"};
Words with(Words words, const Words &more) {
  words.insert(words.begin(), "render");
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

class TrustCommand : public ToolTest {};

// oracle: the contract: one picture of all shares, the same files as one run's;  tolerance: none but for the time
TEST_F(TrustCommand, MergeMakesTheFilesOfOneRun) {
  ASSERT_EQ(run(with(room, {"-o", "one.exr"})).code, 0);
  for (const char *share : {"1/2", "2/2"})
    ASSERT_EQ(run(with(room, {"-o", "s.exr", "--shard", share})).code, 0) << share;
  const Outcome merged = run({"merge", "s.2-of-2.grck", "s.1-of-2.grck", "-o", "m.exr"});
  ASSERT_EQ(merged.code, 0) << merged.err;
  EXPECT_EQ(contents(folder / "one.exr"), contents(folder / "m.exr"));
  EXPECT_EQ(contents(folder / "one.png"), contents(folder / "m.png"));
  EXPECT_TRUE(fs::exists(folder / "m.json"));
}

// oracle: the contract: exit 2, what was expected and where, nothing written;  tolerance: none
TEST_F(TrustCommand, WrongSharesAndParts) {
  write(folder / "text.grck", "no part");
  ASSERT_EQ(run(with(room, {"-o", "s.exr", "--shard", "1/2"})).code, 0);
  const auto before = listing(folder);
  const auto refused = [&](const Words &words, const std::string &expected) {
    const Outcome result = run(words);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_TRUE(has(result.err, expected)) << result.err;
    EXPECT_EQ(listing(folder), before);
  };
  for (const char *wrong : {"0/2", "3/2", "1", "1/", "/2", "a/b", "1/2/3", "1/70000", "1.5/2"})
    refused(with(room, {"-o", "s.exr", "--shard", wrong}), "expected I/N");
  refused(with(room, {"-o", "s.exr", "--shard", "1/2", "--error", "5"}), "--photons");
  refused({"render", "flat-sun", "-o", "s.exr", "--shard", "1/2", "--error", "5"}, "--spp");
  refused({"merge", "s.1-of-2.grck", "-o", "m.exr"}, "missing 2/2");
  refused({"merge", "text.grck", "-o", "m.exr"}, "text.grck:1:1: expected a part");
  refused({"merge", "nowhere.grck", "-o", "m.exr"}, "nowhere.grck:1:1: expected a part");
  refused({"merge", "s.1-of-2.grck", "s.1-of-2.grck", "-o", "m.exr"}, "is given twice");
  refused({"merge", "s.1-of-2.grck", "-o", "m.png"}, ".exr");
}

// oracle: pictures 2, 4 .. of the list, and only these;  tolerance: none
TEST_F(TrustCommand, BatchMakesItsShareOfThePictures) {
  write(folder / "s.toml", small_scene);
  write(folder / "jobs.csv", "scene,name,sun.apparent_altitude_deg\ns.toml,a,0.2\ns.toml,b,0.3\ns.toml,c,0.4\n");
  ASSERT_EQ(run({"batch", "jobs.csv", "-o", "p", "--shard", "2/2", "--quiet"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "p/b.exr"));
  EXPECT_FALSE(fs::exists(folder / "p/a.exr") || fs::exists(folder / "p/c.exr"));
  ASSERT_EQ(run({"batch", "jobs.csv", "-o", "p", "--shard", "1/2", "--quiet"}).code, 0);
  EXPECT_TRUE(fs::exists(folder / "p/a.exr") && fs::exists(folder / "p/c.exr") &&
              fs::exists(folder / "p/jobs-sheet.png"));
}

// oracle: a render goes on without its checkpoint; where the picture itself has no room: exit 1, or 5 with a checkpoint
// that then goes on to the same picture;  tolerance: none
TEST_F(TrustCommand, ADiskThatFillsUp) {
  ASSERT_EQ(run(with(room, {"-o", "one.exr"})).code, 0);
  const fs::path disk = folder / "disk";
  fs::create_directories(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=160k") != 0) GTEST_SKIP() << "mounting needs rights";
  // 616 pixels of 13 sums of 8 bytes and 3 of 4 bytes: 71 kB of checkpoint, twice while a new one is written.
  const auto fill = [&](std::size_t bytes) { write(disk / "other", std::string(bytes, 'x')); };
  fill(120'000);
  const Outcome no_checkpoint = run(with(room, {"-o", "disk/x.exr", "--checkpoint", "0"}));
  EXPECT_TRUE(has(no_checkpoint.err, "note: no checkpoint: cannot write disk/x.grck: No space left on device"))
      << no_checkpoint.err;
  EXPECT_TRUE(no_checkpoint.code == 0 || no_checkpoint.code == 1) << no_checkpoint.err;
  for (const char *name : {"x.exr", "x.png", "x.json"}) fs::remove(disk / name);
  fs::remove(disk / "other");
  EXPECT_TRUE(fs::is_empty(disk));

  How how = here();  // fills up when the first checkpoint is there
  how.meanwhile = [&](pid_t) {
    for (int i = 0; i < 3000 && !fs::exists(disk / "x.grck"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::error_code none;
    std::ofstream(disk / "other", std::ios::binary) << std::string(1'000'000, 'x');
  };
  const Outcome full = run_tool(with(room, {"-o", "disk/x.exr", "--checkpoint", "0"}), how);
  EXPECT_EQ(full.code, 5) << full.err;
  EXPECT_TRUE(has(full.err, "the checkpoint is kept in disk/x.grck")) << full.err;
  EXPECT_FALSE(fs::exists(disk / "x.exr"));
  fs::remove(disk / "other");
  const Outcome again = run(with(room, {"-o", "disk/x.exr", "--resume"}));
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(contents(disk / "x.exr"), contents(folder / "one.exr"));
  EXPECT_FALSE(fs::exists(disk / "x.grck"));
  ::umount(disk.c_str());
}

// oracle: sums over lanes have another order: --resume says so, without it the picture is made anew;  tolerance: none
TEST_F(TrustCommand, OtherLanesAreAnotherPicture) {
  How how = here();
  how.meanwhile = [&](pid_t child) {
    for (int i = 0; i < 3000 && !fs::exists(folder / "x.grck"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    ::kill(child, SIGKILL);
  };
  const Words long_room = with(room, {"-o", "x.exr", "-D", "photons.emitted=600000", "--checkpoint", "0"});
  EXPECT_EQ(run_tool(long_room, how).code, 1000 + SIGKILL);
  ASSERT_TRUE(fs::exists(folder / "x.grck"));
  Words other = long_room;
  other.insert(other.end(), {"--lanes", "1", "--resume"});
  const Outcome refused = run(other);
  EXPECT_EQ(refused.code, 2) << refused.err;
  EXPECT_TRUE(has(refused.err, "--lanes was 8, is 1")) << refused.err;
}

// oracle: the contract; a tool that mpirun started alone among many says what it misses;  tolerance: none
TEST_F(TrustCommand, UnderMpirunOnlyRenderWorksWithOthers) {
  How how = here();
  how.environment = {{"OMPI_COMM_WORLD_SIZE", "2"}};
  const Outcome batch = run_tool({"batch", "sunset"}, how);
  EXPECT_EQ(batch.code, 2) << batch.err;
  EXPECT_TRUE(has(batch.err, "--shard I/N")) << batch.err;
  EXPECT_TRUE(listing(folder).empty());
  EXPECT_EQ(run_tool({"scenes"}, how).code, 0);
}

}  // namespace
}  // namespace greenray::cli_tests
