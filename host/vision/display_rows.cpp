#include "vision/display_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "image/colour.hpp"
#include "support/fast_math.hpp"
#include "vision/acuity.hpp"

namespace greenray::vision {

namespace {

constexpr std::uint32_t pieces_bits = 7;  // 128 pieces an octave
constexpr std::uint32_t fraction_bits = 23 - pieces_bits;

std::uint32_t index_of(float x) { return std::bit_cast<std::uint32_t>(x) >> fraction_bits; }
const std::uint32_t first_index = index_of(static_cast<float>(darkest_cd_m2));

struct RgbMatrix {
  float m[3][3];
  float white[3];  // XYZ of (1,1,1)
  RgbMatrix() {
    for (std::size_t c = 0; c < 3; ++c) {
      Xyz unit{0, 0, 0};
      unit[c] = 1;
      const Rgb column = rgb_from_xyz(unit);
      for (std::size_t r = 0; r < 3; ++r) m[r][c] = static_cast<float>(column[r]);
      white[c] = static_cast<float>(xyz_from_rgb({1, 1, 1})[c]);
    }
  }
};

const RgbMatrix &rgb_matrix() {
  static const RgbMatrix matrix;
  return matrix;
}

/// Luminance of the mix, and the share of it that has colour.
struct Mixed {
  float luminance, coloured;
};

Mixed mix(RodVision rods, float photopic, float scotopic) {
  if (rods == RodVision::cie191) {
    const Mesopic m = cie191(static_cast<double>(photopic), static_cast<double>(scotopic));
    return {static_cast<float>(m.luminance_cd_m2), static_cast<float>(m.cone_share)};
  }
  if (photopic >= static_cast<float>(top_of_mesopic_cd_m2)) return {photopic, 1.0F};
  const auto share = static_cast<float>(cone_share(static_cast<double>(photopic)));
  const float cones = share * photopic, grey = (1 - share) * scotopic / static_cast<float>(scotopic_per_photopic_white);
  const float sum = cones + grey;
  return {sum, sum > 0 ? cones / sum : 0.0F};
}

}  // namespace

ToneTable::ToneTable(const ToneCurve &curve) {
  const std::uint32_t last = index_of(static_cast<float>(brightest_cd_m2)) + 2;
  for (std::uint32_t i = first_index; i <= last; ++i) {
    const auto edge = static_cast<double>(std::bit_cast<float>(i << fraction_bits));
    fraction_.push_back(static_cast<float>(curve.display_fraction(std::max(edge, darkest_cd_m2))));
  }
  for (std::size_t i = 1; i < fraction_.size(); ++i) fraction_[i] = std::max(fraction_[i], fraction_[i - 1]);
}

float ToneTable::fraction(float world_cd_m2) const {
  if (!(world_cd_m2 >= static_cast<float>(darkest_cd_m2))) return 0;
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(world_cd_m2);
  const std::size_t i = std::min<std::size_t>((bits >> fraction_bits) - first_index, fraction_.size() - 2);
  const float t = static_cast<float>(bits & ((1U << fraction_bits) - 1)) * (1.0F / (1U << fraction_bits));
  return std::min(fraction_[i] + t * (fraction_[i + 1] - fraction_[i]), fraction_[i + 1]);
}

void display_rows(const ToneTable &tone, RodVision rods, std::size_t count, const float *x, const float *y,
                  const float *z, float *luminance, const float *scotopic, float *rgb) {
  const RgbMatrix &matrix = rgb_matrix();
  for (std::size_t i = 0; i < count; ++i) {
    const Mixed mixed = rods == RodVision::off ? Mixed{luminance[i], 1.0F} : mix(rods, luminance[i], scotopic[i]);
    luminance[i] = mixed.luminance;
    const float shown = tone.fraction(mixed.luminance);
    const float coloured = y[i] > 1e-30F ? shown * mixed.coloured / y[i] : 0.0F;
    const float grey = y[i] > 1e-30F ? shown * (1 - mixed.coloured) : shown;
    float *to = rgb + 3 * i;
    for (std::size_t c = 0; c < 3; ++c)
      to[c] = coloured * (matrix.m[c][0] * x[i] + matrix.m[c][1] * y[i] + matrix.m[c][2] * z[i]) + grey;
  }
}

namespace {

/// Ottosson's matrices, as in image/colour.cpp; rgb of cube roots r is sum_j m[c][j] r[j]^3.
struct OkMatrices {
  float lms_of_rgb[3][3], rgb_of_lms[3][3], lab_of_roots[3][3], roots_of_lab[3][3];
  OkMatrices() {
    // found by probing the functions of colour.hpp, which are their one home
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, 3> unit{0, 0, 0};
      unit[c] = 1;
      const auto rgb = ok_rgb_from_cones(unit), cones = ok_cones_from_rgb(unit);
      const auto lab = ok_lab_from_roots(unit), roots = ok_roots_from_lab(unit);
      for (std::size_t r = 0; r < 3; ++r) {
        rgb_of_lms[r][c] = static_cast<float>(rgb[r]), lms_of_rgb[r][c] = static_cast<float>(cones[r]);
        lab_of_roots[r][c] = static_cast<float>(lab[r]), roots_of_lab[r][c] = static_cast<float>(roots[r]);
      }
    }
  }
};

float signed_cbrt(float x) {
  const float size = std::abs(x);
  return size < 1e-30F ? 0.0F : std::copysign(fast_pow(size, 1.0F / 3.0F), x);
}

/// A colour on the straight way from a grey (t = 0) to itself (t = 1): cube roots base + t slope.
struct ChromaLine {
  float base;
  float slope[3];
};

float channel_at(const ChromaLine &line, const float weights[3], float t, float *derivative) {
  float value = 0, change = 0;
  for (std::size_t j = 0; j < 3; ++j) {
    const float root = line.base + t * line.slope[j], square = root * root;
    value += weights[j] * square * root;
    change += weights[j] * 3 * square * line.slope[j];
  }
  *derivative = change;
  return value;
}

/// Where a channel that is within its bound at `from` and beyond it at `to` meets it: Newton's steps, kept in a
/// bracket.
float meets_bound(const ChromaLine &line, const float weights[3], float bound, bool above, float from, float to) {
  float inside = from, outside = to, t = 0.5F * (from + to);
  for (int i = 0; i < 12; ++i) {
    float slope = 0;
    const float off = channel_at(line, weights, t, &slope) - bound;
    ((above ? off > 0 : off < 0) ? outside : inside) = t;
    const float next = slope != 0 ? t - off / slope : -1.0F;
    const bool good = next > inside && next < outside;
    const float step_to = good ? next : 0.5F * (inside + outside);
    if (std::abs(step_to - t) < 1e-6F) break;
    t = step_to;
  }
  return t;  // to 1e-6; what is left is clipped
}

/// Lightness of the grey that a colour moves towards: its own in the dark, between that and 0.5 above.
float grey_to_aim_at(float lightness, float chroma) {
  constexpr float pull = 0.5F;
  const float above = lightness - 0.5F, e = 0.5F + above + pull * chroma;
  if (above <= 0) return clamped(lightness, 0, 1);
  return clamped(0.5F * (1 + e - std::sqrt(std::max(e * e - 2 * above, 0.0F))), 0, 1);
}

void into_gamut(float rgb[3]) {
  static const OkMatrices ok;
  float roots[3], lab[3] = {0, 0, 0};
  for (std::size_t j = 0; j < 3; ++j)
    roots[j] = signed_cbrt(ok.lms_of_rgb[j][0] * rgb[0] + ok.lms_of_rgb[j][1] * rgb[1] + ok.lms_of_rgb[j][2] * rgb[2]);
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t j = 0; j < 3; ++j) lab[r] += ok.lab_of_roots[r][j] * roots[j];
  const float strongest = std::max({rgb[0], rgb[1], rgb[2]}), own = clamped(lab[0], 0, 1);
  const float aimed = grey_to_aim_at(lab[0], std::sqrt(lab[1] * lab[1] + lab[2] * lab[2]));
  // the gamut is hollow below its corners: a colour that is hardly too strong must not be pulled through the outside
  const float grey = own + (aimed - own) * clamped(strongest - 1, 0, 1);
  ChromaLine line{grey, {0, 0, 0}};
  for (std::size_t j = 0; j < 3; ++j) line.slope[j] = ok.roots_of_lab[j][1] * lab[1] + ok.roots_of_lab[j][2] * lab[2];
  // the first place where any channel leaves: a channel is a cubic, which may come back before the end
  constexpr int stretches = 8;
  float kept = 1, slope = 0;
  for (int k = 1; k <= stretches && kept == 1; ++k) {
    const float from = static_cast<float>(k - 1) / stretches, to = static_cast<float>(k) / stretches;
    float leaves = 2;
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = channel_at(line, ok.rgb_of_lms[c], to, &slope);
      if (value > 1) leaves = std::min(leaves, meets_bound(line, ok.rgb_of_lms[c], 1, true, from, to));
      else if (value < 0) leaves = std::min(leaves, meets_bound(line, ok.rgb_of_lms[c], 0, false, from, to));
    }
    if (leaves < 2) kept = std::min(leaves, 0.999999F);
  }
  for (std::size_t c = 0; c < 3; ++c) rgb[c] = channel_at(line, ok.rgb_of_lms[c], kept, &slope);
}

}  // namespace

std::size_t gamut_rows(std::size_t count, float *rgb) {
  std::size_t moved = 0;
  for (std::size_t i = 0; i < count; ++i) {
    float *pixel = rgb + 3 * i;
    const float least = std::min({pixel[0], pixel[1], pixel[2]}), most = std::max({pixel[0], pixel[1], pixel[2]});
    if (least < -1e-6F || most > 1 + 1e-6F) {
      into_gamut(pixel);
      ++moved;
    }
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = clamped(pixel[c], 0, 1);
  }
  return moved;
}

}  // namespace greenray::vision
