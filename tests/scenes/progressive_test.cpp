// Rooms pass by pass: the error they claim, parts of pictures, and runs that are taken up again.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <regex>

#include "render/room_plan.hpp"
#include "support/error.hpp"
#include "support_code/path_tracer.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

namespace fs = std::filesystem;

RoomScene shipped(const std::string &name, const std::vector<std::string> &overrides) {
  const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/" + name + ".toml";
  std::ifstream in(file);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return parse_room(file, text, overrides);
}

RoomOptions small(int width, int height) {
  RoomOptions o;
  o.size = {width, height};
  o.spp = 8;
  return o;
}

/// Grey furnace: every wall emits 1 W/m^2 and reflects half.
RoomScene furnace(int photons) {
  return parse_room("furnace.toml",
                    "greenray = 1\n[camera]\nfrom = [0.3, 0.4, 0.6]\nto = [1.0, 0.9, 0.2]\nfov_deg = 80\n"
                    "[[box]]\nname = \"walls\"\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\ninward = true\nreflectance = 0.5\n"
                    "[[light]]\nkind = \"area\"\nsurface = \"walls\"\npower_W = 6.0\n[spectrum]\nsamples = 1\n"
                    "[photons]\ngather = 60\nemitted = " +
                        std::to_string(photons) + "\n");
}

/// RMS over the pixels of the difference of the pictures' sums over the wavelengths, over the second's mean.
double relative_rms(const SpectralImage &image, const std::vector<double> &truth) {
  const std::size_t waves = image.wavelength_nm.size();
  double squares = 0, whole = 0;
  for (std::size_t p = 0; p < truth.size(); ++p) {
    double sum = 0;
    for (std::size_t w = 0; w < waves; ++w) sum += static_cast<double>(image.radiance[p * waves + w]);
    squares += (sum - truth[p]) * (sum - truth[p]), whole += truth[p];
  }
  const double n = static_cast<double>(truth.size());
  return std::sqrt(squares / n) / (whole / n);
}

std::vector<double> sums_of(const SpectralImage &image) {
  const std::size_t waves = image.wavelength_nm.size();
  std::vector<double> sums(image.pixels());
  for (std::size_t i = 0; i < image.radiance.size(); ++i) sums[i / waves] += static_cast<double>(image.radiance[i]);
  return sums;
}

void expect_within(double claimed, double truth, const std::string &what, double factor = 1.5) {
  EXPECT_LT(claimed / truth, factor) << what << ": claimed " << claimed << ", true " << truth;
  EXPECT_GT(claimed / truth, 1 / factor) << what << ": claimed " << claimed << ", true " << truth;
  std::cout << what << ": claimed " << claimed << ", true " << truth << "\n";
}

TEST(RoomError, FurnaceClaimsItsTrueError) {
  // oracle: the radiance is 1/(1 - 1/2)/pi everywhere
  // tolerance: a factor 1.5, the claim of the method. Few photons: noise; many in one kernel: the bias of the corners
  for (const auto &[photons, gather] : {std::pair{50000, 60}, {1000000, 60}, {200000, 6000}, {20000, 100}}) {
    RoomScene scene = furnace(photons);
    scene.photons.gather = gather;
    const RoomPicture picture = render_room(scene, small(48, 48), shared_device());
    const std::vector<double> truth(picture.image.pixels(), 2 / M_PI);
    expect_within(picture.report.error_rms, relative_rms(picture.image, truth),
                  std::to_string(photons) + " photons, " + std::to_string(gather) + " an estimate");
  }
}

TEST(RoomError, FallsWithPhotons) {
  // oracle: the radiance of the furnace; the mean square error of a density estimate in the plane is best where noise
  // and
  //         bias fall alike, and is then photons^(-2/3)
  // tolerance: of the slope 0.08: the noise of RMS over 2304 pixels whose estimates overlap, some 5 % at either end of
  // a
  //            factor 27
  const RoomScene scene = furnace(50000);
  std::vector<double> errors;
  for (const int photons : {50000, 1350000}) {
    RoomOptions options = small(48, 48);
    options.photons = photons;
    const RoomPicture picture = render_room(scene, options, shared_device());
    errors.push_back(relative_rms(picture.image, std::vector<double>(picture.image.pixels(), 2 / M_PI)));
  }
  EXPECT_NEAR(std::log(errors[1] / errors[0]) / std::log(27.0), -1.0 / 3, 0.08) << errors[0] << " " << errors[1];
}

TEST(RoomError, ShippedRoomsClaimTheirTrueError) {
  // oracle: the same room with other random numbers, 20 times the photons and 8 times the samples
  // tolerance: a factor 1.5; the reference's own error is a third or less. prism-caustic a factor 2: the RMS of its few
  // bright pixels is above the picture's mean, and its estimate is as noisy as that
  for (const char *name : {"cornell", "cross-room", "prism-caustic"}) {
    RoomOptions options = small(64, 48);
    options.straight = true;
    const RoomScene scene = shipped(name, {"photons.emitted=200000"});
    const RoomPicture picture = render_room(scene, options, shared_device());
    options.seed = 77, options.photons = 4000000, options.spp = 64;
    const RoomPicture better = render_room(scene, options, shared_device());
    expect_within(picture.report.error_rms, relative_rms(picture.image, sums_of(better.image)), name,
                  std::string(name) == "prism-caustic" ? 2 : 1.5);
  }
}

/// Radiance of each pixel by the path tracer, twice with places in cells of a grid of side^2, so that the edges of
/// lamps are good, and the mean square of what its average is off, from the difference of the two.
std::pair<std::vector<double>, double> traced(const RoomScene &scene, const std::vector<double> &albedo, int side) {
  const PathTracer tracer(scene, albedo);
  const CameraScene &c = scene.camera;
  const Triple ahead = unit(c.to - c.from), right = unit(cross(ahead, c.up)), up = cross(right, ahead);
  const auto [width, height] = c.resolution;
  const double pixel = 2 * std::tan(c.fov_deg * M_PI / 360) / width;
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  const auto mean_of = [&](int x, int y) {
    double sum = 0;
    for (int k = 0; k < side * side; ++k) {
      const double across = (k % side + uniform(engine)) / side, down = (k / side + uniform(engine)) / side;
      const double u = (x + across - 0.5 * width) * pixel, v = (0.5 * height - y - down) * pixel;
      sum += tracer.radiance(c.from, unit(ahead + u * right + v * up), engine);
    }
    return sum / (side * side);
  };
  std::vector<double> truth;
  double noise2 = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double first = mean_of(x, y), second = mean_of(x, y);
      truth.push_back(0.5 * (first + second));
      noise2 += 0.25 * (first - second) * (first - second) / (width * height);
    }
  return {truth, noise2};
}

TEST(RoomError, CornellAgainstThePathTracer) {
  // oracle: brute-force path tracing in double (support_code/path_tracer.hpp), pixel by pixel, its own noise taken off
  // tolerance: a factor 1.5
  const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/cornell.toml";
  std::ifstream in(file);
  const std::string coloured{std::istreambuf_iterator<char>(in), {}};
  const std::string grey = std::regex_replace(coloured, std::regex("reflectance = \\[[^\\]]*\\]"), "reflectance = 0.5");
  const RoomScene scene =
      parse_room(file, grey, {"photons.emitted=60000", "spectrum.samples=1", "camera.resolution=[24, 20]"});
  const RoomPicture picture = render_room(scene, small(24, 20), shared_device());
  std::vector<double> albedo;
  for (const MaterialScene &m : scene.materials) albedo.push_back(m.reflectance.rgb[0]);
  const auto [truth, noise2] = traced(scene, albedo, 28);
  double whole = 0;
  for (const double x : truth) whole += x / static_cast<double>(truth.size());
  const double apart = relative_rms(picture.image, truth);
  expect_within(picture.report.error_rms, std::sqrt(apart * apart - noise2 / (whole * whole)), "cornell, path tracer");
}

/// A folder of its own, removed at the end.
class RoomRuns : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "greenray-room-XXXXXX").string();
    ASSERT_TRUE(::mkdtemp(name.data()));
    folder = name;
  }
  void TearDown() override { fs::remove_all(folder); }
  fs::path folder;
};

void expect_same_bits(const SpectralImage &a, const SpectralImage &b) {
  EXPECT_EQ(a.radiance, b.radiance);
  EXPECT_EQ(a.channels, b.channels);
}

RoomOptions interrupted_at(RoomOptions options, int call) {
  options.progress = [count = 0, call](const std::string &, double, double) mutable {
    if (++count == call) throw Interrupted();
  };
  return options;
}

TEST_F(RoomRuns, TakenUpAgainTheBitsAreTheSame) {
  // oracle: the promise of the user's page: a resumed run equals one run, wherever it was stopped
  // tolerance: none
  for (const char *name : {"cornell", "prism-caustic"}) {
    const RoomScene scene = shipped(name, {"photons.emitted=60000"});
    RoomOptions options = small(40, 30);
    const RoomPicture whole = render_room(scene, options, shared_device());
    options.checkpoint = folder / (std::string(name) + ".grck");
    for (const int call : {3, 4, 2}) {  // of two a pass: while tracing or looking; each goes on from the one before
      EXPECT_THROW(render_room(scene, interrupted_at(options, call), shared_device()), Interrupted);
      EXPECT_TRUE(fs::exists(options.checkpoint));
    }
    options.resume = RoomOptions::Resume::always;
    const RoomPicture resumed = render_room(scene, options, shared_device());
    EXPECT_GT(resumed.report.resumed_at, 0);
    expect_same_bits(whole.image, resumed.image);
    EXPECT_EQ(whole.report.photons.stored, resumed.report.photons.stored);
    EXPECT_EQ(whole.report.photons.emitted, resumed.report.photons.emitted);
    EXPECT_EQ(whole.report.error_rms, resumed.report.error_rms);
  }
}

TEST_F(RoomRuns, InterruptedInTheFirstPassNothingIsKept) {
  const RoomScene scene = shipped("cornell", {"photons.emitted=60000"});
  RoomOptions options = small(16, 12);
  options.checkpoint = folder / "a.grck";
  EXPECT_THROW(render_room(scene, interrupted_at(options, 2), shared_device()), Interrupted);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(RoomRuns, ACheckpointOfAnotherPictureIsRefusedWithTheChangedKeys) {
  RoomOptions options = small(16, 12);
  options.checkpoint = folder / "a.grck";
  const RoomScene scene = shipped("cornell", {"photons.emitted=60000"});
  EXPECT_THROW(render_room(scene, interrupted_at(options, 5), shared_device()), Interrupted);
  const auto refused = [&](const RoomScene &other, RoomOptions with) -> std::string {
    with.resume = RoomOptions::Resume::always;
    try {
      render_room(other, with, shared_device());
    } catch (const InputError &error) {
      return error.what();
    }
    return "";
  };
  const RoomScene wider = shipped("cornell", {"photons.emitted=60000", "camera.fov_deg=41"});
  EXPECT_NE(refused(wider, options).find("camera.fov_deg was 39, is 41"), std::string::npos) << refused(wider, options);
  RoomOptions other_seed = options;
  other_seed.seed = 9;
  EXPECT_NE(refused(scene, other_seed).find("--seed was 1, is 9"), std::string::npos);
  EXPECT_EQ(refused(shipped("cornell", {"photons.emitted=60000", "title=other"}), options), "");  // changes no pixel

  // Not asked to resume: starts anew and says why.
  std::string said;
  options.note = [&](const std::string &words) { said += words; };
  const RoomPicture anew = render_room(wider, options, shared_device());
  EXPECT_EQ(anew.report.resumed_at, 0);
  EXPECT_NE(said.find("camera.fov_deg was 39, is 41"), std::string::npos) << said;
}

TEST_F(RoomRuns, DamagedCheckpointsAreInputErrors) {
  // oracle: any byte changed, left out or added makes another checksum
  RoomOptions options = small(12, 8);
  options.checkpoint = folder / "a.grck";
  const RoomScene scene = shipped("cornell", {"photons.emitted=60000"});
  EXPECT_THROW(render_room(scene, interrupted_at(options, 5), shared_device()), Interrupted);
  std::ifstream in(options.checkpoint, std::ios::binary);
  const std::string right{std::istreambuf_iterator<char>(in), {}};
  options.resume = RoomOptions::Resume::always;
  for (std::size_t i = 0; i < 60; ++i) {
    std::string wrong = right;
    const std::size_t at = right.size() * i / 60;
    if (i % 3 == 0) wrong[at] = static_cast<char>(wrong[at] ^ (1 << i % 8));
    else if (i % 3 == 1) wrong.resize(at);
    else wrong.insert(at, "x");
    std::ofstream(options.checkpoint, std::ios::binary) << wrong;
    EXPECT_THROW(render_room(scene, options, shared_device()), InputError) << i;
  }
}

TEST(RoomPasses, ACropIsAPartOfThePicture) {
  // oracle: the picture itself;  tolerance: none
  for (const char *name : {"cornell", "prism-caustic"}) {
    const RoomScene scene = shipped(name, {"photons.emitted=60000"});
    RoomOptions options = small(48, 36);
    const SpectralImage whole = render_room(scene, options, shared_device()).image;
    options.crop = {{20, 1, 48, 17}};  // the lamp's edge and the picture's
    const SpectralImage part = render_room(scene, options, shared_device()).image;
    ASSERT_EQ(part.width, 28);
    ASSERT_EQ(part.height, 16);
    const std::size_t waves = whole.wavelength_nm.size();
    std::size_t different = 0;
    for (std::size_t y = 0; y < 16; ++y)
      for (std::size_t x = 0; x < 28; ++x) {
        const std::size_t a = y * 28 + x, b = (y + 1) * 48 + x + 20;
        for (std::size_t w = 0; w < waves; ++w)
          different += part.radiance[a * waves + w] != whole.radiance[b * waves + w];
        for (const auto &[channel, values] : whole.channels) different += part.channels.at(channel)[a] != values[b];
      }
    EXPECT_EQ(different, 0u) << name;
  }
}

TEST(RoomPasses, MemoryIsBoundedWhateverTheNumberOfPhotons) {
  // oracle: sums; the cap of the plan;  tolerance: none
  const RoomScene scene = shipped("cornell", {});
  for (const std::int64_t photons :
       {std::int64_t{1}, std::int64_t{39999}, std::int64_t{3000001}, std::int64_t{1000000007}}) {
    RoomOptions options = small(16, 12);
    options.photons = photons;
    const RoomPlan plan = plan_room(scene, options);
    std::int64_t sum = 0;
    for (int pass = 0; pass < plan.passes; ++pass) {
      EXPECT_LE(plan.photons_of(pass), most_photons_a_pass);
      sum += plan.photons_of(pass);
    }
    EXPECT_EQ(sum, photons);
  }
}

TEST(RoomPasses, PassesFitTheBudgetOfTheDevice) {
  // oracle: a device that has only 10 MB ends in MemoryError unless the passes are made smaller
  // tolerance: of the mean: 5 %: 200000 photons are good to 1 %
  DeviceOptions little;
  little.memory_bytes = 10u << 20;
  const RoomScene scene = shipped("cornell", {"photons.emitted=200000", "spectrum.samples=4"});
  const RoomPicture whole = render_room(scene, small(24, 20), shared_device());
  const std::shared_ptr<Device> device = open_device(little);
  const RoomPicture cut = render_room(scene, small(24, 20), device);
  EXPECT_GT(cut.report.passes, whole.report.passes);
  EXPECT_EQ(cut.report.photons.photons, 200000u);
  double a = 0, b = 0;
  for (const double x : sums_of(whole.image)) a += x;
  for (const double x : sums_of(cut.image)) b += x;
  EXPECT_NEAR(b / a, 1, 0.05);
}

TEST(RoomPasses, StopsAtTheErrorAndAtTheTime) {
  // oracle: the stopping rule, from the report
  const RoomScene scene = furnace(40000);
  RoomOptions options = small(24, 24);
  options.spp.reset();
  options.error_pct = 4;
  const RoomReport to_error = render_room(scene, options, shared_device()).report;
  EXPECT_LE(to_error.error_rms, 0.04);
  EXPECT_GE(to_error.passes, 4);
  options.error_pct = 1e-3;
  options.minutes = 0.02;
  const auto begin = std::chrono::steady_clock::now();
  const RoomReport to_time = render_room(scene, options, shared_device()).report;
  EXPECT_NEAR(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 1.2, 1.0);
  EXPECT_GT(to_time.error_rms, 1e-5);
  options.minutes.reset();
  options.photons = 100000;  // a limit, of passes of a fourth of it
  const RoomReport to_photons = render_room(scene, options, shared_device()).report;
  EXPECT_EQ(to_photons.passes, 4);
  EXPECT_EQ(to_photons.photons.photons, 100000u);
}

}  // namespace
}  // namespace greenray
