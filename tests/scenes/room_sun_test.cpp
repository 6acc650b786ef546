// The Sun of a room through the air above it: how much of it arrives, from where, and from which part of its disk.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "render/room_report.hpp"
#include "render/room_sun.hpp"
#include "render/spectrum.hpp"
#include "scene/scene_file.hpp"
#include "support/angle.hpp"
#include "support/csv_table.hpp"
#include "support_code/room_photons.hpp"

namespace greenray {
namespace {

constexpr double wavelength_nm = 450;

/// A black floor of 4 m x 4 m under the Sun; `air` are lines of [atmosphere], `sun` of its light.
RoomScene floor_under(const std::string &sun, const std::string &air = "ozone_DU = 0.0\n", double albedo = 0) {
  std::ostringstream text;
  text << "greenray = 1\n[atmosphere]\n"
       << air << "[camera]\nfrom = [0, -0.1, 5]\nto = [0, 0, 0]\nfov_deg = 10\n"
       << "[[quad]]\ncorner = [-2, -2, 0]\nedge_u = [4, 0, 0]\nedge_v = [0, 4, 0]\nreflectance = " << albedo
       << "\n[[light]]\nkind = \"sun\"\n"
       << sun << "[spectrum]\nsamples = 1\nrange_nm = [" << wavelength_nm << ", " << wavelength_nm << "]\n";
  return parse_room("floor.toml", text.str());
}

RoomSun sun_in(const RoomScene &scene) { return sun_through_air(scene, *sun_of(scene), {wavelength_nm}); }

double e490(double nm) {
  return CsvTable::embedded("host/data/solar_extraterrestrial_5nm.csv")
      .interpolate("nm", "E490", nm, CsvTable::Outside::clamp);
}

/// Vertical optical depth of air at sea level, 45 N, 1013.25 mb. source: Bodhaine et al. 1999, eq 30
double bodhaine_depth(double nm) {
  const double l2 = 1e-6 * nm * nm;  // um^2
  return 0.0021520 * (1.0455996 - 341.29061 / l2 - 0.90230850 * l2) / (1 + 0.0027059889 / l2 - 85.968563 * l2);
}

/// source: Kasten & Young, "Revised optical air mass tables and approximation formula", Appl. Opt. 28 (1989), eq 3
double kasten_young(double altitude_deg) {
  return 1 / (std::sin(to_rad(altitude_deg)) + 0.50572 * std::pow(altitude_deg + 6.07995, -1.6364));
}

/// Power that lands, over the floor.
double landed_W_m2(const RoomScene &scene, std::uint32_t photons) {
  const LandedPhotons landed = land_photons(scene, photons);
  double power_W = 0;
  for (std::size_t i = 0; i < landed.count(); ++i) power_W += static_cast<double>(landed.map.power_W[i]);
  return power_W / 16;
}

// oracle: Beer and Lambert: E490 exp(-tau m) with the published depth of Rayleigh scattering and the published air mass
// tolerance: of tau m 0.8 %: air at 45 N weighs 0.4 % more than US76's, the formula of the air mass is good to 0.5 %
TEST(RoomSun, RayleighAlone) {
  for (const double altitude_deg : {90.0, 30.0, 10.0, 3.0, 1.0}) {
    const RoomSun sun = sun_in(floor_under("apparent_altitude_deg = " + std::to_string(altitude_deg) + "\n"));
    const double depth = bodhaine_depth(wavelength_nm) * kasten_young(altitude_deg);
    EXPECT_NEAR(sun.optical_depth[0], depth, 0.008 * depth) << altitude_deg;
    // The mean of the disk, by the rule of midpoints over a thousand chords.
    double through = 0, whole = 0;
    for (int i = 0; i < 1000; ++i) {
      const double x = (i + 0.5) / 500 - 1, chord = std::sqrt(1 - x * x),
                   at = std::min(altitude_deg + 0.26656 * x, 90.0);
      whole += chord, through += chord * std::exp(-bodhaine_depth(wavelength_nm) * kasten_young(at));
    }
    EXPECT_NEAR(-std::log(sun.irradiance_W_m2_nm[0] / e490(wavelength_nm)), -std::log(through / whole), 0.01 * depth);
  }
}

// oracle: Angstrom's turbidity: the aerosol's vertical depth at 550 nm is (turbidity - 1) times the air's, falling with
//         wavelength^-1.3; ozone 300 DU at 600 nm: 0.038 to 0.041 (Serdyuchenko et al., published cross-section
//         5.0e-25 m^2 and 8.06e22 molecules/m^2); both at the zenith
// tolerance: 1 %, as above; the range itself
TEST(RoomSun, AerosolAndOzoneAtTheZenith) {
  const std::string zenith = "altitude_deg = 90.0\n";
  const double clear = sun_in(floor_under(zenith)).optical_depth[0];
  const double hazy =
      sun_in(floor_under(zenith, "ozone_DU = 0.0\naerosol = { turbidity = 3.0, angstrom = 1.3 }\n")).optical_depth[0];
  EXPECT_NEAR((hazy - clear) / (2 * bodhaine_depth(550) * std::pow(wavelength_nm / 550, -1.3)), 1, 0.01);
  const RoomScene with = floor_under(zenith, ""), without = floor_under(zenith);
  const double ozone = sun_through_air(with, *sun_of(with), {600}).optical_depth[0] -
                       sun_through_air(without, *sun_of(without), {600}).optical_depth[0];
  EXPECT_GT(ozone, 0.038);
  EXPECT_LT(ozone, 0.043);
}

// oracle: refraction at 10 and 1 degree (the known answers of US76, 589.3 nm), 1.0011 times as much at 550 nm; without
//         air at all (a site at 100 km, of a millionth of the air) none, and all of E490
// tolerance: 0.2 %; 1e-5
TEST(RoomSun, StandsWhereItIsSeen) {
  for (const auto &[apparent_deg, refraction_arcsec] : {std::pair{10.0, 312.8009}, {1.0, 1410.1253}}) {
    const double true_deg = apparent_deg - refraction_arcsec / 3600;
    std::ostringstream given;
    given.precision(12);
    given << "altitude_deg = " << true_deg << "\nazimuth_deg = 90\n";
    const RoomScene scene = floor_under(given.str());
    const RoomSun sun = sun_in(scene);
    EXPECT_NEAR(to_arcsec(to_rad(sun.apparent_altitude_deg - true_deg)), 1.0011 * refraction_arcsec,
                2e-3 * refraction_arcsec);
    const room_twin::Light light = room_looks(scene).lights[0];
    EXPECT_NEAR(static_cast<double>(light.direction[2]), -std::sin(to_rad(sun.apparent_altitude_deg)), 1e-7);
    EXPECT_NEAR(static_cast<double>(light.direction[0]), -std::cos(to_rad(sun.apparent_altitude_deg)), 1e-7);
  }
  const RoomSun outside = sun_in(floor_under("altitude_deg = 20\nsite_height_m = 100000.0\n", ""));
  EXPECT_NEAR(outside.apparent_altitude_deg, 20, 1e-6);
  EXPECT_NEAR(outside.irradiance_W_m2_nm[0] / e490(wavelength_nm), 1, 1e-5);
}

// oracle: the picture of the sky: radiance over the Sun's disk less that of the sky beside it, summed over solid angle
// tolerance: 0.4 %: the edge of the disk, sampled 16 times a pixel, and the sky's own slope
TEST(RoomSun, AgreesWithPicturesOfTheSky) {
  const std::string air = "ozone_DU = 300.0\naerosol = { visibility_km = 40.0, angstrom = 1.3 }\n";
  for (const double altitude_deg : {25.0, 4.0}) {
    std::ostringstream text;
    text << "greenray = 1\n[atmosphere]\n"
         << air << "[observer]\nheight_m = 0.0\naltitude_deg = " << altitude_deg
         << "\nfov_deg = 0.7\nresolution = [160, 160]\n[sun]\napparent_altitude_deg = " << altitude_deg
         << "\n[spectrum]\nsamples = 1\nrange_nm = [" << wavelength_nm << ", " << wavelength_nm
         << "]\n[tracing]\nquality = { spp = 16 }\n";
    const Scene scene = parse_scene("sky.toml", text.str());
    const Rendered picture = render(scene, plan_render(scene, {}), {}, shared_device());
    double seen_W_m2_nm = 0;
    const double pixel = 2 * std::tan(to_rad(0.35)) / 160;
    double sky = 0;
    for (std::size_t row = 0; row < 160; ++row) sky += static_cast<double>(picture.image.radiance[160 * row]) / 160;
    for (const float radiance : picture.image.radiance)
      seen_W_m2_nm += (static_cast<double>(radiance) - sky) * pixel * pixel;
    const RoomSun sun = sun_in(floor_under("apparent_altitude_deg = " + std::to_string(altitude_deg) + "\n", air));
    // A refracted disk is lower than it is wide: it shows less solid angle at the same radiance.
    const RoomSun above =
        sun_in(floor_under("apparent_altitude_deg = " + std::to_string(altitude_deg + 0.2) + "\n", air));
    const double flattened = (above.true_altitude_deg - sun.true_altitude_deg) / 0.2;
    EXPECT_NEAR(seen_W_m2_nm * flattened / sun.irradiance_W_m2_nm[0], 1, 4e-3) << altitude_deg;
  }
}

// oracle: E sin(altitude) lands on the floor, and a white one shows that over pi to the eye
// tolerance: 5 Poisson errors of what lands; 2 % of the picture
TEST(RoomSun, LightsAFloor) {
  const std::string sun = "altitude_deg = 30.0\n";
  const RoomScene scene = floor_under(sun);
  const RoomSun through = sun_in(scene);
  const double expected = through.irradiance_W_m2_nm[0] * std::sin(to_rad(through.apparent_altitude_deg));
  EXPECT_NEAR(landed_W_m2(scene, 400000), expected, 5 * expected / std::sqrt(80000));
  RoomOptions options;
  options.size = {16, 16};
  options.photons = 400000;
  const RoomPicture picture = render_room(floor_under(sun, "ozone_DU = 0.0\n", 0.5), options, shared_device());
  double mean = 0;
  for (const float x : picture.image.radiance) mean += static_cast<double>(x) / 256;
  EXPECT_NEAR(mean, 0.5 * expected / M_PI, 0.02 * expected / 2 / M_PI);
}

// oracle: the moment of Neckel & Labs' profile: integral of (1 - mu^2) I(mu) 2 mu dmu over that of I, by Simpson; for
// an
//         even disk 1/2. Directions at the overhead Sun: (1 - cos)/(1 - cos of its radius) is 1 - mu^2
// tolerance: 5 standard errors, of numbers between 0 and 1.4
TEST(RoomSun, ItsLimbIsDark) {
  const CsvTable table = CsvTable::embedded("host/data/limb_darkening_neckel_labs1994.csv");
  double sum = 0, moment = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double mu = i / 1000.0, simpson = i % 1000 == 0 ? 1 : i % 2 == 1 ? 4 : 2;
    double intensity = 0;
    for (int k = 0; k < 6; ++k)
      intensity += std::pow(mu, k) * table.interpolate("nm", "A" + std::to_string(k), wavelength_nm);
    sum += simpson * mu * intensity, moment += simpson * mu * intensity * (1 - mu * mu);
  }
  for (const bool dark : {true, false}) {
    RoomScene scene = floor_under("apparent_altitude_deg = 90.0\ndiameter_deg = 20.0\nlimb_darkening = " +
                                  std::string(dark ? "true\n" : "false\n"));
    scene.spectrum.samples = 8;  // as many as room_twin has, all the same
    const RoomLooks looks = room_looks(scene);
    const room_twin::Looks device{nullptr, looks.spectra.data(), nullptr, nullptr, looks.lights.data(), nullptr};
    constexpr unsigned photons = 200000;
    double power = 0, seen = 0;
    for (unsigned id = 0; id < photons; ++id) {
      const auto place = room_twin::photon_words(1, 0, id, 0, 0), aim = room_twin::photon_words(1, 0, id, 0, 1);
      room_twin::Vec3 from, direction;
      room_twin::Bundle b{};
      b.weight[0] = 1;
      room_twin::emit_photon(nullptr, &device, 0, place, aim, &from, &direction);
      room_twin::darken_limb(&device, looks.lights[0].limb, room_twin::unit_interval(aim.word[0]), &b);
      const double weight = static_cast<double>(b.weight[0]);
      power += weight, seen += weight * (1 + static_cast<double>(direction.z)) / (1 - std::cos(to_rad(10.0)));
    }
    EXPECT_NEAR(power / photons, 1, 5 * 0.3 / std::sqrt(photons)) << dark;
    EXPECT_NEAR(seen / power, dark ? moment / sum : 0.5, 5 * 0.35 / std::sqrt(photons)) << dark;
  }
}

// oracle: the low Sun is red: Rayleigh's depth at 450 nm is 4.4 times that at 650 nm (Bodhaine et al. 1999)
// tolerance: 1 %
TEST(RoomSun, ReddensTheSpectrumOfItsLight) {
  RoomScene scene = floor_under("apparent_altitude_deg = 2.0\n");
  scene.spectrum.range_nm = {450, 650};
  scene.spectrum.samples = 2;
  const RoomLooks looks = room_looks(scene);
  const float *power = &looks.spectra[static_cast<std::size_t>(looks.lights[0].power) * 2];
  const double blue = bodhaine_depth(450), red = bodhaine_depth(650), mass = kasten_young(2);
  const double ratio = e490(450) / e490(650) * std::exp((red - blue) * mass);
  EXPECT_NEAR(static_cast<double>(power[0] / power[1]) / ratio, 1, 0.008 * (blue - red) * mass + 0.01);
}

std::string complaint_about(const std::string &sun, const std::string &air = "") {
  try {
    const RoomScene scene = floor_under(sun, air);
    (void)room_looks(scene);
  } catch (const InputError &error) {
    return error.what();
  }
  return "";
}

// oracle: user-experience.md: file:line:column, what was expected
// tolerance: none
TEST(RoomSun, SaysWhatIsWrong) {
  const auto says = [](const std::string &sun, const std::string &words, const std::string &air = "") {
    const std::string found = complaint_about(sun, air);
    EXPECT_NE(found.find("floor.toml:"), std::string::npos) << sun << found;
    EXPECT_NE(found.find(words), std::string::npos) << sun << found;
  };
  says("altitude_deg = -3.0\n", "not in the sky");
  says("apparent_altitude_deg = -0.1\n", "not in the sky");
  says("altitude_deg = 30\napparent_altitude_deg = 30\n", "found both");
  says("azimuth_deg = 30\n", "apparent_altitude_deg (as seen)");
  says("altitude_deg = 30\ncolour = [1, 0, 0]\n", "irradiance_W_m2");
  says("altitude_deg = 30\nirradiance_W_m2 = 5\nsite_height_m = 100\n", "irradiance_W_m2");
  says("altitude_deg = 30\nsite_height_m = 100\n", "own profile", "profile = \"us76\"\n");
  says("altitude_deg = 30\n", "found both", "aerosol = { visibility_km = 5, turbidity = 2 }\n");
  says("altitude_deg = 3\n", "no light", "aerosol = { visibility_km = 0.05 }\n");
}

// oracle: what the scene says: the plan names the air, both altitudes and the depth; a given irradiance leaves it out
// tolerance: none
TEST(RoomSun, ThePlanSaysWhatIsModelled) {
  const auto plan = [](const std::string &sun) {
    const RoomScene scene = floor_under(sun);
    RoomOptions options;
    options.size = scene.camera.resolution;
    return room_plan_json(scene, options).dump();
  };
  EXPECT_NE(plan("altitude_deg = 10.0\n").find("seen at 10.08"), std::string::npos);
  EXPECT_NE(plan("altitude_deg = 10.0\nirradiance_W_m2 = 100\n").find("is what arrives"), std::string::npos);
  EXPECT_NE(room_hash(floor_under("altitude_deg = 10.0\n")), room_hash(floor_under("altitude_deg = 10.0\n", "")));
}

}  // namespace
}  // namespace greenray
