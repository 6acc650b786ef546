// Spectra to colours against published tables and numbers.
#include "image/colour.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <numeric>
#include <sstream>
#include <stdexcept>

#include "image/picture_source.hpp"
#include "support/csv_table.hpp"

namespace greenray {

namespace {

std::vector<double> range(double from, double to, double step) {
  std::vector<double> values;
  for (int i = 0; from + i * step <= to + 1e-9; ++i) values.push_back(from + i * step);
  return values;
}

double sum(const std::vector<double> &values) { return std::accumulate(values.begin(), values.end(), 0.0); }

double hue_deg(const OkLab &lab) { return std::atan2(lab[2], lab[1]) * 180 / std::acos(-1.0); }

}  // namespace

// oracle: CIE 15: the sums of the 1-nm table are 106.8655 (xbar), 106.8569 (ybar), 106.8923 (zbar): equal energy is at
//         x = 0.33331, y = 0.33329, and X = Y = Z to 3e-4
// tolerance: 2e-5 relative, the digits of the 5-nm table
TEST(SpectralWeights, EqualEnergyIsWhite) {
  for (const double step : {1.0, 5.0, 470.0 / 27, 23.5}) {
    const SpectralWeights weights = spectral_weights(range(360, 830, step));
    EXPECT_NEAR(sum(weights.x), 683.002 * 106.8655, 2e-5 * 73000) << step;
    EXPECT_NEAR(sum(weights.y), 683.002 * 106.8569, 2e-5 * 73000) << step;
    EXPECT_NEAR(sum(weights.z), 683.002 * 106.8923, 2e-5 * 73000) << step;
    EXPECT_NEAR(sum(weights.z), sum(weights.y), 4e-4 * sum(weights.y)) << step;
  }
}

// oracle: 1 nm of 1 W m^-2 sr^-1 nm^-1 at the peak of V(lambda) is 683 cd/m2 by the definition of the candela
// tolerance: 1e-4 relative; V falls by about that within the nanometre's hat
TEST(SpectralWeights, LineAt555nm) {
  EXPECT_NEAR(spectral_weights({554, 555, 556}).y[1], 683.002, 0.07);
  EXPECT_DOUBLE_EQ(colour_matching(555)[1], 1.0);
}

// oracle: hats add up to 1, so splitting an interval keeps the integral; a radiance linear in wavelength is met exactly
// tolerance: rounding
TEST(SpectralWeights, UnevenSamplesIntegrateExactly) {
  const std::vector<double> uneven{390.25, 402.5, 421.75, 455.1, 500.9, 561.3, 640.77, 719.5};
  const SpectralWeights coarse = spectral_weights(uneven);
  const SpectralWeights two = spectral_weights({390.25, 719.5});
  EXPECT_NEAR(sum(coarse.x), sum(two.x), 1e-9 * sum(two.x));
  double slanted = 0;
  for (std::size_t i = 0; i < uneven.size(); ++i) slanted += coarse.z[i] * (uneven[i] - 390.25) / (719.5 - 390.25);
  EXPECT_NEAR(slanted, two.z[1], 1e-9 * two.z[1]);
  EXPECT_EQ(spectral_weights({900, 950}).y[0], 0.0);  // nothing is seen there
  EXPECT_THROW(spectral_weights({550}), std::domain_error);
  EXPECT_THROW(spectral_weights({550, 540}), std::domain_error);
}

// oracle: rows of the CIE 1931 1-nm table (ISO 11664-1) that the 5-nm table leaves out
// tolerance: 3e-4, the cubic's own error (1e-3 where zbar is steep); a straight line misses ybar(552) by 1.1e-3
TEST(SpectralWeights, CubicBetweenRows) {
  EXPECT_NEAR(colour_matching(552)[1], 0.9980983, 3e-4);
  EXPECT_NEAR(colour_matching(598)[0], 1.0628068, 3e-4);
  EXPECT_NEAR(colour_matching(472)[2], 1.1878243, 1e-3);
  EXPECT_NEAR(colour_matching(502)[1], 0.3546858, 3e-4);
  EXPECT_NEAR(colour_matching(503)[0], 0.0024249, 3e-4);
}

// oracle: the CIE D65 table is the white of Rec. 709: R = G = B.  tolerance: 4e-4, the rounding of 0.3127, 0.3290
TEST(Colour, DaylightIsNeutral) {
  std::ifstream in(GREENRAY_TEST_DATA "/image/cie_d65_5nm.csv");
  std::stringstream text;
  text << in.rdbuf();
  const CsvTable d65 = CsvTable::parse(text.str(), "cie_d65_5nm.csv");
  SpectralImage image;
  image.width = image.height = 1;
  image.wavelength_nm = d65.column("nm");
  for (const double power : d65.column("S")) image.radiance.push_back(static_cast<float>(power));
  const Rgb rgb = rgb_from_spectral(image).pixel(0);
  const double y = static_cast<double>(luminance_cd_m2(image)[0]);
  for (const double channel : rgb) EXPECT_NEAR(channel / y, 1.0, 4e-4);
  EXPECT_NEAR(luminance(rgb), y, 1e-6 * y);
}

// oracle: the matrix printed in IEC 61966-2-1 (four digits), and white has Y = 1.  tolerance: its last digit
TEST(Colour, Rec709Matrix) {
  const Xyz red = xyz_from_rgb({1, 0, 0}), green = xyz_from_rgb({0, 1, 0}), blue = xyz_from_rgb({0, 0, 1});
  const double printed[3][3] = {{0.4124, 0.2126, 0.0193}, {0.3576, 0.7152, 0.1192}, {0.1805, 0.0722, 0.9505}};
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(red[c], printed[0][c], 1e-4);
    EXPECT_NEAR(green[c], printed[1][c], 1e-4);
    EXPECT_NEAR(blue[c], printed[2][c], 1e-4);
  }
  EXPECT_NEAR(luminance({1, 1, 1}), 1.0, 1e-15);
  const Rgb back = rgb_from_xyz(xyz_from_rgb({0.1, -0.2, 3}));
  EXPECT_NEAR(back[0], 0.1, 1e-14);
  EXPECT_NEAR(back[1], -0.2, 1e-14);
  EXPECT_NEAR(back[2], 3, 1e-14);
}

// oracle: IEC 61966-2-1; middle grey 0.2140 is 127.5/255, code 188 is 0.5029 linear.  tolerance: printed digits
TEST(Colour, SrgbCurve) {
  EXPECT_NEAR(srgb_encode(0.214041), 0.5, 1e-6);
  EXPECT_NEAR(srgb_decode(188 / 255.0), 0.5028865, 1e-6);
  EXPECT_NEAR(srgb_encode(0.001), 0.01292, 1e-15);
  EXPECT_NEAR(srgb_encode(1), 1, 1e-15);
  EXPECT_NEAR(srgb_encode(-0.214041), -0.5, 1e-6);
  for (int code = 0; code <= 255; ++code) EXPECT_NEAR(srgb_encode(srgb_decode(code / 255.0)), code / 255.0, 1e-7);
}

// oracle: Ottosson 2020: white is (1,0,0); sRGB red is L 0.6280 a 0.2249 b 0.1258.  tolerance: printed digits
TEST(Colour, OkLab) {
  const OkLab white = oklab_from_rgb({1, 1, 1}), red = oklab_from_rgb({1, 0, 0});
  EXPECT_NEAR(white[0], 1, 1e-6);
  EXPECT_NEAR(white[1], 0, 1e-6);
  EXPECT_NEAR(white[2], 0, 1e-6);
  EXPECT_NEAR(red[0], 0.6280, 1e-4);
  EXPECT_NEAR(red[1], 0.2249, 1e-4);
  EXPECT_NEAR(red[2], 0.1258, 1e-4);
}

// oracle: what the mapping is for: inside [0,1], hue and lightness as before, colours inside untouched
// tolerance: 1e-3 (the last clamp of at most 1e-7 in linear light, next to black)
TEST(Colour, GamutMappingKeepsHue) {
  for (const double wavelength_nm : {450.0, 490.0, 510.0, 530.0, 550.0, 580.0, 620.0}) {
    Rgb colour = rgb_from_xyz(colour_matching(wavelength_nm));
    for (double &channel : colour) channel *= 0.3;
    const OkLab before = oklab_from_rgb(colour);
    EXPECT_TRUE(map_into_gamut(colour)) << wavelength_nm;
    const OkLab after = oklab_from_rgb(colour);
    for (const double channel : colour) EXPECT_TRUE(channel >= 0 && channel <= 1) << wavelength_nm;
    EXPECT_NEAR(after[0], before[0], 1e-3) << wavelength_nm;
    EXPECT_NEAR(hue_deg(after), hue_deg(before), 0.1) << wavelength_nm;
    EXPECT_LT(std::hypot(after[1], after[2]), std::hypot(before[1], before[2]));
    EXPECT_FALSE(map_into_gamut(colour));
  }
  Rgb inside{0.2, 0.9, 1.0};
  EXPECT_FALSE(map_into_gamut(inside));
  EXPECT_EQ(inside, (Rgb{0.2, 0.9, 1.0}));
  Rgb brighter{3, 2.9, 2.8};
  EXPECT_TRUE(map_into_gamut(brighter));
  for (const double channel : brighter) EXPECT_NEAR(channel, 1, 1e-5);
}

// oracle: more light than a number can tell stays that in any primaries, also where a matrix has a 0 (Display P3: red
// has
//         no Z) or a negative number (ACES AP0); NaN and -infinity are no light.  tolerance: none
TEST(Primaries, InfiniteLightStaysInfinite) {
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::array<double, 8> &xy :
       {std::array<double, 8>{0.68, 0.32, 0.265, 0.69, 0.15, 0.06, 0.3127, 0.329},
        std::array<double, 8>{0.7347, 0.2653, 0, 1, 0.0001, -0.077, 0.32168, 0.33767}}) {
    std::vector<float> planes{inf, inf, 5, nan,   // R
                              inf, 5,   5, -inf,  // G
                              inf, 5,   5, inf};  // B
    transform_planes(xyz_of_primaries(xy), planes);
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(planes[4 * c], inf);
      EXPECT_EQ(planes[4 * c + 1], inf);
      EXPECT_TRUE(std::isfinite(planes[4 * c + 2]));
      EXPECT_TRUE(std::isnan(planes[4 * c + 3]));
    }
  }
}

}  // namespace greenray
