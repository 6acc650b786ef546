// Output files appear whole or not at all, whatever the disk does.
#include "support/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "support/error.hpp"

namespace greenray {
namespace fs = std::filesystem;

namespace {

std::string contents(const fs::path &path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::size_t entries(const fs::path &folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

template <class Work>
std::string run_error(Work &&work) {
  try {
    work();
  } catch (const RunError &error) {
    EXPECT_EQ(error.exit_code(), ExitCode::run_failed);
    return error.what();
  }
  return "";
}

/// A write beyond `bytes` fails with EFBIG while this lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    rlimit small = old_limit_;
    small.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_limit_{};
  void (*old_handler_)(int) = SIG_DFL;
};

}  // namespace

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto *info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder = fs::temp_directory_path() / ("greenray-atomic-" + std::string(info->name()) + std::to_string(getpid()));
    fs::create_directories(folder);
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path folder;
};

// oracle: the bytes handed in; the folder holds one file afterwards.  tolerance: none
TEST_F(AtomicFileTest, TargetAppearsOnlyAtCommit) {
  const fs::path target = folder / "new" / "deep" / "x.exr";  // folders are made
  {
    AtomicFile file(target);
    file.write("0123456789");
    file.seek(2);
    file.write("ab");
    EXPECT_EQ(file.position(), 4U);
    EXPECT_FALSE(fs::exists(target));
    EXPECT_EQ(file.temporary().filename().string(), ".x.exr." + std::to_string(getpid()) + ".tmp");
    EXPECT_EQ(file.temporary().parent_path(), target.parent_path());
    file.commit();
    file.commit();
  }
  EXPECT_EQ(contents(target), "01ab456789");
  EXPECT_EQ(entries(target.parent_path()), 1U);
}

// oracle: an abandoned write leaves the old bytes and no temporary.  tolerance: none
TEST_F(AtomicFileTest, AbandonedWriteLeavesOldFile) {
  write_file_atomically(folder / "x.json", "old");
  {
    AtomicFile first(folder / "x.json"), second(folder / "x.json");  // two writers do not collide
    first.write("new");
    second.write("newer");
  }
  EXPECT_EQ(contents(folder / "x.json"), "old");
  EXPECT_EQ(entries(folder), 1U);
}

// oracle: RLIMIT_FSIZE makes the kernel refuse bytes beyond the limit (EFBIG).  tolerance: none
TEST_F(AtomicFileTest, RefusedBytesKeepTheOldPicture) {
  write_file_atomically(folder / "x.exr", "old");
  const FileSizeLimit limit(100'000);
  const std::string small_then_seal = run_error([&] {
    AtomicFile file(folder / "x.exr");
    file.write(std::string(99'000, 'a'));
    file.write(std::string(2'000, 'a'));  // sits in the buffer: found at the latest by seal
    file.seal();
  });
  EXPECT_NE(small_then_seal.find("x.exr: File too large (needs at least"), std::string::npos) << small_then_seal;
  EXPECT_NE(small_then_seal.find("the old picture is kept"), std::string::npos) << small_then_seal;
  EXPECT_EQ(contents(folder / "x.exr"), "old");
  EXPECT_EQ(entries(folder), 1U);
}

// oracle: as above; a caller that swallows the failure still cannot commit.  tolerance: none
TEST_F(AtomicFileTest, SwallowedFailureComesBack) {
  const FileSizeLimit limit(1000);
  AtomicFile file(folder / "x.exr");
  EXPECT_THROW(file.write(std::string(1'000'000, 'a')), RunError);
  EXPECT_THROW(file.write("b"), RunError);
  EXPECT_THROW(file.seek(0), RunError);
  EXPECT_THROW(file.commit(), RunError);
  EXPECT_FALSE(fs::exists(folder / "x.exr"));
}

// oracle: the second of three files does not fit, so the first must not be renamed.  tolerance: none
TEST_F(AtomicFileTest, SetIsAllOrNothing) {
  for (const char *name : {"x.exr", "x.png", "x.json"}) write_file_atomically(folder / name, "old");
  {
    AtomicFileSet set;
    set.add(folder / "x.exr").write("new");
    AtomicFile &png = set.add(folder / "x.png");
    set.add(folder / "x.json").write("new");
    const FileSizeLimit limit(1000);
    png.write(std::string(1500, 'a'));  // buffered, fails when sealed
    EXPECT_THROW(set.commit(), RunError);
  }
  for (const char *name : {"x.exr", "x.png", "x.json"}) EXPECT_EQ(contents(folder / name), "old") << name;
  EXPECT_EQ(entries(folder), 3U);
  AtomicFileSet set;
  for (const char *name : {"x.exr", "x.png", "x.json"}) set.add(folder / name).write("new");
  set.commit();
  for (const char *name : {"x.exr", "x.png", "x.json"}) EXPECT_EQ(contents(folder / name), "new") << name;
  EXPECT_EQ(entries(folder), 3U);
}

// oracle: a folder that takes a target's place makes rename(2) fail; renames before it are undone.  tolerance: none
TEST_F(AtomicFileTest, SetTakesBackRenames) {
  write_file_atomically(folder / "a.exr", "old");
  {
    AtomicFileSet set;
    set.add(folder / "a.exr").write("new");
    set.add(folder / "b.png").write("new");
    set.add(folder / "c.json").write("new");
    fs::create_directories(folder / "c.json" / "in the way");
    EXPECT_THROW(set.commit(), RunError);
  }
  EXPECT_EQ(contents(folder / "a.exr"), "old");
  EXPECT_FALSE(fs::exists(folder / "b.png"));
  EXPECT_EQ(entries(folder), 2U);  // a.exr and the folder
}

// oracle: a 256 kB file system of memory holds no 1 MB (ENOSPC); needs the right to mount, else skipped.  tolerance:
// none
TEST_F(AtomicFileTest, FullDisk) {
  if (mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=256k") != 0) GTEST_SKIP() << "cannot mount a small file system";
  write_file_atomically(folder / "x.exr", "old");
  const std::string message = run_error([&] { write_file_atomically(folder / "x.exr", std::string(1'000'000, 'a')); });
  EXPECT_EQ(message, "cannot write " + (folder / "x.exr").string() +
                         ": No space left on device (needs at least 1.0 MB; the old picture is kept)");
  EXPECT_EQ(contents(folder / "x.exr"), "old");
  EXPECT_EQ(entries(folder), 1U);
  umount(folder.c_str());
}

// oracle: POSIX: a path below a file, a folder and a device are no targets.  tolerance: none
TEST_F(AtomicFileTest, ImpossibleTargets) {
  write_file_atomically(folder / "file", "old");
  const auto message = [](const fs::path &path) { return run_error([&] { write_file_atomically(path, "new"); }); };
  EXPECT_NE(message(folder / "file" / "x.exr").find("no folder"), std::string::npos);
  EXPECT_NE(message(folder).find("it is a folder"), std::string::npos);
  EXPECT_NE(message("/dev/full").find("not a regular file"), std::string::npos);
  EXPECT_NE(message("/proc/x.exr").find("cannot write /proc/x.exr: "), std::string::npos);
  EXPECT_NE(message(folder / std::string(250, 'n')).find("name too long"), std::string::npos);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  if (geteuid() != 0) {  // root may write everywhere
    fs::permissions(folder, fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_NE(message(folder / "x.exr").find("Permission denied"), std::string::npos);
    fs::permissions(folder, fs::perms::owner_all);
  }
}

// oracle: a symbolic link stays a link and the file it names is replaced.  tolerance: none
TEST_F(AtomicFileTest, FollowsLinks) {
  fs::create_directories(folder / "real");
  write_file_atomically(folder / "real" / "x", "old");
  fs::create_symlink(folder / "real" / "x", folder / "x");
  write_file_atomically(folder / "x", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "x"));
  EXPECT_EQ(contents(folder / "real" / "x"), "new");
}

}  // namespace greenray
