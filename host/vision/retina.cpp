#include "vision/retina.hpp"

#include <algorithm>
#include <cmath>

#include "support/fast_math.hpp"

namespace greenray::vision {

namespace {

/// Rows and columns of the linear map between XYZ and LMS, as floats for the loops below.
struct ConeMatrices {
  float lms[3][3], xyz[3][3];
  ConeMatrices() {
    for (std::size_t c = 0; c < 3; ++c) {
      std::array<double, 3> unit{0, 0, 0};
      unit[c] = 1;
      const Lms to_lms = lms_from_xyz(unit);
      const auto to_xyz = xyz_from_lms(unit);
      for (std::size_t r = 0; r < 3; ++r)
        lms[r][c] = static_cast<float>(to_lms[r]), xyz[r][c] = static_cast<float>(to_xyz[r]);
    }
  }
};

const ConeMatrices &matrices() {
  static const ConeMatrices m;
  return m;
}

GREENRAY_VECTOR_CLONES void combine(const float *a, const float *b, const float *c, const float weight[3],
                                    std::size_t count, float *to) {
  for (std::size_t i = 0; i < count; ++i) to[i] = weight[0] * a[i] + weight[1] * b[i] + weight[2] * c[i];
}

/// Kinetics of one kind of cone: u before -> u after. rate: seconds / tau; steady: no history.
GREENRAY_VECTOR_CLONES void expose(const float *response, float inverse_half_response, float rate, bool steady,
                                   std::size_t count, float *u) {
  const float keep = steady ? 0.0F : 1.0F;
  for (std::size_t i = 0; i < count; ++i) {
    const float light = response[i] > 0 ? response[i] * inverse_half_response : 0.0F;  // I / I0
    const float level = 1.0F / (1.0F + light);
    const float exponent = -rate * (1.0F + light);
    u[i] = level + keep * (u[i] - level) * fast_exp_of_negative(exponent > -87.0F ? exponent : -87.0F);
  }
}

GREENRAY_VECTOR_CLONES void gains_from_catch(const float *u, float scale, std::size_t count, float *gain) {
  for (std::size_t i = 0; i < count; ++i) gain[i] = u[i] * scale;
}

GREENRAY_VECTOR_CLONES void gains_from_threshold(const float *u, std::size_t count, float *gain) {
  constexpr float cone_decades = 3;  // of threshold for a full bleach (Hollins & Alpern 1973)
  for (std::size_t i = 0; i < count; ++i) gain[i] = fast_exp2(cone_decades * 3.3219281F * (u[i] - 1.0F));
}

/// u r(u), r the parabola through r(0), r(1/2) and r(1) = 1.
void gains_from_shape(const float *u, const std::vector<SelfScreening> &screening, std::size_t cone, std::size_t count,
                      float *gain) {
  for (std::size_t i = 0; i < count; ++i) {
    const float t = u[i], none = screening[i].at_none[cone], half = screening[i].at_half[cone];
    const float ratio = none * (1 - t) * (1 - 2 * t) + half * 4 * t * (1 - t) + t * (2 * t - 1);
    gain[i] = t >= 1 ? 1.0F : t * ratio;
  }
}

/* colour += columns x (gain - 1) response, then back to its luminance (unless it dims). Written as a change, so that
   gains of 1 change no bit. */
GREENRAY_VECTOR_CLONES void apply_gains(const float *const response[3], const float *const gain[3],
                                        const float columns[3][3], bool dims, std::size_t count, float *x, float *y,
                                        float *z, float *luminance) {
  for (std::size_t i = 0; i < count; ++i) {
    const float l = (gain[0][i] - 1.0F) * response[0][i], m = (gain[1][i] - 1.0F) * response[1][i],
                s = (gain[2][i] - 1.0F) * response[2][i];
    const float x1 = x[i] + columns[0][0] * l + columns[0][1] * m + columns[0][2] * s;
    const float y1 = y[i] + columns[1][0] * l + columns[1][1] * m;
    const float z1 = z[i] + columns[2][2] * s;
    const bool seen = y1 > 1e-7F * y[i] && y1 > 1e-30F;
    const float back = dims || !seen ? 1.0F : y[i] / y1;
    const float fallen = dims && y[i] > 1e-30F ? (y1 > 0 ? y1 : 0.0F) / y[i] : 1.0F;
    x[i] = seen || dims ? x1 * back : x[i];
    z[i] = seen || dims ? z1 * back : z[i];
    y[i] = dims ? (y1 > 0 ? y1 : 0.0F) : y[i];
    luminance[i] = luminance[i] * fallen;
  }
}

double band(std::size_t k, double nm) {
  constexpr double centre_nm[3] = {610, 545, 450};
  const double t = (nm - centre_nm[k]) / 25;
  return std::exp(-0.5 * t * t);
}

std::array<std::array<double, 3>, 3> inverse(const std::array<std::array<double, 3>, 3> &m) {
  std::array<std::array<double, 3>, 3> result{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
      result[r][c] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
    }
  const double determinant = m[0][0] * result[0][0] + m[0][1] * result[1][0] + m[0][2] * result[2][0];
  for (auto &row : result)
    for (double &value : row) value /= determinant;
  return result;
}

constexpr double nearly_none = 1e-4;  // of the pigment: catch per pigment has reached its limit to 1e-4

}  // namespace

BandScreening::BandScreening() {
  std::array<std::array<double, 3>, 3> whole{};  // [cone][band]
  Spectrum light;
  for (double nm = 390; nm <= 780; nm += 2) light.wavelength_nm.push_back(nm);
  for (std::size_t k = 0; k < 3; ++k) {
    light.radiance.clear();
    for (const double nm : light.wavelength_nm) light.radiance.push_back(band(k, nm));
    const Lms c1 = cone_catches(light), c5 = cone_catches(light, {0.5, 0.5, 0.5}),
              c0 = cone_catches(light, {nearly_none, nearly_none, nearly_none});
    for (std::size_t i = 0; i < 3; ++i) {
      const double peak = cone_troland_factors()[i];  // responses of peak 1, to a common factor
      whole[i][k] = c1[i] / peak;
      half_[i][k] = c5[i] / (0.5 * peak);
      none_[i][k] = c0[i] / (nearly_none * peak);
    }
  }
  amounts_ = inverse(whole);
}

SelfScreening BandScreening::of(const Lms &lms) const {
  SelfScreening result;
  std::array<double, 3> amount{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 3; ++i) amount[k] += amounts_[k][i] * lms[i];
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(lms[i] > 0)) continue;
    double none = 0, half = 0;
    for (std::size_t k = 0; k < 3; ++k) none += none_[i][k] * amount[k], half += half_[i][k] * amount[k];
    // no light can leave these bounds: what a pigment of density 0.5 catches more when thin is 1 to 1.9 per pigment
    result.at_none[i] = static_cast<float>(std::clamp(none / lms[i], 1.0, 1.9));
    result.at_half[i] = static_cast<float>(std::clamp(half / lms[i], 1.0, 1.4));
  }
  return result;
}

SpectralScreening::SpectralScreening(const std::vector<double> &wavelength_nm) {
  const std::size_t count = wavelength_nm.size();
  for (std::size_t k = 0; k < count; ++k) {
    Spectrum hat;
    for (std::size_t n = k == 0 ? 0 : k - 1; n < std::min(count, k + 2); ++n) {
      hat.wavelength_nm.push_back(wavelength_nm[n]);
      hat.radiance.push_back(n == k ? 1.0 : 0.0);
    }
    if (count == 1) hat = {{wavelength_nm[0] - 1, wavelength_nm[0], wavelength_nm[0] + 1}, {0, 1, 0}};
    const Lms c1 = cone_catches(hat), c5 = cone_catches(hat, {0.5, 0.5, 0.5}),
              c0 = cone_catches(hat, {nearly_none, nearly_none, nearly_none});
    for (std::size_t i = 0; i < 3; ++i) {
      whole[i].push_back(static_cast<float>(c1[i]));
      half[i].push_back(static_cast<float>(c5[i] / 0.5));
      none[i].push_back(static_cast<float>(c0[i] / nearly_none));
    }
  }
}

SelfScreening SpectralScreening::of(const float *radiance, std::size_t spacing) const {
  SelfScreening result;
  for (std::size_t k = 0; k < 3; ++k) {
    float all = 0, bleached = 0, gone = 0;
    for (std::size_t w = 0; w < whole[k].size(); ++w) {
      const float value = radiance[w * spacing];
      if (!(value > 0) || std::isinf(value)) continue;
      all += value * whole[k][w];
      bleached += value * half[k][w];
      gone += value * none[k][w];
    }
    if (all > 0) result.at_none[k] = gone / all, result.at_half[k] = bleached / all;
  }
  return result;
}

double Retina::after(double before, double td) const {
  if (options.exposure == BleachingOptions::Exposure::off) return before;
  if (options.exposure == BleachingOptions::Exposure::steady) return steady_unbleached(td, options.pigment);
  return unbleached_after(before, td, options.seconds, options.pigment);
}

void cone_response(std::size_t cone, const float *x, const float *y, const float *z, std::size_t count, float *to) {
  combine(x, y, z, matrices().lms[cone], count, to);
}

void expose_cones(const Retina &retina, std::size_t cone, const float *response, std::size_t count, float *u) {
  const BleachingOptions &options = retina.options;
  const bool steady = options.exposure == BleachingOptions::Exposure::steady;
  if (options.exposure == BleachingOptions::Exposure::off || (!steady && !(options.seconds > 0))) return;
  const auto half = static_cast<float>(options.pigment.half_bleach_td);
  const auto rate = static_cast<float>(options.seconds / options.pigment.time_constant_s);
  expose(response, retina.td_per_lms[cone] / half, rate, steady, count, u);
}

void bleach_rows(const Retina &retina, std::size_t count, float *x, float *y, float *z, float *luminance,
                 const std::array<float *, 3> &u, const std::vector<SelfScreening> &screening) {
  const BleachingOptions &options = retina.options;
  if (options.exposure == BleachingOptions::Exposure::off) return;
  std::vector<float> responses(3 * count), gains(3 * count);
  const float *response[3], *gain[3];
  for (std::size_t i = 0; i < 3; ++i) {
    float *to = responses.data() + i * count, *gain_to = gains.data() + i * count;
    response[i] = to, gain[i] = gain_to;
    cone_response(i, x, y, z, count, to);
    if (retina.shared) std::fill_n(u[i], count, (*retina.shared)[i]);
    else expose_cones(retina, i, to, count, u[i]);
    switch (options.model) {
      case BleachModel::catch_:
        gains_from_catch(u[i], 1.0F, count, gain_to);
        break;
      case BleachModel::shape:
        gains_from_shape(u[i], screening, i, count, gain_to);
        break;
      case BleachModel::threshold:
        gains_from_threshold(u[i], count, gain_to);
        break;
      case BleachModel::adapted:
        gains_from_catch(u[i], std::pow(retina.pool[i], -static_cast<float>(options.neural)), count, gain_to);
        break;
    }
  }
  apply_gains(response, gain, matrices().xyz, options.dims, count, x, y, z, luminance);
}

}  // namespace greenray::vision
