// Terrain before the sky: where bent rays meet hills of known shape, and what pictures show of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "atmosphere/profile.hpp"
#include "render/renderer.hpp"
#include "render/sky_sight.hpp"
#include "render/terrain_light.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support_code/terrain.hpp"

namespace greenray {
namespace {

namespace made = testing_terrain;

const std::shared_ptr<Device> &device() {
  static const std::shared_ptr<Device> opened = open_device({});
  return opened;
}

/// A cone on the sea, seen from an eye above the sea.
struct Cone {
  GeoPlace eye{46.2, 7.3}, apex{46.4, 7.4};
  double top_m = 1500, slope = 0.25;
  double height_m(const GeoPlace &at) const { return std::max(0.0, top_m - slope * made::chord_m(at, apex)); }

  double distance_m() const { return made::distance_m(eye, apex); }
  double azimuth_deg() const { return to_deg(made::azimuth_rad(eye, apex)); }
  /// At a distance and so far aside of the apex, as seen from the eye: sides and angle of a triangle on a sphere.
  double height_m(double distance, double aside_rad) const {
    const double r = 6371000, a = distance / r, b = distance_m() / r, half = std::sin(aside_rad / 2);
    const double lean = std::sin((a - b) / 2);
    const double away = 2 * r * std::asin(std::sqrt(lean * lean + std::sin(a) * std::sin(b) * half * half));
    return std::max(0.0, top_m - slope * away);
  }
  HeightTile tile() const {
    return made::tile_of(46, 7, 1.0 / 3600, 2401, 2401, [this](const GeoPlace &at) { return height_m(at); });
  }
};

Scene scene_of(const std::string &air, const GeoPlace &eye, const HeightTile &tile, double azimuth_deg, double height_m,
               double farthest_m, const std::vector<std::string> &more = {}) {
  std::vector<std::string> keys = more;
  keys.push_back("observer.height_m=" + std::to_string(height_m));
  keys.push_back("observer.azimuth_deg=" + std::to_string(azimuth_deg));
  Scene scene = parse_scene("terrain.toml",
                            "greenray = 1\n[atmosphere]\n" + air +
                                "\n[observer]\naltitude_deg = 1.5\nfov_deg = 8.0\nresolution = [800, 480]\n"
                                "[spectrum]\nsamples = 1\nrange_nm = [550.0, 550.0]\n",
                            keys);
  scene.terrain.field = std::make_shared<const HeightField>(std::vector<HeightTile>{tile});
  scene.terrain.eye = eye, scene.terrain.farthest_m = farthest_m;
  return scene;
}

/// The sight of a scene, and its terrain as the kernel's text sees it on the host.
class Look {
 public:
  explicit Look(const Scene &scene, const RenderOptions &options = {})
      : scene_(scene),
        plan_(plan_render(scene, options)),
        sight_(scene, plan_, options, device(), [](const std::string &) {}),
        table_(terrain_shape(*sight_.terrain(), sight_.terrain_sights())),
        terrain_(table_.view(1)) {}

  f32::TerrainHit at(double elevation_rad, double azimuth_rad) const {
    const double entry =
        std::clamp((elevation_rad - sight_.transfer().first_elevation_rad) / sight_.transfer().spacing_rad, 0.0,
                   static_cast<double>(sight_.transfer().entries - 1));
    const f32::TerrainSight s =
        f32::terrain_sight(&terrain_, static_cast<float>(entry), static_cast<float>(azimuth_rad));
    return f32::first_terrain(&terrain_, &s, 0);
  }
  /// Highest elevation at which terrain is met, where there is one skyline.
  double skyline_rad(double azimuth_rad) const {
    double low = to_rad(-0.5), high = to_rad(3.8);
    for (int i = 0; i < 40; ++i) {
      const double middle = 0.5 * (low + high);
      (at(middle, azimuth_rad).distance_m > 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  const RenderReport &report() const { return sight_.report(); }

 private:
  Scene scene_;
  RenderPlan plan_;
  SkySight sight_;
  TerrainTable table_;
  f32::Terrain terrain_;
};

RenderOptions in_air(bool bent) {
  RenderOptions options;
  options.straight = !bent;
  return options;
}

/* Elevation at which a place is seen in air of n = n0 (R/r)^k: r^(1-k) cos e is constant (Bouguer), so that rays are
   straight lines in the plane of radius r^(1-k) and angle (1-k) theta. */
double elevation_rad(double eye_m, double height_m, double distance_m, double k, double radius_m = 6371000) {
  const double angle = (1 - k) * distance_m / radius_m, half = std::sin(angle / 2);
  const double ratio = std::exp((1 - k) * (std::log1p(height_m / radius_m) - std::log1p(eye_m / radius_m)));
  const double beyond = std::expm1((1 - k) * (std::log1p(height_m / radius_m) - std::log1p(eye_m / radius_m)));
  return std::atan2(beyond - 2 * ratio * half * half, ratio * std::sin(angle));
}

double skyline_of(const std::function<double(double)> &height_at, double eye_m, double farthest_m, double k) {
  double highest = -1;
  for (double d = 20; d < farthest_m; d += 2) highest = std::max(highest, elevation_rad(eye_m, height_at(d), d, k));
  return highest;
}

/// Of a pixel's centre, from the picture's middle.
double azimuth_of(const SpectralImage &image, std::size_t pixel, const Scene &scene) {
  const auto width = static_cast<std::size_t>(image.width);
  const double tangent = 2 * std::tan(to_rad(scene.observer.fov_deg) / 2) / image.width;
  const double right = (static_cast<double>(pixel % width) + 0.5 - 0.5 * image.width) * tangent;
  const double up = (0.5 * image.height - static_cast<double>(pixel / width) - 0.5) * tangent;
  const double altitude = to_rad(scene.observer.altitude_deg);
  return std::atan2(right, std::cos(altitude) - up * std::sin(altitude));
}

}  // namespace

// oracle: the closed form of straight lines, and of light that bends k times as much as the surface does, over the
// cone's own formula: the largest elevation over all distances
// tolerance: off the axis a cone is smooth: bilinear cells 21 m x 31 m are below it by (31 m)^2/8 x slope/distance from
// the apex, under 0.05 m there, 0.4" at 24 km; with the look-up's 0.02 pixel (0.7") and floats 1.5". The apex itself is
// cut off: half a cell times the slope, 4 m, 34"
TEST(Terrain, SkylineOfAConeInClosedForm) {
  const Cone cone;
  struct Air {
    std::string keys;
    double k;
  };
  // n - 1 falls by k n/R a metre; 9000 m of it, more than any ray needs
  const double k = 0.17, n0 = 3e-4, fall = k * (1 + n0) / 6371000;
  std::vector<Air> airs{{"profile = \"us76\"", 0}};
  std::string bent = "profile = \"" + std::string(GREENRAY_TEST_DATA) + "/terrain/constant_k.toml\"";
  airs.push_back({bent, k});
  EXPECT_NEAR(fall, 2.669141e-8, 1e-14);  // as that file has it
  for (const Air &air : airs) {
    const Look look(scene_of(air.keys, cone.eye, cone.tile(), cone.azimuth_deg(), 50, 40e3), in_air(air.k > 0));
    for (const double aside_deg : {-3.5, -2.0, -1.0, -0.3, 0.0, 0.3, 1.0, 2.0, 3.5}) {
      const double aside = to_rad(aside_deg);
      const double known = skyline_of([&](double d) { return cone.height_m(d, aside); }, 50, 40e3, air.k);
      const double ours = look.skyline_rad(aside);
      if (aside_deg == 0) {
        EXPECT_NEAR(to_arcsec(ours - known), -17, 18) << air.keys;
      } else {
        EXPECT_NEAR(to_arcsec(ours), to_arcsec(known), 1.5) << air.keys << " " << aside_deg;
      }
    }
    EXPECT_LT(*look.report().terrain_arcsec, 36 * 0.05);
  }
}

// oracle: heights hidden at a distance, in closed form (as above, of the level ray that grazes the sea): tables of
// land that begin at 40, 60 and 80 km and are 1 m lower than that are not seen, 1 m higher ones are
// tolerance: 1 m at 40 km is 5", at 80 km 2.6"; float and look-up leave 1", a table of land begins up to a cell (46 m)
// later, by when the sea hides 0.5 m more
TEST(Terrain, TheSeaHidesWhatSurveyorsTablesSay) {
  const GeoPlace eye{46.0, 7.5};
  const double eye_m = 10, radius = 6371000;
  for (const double distance : {40e3, 60e3, 80e3}) {
    const double beyond = distance - radius * std::acos(radius / (radius + eye_m));
    const double hidden = radius * (1 / std::cos(beyond / radius) - 1);
    for (const double over : {-1.0, 1.0}) {
      const HeightTile tile = made::tile_of(45.99, 7.3, 1.0 / 2400, 1921, 961, [&](const GeoPlace &at) {
        const double away = made::distance_m(eye, at);
        return away < distance ? 0 : hidden + over;
      });
      const Look look(scene_of("profile = \"us76\"", eye, tile, 0, eye_m, 85e3,
                               {"observer.fov_deg=1.0", "observer.altitude_deg=0.0"}),
                      in_air(false));
      int met = 0;
      const double horizon = -std::acos(radius / (radius + eye_m));
      for (int i = -200; i <= 200; ++i) met += look.at(horizon + from_arcsec(0.2 * i), 0).distance_m > 0;
      EXPECT_EQ(met > 0, over > 0) << distance;
    }
  }
}

// oracle: rays by Runge & Kutta's fourth order in steps of 4 m straight from Profile::refractivity, the ground by the
// cone's own formula; the first step below it is where the ray ends
// tolerance: heights where they meet within 0.5 m (0.05 m of the cells, 2" of direction at 24 km: 0.25 m), distances
// within that over the slope between ray and ground; rays within 5" of a silhouette, where the ground is met elsewhere,
// are left out, and counted
TEST(Terrain, HillsAreMetWhereBruteForceMeetsThemInMirages) {
  Cone cone;
  cone.top_m = 900, cone.slope = 0.12;
  for (const std::string air : {"superior-mirage", "fata-morgana", "us76"}) {
    const double eye_m = 16;
    const Scene scene = scene_of("profile = \"" + air + "\"", cone.eye, cone.tile(), cone.azimuth_deg(), eye_m, 40e3,
                                 {"observer.fov_deg=4.0", "observer.altitude_deg=0.6"});
    const Look look(scene);
    const Profile profile(scene.atmosphere.profile);
    const double radius = 6371000;
    const auto brute = [&](double elevation, double aside) {
      const auto slope = [&](double h, double e) {
        const auto n = profile.refractivity(std::max(h, 0.0), 550);
        return std::array<double, 2>{(1 + h / radius) * std::tan(e),
                                     1 / radius + (1 + h / radius) * n.slope / (1 + n.value)};
      };
      double h = eye_m, e = elevation, d = 0;
      const double step = 4;
      while (d < 40e3) {
        const auto a = slope(h, e), b = slope(h + step / 2 * a[0], e + step / 2 * a[1]);
        const auto c = slope(h + step / 2 * b[0], e + step / 2 * b[1]), f = slope(h + step * c[0], e + step * c[1]);
        h += step / 6 * (a[0] + 2 * b[0] + 2 * c[0] + f[0]), e += step / 6 * (a[1] + 2 * b[1] + 2 * c[1] + f[1]);
        d += step;
        if (h <= cone.height_m(d, aside)) return std::array<double, 2>{h > 0 ? d : 0, std::max(h, 0.0)};
      }
      return std::array<double, 2>{0, 0};
    };
    int compared = 0, left_out = 0, inverted = 0;
    double last_height = -1;
    for (const double aside : {0.002, 0.012})
      for (int i = -10; i <= 60; ++i) {  // close together near the horizon
        const double elevation = from_arcsec(i < 40 ? 20 * i : 800 + 120 * (i - 40));
        const auto known = brute(elevation, aside), beside = brute(elevation + from_arcsec(5), aside);
        const f32::TerrainHit ours = look.at(elevation, aside);
        if ((known[0] > 0) != (beside[0] > 0) || std::abs(known[0] - beside[0]) > 400) {
          ++left_out;
          continue;
        }
        ++compared;
        ASSERT_EQ(ours.distance_m > 0, known[0] > 0) << air << " " << to_deg(elevation) << " " << aside;
        const double stretch = 1 + std::abs(beside[1] - known[1]) / 5;  // m per arc-second there
        EXPECT_NEAR(ours.height_m, known[1], 0.5 * stretch) << air << " " << to_deg(elevation);
        EXPECT_NEAR(ours.distance_m, known[0], 10 * stretch + 5) << air << " " << to_deg(elevation);
        if (known[1] > 0 && last_height > known[1]) ++inverted;
        last_height = known[1];
      }
    EXPECT_GT(compared, 100) << air;
    EXPECT_LT(left_out, 30) << air;
    if (air == "fata-morgana") {
      EXPECT_GT(inverted, 0);
    }
  }
}

// oracle: the host twin of the same text, and the picture's own channels: sky where nothing is met, ground where it is;
// a wall nearer than the hill hides it, one behind it is hidden
// tolerance: pixels of which the four corners and the centre agree
TEST(Terrain, PicturesShowItBeforeTheSkyAndTargetsBeforeAndBehindIt) {
  const Cone cone;
  Scene scene = scene_of("profile = \"us76\"", cone.eye, cone.tile(), cone.azimuth_deg(), 50, 40e3,
                         {"observer.resolution=[160, 96]", "spectrum.samples=5", "spectrum.range_nm=[450.0, 650.0]",
                          "sun={ altitude_deg = 30.0, azimuth_deg = 190.0 }"});
  TargetScene wall;
  wall.width_m = 500, wall.height_m = 5000, wall.luminance_cd_m2 = 1e5;
  wall.distance_m = 10e3, wall.offset_m = -500;
  scene.targets.push_back(wall);
  wall.distance_m = 35e3, wall.offset_m = 1200;
  scene.targets.push_back(wall);
  const Rendered made_picture = render(scene, plan_render(scene, {}), {}, device());
  const SpectralImage &image = made_picture.image;
  const auto &distance = image.channels.at("target_distance_m"), &height = image.channels.at("target_height_m");
  int near = 0, hill = 0, behind = 0;
  for (std::size_t i = 0; i < image.pixels(); ++i) {
    const double d = static_cast<double>(distance[i]), bright = static_cast<double>(image.radiance[5 * i + 2]);
    if (d == 0) continue;
    if (std::abs(d - 10e3) < 1) {
      ++near;
    } else if (std::abs(d - 35e3) < 1) {
      ++behind;
      EXPECT_GT(static_cast<double>(height[i]), 800);
    } else {
      ++hill;
      EXPECT_NEAR(static_cast<double>(height[i]), cone.height_m(d, azimuth_of(image, i, scene)), 12);
    }
    EXPECT_GT(bright, 0);
  }
  EXPECT_GT(near, 200);
  EXPECT_GT(hill, 1000);
  EXPECT_GT(behind, 20);
}

}  // namespace greenray
