// Shares of a room's picture, made apart and put together.
#include "render/room_plan.hpp"
#include "trust/rooms.hpp"

namespace greenray {
namespace {

TEST_F(TrustTest, SharesMergedAreOneRun) {
  // oracle: one undisturbed run;  tolerance: none, bit for bit
  const RoomScene scene = prism();
  const RoomOptions options = in_passes(5);
  const RoomPicture whole = render_room(scene, options, shared_device());
  for (const int count : {1, 3}) {
    const std::vector<fs::path> parts = make_shares(scene, options, count);
    expect_same(whole, merge_room(scene, options, {parts.rbegin(), parts.rend()}).picture);
  }
  const std::vector<fs::path> more = make_shares(scene, options, 7);  // two of them have nothing to do
  expect_same(whole, merge_room(scene, options, more).picture);
}

TEST_F(TrustTest, SumsInBlocksOfPassesAreOneRun) {
  // oracle: one undisturbed run; more passes than blocks, the last block is not full;  tolerance: none
  const RoomScene scene = shipped_room("cornell", {"photons.emitted=28900", "spectrum.samples=1"});
  RoomOptions options = in_passes(RoomPlan::most_blocks + 33);
  options.size = {6, 5};
  const RoomPlan plan = plan_room(scene, options);
  ASSERT_EQ(plan.block_passes(), 2);
  ASSERT_EQ(plan.blocks(), 145);
  const RoomPicture whole = render_room(scene, options, shared_device());
  expect_same(whole, merge_room(scene, options, make_shares(scene, options, 2)).picture);

  RoomOptions kept = options;
  kept.checkpoint = folder / "b.grck";
  EXPECT_THROW(render_room(scene, stopped_at(kept, 2 * 40 + 2), shared_device()), Interrupted);  // within a block
  const RoomPicture resumed = render_room(scene, kept, shared_device());
  EXPECT_EQ(resumed.report.resumed_at, 40);
  expect_same(whole, resumed);
}

TEST_F(TrustTest, AStoppedShareGoesOn) {
  // oracle: one undisturbed run, wherever the share was stopped;  tolerance: none
  const RoomScene scene = prism();
  RoomOptions options = in_passes(6);
  const RoomPicture whole = render_room(scene, options, shared_device());
  std::vector<fs::path> parts = make_shares(scene, options, 2);
  fs::remove(parts[1]);
  options.checkpoint = parts[1], options.checkpoint_seconds = 0;
  PartHead head;
  head.command = {"scene"};
  const auto go_on = [&](int call) {
    render_room_share(scene, call > 0 ? stopped_at(options, call) : options, shared_device(), {1, 2}, head);
  };
  EXPECT_THROW(go_on(3), Interrupted);  // the first pass is traced before the share's own
  EXPECT_FALSE(fs::exists(parts[1]));   // nothing of it is worth keeping
  EXPECT_THROW(go_on(6), Interrupted);
  ASSERT_TRUE(fs::exists(parts[1]));
  const std::string unfinished = what_is_wrong([&] { (void)merge_room(scene, options, parts); });
  EXPECT_NE(unfinished.find("share 2/2 is not finished"), std::string::npos) << unfinished;
  EXPECT_THROW(go_on(3), Interrupted);
  go_on(0);
  go_on(0);  // is done, stays so
  expect_same(whole, merge_room(scene, options, parts).picture);
}

TEST_F(TrustTest, PartsOfAnotherPictureAreRefused) {
  // oracle: each way that parts may not fit each other, told with the file's name;  tolerance: none
  const RoomScene scene = shipped_room("cornell", {"photons.emitted=60000"});
  const RoomOptions options = in_passes(2);
  const std::vector<fs::path> right = make_shares(scene, options, 2);
  const auto wrong = [&](const std::vector<fs::path> &parts) {
    return what_is_wrong([&] { (void)merge_room(scene, options, parts); });
  };
  EXPECT_EQ(wrong(right), "");
  EXPECT_NE(wrong({right[0]}).find("missing 2/2"), std::string::npos);
  EXPECT_NE(wrong({right[0], right[1], right[0]}).find("share 1/2 is given twice"), std::string::npos);
  const auto with = [&](const RoomScene &other, const RoomOptions &o, int count, int index) {
    const fs::path kept = folder / "other.grck";
    fs::copy_file(right[1], folder / "right.grck", fs::copy_options::overwrite_existing);
    fs::rename(make_shares(other, o, count)[static_cast<std::size_t>(index)], kept);
    for (const fs::path &path : right) fs::remove(path);
    make_shares(scene, options, 2);
    return wrong({right[0], kept});
  };
  RoomOptions seed = options;
  seed.seed = 4;
  EXPECT_NE(with(scene, seed, 2, 1).find("other.grck:1:1: expected a part of the same picture"), std::string::npos);
  EXPECT_NE(with(scene, seed, 2, 1).find("--seed was 1, is 4"), std::string::npos);
  EXPECT_NE(with(scene, options, 3, 1).find("expected a share of 2, found 2/3"), std::string::npos);
  const RoomScene wider = shipped_room("cornell", {"photons.emitted=60000", "camera.fov_deg=41"});
  EXPECT_NE(with(wider, options, 2, 1).find("camera.fov_deg was 39, is 41"), std::string::npos);
  const std::string since = what_is_wrong([&] { (void)merge_room(wider, options, right); });
  EXPECT_NE(since.find("expected a part of the scene as it is now: camera.fov_deg was 39, is 41"), std::string::npos);
}

TEST_F(TrustTest, DamagedPartsAreInputErrors) {
  // oracle: any byte changed, left out or added makes another checksum;  tolerance: none
  const RoomScene scene = shipped_room("cornell", {"photons.emitted=60000", "spectrum.samples=1"});
  RoomOptions options = in_passes(2);
  options.size = {8, 6};
  const std::vector<fs::path> parts = make_shares(scene, options, 2);
  std::ifstream in(parts[1], std::ios::binary);
  const std::string right{std::istreambuf_iterator<char>(in), {}};
  for (std::size_t i = 0; i < 90; ++i) {
    std::string wrong = right;
    const std::size_t at = i < 45 ? i : right.size() * (i - 45) / 45;
    if (i % 3 == 0) wrong[at] = static_cast<char>(wrong[at] ^ (1 << i % 8));
    else if (i % 3 == 1) wrong.resize(at);
    else wrong.insert(at, "x");
    std::ofstream(parts[1], std::ios::binary) << wrong;
    EXPECT_THROW((void)merge_room(scene, options, parts), InputError) << i;
  }
}

}  // namespace
}  // namespace greenray
