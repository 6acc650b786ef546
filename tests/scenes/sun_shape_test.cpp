// The Sun measured in rendered pictures: its shape, its rims, the horizon, and how bright it is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "render/renderer.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support_code/reference_table.hpp"

namespace greenray {
namespace {

using testing_data::ReferenceRow;
using testing_data::ReferenceTable;

/// Academic sky (white disk, black sky, no extinction) unless lines say otherwise; `keys` are -D overrides.
Scene sky_scene(const std::vector<std::string> &keys) {
  return parse_scene("measured.toml",
                     "greenray = 1\n[atmosphere]\nprofile = \"us76\"\n[sun]\naltitude_deg = 0.0\n"
                     "[sky]\nmodel = \"academic\"\n",
                     keys);
}

std::string key(const std::string &name, double value) {
  std::ostringstream text;
  text.precision(15);
  text << std::fixed << name << "=" << value;
  return text.str();
}

const std::vector<std::string> only_550{"spectrum.samples=1", "spectrum.range_nm=[549.0, 551.0]"};

/// A picture in squares of `pixel_arcsec` about a point at apparent altitude `centre_deg`.
struct Frame {
  double centre_deg, pixel_arcsec;
  int columns, rows;
  int samples = 64;

  std::vector<std::string> keys() const {
    const double tangent = std::tan(from_arcsec(pixel_arcsec)) * columns / 2;
    return {key("observer.altitude_deg", centre_deg), key("observer.fov_deg", 2 * to_deg(std::atan(tangent))),
            "observer.resolution=[" + std::to_string(columns) + ", " + std::to_string(rows) + "]",
            "tracing.quality.spp=" + std::to_string(samples)};
  }
  /// Apparent altitude of a place `down` pixels below the upper edge, in the column of the centre.
  double altitude_deg(double down) const {
    return centre_deg + to_deg(std::atan((rows / 2.0 - down) * std::tan(from_arcsec(pixel_arcsec))));
  }
};

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string> &b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Rendered make(const std::vector<std::string> &keys, const std::optional<std::array<int, 4>> &crop = {}) {
  const Scene scene = sky_scene(keys);
  RenderOptions options;
  options.crop = crop;
  static const std::shared_ptr<Device> device = open_device({});
  return render(scene, plan_render(scene, options), options, device);
}

/// Lit pixels of each row or column, counted in parts of the disk's radiance (its brightest pixel): edges fall where
/// the areas say, far inside a pixel.
class Lit {
 public:
  Lit(const SpectralImage &image, std::size_t wave) : image_(image), wave_(wave) {
    for (std::size_t i = 0; i < image.pixels(); ++i) disk_ = std::max(disk_, value(i));
  }
  double row(int y) const {
    double sum = 0;
    for (int x = 0; x < image_.width; ++x) sum += at(x, y);
    return sum / disk_;
  }
  /// Mean over all columns of the picture, of the rows first .. last - 1.
  double mean_column(int first, int last) const {
    double sum = 0;
    for (int y = first; y < last; ++y) sum += row(y);
    return sum / image_.width;
  }
  double mean_column() const { return mean_column(0, image_.height); }
  /// Rows from the top to the upper edge of a lit part that reaches the bottom.
  double top_edge() const { return image_.height - mean_column(); }

 private:
  double value(std::size_t pixel) const {
    return static_cast<double>(image_.radiance[pixel * image_.wavelength_nm.size() + wave_]);
  }
  double at(int x, int y) const { return value(static_cast<std::size_t>(y * image_.width + x)); }
  const SpectralImage &image_;
  std::size_t wave_;
  double disk_ = 0;
};

const ReferenceRow &shape(const std::string &kind, double height_m, const std::string &part_of_case) {
  static const ReferenceTable table("sun_shapes.csv");
  for (const ReferenceRow &row : table.rows())
    if (row.text("kind") == kind && row.number("height_m") == height_m &&
        row.text("case").find(part_of_case) != std::string::npos)
      return row;
  throw std::runtime_error("no such row in sun_shapes.csv");
}

struct Diameters {
  double vertical_arcsec, horizontal_arcsec, low_deg, high_deg;
};

/// Vertical: a strip about the centre of the disk; horizontal: the longest row about its widest place.
Diameters measure_disk(double height_m) {
  const ReferenceRow &row = shape("flattening", height_m, "lower limb");
  const Frame frame{0.5 * (row.number("low_apparent_deg") + row.number("high_apparent_deg")), 1.0, 2000, 1800, 64};
  const auto keys = only_550 + frame.keys() +
                    std::vector<std::string>{key("observer.height_m", height_m),
                                             key("sun.altitude_deg", row.number("true_centre_altitude_deg"))};
  const Rendered strip = make(keys, std::array<int, 4>{997, 0, 1003, 1800});
  const Lit lit(strip.image, 0);
  const double above = 900 - lit.mean_column(0, 900), below = 900 + lit.mean_column(900, 1800);
  Diameters found{lit.mean_column() * frame.pixel_arcsec, 0, frame.altitude_deg(below), frame.altitude_deg(above)};

  const double centre_deg = strip.report.sun_apparent_altitude_deg.value();
  const int middle = static_cast<int>(900 - (centre_deg - frame.centre_deg) * 3600 / frame.pixel_arcsec);
  const Rendered belt = make(keys, std::array<int, 4>{0, middle - 40, 2000, middle + 40});
  const Lit rows(belt.image, 0);
  for (int y = 0; y < belt.image.height; ++y) {
    const double half = 0.5 * rows.row(y) * std::tan(from_arcsec(frame.pixel_arcsec));
    found.horizontal_arcsec = std::max(found.horizontal_arcsec, 2 * to_arcsec(std::atan(half)));
  }
  return found;
}

}  // namespace

// oracle: numerics.md section 4 (0.844 from 2 m, 0.775 from 1000 m) and sun_shapes.csv (independent quadrature)
// tolerance: 0.004 is what the project promises; 0.3" for each limb against the table: a quarter of a pixel, half a
// step of
//            the transfer table at the horizon
TEST(SunShape, FlattenedOnTheSeaHorizon) {
  for (const auto &[height_m, known] : {std::pair{2.0, 0.844}, std::pair{1000.0, 0.775}}) {
    SCOPED_TRACE(height_m);
    const ReferenceRow &row = shape("flattening", height_m, "lower limb");
    const Diameters disk = measure_disk(height_m);
    EXPECT_NEAR(disk.vertical_arcsec / disk.horizontal_arcsec, known, 0.004);
    EXPECT_NEAR(disk.vertical_arcsec, row.number("vertical_arcsec"), 0.5);
    EXPECT_NEAR(disk.horizontal_arcsec, row.number("horizontal_arcsec"), 0.5);
    EXPECT_NEAR(disk.low_deg * 3600, row.number("low_apparent_deg") * 3600, 0.3);
    EXPECT_NEAR(disk.high_deg * 3600, row.number("high_apparent_deg") * 3600, 0.3);
  }
}

// oracle: numerics.md section 4 (13.3", 8.95") and sun_shapes.csv, whose README tells the two readings of "at the
// horizon" tolerance: 0.3" and 0.2" are promised; against the table 0.05", a tenth of a pixel: area sampling and
// look-up
TEST(SunShape, GreenRimOfTheUpperLimb) {
  struct Case {
    double height_m;
    const char *name;
    double known_arcsec, promised_arcsec;
  };
  for (const Case &c :
       {Case{2, "650 nm upper limb at apparent", 13.3, 0.3}, Case{2, "true altitude 1 deg", 8.95, 0.2}}) {
    SCOPED_TRACE(c.name);
    const ReferenceRow &row = shape("rim", c.height_m, c.name);
    // The picture's lower half lies inside the disk and above the sea horizon, its upper half shows both limbs.
    const Frame frame{row.number("low_apparent_deg"), 0.5, 8, 128, 256};
    const Rendered picture =
        make(frame.keys() + std::vector<std::string>{"spectrum.samples=2", "spectrum.range_nm=[520.0, 650.0]",
                                                     key("observer.height_m", c.height_m),
                                                     key("sun.altitude_deg", row.number("true_centre_altitude_deg"))});
    ASSERT_EQ(picture.image.wavelength_nm, (std::vector<double>{520, 650}));
    const double green_deg = frame.altitude_deg(Lit(picture.image, 0).top_edge()),
                 red_deg = frame.altitude_deg(Lit(picture.image, 1).top_edge()), rim = (green_deg - red_deg) * 3600;
    EXPECT_NEAR(rim, c.known_arcsec, c.promised_arcsec);
    EXPECT_NEAR(rim, row.number("vertical_arcsec"), 0.05);
    EXPECT_NEAR(green_deg * 3600, row.number("high_apparent_deg") * 3600, 0.1);
    EXPECT_NEAR(red_deg * 3600, row.number("low_apparent_deg") * 3600, 0.1);
  }
}

// oracle: numerics.md section 4: dip 2.48' from 2 m, 55.7' from 1000 m; sun_shapes.csv: the ray that touches the sea
// tolerance: half of the last digit known; 0.2" against the table, half a pixel's step of the transfer table
TEST(SunShape, DipOfTheHorizonAgainstAHugeSun) {
  for (const auto &[height_m, dip_arcmin, digit] : {std::tuple{2.0, 2.48, 0.005}, std::tuple{1000.0, 55.7, 0.05}}) {
    SCOPED_TRACE(height_m);
    const Frame frame{-dip_arcmin / 60, 0.5, 8, 128, 64};
    const Rendered picture = make(only_550 + frame.keys() +
                                  std::vector<std::string>{key("observer.height_m", height_m), "sun.altitude_deg=0.0",
                                                           "sun.diameter_arcmin=600.0"});
    const double dip_deg = -frame.altitude_deg(Lit(picture.image, 0).mean_column());
    EXPECT_NEAR(dip_deg * 60, dip_arcmin, digit);
    EXPECT_NEAR(dip_deg * 3600, -shape("flattening", height_m, "lower limb").number("low_apparent_deg") * 3600, 0.2);
    EXPECT_NEAR(dip_deg * 3600, -picture.report.horizon_altitude_deg.value() * 3600, 0.2);
  }
}

namespace {

const std::vector<std::string> plain_sky{"sky.model=plain", "atmosphere.ozone_DU=0.0", "observer.height_m=0.0"};

}  // namespace

// oracle: ASTM E-490-00a, mean over 5 nm about 450, 550 and 650 nm [W m^-2 nm^-1]: radiance summed over the disk
// tolerance: 0.5 %: refraction at 60 deg makes the disk 0.04 % smaller, the edges of a disk of 128 pixels 0.05 %
TEST(SunLight, DiskWithoutExtinctionCarriesTheSolarSpectrum) {
  const Frame frame{60.0094, 16, 132, 132, 64};
  for (const auto &[nm, irradiance] : {std::pair{450.0, 2.0524}, std::pair{550.0, 1.8661}, std::pair{650.0, 1.58628}}) {
    for (const char *darkening : {"true", "false"}) {
      const Rendered picture = make(
          plain_sky + frame.keys() +
          std::vector<std::string>{"atmosphere.extinction=false", "sun.altitude_deg=60.0", "spectrum.samples=1",
                                   "spectrum.range_nm=[" + std::to_string(nm - 1) + "," + std::to_string(nm + 1) + "]",
                                   std::string("sun.limb_darkening=") + darkening});
      double sum = 0;
      for (float radiance : picture.image.radiance) sum += static_cast<double>(radiance);
      const double pixel_sr = std::pow(from_arcsec(frame.pixel_arcsec), 2);
      EXPECT_NEAR(sum * pixel_sr / irradiance, 1.0, 0.005) << nm << " nm, limb darkening " << darkening;
    }
  }
}

// oracle: Bodhaine et al. 1999, equation 30: Rayleigh optical depth at sea level, 1013.25 hPa, 45 deg
// tolerance: 1 %: gravity and CO2 of that standard differ from ours by a few 0.1 %
TEST(SunLight, ZenithThroughRayleighAirAlone) {
  const auto centre_radiance = [](double nm, const char *extinction) {
    const Frame frame{90, 4, 4, 4, 16};
    const Rendered picture =
        make(plain_sky + frame.keys() +
             std::vector<std::string>{
                 std::string("atmosphere.extinction=") + extinction, "sun.altitude_deg=90.0", "spectrum.samples=1",
                 "spectrum.range_nm=[" + std::to_string(nm - 1) + "," + std::to_string(nm + 1) + "]"});
    double sum = 0;
    for (float radiance : picture.image.radiance) sum += static_cast<double>(radiance);
    return sum;
  };
  for (const double nm : {400.0, 450.0, 550.0, 650.0}) {
    const double um2 = nm * nm * 1e-6;
    const double tau =
        0.0021520 * (1.0455996 - 341.29061 / um2 - 0.90230850 * um2) / (1 + 0.0027059889 / um2 - 85.968563 * um2);
    EXPECT_NEAR(centre_radiance(nm, "true") / centre_radiance(nm, "false") / std::exp(-tau), 1.0, 0.01) << nm;
    EXPECT_NEAR(-std::log(centre_radiance(nm, "true") / centre_radiance(nm, "false")) / tau, 1.0, 0.01) << nm;
  }
}

}  // namespace greenray
