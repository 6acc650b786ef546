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

/// Colours in work at once, one array for each quantity: what follows is arithmetic over them without branches.
constexpr int lanes = 16;
using Lanes = float[lanes];

/* Colours on straight ways from a grey (t = 0) to themselves (t = 1), in the space of OKLab's cube roots:
   root j = base + t slope[j], channel c = sum over j of weight[c][j] root_j^3. */
struct ChromaLines {
  Lanes base, slope[3];
};

[[gnu::always_inline]] inline float signed_cbrt(float x) {
  const float size = x < 0 ? -x : x;
  const float root = fast_pow(size > 1e-30F ? size : 1e-30F, 1.0F / 3.0F);
  return size < 1e-30F ? 0.0F : x < 0 ? -root : root;
}

/// How far the worst channel is beyond [0, 1] at t: below 0 inside.
[[gnu::always_inline]] inline void beyond_gamut(const ChromaLines &line, const OkMatrices &ok, const Lanes t,
                                                Lanes off) {
  for (int i = 0; i < lanes; ++i) {
    float cube[3];
    for (std::size_t j = 0; j < 3; ++j) {
      const float root = line.base[i] + t[i] * line.slope[j][i];
      cube[j] = root * root * root;
    }
    float worst = -1;
    for (std::size_t c = 0; c < 3; ++c) {
      const float value = ok.rgb_of_lms[c][0] * cube[0] + ok.rgb_of_lms[c][1] * cube[1] + ok.rgb_of_lms[c][2] * cube[2];
      const float here = value - 1 > -value ? value - 1 : -value;
      worst = here > worst ? here : worst;
    }
    off[i] = worst;
  }
}

/* Lightness of the grey that a colour moves towards: its own in the dark, between that and 0.5 above.
   strongest: channel of the colour; the gamut is hollow below its corners: a colour that is hardly too strong must not
   be pulled through the outside */
[[gnu::always_inline]] inline float grey_to_aim_at(float lightness, float chroma, float strongest) {
  constexpr float pull = 0.5F;
  const float above = lightness - 0.5F, e = 0.5F + above + pull * chroma, root = e * e - 2 * above;
  const float between = 0.5F * (1 + e - std::sqrt(root > 0 ? root : 0.0F));
  const float aimed = clamped(above <= 0 ? lightness : between, 0, 1), own = clamped(lightness, 0, 1);
  return own + (aimed - own) * clamped(strongest - 1, 0, 1);
}

[[gnu::always_inline]] inline void lines_to_grey(const OkMatrices &ok, const Lanes rgb[3], ChromaLines &line) {
  for (int i = 0; i < lanes; ++i) {
    float roots[3], lab[3];
    for (std::size_t j = 0; j < 3; ++j)
      roots[j] = signed_cbrt(ok.lms_of_rgb[j][0] * rgb[0][i] + ok.lms_of_rgb[j][1] * rgb[1][i] +
                             ok.lms_of_rgb[j][2] * rgb[2][i]);
    for (std::size_t r = 0; r < 3; ++r)
      lab[r] = ok.lab_of_roots[r][0] * roots[0] + ok.lab_of_roots[r][1] * roots[1] + ok.lab_of_roots[r][2] * roots[2];
    const float first = rgb[0][i] > rgb[1][i] ? rgb[0][i] : rgb[1][i],
                strongest = first > rgb[2][i] ? first : rgb[2][i];
    // Bleached eyes see colours that no light has. OKLab makes them darker than they are, which none of the gamut is
    // below 0.968 of the grey of its luminance, and stronger than the spectrum (0.4), which would pull them to
    // mid-grey.
    const float y = 0.2126F * rgb[0][i] + 0.7152F * rgb[1][i] + 0.0722F * rgb[2][i];
    const float least = y > 0 ? 0.96F * signed_cbrt(y) : 0.0F, lightness = lab[0] > least ? lab[0] : least;
    const float chroma = std::sqrt(lab[1] * lab[1] + lab[2] * lab[2]), weaker = chroma > 0.4F ? 0.4F / chroma : 1.0F;
    line.base[i] = grey_to_aim_at(lightness, weaker * chroma, strongest);
    for (std::size_t j = 0; j < 3; ++j)
      line.slope[j][i] =
          lightness - line.base[i] + weaker * (ok.roots_of_lab[j][1] * lab[1] + ok.roots_of_lab[j][2] * lab[2]);
  }
}

/// The first place where a line leaves the gamut: a channel is a cubic, which may come back before the end.
[[gnu::always_inline]] inline void leave_gamut(const ChromaLines &line, const OkMatrices &ok, Lanes kept) {
  constexpr int stretches = 8, refinements = 9;
  Lanes in, out, off_in, off_out, t, off;
  for (int i = 0; i < lanes; ++i) in[i] = 0, out[i] = 2, off_in[i] = -1e-6F, off_out[i] = 1, t[i] = 0;
  beyond_gamut(line, ok, t, off);
  for (int i = 0; i < lanes; ++i) off_in[i] = off[i] < -1e-6F ? off[i] : -1e-6F;
  for (int k = 1; k <= stretches; ++k) {
    for (int i = 0; i < lanes; ++i) t[i] = static_cast<float>(k) / stretches;
    beyond_gamut(line, ok, t, off);
    for (int i = 0; i < lanes; ++i) {
      const bool searching = out[i] > 1, left = off[i] > 0;
      off_out[i] = searching && left ? off[i] : off_out[i];
      off_in[i] = searching && !left ? (off[i] < -1e-6F ? off[i] : -1e-6F) : off_in[i];
      in[i] = searching && !left ? t[i] : in[i];
      out[i] = searching && left ? t[i] : out[i];
    }
  }
  for (int i = 0; i < lanes; ++i) out[i] = out[i] > 1 ? 1.0F : out[i];
  for (int k = 0; k < refinements; ++k) {  // false position; an end that stays counts half (Illinois)
    for (int i = 0; i < lanes; ++i) t[i] = in[i] + (out[i] - in[i]) * off_in[i] / (off_in[i] - off_out[i]);
    beyond_gamut(line, ok, t, off);
    for (int i = 0; i < lanes; ++i) {
      const bool left = off[i] > 0;
      const float other_in = off_in[i] * (left ? 0.5F : 0.0F), other_out = off_out[i] * (left ? 0.0F : 0.5F);
      in[i] = left ? in[i] : t[i];
      out[i] = left ? t[i] : out[i];
      off_in[i] = left ? other_in : (off[i] < -1e-9F ? off[i] : -1e-9F);
      off_out[i] = left ? off[i] : other_out;
    }
  }
  for (int i = 0; i < lanes; ++i) kept[i] = t[i];  // the ends may close in from one side only
}

GREENRAY_VECTOR_CLONES void into_gamut(const OkMatrices &ok, Lanes rgb[3]) {
  ChromaLines line;
  Lanes kept;
  lines_to_grey(ok, rgb, line);
  leave_gamut(line, ok, kept);
  for (int i = 0; i < lanes; ++i) {
    float cube[3];
    for (std::size_t j = 0; j < 3; ++j) {
      const float root = line.base[i] + kept[i] * line.slope[j][i];
      cube[j] = root * root * root;
    }
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c][i] = ok.rgb_of_lms[c][0] * cube[0] + ok.rgb_of_lms[c][1] * cube[1] + ok.rgb_of_lms[c][2] * cube[2];
  }
}

/// Samples outside [0, 1] by more than 1e-6, NaN among them.
GREENRAY_VECTOR_CLONES int count_outside(const float *samples, std::size_t count) {
  int outside = 0;
  for (std::size_t i = 0; i < count; ++i) outside += samples[i] >= -1e-6F && samples[i] <= 1 + 1e-6F ? 0 : 1;
  return outside;
}

GREENRAY_VECTOR_CLONES void clip(float *samples, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) samples[i] = samples[i] > 0 ? (samples[i] < 1 ? samples[i] : 1.0F) : 0.0F;
}

}  // namespace

std::size_t gamut_rows(std::size_t count, float *rgb) {
  static const OkMatrices ok;
  std::size_t moved = 0;
  std::array<float *, lanes> pixels{};
  int waiting = 0;
  const auto move = [&] {
    Lanes colours[3] = {};
    for (int i = 0; i < waiting; ++i)
      for (std::size_t c = 0; c < 3; ++c) colours[c][i] = pixels[static_cast<std::size_t>(i)][c];
    into_gamut(ok, colours);
    for (int i = 0; i < waiting; ++i)
      for (std::size_t c = 0; c < 3; ++c) pixels[static_cast<std::size_t>(i)][c] = colours[c][i];
    waiting = 0;
  };
  constexpr std::size_t block = 64;
  for (std::size_t begin = 0; begin < count; begin += block) {
    const std::size_t some = std::min(block, count - begin);
    if (count_outside(rgb + 3 * begin, 3 * some) == 0) continue;
    for (std::size_t i = begin; i < begin + some; ++i) {
      float *pixel = rgb + 3 * i;
      const float least = std::min({pixel[0], pixel[1], pixel[2]}), most = std::max({pixel[0], pixel[1], pixel[2]});
      if (!(least < -1e-6F || most > 1 + 1e-6F)) continue;
      ++moved;
      pixels[static_cast<std::size_t>(waiting)] = pixel;
      if (++waiting == lanes) move();
    }
  }
  if (waiting > 0) move();
  clip(rgb, 3 * count);
  return moved;
}

}  // namespace greenray::vision
