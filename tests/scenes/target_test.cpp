// Targets in rendered pictures: where their edges are seen, how often, and how bright.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "image/colour.hpp"
#include "image/exr.hpp"
#include "image/png.hpp"
#include "render/renderer.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"

namespace greenray {
namespace {

constexpr double earth_m = 6371000;

/// A black sky without extinction, one wavelength, in which targets shine.
const std::string dark =
    "greenray = 1\n[sky]\nmodel = \"academic\"\n[atmosphere]\nextinction = false\n[spectrum]\nsamples = 1\n"
    "range_nm = [550.0, 550.0]\n";

std::string text(double value) {
  std::ostringstream out;
  out.precision(15);
  out << std::fixed << value;
  return out.str();
}

std::string rectangle(double distance_m, double width_m, double base_m, double height_m, const std::string &more = "") {
  return "[[target]]\nkind = \"rectangle\"\ndistance_m = " + text(distance_m) + "\nwidth_m = " + text(width_m) +
         "\nbase_m = " + text(base_m) + "\nheight_m = " + text(height_m) +
         (more.empty() ? "\nluminance_cd_m2 = 100.0\n" : "\n" + more + "\n");
}

/// Rows of pixels of one size about an apparent altitude.
struct Frame {
  double centre_deg, pixel_arcsec;
  int columns, rows, samples = 64;
  std::vector<std::string> keys() const {
    const double half = std::tan(from_arcsec(pixel_arcsec)) * columns / 2;
    return {"observer.altitude_deg=" + text(centre_deg), "observer.fov_deg=" + text(2 * to_deg(std::atan(half))),
            "observer.resolution=[" + std::to_string(columns) + ", " + std::to_string(rows) + "]",
            "tracing.quality.spp=" + std::to_string(samples), "observer.azimuth_deg=0.0"};
  }
  double altitude_deg(double down) const {
    return centre_deg + to_deg(std::atan((rows / 2.0 - down) * std::tan(from_arcsec(pixel_arcsec))));
  }
};

Rendered make(const std::string &scene_text, const Frame &frame, std::vector<std::string> keys,
              const RenderOptions &options = {}) {
  for (const std::string &key : frame.keys()) keys.push_back(key);
  const Scene scene = parse_scene("targets.toml", scene_text, keys);
  static const std::shared_ptr<Device> device = open_device({});
  return render(scene, plan_render(scene, options), options, device);
}

double value(const SpectralImage &image, int column, int row, std::size_t wave = 0) {
  const auto pixel =
      static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(column);
  return static_cast<double>(image.radiance[pixel * image.wavelength_nm.size() + wave]);
}

/// Mean of each row over that of the brightest row.
std::vector<double> row_cover(const SpectralImage &image) {
  std::vector<double> rows;
  double most = 0;
  for (int y = 0; y < image.height; ++y) {
    double sum = 0;
    for (int x = 0; x < image.width; ++x) sum += value(image, x, y);
    rows.push_back(sum / image.width);
    most = std::max(most, rows.back());
  }
  for (double &row : rows) row /= most > 0 ? most : 1;
  return rows;
}

/// Share of each pixel row that a condition on the apparent altitude [deg] lights.
std::vector<double> expected_cover(const Frame &frame, const std::function<bool(double)> &lit) {
  constexpr int parts = 200;
  std::vector<double> rows;
  for (int y = 0; y < frame.rows; ++y) {
    int hits = 0;
    for (int k = 0; k < parts; ++k) hits += lit(frame.altitude_deg(y + (k + 0.5) / parts));
    rows.push_back(hits / static_cast<double>(parts));
  }
  return rows;
}

struct Match {
  double worst = 0;  // of runs of rows: difference of the lit height [pixels]
  int images = 0, expected_images = 0;
};

int runs(const std::vector<double> &rows) {
  int count = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) count += rows[i] > 0.5 && (i == 0 || rows[i - 1] <= 0.5);
  return count;
}

/// Compares edges: sums over the rows between places where the expectation is all lit or all dark for three rows.
Match compare(const std::vector<double> &found, const std::vector<double> &expected) {
  Match match;
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    sum += found[i] - expected[i];
    const bool flat = i + 1 < found.size() && i > 0 && expected[i - 1] == expected[i] && expected[i] == expected[i + 1];
    if (!flat) continue;
    match.worst = std::max(match.worst, std::abs(sum));
    sum = 0;
  }
  match.worst = std::max(match.worst, std::abs(sum));
  match.images = runs(found);
  match.expected_images = runs(expected);
  return match;
}

/// Apparent altitude [deg] of a point at a height over a sphere in air of constant index.
double straight_altitude_deg(double eye_m, double height_m, double distance_m) {
  const double angle = distance_m / earth_m;
  const double up = (earth_m + height_m) * std::cos(angle) - (earth_m + eye_m);
  return to_deg(std::atan2(up, (earth_m + height_m) * std::sin(angle)));
}

const RenderOptions straight = [] {
  RenderOptions options;
  options.straight = true;
  return options;
}();

}  // namespace

// oracle: straight lines over a sphere: dip acos(R/(R+h)), elevation of the top; the part below the dip is hidden, and
// so is
//         what lies below the surface, though rays that end before would meet it there
// tolerance: 0.1 pixel of 2": samples in a pixel, and the table's step is half a pixel
TEST(Targets, StraightLightOverASphere) {
  const double eye = 3, distance = 20000, top = 40;
  const Frame frame{0.0, 2, 8, 400};
  const Rendered picture =
      make(dark + rectangle(distance, 200, -10, top + 10), frame, {"observer.height_m=" + text(eye)}, straight);
  const double dip = -to_deg(std::acos(earth_m / (earth_m + eye)));
  const double highest = straight_altitude_deg(eye, top, distance);
  ASSERT_LT(straight_altitude_deg(eye, 0, distance), dip);  // the waterline is hidden
  const auto expected = expected_cover(frame, [&](double deg) { return deg > dip && deg < highest; });
  const Match match = compare(row_cover(picture.image), expected);
  EXPECT_LT(match.worst, 0.1);
  EXPECT_EQ(match.images, 1);
}

// oracle: the arc through the target at R sin(d/R) per radian of azimuth, and offsets to the right; solid angles
// tolerance: 0.1 pixel
TEST(Targets, WidthAndOffsetByAzimuth) {
  const double distance = 50000, width = 30, offset = 50;
  const Frame frame{0.1, 4, 200, 8};
  const Rendered picture =
      make(dark + rectangle(distance, width, 0, 900, "offset_m = 50.0\nluminance_cd_m2 = 10.0"), frame, {}, straight);
  const double per_rad = earth_m * std::sin(distance / earth_m);
  double sum = 0, moment = 0, most = 0;
  for (int x = 0; x < frame.columns; ++x) most = std::max(most, value(picture.image, x, 4));
  for (int x = 0; x < frame.columns; ++x) {
    sum += value(picture.image, x, 4) / most;
    moment += value(picture.image, x, 4) / most * (x + 0.5);
  }
  const double pixel = std::tan(from_arcsec(4));
  EXPECT_NEAR(sum, (std::tan((offset + width / 2) / per_rad) - std::tan((offset - width / 2) / per_rad)) / pixel, 0.1);
  EXPECT_NEAR(moment / sum - 100, std::tan(offset / per_rad) / pixel, 0.1);
}

// oracle: a sphere of radius R/(1 - k) takes the place of air whose gradient is -k/R: hidden height
//         (d - sqrt(2 R' h))^2 / (2 R')
// tolerance: 0.3 % of the hidden height: the formula leaves out h/R and the index itself (3e-4)
TEST(Targets, HiddenHeightByTheRefractionCoefficient) {
  const double eye = 10, distance = 40000, k = 0.13;
  const double gradient = k / earth_m;  // of n - 1, per metre, downwards
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("greenray-k-" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << "[[index_level]]\nheight_m = 0.0\nrefractivity = 3.0e-4\n[[index_level]]\nheight_m = 2000.0\n"
                         "refractivity = "
                      << text(3e-4 - 2000 * gradient) << "\n";
  const double radius = earth_m / (1 - k);
  const double hidden = std::pow(distance - std::sqrt(2 * radius * eye), 2) / (2 * radius);
  const Frame frame{-0.05, 1, 4, 400};
  const auto keys = [&] {
    return std::vector<std::string>{"atmosphere.profile=" + file.string(), "observer.height_m=" + text(eye)};
  }();
  // A target that ends below the hidden height is not seen; one that reaches a little above it is.
  const Rendered below = make(dark + rectangle(distance, 400, 0, hidden * 0.997), frame, keys);
  const Rendered above = make(dark + rectangle(distance, 400, 0, hidden * 1.003), frame, keys);
  std::filesystem::remove(file);
  double lit = 0, dark_light = 0;
  for (const float x : below.image.radiance) dark_light += static_cast<double>(x);
  for (const float x : above.image.radiance) lit += static_cast<double>(x);
  EXPECT_EQ(dark_light, 0);
  EXPECT_GT(lit, 0);
}

namespace {

/// Air over a flat surface: constant index above `top`, below it n falls linearly to `low` at the surface. Height of a
/// ray at x by its three pieces: a straight line, the catenary n = C cosh(g (x - x0)/C), a straight line. NaN: ground.
struct LinearLayer {
  double top_m, high, low;
  double height_m(double eye_m, double elevation_rad, double x_m) const {
    const double slope = std::tan(elevation_rad);
    if (slope >= 0) return eye_m + slope * x_m;
    const double enters = (top_m - eye_m) / slope;
    if (x_m <= enters) return eye_m + slope * x_m;
    const double g = (high - low) / top_m, c = high * std::cos(elevation_rad);
    const double half = c / g * std::acosh(high / c);  // from the edge to the turn
    const auto inside = [&](double x) { return (c * std::cosh(g * (x - enters - half) / c) - low) / g; };
    const bool hits = c < low;
    if (hits && x_m >= enters + half - c / g * std::acosh(low / c)) return NAN;
    if (x_m <= enters + 2 * half) return inside(x_m);
    return top_m - slope * (x_m - enters - 2 * half);
  }
};

std::string layer_file(const LinearLayer &layer) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("greenray-layer-" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << "[[index_level]]\nheight_m = 0.0\nrefractivity = " << text(layer.low - 1)
                      << "\n[[index_level]]\nheight_m = " << text(layer.top_m)
                      << "\nrefractivity = " << text(layer.high - 1)
                      << "\n[[index_level]]\nheight_m = 5000.0\nrefractivity = " << text(layer.high - 1) << "\n";
  return file.string();
}

}  // namespace

// oracle: closed form of lines and a catenary (LinearLayer): an erect image above an inverted one, both cut by the
//         vanishing line; and the road where rays are too steep to turn
// tolerance: 0.15 pixel for each edge (64 samples a pixel, a table of half a pixel)
TEST(Targets, InferiorMirageOfALinearLayer) {
  const LinearLayer layer{0.5, 1.0003, 1.00029};
  const double eye = 2, distance = 1500;
  const std::string file = layer_file(layer);
  for (const auto &[base, height] : {std::pair{0.0, 3.0}, std::pair{1.0, 1.5}, std::pair{0.0, 0.6}}) {
    for (const char *precision : {"float", "double"}) {
      SCOPED_TRACE(std::to_string(base) + " " + precision);
      const Frame frame{-0.13, 2, 4, 900};
      const Rendered picture = make(dark + rectangle(distance, 40, base, height), frame,
                                    {"atmosphere.profile=" + file, "atmosphere.surface=flat", "observer.height_m=2.0",
                                     std::string("tracing.precision=") + precision});
      const auto expected = expected_cover(frame, [&](double deg) {
        const double h = layer.height_m(eye, to_rad(deg), distance);
        return h >= base && h < base + height;
      });
      const Match match = compare(row_cover(picture.image), expected);
      EXPECT_LT(match.worst, 0.15);
      EXPECT_EQ(match.images, match.expected_images);
      if (base > 0) {
        EXPECT_EQ(match.images, 2);
      }
    }
  }
  std::filesystem::remove(file);
}

// oracle: the same closed form for the heights of channel target_height_m, which fall with altitude in the inverted
// image tolerance: 5 mm: 0.7" at 1500 m, the look-up between two entries half a pixel apart in a bent curve
TEST(Targets, ChannelsTellDistanceAndHeight) {
  const LinearLayer layer{0.5, 1.0003, 1.00029};
  const std::string file = layer_file(layer);
  const Frame frame{-0.13, 2, 4, 900, 4};
  const Rendered picture = make(dark + rectangle(1500, 40, 0, 3), frame,
                                {"atmosphere.profile=" + file, "atmosphere.surface=flat", "observer.height_m=2.0"});
  std::filesystem::remove(file);
  const auto &distance = picture.image.channels.at("target_distance_m"),
             &height = picture.image.channels.at("target_height_m");
  int met = 0, upside_down = 0;
  float last = 0;
  for (int y = 0; y < frame.rows; ++y) {
    const auto at = static_cast<std::size_t>(y * frame.columns + 2);
    const double known = layer.height_m(2, to_rad(frame.altitude_deg(y + 0.5)), 1500);
    const bool inside = known >= 0.01 && known < 2.99, outside = !(known >= -0.01 && known < 3.01);
    if (inside || outside) {
      EXPECT_EQ(distance[at], inside ? 1500.0f : 0.0f) << y;
    }
    if (!inside) continue;
    EXPECT_NEAR(static_cast<double>(height[at]), known, 0.005) << y;
    ++met;
    upside_down += height[at] > last;  // downwards in the picture, upwards on the target
    last = height[at];
  }
  EXPECT_GT(met, 300);
  EXPECT_GT(upside_down, 100);
}

namespace {

/// Heights at a target by altitude, from the reference table; NaN where the ray met the ground.
class Sights {
 public:
  explicit Sights(const std::string &profile) {
    const testing_data::ReferenceTable table("target_sights.csv");
    for (const auto &row : table.rows())
      if (row.text("profile") == profile) {
        eye_m = row.number("height_m"), distance_m = row.number("distance_m");
        deg_.push_back(row.number("apparent_altitude_deg"));
        height_.push_back(row.number_or_blank("height_at_distance_m").value_or(NAN));
      }
  }
  double height_m(double deg) const {
    const double at = (deg - deg_.front()) / (deg_[1] - deg_[0]);
    const auto i = static_cast<std::size_t>(std::clamp(at, 0.0, double(deg_.size() - 2)));
    const double f = at - static_cast<double>(i), a = height_[i], b = height_[i + 1];
    if (std::isnan(a) || std::isnan(b) || std::abs(b - a) > 5) return f < 0.5 ? a : b;  // beside a jump
    return a + f * (b - a);
  }
  double eye_m = 0, distance_m = 0;

 private:
  std::vector<double> deg_, height_;
};

}  // namespace

// oracle: reference/target_sights.csv, an independent integration through the air of the profile: inferior mirage over
//         a road, superior mirage by an inversion; number of images and every edge
// tolerance: 0.25 pixel of 4": the table's rows lie 1.8" and 3.6" apart
TEST(Targets, MiragesOfRealAir) {
  for (const auto &[profile, base, height, images] :
       {std::tuple{"hot_road_thin", 0.3, 1.4, 2}, std::tuple{"duct_10K", 47.15, 0.5, 3},
        std::tuple{"duct_10K", 20.0, 15.0, 1}}) {
    SCOPED_TRACE(std::string(profile) + " " + std::to_string(base));
    const Sights sights(profile);
    const bool road = sights.distance_m < 1000;
    const Frame frame{road ? -0.12 : 0.08, 4, 4, road ? 400 : 620};
    const Rendered picture =
        make(dark + rectangle(sights.distance_m, 500, base, height), frame,
             {"atmosphere.profile=" + testing_data::reference_path(std::string("profiles/") + profile + ".toml"),
              "observer.height_m=" + text(sights.eye_m)});
    const auto expected = expected_cover(frame, [&, low = base, tall = height](double deg) {
      const double h = sights.height_m(deg);
      return h >= low && h < low + tall;
    });
    const Match match = compare(row_cover(picture.image), expected);
    EXPECT_LT(match.worst, 0.25);
    EXPECT_EQ(match.images, match.expected_images);
    EXPECT_EQ(match.images, images);
  }
}

// oracle: every sample with rays of its own, no table: the same picture
// tolerance: noise of 16 samples at edges alone: the same samples; rows differ by a look-up of half a pixel
TEST(Targets, TableAndOwnRaysAgree) {
  const LinearLayer layer{0.5, 1.0003, 1.00029};
  const std::string file = layer_file(layer);
  const Frame frame{-0.13, 10, 12, 180, 16};
  const std::vector<std::string> keys{"atmosphere.profile=" + file, "atmosphere.surface=flat", "observer.height_m=2.0"};
  const std::string scene = dark + rectangle(1500, 0.4, 0.3, 2) +
                            "[[target]]\nkind = \"triangle\"\ndistance_m = 4000.0\nwidth_m = 2.0\nheight_m = 6.0\n"
                            "luminance_cd_m2 = 30.0\n";
  const Rendered table = make(scene, frame, keys);
  auto own_keys = keys;
  own_keys.push_back("tracing.transfer=per-pixel");
  const Rendered own = make(scene, frame, own_keys);
  std::filesystem::remove(file);
  double difference = 0, light = 0;
  for (std::size_t i = 0; i < table.image.radiance.size(); ++i) {
    difference += std::abs(static_cast<double>(table.image.radiance[i] - own.image.radiance[i]));
    light += static_cast<double>(own.image.radiance[i]);
  }
  ASSERT_GT(light, 0);
  EXPECT_LT(difference / light, 0.01);
}

// oracle: 683 lm/W x integral of spectral radiance x ybar is the luminance that the scene asks for; Rec. 709 white is
// D65 tolerance: 0.5 %: 32 samples of the spectrum from 390 to 720 nm
TEST(Targets, LuminanceAndColourOfLamps) {
  const Frame frame{0.0, 60, 4, 4, 4};
  const Rendered picture = make("greenray = 1\n[sky]\nmodel = \"academic\"\n[spectrum]\nsamples = 32\n" +
                                    rectangle(1000, 1000, -500, 1000, "luminance_cd_m2 = 250.0"),
                                frame, {}, straight);
  const RgbImage rgb = rgb_from_spectral(picture.image);
  const Rgb pixel = rgb.pixel(5);
  EXPECT_NEAR(luminance(pixel) / 250, 1, 0.005);
  for (const double part : pixel) EXPECT_NEAR(part / 250, 1, 0.02);
}

// oracle: Koschmieder: at the distance of visibility 2 % of the light passes at 550 nm; exp(-beta d) at others; and a
//         black target shows the airlight J (1 - exp(-beta d)), so that of two distances the ratio is known
// tolerance: 0.5 %: air is thinner by 1e-4 a metre above the surface, and rays keep within 20 m
TEST(Targets, ExtinctionAndAirlightOfThePath) {
  const double visibility = 20000, beta = std::log(50.0) / visibility;
  const std::string hazy =
      "greenray = 1\n[spectrum]\nsamples = 1\nrange_nm = [550.0, 550.0]\n[atmosphere]\nozone_DU = 0.0\n"
      "aerosol = { visibility_km = 20.0, scale_height_m = 100000.0 }\n";
  const Frame frame{0.0, 10, 4, 4, 4};
  const auto radiance = [&](const std::string &scene, double distance, const std::string &light) {
    return value(make(scene + rectangle(distance, 2000, 0, 300, light), frame, {"observer.height_m=20.0"}).image, 1, 1);
  };
  const std::string lamp = "luminance_cd_m2 = 100.0", black = "reflectance = 0.0";
  const double bare = radiance(dark, 100, lamp);
  for (const double distance : {1000.0, 8000.0, visibility}) {
    const double passed = (radiance(hazy, distance, lamp) - radiance(hazy, distance, black)) / bare;
    EXPECT_NEAR(passed / std::exp(-beta * distance), 1, 0.005) << distance;
  }
  const std::string sunny = hazy + "[sun]\naltitude_deg = 30.0\nazimuth_deg = 180.0\n";
  const double near = radiance(sunny, 1000, black), far = radiance(sunny, 8000, black);
  EXPECT_NEAR(far / near / (std::expm1(-beta * 8000) / std::expm1(-beta * 1000)), 1, 0.005);
  // Light of the target is added to that of the air before it.
  EXPECT_NEAR(radiance(sunny, 8000, lamp), far + bare * std::exp(-beta * 8000), 0.005 * far);
}

// oracle: Lambert: radiance of a white target = E/pi, E = E0 cos(altitude) of a Sun behind the eye; no air between, so
//         E0 = ASTM E-490 at 550 nm (1.8661 W m^-2 nm^-1); a target before the Sun has none of it. A ground of albedo a
//         lights what is upright by half of its radiance's hemisphere: a E0 sin(altitude)/2
// tolerance: 1 %: E0 is a mean over 5 nm
TEST(Targets, SunlitReflectance) {
  const std::string scene =
      "greenray = 1\n[spectrum]\nsamples = 1\nrange_nm = [550.0, 550.0]\n[atmosphere]\nextinction = false\n";
  const Frame frame{0.0, 10, 4, 4, 4};
  const auto radiance = [&](double azimuth_deg, double albedo = 0) {
    return value(make(scene + "[sky]\nground_albedo = " + text(albedo) +
                          "\n[sun]\naltitude_deg = 30.0\nazimuth_deg = " + text(azimuth_deg) + "\n" +
                          rectangle(1000, 2000, -500, 1000, "reflectance = 0.5"),
                      frame, {}, straight)
                     .image,
                 1, 1);
  };
  EXPECT_NEAR(radiance(180) / (0.5 * 1.8661 * std::cos(to_rad(30)) / pi), 1, 0.01);
  EXPECT_NEAR(radiance(120) / radiance(180), 0.5, 1e-4);
  EXPECT_EQ(radiance(0), 0);
  EXPECT_NEAR(radiance(0, 0.2) / (0.5 * 1.8661 * 0.2 * std::sin(to_rad(30)) / 2 / pi), 1, 0.01);
}

// oracle: areas of polygons by the shoelace formula, with the even-odd rule: a square with a square hole as one outline
// tolerance: 0.2 m2 of some 50: 16 samples in each of some hundreds of pixels of edge
TEST(Targets, ExactOutlines) {
  const Frame frame{0.0, 10, 300, 300, 16};
  const auto area_m2 = [&](const std::string &corners) {
    const Rendered picture = make(dark + "[[target]]\nkind = \"polygon\"\ndistance_m = 1000.0\noutline_m = " + corners +
                                      "\nluminance_cd_m2 = 1.0\n",
                                  frame, {"atmosphere.surface=flat", "observer.height_m=5.0"}, straight);
    double sum = 0, most = 0;
    for (const float x : picture.image.radiance) {
      sum += static_cast<double>(x);
      most = std::max(most, static_cast<double>(x));
    }
    return sum / most * std::pow(1000 * std::tan(from_arcsec(10)), 2);
  };
  EXPECT_NEAR(area_m2("[[-5.0, 1.0], [5.0, 1.0], [3.0, 8.0], [-1.0, 10.0]]"), 0.5 * (-10 + 37 + 38 + 49), 0.2);
  EXPECT_NEAR(area_m2("[[-4.0, 1.0], [4.0, 1.0], [4.0, 9.0], [-4.0, 9.0], [-4.0, 1.0], [-2.0, 3.0], [2.0, 3.0], "
                      "[2.0, 7.0], [-2.0, 7.0], [-2.0, 3.0]]"),
              64 - 16, 0.2);
}

namespace {

struct TemporaryFile {
  std::filesystem::path path;
  explicit TemporaryFile(const std::string &name)
      : path(std::filesystem::temp_directory_path() / ("greenray-" + std::to_string(getpid()) + "-" + name)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

}  // namespace

// oracle: a target that covers a share a of a pixel shows a x its light + (1 - a) x that behind; OpenEXR's colours are
//         multiplied by alpha, so that grey 0.2 at alpha 0.5 is a reflectance of 0.4; the nearer target is in front
// tolerance: 1e-5 relative, float
TEST(Targets, AlphaOfPicturesAndOrder) {
  const TemporaryFile file("alpha.exr");
  RgbImage colours{2, 2, std::vector<float>(12, 0.2f)};
  {
    Imf::Header header(2, 2);
    std::vector<float> alpha(4, 0.5f);
    for (const char *name : {"R", "G", "B", "A"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    Imf::OutputFile out(file.path.c_str(), header);
    Imf::FrameBuffer buffer;
    for (int c = 0; c < 3; ++c)
      buffer.insert(c == 0   ? "R"
                    : c == 1 ? "G"
                             : "B",
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(colours.rgb.data() + c), 12, 24));
    buffer.insert("A", Imf::Slice(Imf::FLOAT, reinterpret_cast<char *>(alpha.data()), 4, 8));
    out.setFrameBuffer(buffer);
    out.writePixels(2);
  }
  const Frame frame{0.0, 10, 4, 4, 4};
  const std::string front = "[[target]]\nkind = \"billboard\"\npicture = \"" + file.path.string() +
                            "\"\ndistance_m = 500.0\nwidth_m = 1000.0\nbase_m = -500.0\nheight_m = 1000.0\n"
                            "luminance_cd_m2 = 100.0\n";
  const auto shown = [&](const std::string &targets) {
    return value(make(dark + targets, frame, {}, straight).image, 1, 1);
  };
  const double white = shown(rectangle(1000, 1000, -500, 1000));
  EXPECT_NEAR(shown(front) / white, 0.5 * 0.4, 2e-4);
  for (const std::string &both : {front + rectangle(1000, 1000, -500, 1000), rectangle(1000, 1000, -500, 1000) + front})
    EXPECT_NEAR(shown(both) / white, 0.5 * 0.4 + 0.5, 2e-4);
  EXPECT_NEAR(shown(front + rectangle(100, 1000, -500, 1000)) / white, 1, 1e-5);
}

// oracle: a picture of four texels, dark and bright, left and right, above and below: each quarter shows its own
// tolerance: 1 % of white: sRGB levels of 8 bits, spectra found to 1e-3
TEST(Targets, PicturesAreTheRightWayUp) {
  const TemporaryFile file("four.png");
  Raster four{2, 2, 8, {255, 255, 255, 0, 0, 0, 188, 188, 188, 99, 99, 99}};  // 1, 0 over 0.5, 0.125
  write_png(file.path, four);
  const Frame frame{0.0, 10, 8, 8, 4};
  const Rendered picture =
      make(dark + "[[target]]\nkind = \"billboard\"\npicture = \"" + file.path.string() +
               "\"\ndistance_m = 1000.0\nwidth_m = 40.0\nbase_m = 32.0\nheight_m = 40.0\nluminance_cd_m2 = 100.0\n",
           Frame{0.0, 1000, 8, 8, 64}, {"atmosphere.surface=flat", "observer.height_m=52.0"}, straight);
  const Rendered white = make(dark + rectangle(1000, 1000, -500, 1000), frame, {}, straight);
  const double full = value(white.image, 1, 1);
  // A pixel is 4.848 m: rows and columns 1 and 6 lie between the texels' middles and the picture's edges.
  EXPECT_NEAR(value(picture.image, 1, 1) / full, 1.0, 0.05);
  EXPECT_NEAR(value(picture.image, 6, 1) / full, 0.0, 0.05);
  EXPECT_NEAR(value(picture.image, 1, 6) / full, 0.5, 0.05);
  EXPECT_NEAR(value(picture.image, 6, 6) / full, 0.125, 0.05);
}

// oracle: two renderings of the same scene, whole and cropped: a crop has the bits of the whole
// tolerance: none
TEST(Targets, SameBitsInACrop) {
  const LinearLayer layer{0.5, 1.0003, 1.00029};
  const std::string file = layer_file(layer);
  const Frame frame{-0.13, 10, 40, 180, 8};
  const std::vector<std::string> keys{"atmosphere.profile=" + file, "atmosphere.surface=flat", "observer.height_m=2.0"};
  const std::string scene = dark + rectangle(1500, 1, 0.3, 2);
  const Rendered whole = make(scene, frame, keys);
  RenderOptions options;
  options.crop = {10, 60, 30, 120};
  const Rendered part = make(scene, frame, keys, options);
  std::filesystem::remove(file);
  double light = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 20; ++x) {
      EXPECT_EQ(value(part.image, x, y), value(whole.image, x + 10, y + 60));
      light += value(part.image, x, y);
    }
  EXPECT_GT(light, 0);
}

}  // namespace greenray
