// Pictures of scenes with surfaces against closed forms, conservation and an independent path tracer.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "render/room.hpp"
#include "support_code/path_tracer.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

RoomOptions options_for(int width, int height, int spp) {
  RoomOptions o;
  o.size = {width, height};
  o.spp = spp;
  return o;
}

std::string furnace(double albedo, const std::string &air) {
  return "greenray = 1\n" + air +
         "[camera]\nfrom = [0.3, 0.4, 0.6]\nto = [1.0, 0.9, 0.2]\nfov_deg = 80\n"
         "[[box]]\nname = \"walls\"\nlow = [0, 0, 0]\nhigh = [1, 1, 1]\ninward = true\nreflectance = " +
         std::to_string(albedo) +
         "\n[[light]]\nkind = \"area\"\nsurface = \"walls\"\npower_W = 6.0\n"
         "[spectrum]\nsamples = 1\n[photons]\nemitted = 200000\ngather = 400\n";
}

double mean_of(const SpectralImage &image) {
  double sum = 0;
  for (const float x : image.radiance) sum += static_cast<double>(x);
  return sum / static_cast<double>(image.radiance.size());
}

TEST(RoomPicture, FurnaceBox) {
  // oracle: all walls emit M = 1 W/m^2 and reflect a: radiosity M/(1-a), the radiance everywhere that over pi
  // tolerance: 1 % of the mean: 200000 photons are good to 0.3 %, and the kernels are flat but in the corners
  for (const double albedo : {0.0, 0.5, 0.8}) {
    const RoomScene scene = parse_room("furnace.toml", furnace(albedo, ""));
    const RoomPicture picture = render_room(scene, options_for(40, 40, 4), shared_device());
    EXPECT_NEAR(mean_of(picture.image) / (1 / (1 - albedo) / M_PI), 1, albedo == 0 ? 1e-5 : 0.01) << albedo;
  }
}

TEST(RoomPicture, FurnaceInAMedium) {
  // oracle: in equilibrium L/n^2 is the same everywhere along any path: the walls' own L at each height is seen with
  //         (n_eye/n_wall)^2. With a = 0 the radiance of a wall is M/pi, so that a pixel shows (n_eye/n_wall)^2 / pi,
  //         between the extremes of n on the walls
  // tolerance: 1e-4, float
  const std::string air =
      "[atmosphere]\nfield = { kind = \"layers\", height_m = [0.0, 1.0], refractivity = [0.3, 0.0] }\n";
  const RoomScene scene = parse_room("furnace.toml", furnace(0, air));
  const RoomPicture picture = render_room(scene, options_for(40, 40, 4), shared_device());
  const double n_eye = 1 + 0.3 * (1 - 0.6);
  const auto [low, high] = std::minmax_element(picture.image.radiance.begin(), picture.image.radiance.end());
  EXPECT_GE(static_cast<double>(*low) * M_PI, n_eye * n_eye / (1.3 * 1.3) - 1e-4);
  EXPECT_LE(static_cast<double>(*high) * M_PI, n_eye * n_eye + 1e-4);
  EXPECT_GT(static_cast<double>(*high) / static_cast<double>(*low), 1.2);  // and it does vary
}

TEST(RoomPicture, EyeInsideGlass) {
  // oracle: in the furnace L/n^2 is the same everywhere, whatever is reflected or bent: inside glass L = n^2 M/pi/(1-a)
  // tolerance: 1 %, as in FurnaceBox
  const std::string ball =
      "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\n[[sphere]]\ncentre = [0.35, "
      "0.4, 0.55]\nradius_m = 0.2\nmaterial = \"glass\"\n";
  const RoomScene scene = parse_room("furnace.toml", furnace(0.5, "") + ball);
  const RoomPicture picture = render_room(scene, options_for(40, 40, 4), shared_device());
  EXPECT_NEAR(mean_of(picture.image) / (1.5 * 1.5 * 2 / M_PI), 1, 0.01);
}

TEST(RoomPicture, LampInsideGlass) {
  // oracle: from a lamp h below a flat side of glass, a cone of half angle t reaches t (h + n H) from the axis on a
  //         screen H above it: irradiance I T/(h + n H)^2, T = 4n/(n+1)^2; radiance that over pi times the albedo
  // tolerance: 4 %: noise of the mean of 16 pixels with 150 photons, and what the 3 degrees of the picture bend it by;
  //            a lamp whose light left the glass unbent would be 1.6 times as bright
  const RoomScene scene =
      parse_room("lamp.toml",
                 "greenray = 1\n[camera]\nfrom = [0, 0, 0.6]\nto = [0, 0, 1]\nup = [0, 1, 0]\nfov_deg = "
                 "6\n[spectrum]\nsamples = 1\n"
                 "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\n"
                 "[[box]]\nlow = [-20, -20, -20]\nhigh = [20, 20, 0.5]\nmaterial = \"glass\"\n"
                 "[[quad]]\ncorner = [-1, -1, 1]\nedge_u = [0, 2, 0]\nedge_v = [2, 0, 0]\nreflectance = 0.5\n"
                 "[[light]]\nkind = \"spot\"\nfrom = [0, 0, 0]\nto = [0, 0, 1]\ncone_deg = 20\npower_W = 1\n"
                 "[photons]\nemitted = 400000\ngather = 150\n");
  const RoomPicture picture = render_room(scene, options_for(4, 4, 16), shared_device());
  const double intensity = 1 / (2 * M_PI * (1 - std::cos(10 * M_PI / 180))), through = 4 * 1.5 / (2.5 * 2.5);
  const double expected = 0.5 / M_PI * intensity * through / std::pow(0.5 + 1.5 * 0.5, 2);
  EXPECT_NEAR(mean_of(picture.image) / expected, 1, 0.04);
}

TEST(RoomPicture, GlassInGlass) {
  // oracle: light that goes straight through flat layers of glass in glass, each side letting 4 n n'/(n + n')^2
  // through,
  //         lands as if nothing were there but for that (multiple reflections: below 0.4 %) and the nearer image
  // tolerance: 3 %, noise; with air behind the inner glass the sides would let through 0.88 of it
  const std::string head =
      "greenray = 1\n[camera]\nfrom = [0, 0, 0.6]\nto = [0, 0, 1]\nup = [0, 1, 0]\nfov_deg = 6\n[spectrum]\nsamples = "
      "1\n"
      "[[material]]\nname = \"outer\"\nkind = \"dielectric\"\nindex = 1.5\n"
      "[[material]]\nname = \"inner\"\nkind = \"dielectric\"\nindex = 2.5\n"
      "[[box]]\nlow = [-9, -9, -0.5]\nhigh = [9, 9, 0.5]\nmaterial = \"outer\"\n"
      "[[box]]\nlow = [-8, -8, -0.25]\nhigh = [8, 8, 0.25]\nmaterial = \"inner\"\n"
      "[[quad]]\ncorner = [-1, -1, 1]\nedge_u = [0, 2, 0]\nedge_v = [2, 0, 0]\nreflectance = 0.5\n"
      "[photons]\nemitted = 400000\ngather = 150\n"
      "[[light]]\nkind = \"spot\"\nfrom = [0, 0, -1]\nto = [0, 0, 1]\ncone_deg = 10\npower_W = 1\n";
  const RoomPicture picture = render_room(parse_room("nested.toml", head), options_for(4, 4, 16), shared_device());
  const auto through = [](double n, double beyond) { return 4 * n * beyond / std::pow(n + beyond, 2); };
  const double intensity = 1 / (2 * M_PI * (1 - std::cos(5 * M_PI / 180)));
  const double away = 1 + 2 * 0.25 / 1.5 + 0.5 / 2.5;
  // Light that is reflected twice adds up to r_a r_b between each two sides: 0.04^2 and 0.0625 x (0.0625 + 2 x 0.04).
  const double expected = 0.5 / M_PI * intensity * std::pow(through(1, 1.5) * through(1.5, 2.5), 2) / (away * away);
  EXPECT_NEAR(mean_of(picture.image) / expected, 1.006, 0.03);
}

TEST(RoomPicture, LambertInsideAbsorbingGlass) {
  // oracle: Beer and Lambert's law on the way in and on the way out, everything straight: a picture of a screen in
  // glass
  //         that absorbs, over one of the same screen in glass that does not, is exp(-a (way in + way out))
  // tolerance: 2 %: both pictures have the same photons
  const auto shown = [](double absorption) {
    const std::string text =
        "greenray = 1\n[camera]\nfrom = [0, 0, 0.9]\nto = [0, 0, 0]\nup = [0, 1, 0]\nfov_deg = 6\n[spectrum]\nsamples "
        "= 1\n"
        "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\nabsorption_per_m = " +
        std::to_string(absorption) +
        "\n[[box]]\nlow = [-9, -9, -9]\nhigh = [9, 9, 0.5]\nmaterial = \"glass\"\n"
        "[[quad]]\ncorner = [-1, -1, 0]\nedge_u = [2, 0, 0]\nedge_v = [0, 2, 0]\nreflectance = 0.5\n"
        "[photons]\nemitted = 200000\ngather = 150\n"
        "[[light]]\nkind = \"spot\"\nfrom = [0, 0, 1]\nto = [0, 0, 0]\ncone_deg = 10\npower_W = 1\n";
    return mean_of(render_room(parse_room("dark.toml", text), options_for(4, 4, 16), shared_device()).image);
  };
  EXPECT_NEAR(shown(1) / shown(0) / std::exp(-2 * 0.5), 1, 0.02);
}

TEST(RoomPicture, MirrorLosesPowerOnce) {
  // oracle: a lamp seen by a screen over a mirror of 0.5 is its image behind the mirror with half the intensity
  // tolerance: 3 %: noise of 16 pixels with 150 photons each
  const std::string text =
      "greenray = 1\n[camera]\nfrom = [0, 0, 0.2]\nto = [0, 0, 1]\nup = [0, 1, 0]\nfov_deg = 6\n[spectrum]\nsamples = "
      "1\n"
      "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nreflectance = 0.5\n"
      "[[quad]]\ncorner = [-9, -9, 0]\nedge_u = [18, 0, 0]\nedge_v = [0, 18, 0]\nmaterial = \"mirror\"\n"
      "[[quad]]\ncorner = [-1, -1, 1]\nedge_u = [0, 2, 0]\nedge_v = [2, 0, 0]\nreflectance = 0.5\n"
      "[photons]\nemitted = 200000\ngather = 150\n"
      "[[light]]\nkind = \"spot\"\nfrom = [0, 0, 0.5]\nto = [0, 0, 0]\ncone_deg = 20\npower_W = 1\n";
  const RoomPicture picture = render_room(parse_room("mirror.toml", text), options_for(4, 4, 16), shared_device());
  const double intensity = 1 / (2 * M_PI * (1 - std::cos(10 * M_PI / 180)));
  EXPECT_NEAR(mean_of(picture.image) / (0.5 / M_PI * 0.5 * intensity / (1.5 * 1.5)), 1, 0.03);
}

TEST(RoomPicture, FarFromTheOrigin) {
  // oracle: the furnace, wherever it stands
  // tolerance: 1 %, as in FurnaceBox; floats alone are 8 mm apart there
  std::string text = furnace(0.5, "");
  for (const auto &[from, to] :
       {std::pair<std::string, std::string>{"[0.3, 0.4, 0.6]", "[100000.3, -99999.6, 50000.6]"},
        {"[1.0, 0.9, 0.2]", "[100001.0, -99999.1, 50000.2]"},
        {"[0, 0, 0]", "[100000, -100000, 50000]"},
        {"[1, 1, 1]", "[100001, -99999, 50001]"}})
    text.replace(text.find(from), from.size(), to);
  const RoomPicture picture = render_room(parse_room("far.toml", text), options_for(40, 40, 4), shared_device());
  EXPECT_NEAR(mean_of(picture.image) / (2 / M_PI), 1, 0.01);
  EXPECT_EQ(picture.report.photons.escaped, 0);
}

TEST(RoomPicture, PlacesThatFloatsCannotTellApart) {
  // oracle: such scenes are refused, not rendered wrong
  const std::string rows =
      "greenray = 1\n[camera]\nfrom = [0, 0, 9]\nto = [0, 0, 0]\nup = [0, 1, 0]\n[[light]]\nkind = "
      "\"point\"\nfrom = [0, 0, 5]\npower_W = 1\n[[quad]]\nreflectance = 0.5\n";
  for (const char *corner :
       {"corner = [0, 0, 0]\nedge_u = [1e-200, 0, 0]\nedge_v = [0, 1e-200, 0]\n",
        "corner = [0, 0, 0]\nedge_u = [1e-4, 0, 0]\nedge_v = [0, 1e-4, 0]\n",
        "corner = [0, 0, 0]\nedge_u = [10, 0, 0]\nedge_v = [0, 10, 0]\nscale = 1e6\ntranslate_m = [1e6, 0, 0]\n"})
    EXPECT_THROW(render_room(parse_room("far.toml", rows + corner), options_for(4, 4, 1), shared_device()), InputError)
        << corner;
}

TEST(RoomPicture, EdgesOfLightAreSmooth) {
  // oracle: a square before black nothing, turned by 20 degrees: a pixel is as bright as the share of it that the
  // square
  //         covers, counted at 64 x 64 places
  // tolerance: of an edge pixel RMS 0.06: 4 passes of 9 samples, (4 x 9)^(-3/4) of the 0.5 that one is off, and 4 % of
  //         photons' noise; the four samples alone would be off by 0.18
  const double c = std::cos(20 * M_PI / 180), s = std::sin(20 * M_PI / 180);
  std::ostringstream text;
  text << "greenray = 1\n[camera]\nfrom = [0, 0, 4]\nto = [0, 0, 0]\nup = [0, 1, 0]\nfov_deg = 40\n[[quad]]\n"
       << "corner = [" << -0.8 * c + 0.8 * s << ", " << -0.8 * s - 0.8 * c << ", 0]\nedge_u = [" << 1.6 * c << ", "
       << 1.6 * s << ", 0]\nedge_v = [" << -1.6 * s << ", " << 1.6 * c << ", 0]\nreflectance = 0.5\n"
       << "[[light]]\nkind = \"sun\"\naltitude_deg = 90\nirradiance_W_m2 = 1\ndiameter_deg = 0\n"
       << "[spectrum]\nsamples = 1\n[photons]\nemitted = 1000000\ngather = 600\n";
  const RoomScene scene = parse_room("edge.toml", text.str());
  const RoomPicture picture = render_room(scene, options_for(48, 48, 4), shared_device());
  const double pixel = 2 * std::tan(20 * M_PI / 180) / 48 * 4, lit = 0.5 / M_PI;
  double squares = 0, edges = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      double covered = 0;
      for (int k = 0; k < 4096; ++k) {
        const double u = (x + (k % 64 + 0.5) / 64 - 24) * pixel, v = (24 - y - (k / 64 + 0.5) / 64) * pixel;
        covered += std::abs(u * c + v * s) < 0.8 && std::abs(v * c - u * s) < 0.8 ? 1.0 / 4096 : 0;
      }
      if (covered == 0 || covered == 1) continue;
      squares += std::pow(
          static_cast<double>(picture.image.radiance[static_cast<std::size_t>(48 * y + x)]) / lit - covered, 2);
      edges += 1;
    }
  ASSERT_GT(edges, 100);
  EXPECT_LT(std::sqrt(squares / edges), 0.06);
  EXPECT_GE(picture.report.edge_pixels, static_cast<std::size_t>(edges));
}

TEST(RoomPicture, EnergyAddsUp) {
  // oracle: conservation: emitted = absorbed + escaped + lost on the way + dropped
  // tolerance: 1e-6 of the power emitted
  for (const char *name : {"cross-room", "prism-caustic"}) {
    const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/" + name + ".toml";
    std::ifstream in(file);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const RoomScene scene = parse_room(file, text, {"photons.emitted=100000"});
    const PhotonTotals p = render_room(scene, options_for(8, 6, 4), shared_device()).report.photons;
    EXPECT_NEAR((p.absorbed + p.escaped + p.medium + p.dropped) / p.emitted, 1, 1e-6) << name;
    EXPECT_EQ(p.outcome[0] + p.outcome[1] + p.outcome[2] + p.outcome[3], p.photons) << name;
    EXPECT_GT(p.stored[0], 10000u) << name;
    EXPECT_EQ(p.outcome[3], 0u) << name;
  }
}

constexpr int width = 64, height = 48, block = 8;
using Blocks = std::vector<double>;

/// Means over blocks of a picture of one wavelength.
Blocks blocks_of(const SpectralImage &image) {
  Blocks means;
  for (int y = 0; y < height; y += block)
    for (int x = 0; x < width; x += block) {
      double sum = 0;
      for (int j = 0; j < block; ++j)
        for (int i = 0; i < block; ++i)
          sum += static_cast<double>(image.radiance[static_cast<std::size_t>((y + j) * width + x + i)]);
      means.push_back(sum / (block * block));
    }
  return means;
}

/// The same by the path tracer, and the variance of each mean; NaN for blocks that show a lamp, a thousand times as
/// bright as all else, of which they would tell how pixels are sampled and nothing more.
void trace_blocks(const RoomScene &scene, int paths, Blocks &means, Blocks &variances) {
  std::vector<double> albedo;
  for (const MaterialScene &m : scene.materials) {
    const Colour &c = m.reflectance;
    EXPECT_TRUE(c.rgb[0] == c.rgb[1] && c.rgb[1] == c.rgb[2]) << "this test wants grey surfaces";
    albedo.push_back(c.rgb[0]);
  }
  const PathTracer tracer(scene, albedo);
  const Triple ahead = unit(scene.camera.to - scene.camera.from), right = unit(cross(ahead, scene.camera.up)),
               up = cross(right, ahead);
  const double pixel = 2 * std::tan(scene.camera.fov_deg * M_PI / 360) / width;
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int y = 0; y < height; y += block)
    for (int x = 0; x < width; x += block) {
      double b = 0, b2 = 0;
      for (int k = 0; k < paths && std::isfinite(b); ++k) {
        const double u = (x + block * uniform(engine) - 0.5 * width) * pixel,
                     v = (0.5 * height - y - block * uniform(engine)) * pixel;
        const Triple d = unit(ahead + u * right + v * up);
        if (k < 2000 && tracer.shows_lamp(scene.camera.from, d)) b = std::nan("");
        const double l = tracer.radiance(scene.camera.from, d, engine);
        b += l / paths, b2 += l * l / paths;
      }
      means.push_back(b), variances.push_back((b2 - b * b) / paths);
    }
}

/* Several pictures with other seeds tell our own noise; it and the path tracer's are taken off the difference of the
   means, so that what is left is bias. */
void expect_like_path_tracer(const std::string &name, const std::vector<std::string> &overrides, int paths,
                             double tolerance) {
  const std::string file = std::string(GREENRAY_SOURCE) + "/scenes/" + name + ".toml";
  std::ifstream in(file);
  const std::string coloured{std::istreambuf_iterator<char>(in), {}};
  const std::string text = std::regex_replace(coloured, std::regex("reflectance = \\[[^\\]]*\\]"), "reflectance = 0.5");
  std::vector<std::string> all{"spectrum.samples=1"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  const RoomScene scene = parse_room(file, text, all);
  constexpr int seeds = 4;
  Blocks ours(static_cast<std::size_t>(width / block * (height / block)), 0.0), spread = ours;
  for (int s = 1; s <= seeds; ++s) {
    RoomOptions options = options_for(width, height, 64);
    options.straight = true, options.seed = static_cast<std::uint32_t>(s);
    const Blocks one = blocks_of(render_room(scene, options, shared_device()).image);
    for (std::size_t i = 0; i < one.size(); ++i) ours[i] += one[i] / seeds, spread[i] += one[i] * one[i] / seeds;
  }
  Blocks theirs, variance;
  trace_blocks(scene, paths, theirs, variance);
  double squares = 0, noise = 0, whole = 0, count = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (!std::isfinite(theirs[i])) continue;
    ++count;
    squares += std::pow(ours[i] - theirs[i], 2), whole += theirs[i];
    noise += variance[i] + std::max(spread[i] - ours[i] * ours[i], 0.0) / (seeds - 1);
  }
  const double mean = whole / count;
  EXPECT_GT(count, 40);
  const double relative = std::sqrt(std::max(squares - noise, 0.0) / count) / mean;
  std::cout << name << ": relative RMS after noise " << relative << ", before " << std::sqrt(squares / count) / mean
            << ", noise of both " << std::sqrt(noise / count) / mean << "\n";
  EXPECT_LT(relative, tolerance);
  EXPECT_LT(std::sqrt(noise / count) / mean, 0.05) << "too noisy to tell";
}

TEST(RoomPicture, CornellLikeThePathTracer) {
  // oracle: brute-force path tracing in double (support_code/path_tracer.hpp)
  // tolerance: 2 % relative RMS of blocks of 8x8 pixels, the noise of both taken off
  expect_like_path_tracer("cornell", {"photons.emitted=1000000"}, 24000, 0.02);
}

TEST(RoomPicture, StraightCrossRoomLikeThePathTracer) {
  // oracle: as above
  // tolerance: as above
  expect_like_path_tracer("cross-room", {"photons.emitted=2000000"}, 24000, 0.02);
}

}  // namespace
}  // namespace greenray
