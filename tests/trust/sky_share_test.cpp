// Rows of a sky picture: kept, taken up again, made in shares and by several workers.
#include "render/sky_run.hpp"
#include "scene/scene_file.hpp"
#include "trust/rooms.hpp"

namespace greenray {
namespace {

struct Sky {
  Scene scene;
  RenderOptions options;
  RenderPlan plan;
};

/// A low Sun with rows of many samples, from the table or with rays of their own.
Sky low_sun(bool own_rays, const std::function<void(RenderOptions &)> &change = {}) {
  Sky sky{load_scene("flat-sun",
                     {"spectrum.samples=3", std::string("tracing.transfer=") + (own_rays ? "per-pixel" : "table")}),
          {},
          {}};
  sky.options.size = {36, 28};
  sky.options.spp = own_rays ? 2 : 40;
  if (change) change(sky.options);
  sky.plan = plan_render(sky.scene, sky.options);
  return sky;
}

Rendered made(const Sky &sky, const SkyKeeping *keeping = nullptr, Ranks *ranks = nullptr, int stop_at = 0) {
  RenderOptions options = sky.options;
  options.keeping = keeping, options.ranks = ranks;
  if (stop_at > 0)
    options.progress = [count = 0, stop_at](const std::string &phase, double, double) mutable {
      if (phase == "picture" && ++count == stop_at) throw Interrupted();
    };
  options.part_report = [](const RenderReport &) { return std::string("{}"); };
  return render(sky.scene, sky.plan, options, shared_device());
}

void expect_same(const Rendered &a, const Rendered &b) {
  EXPECT_EQ(a.image.radiance, b.image.radiance);
  EXPECT_EQ(a.image.channels, b.image.channels);
  EXPECT_EQ(a.report.noise_rms, b.report.noise_rms);
  EXPECT_EQ(a.report.spp, b.report.spp);
  EXPECT_EQ(a.report.trace.rays, b.report.trace.rays);
  EXPECT_EQ(a.report.trace.outcomes, b.report.trace.outcomes);
}

SkyKeeping in_file(const fs::path &file) {
  SkyKeeping keeping;
  keeping.file = file, keeping.seconds = 0, keeping.not_before = 0;
  keeping.command = {"flat-sun"};
  return keeping;
}

TEST_F(TrustTest, SkyTakenUpAgainIsOneRun) {
  // oracle: one undisturbed run, wherever it was stopped; to a number of samples, and to an error;  tolerance: none
  const auto to_an_error = [](RenderOptions &o) { o.spp = 4000, o.error_pct = 0.05; };
  for (const Sky &sky : {low_sun(false), low_sun(true), low_sun(false, to_an_error)}) {
    const Rendered whole = made(sky);
    SkyKeeping keeping = in_file(folder / "a.grck");
    for (const int call : {2, 1, 2}) {  // each goes on from the one before
      EXPECT_THROW(made(sky, &keeping, nullptr, call), Interrupted);
      ASSERT_TRUE(fs::exists(keeping.file));
    }
    keeping.resume = SkyKeeping::Resume::always;
    expect_same(whole, made(sky, &keeping));
    fs::remove(keeping.file);
  }
}

TEST_F(TrustTest, AShortSkyLeavesNoCheckpoint) {
  // oracle: what is made anew sooner than it is read is not kept;  tolerance: none
  const Sky sky = low_sun(false);
  SkyKeeping keeping = in_file(folder / "a.grck");
  keeping.not_before = 10;
  try {
    made(sky, &keeping, nullptr, 3);
    ADD_FAILURE() << "not interrupted";
  } catch (const Interrupted &error) {
    EXPECT_EQ(std::string(error.what()), "interrupted: nothing was written");
  }
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(TrustTest, ASkyCheckpointOfAnotherPictureIsRefused) {
  // oracle: the key that was changed;  tolerance: none
  const Sky sky = low_sun(false);
  SkyKeeping keeping = in_file(folder / "a.grck");
  EXPECT_THROW(made(sky, &keeping, nullptr, 2), Interrupted);
  Sky other = sky;
  other.scene = load_scene("flat-sun", {"spectrum.samples=3", "tracing.transfer=table", "observer.height_m=7"});
  other.plan = plan_render(other.scene, other.options);
  keeping.resume = SkyKeeping::Resume::always;
  const std::string refused = what_is_wrong([&] { made(other, &keeping); });
  EXPECT_NE(refused.find("observer.height_m was"), std::string::npos) << refused;
  EXPECT_NE(refused.find(", is 7"), std::string::npos) << refused;
  std::string said;
  keeping.resume = SkyKeeping::Resume::when_it_fits;
  keeping.note = [&](const std::string &words) { said += words; };
  expect_same(made(other), made(other, &keeping));
  EXPECT_NE(said.find("starting anew"), std::string::npos);
}

TEST_F(TrustTest, SharesOfTheSkyMergedAreOneRun) {
  // oracle: one undisturbed run; more shares than rows are possible, too;  tolerance: none
  for (const bool own_rays : {false, true}) {
    const Sky sky = low_sun(own_rays);
    const Rendered whole = made(sky);
    for (const int count : {1, 3, 40}) {
      if (own_rays && count == 40) continue;
      std::vector<fs::path> parts;
      for (int i = 0; i < count; ++i) {
        SkyKeeping keeping = in_file(part_path(folder / "a.exr", {i, count}));
        keeping.share = PictureShare{i, count};
        parts.insert(parts.begin(), keeping.file);
        if (i == 1 && !own_rays && count == 3) {  // stopped and taken up again
          EXPECT_THROW(made(sky, &keeping, nullptr, 2), Interrupted);
          const std::string unfinished =
              what_is_wrong([&] { (void)merge_sky(sky.scene, sky.plan, sky.options, parts); });
          EXPECT_NE(unfinished.find("share 2/3 is not finished"), std::string::npos) << unfinished;
        }
        made(sky, &keeping);
      }
      MergedSky merged = merge_sky(sky.scene, sky.plan, sky.options, parts);
      EXPECT_EQ(whole.image.radiance, merged.image.radiance);
      EXPECT_EQ(whole.image.channels, merged.image.channels);
      EXPECT_EQ(whole.report.noise_rms, merged.noise_rms);
      EXPECT_EQ(whole.report.spp, merged.spp);
    }
  }
}

TEST_F(TrustTest, WorkersMakeTheSameSky) {
  // oracle: one worker; and a checkpoint of three that two go on with;  tolerance: none
  for (const bool own_rays : {false, true}) {
    const Sky sky = low_sun(own_rays);
    const Rendered whole = made(sky);
    const auto by = [&](int count, const SkyKeeping *keeping, int stop_at) {
      std::vector<std::shared_ptr<Device>> devices;
      for (int i = 0; i < count; ++i) devices.push_back(open_device({}));
      Rendered out;
      run_threads(count, [&](Ranks &ranks) {
        RenderOptions options = sky.options;
        options.keeping = keeping, options.ranks = &ranks;
        if (stop_at > 0 && ranks.first())
          options.progress = [calls = 0, stop_at](const std::string &phase, double, double) mutable {
            if (phase == "picture" && ++calls == stop_at) throw Interrupted();
          };
        Rendered part = render(sky.scene, sky.plan, options, devices[static_cast<std::size_t>(ranks.rank())]);
        if (ranks.first()) out = std::move(part);
      });
      return out;
    };
    expect_same(whole, by(2, nullptr, 0));
    const SkyKeeping keeping = in_file(folder / "a.grck");
    EXPECT_THROW(by(3, &keeping, 7), Interrupted);
    EXPECT_TRUE(fs::exists(keeping.file));
    expect_same(whole, by(2, &keeping, 0));
    fs::remove(keeping.file);
  }
}

}  // namespace
}  // namespace greenray
