#include "scene/transform.hpp"

#include <cmath>
#include <utility>

namespace greenray {
namespace {

using Matrix = std::array<Triple, 3>;

Triple times(const Matrix &m, const Triple &p) { return {dot(m[0], p), dot(m[1], p), dot(m[2], p)}; }

Matrix product(const Matrix &a, const Matrix &b) {
  Matrix out{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) out[i][j] += a[i][k] * b[k][j];
  return out;
}

/// Sine and cosine of degrees, exact at multiples of 90.
std::pair<double, double> sine_cosine(double degrees) {
  const double turned = std::remainder(degrees, 360);
  if (std::remainder(turned, 90) == 0) {
    const int quarter = static_cast<int>(turned / 90 + 4) % 4;
    constexpr double sine[] = {0, 1, 0, -1}, cosine[] = {1, 0, -1, 0};
    return {sine[quarter], cosine[quarter]};
  }
  return {std::sin(turned * M_PI / 180), std::cos(turned * M_PI / 180)};
}

}  // namespace

Transform Transform::of(const Triple &scale, const Triple &turned_deg, const Triple &moved_m) {
  const auto [sx, cx] = sine_cosine(turned_deg[0]);
  const auto [sy, cy] = sine_cosine(turned_deg[1]);
  const auto [sz, cz] = sine_cosine(turned_deg[2]);
  const Matrix scaled{Triple{scale[0], 0, 0}, {0, scale[1], 0}, {0, 0, scale[2]}};
  const Matrix about_x{Triple{1, 0, 0}, {0, cx, -sx}, {0, sx, cx}}, about_y{Triple{cy, 0, sy}, {0, 1, 0}, {-sy, 0, cy}},
      about_z{Triple{cz, -sz, 0}, {sz, cz, 0}, {0, 0, 1}};
  return {product(about_z, product(about_y, product(about_x, scaled))), moved_m};
}

Triple Transform::place(const Triple &p) const { return times(row, p) + moved_m; }

double Transform::determinant() const { return dot(row[0], cross(row[1], row[2])); }

Triple Transform::normal(const Triple &n) const {
  // Rows of the cofactor matrix: the inverse transpose but for a factor, whose sign is the determinant's.
  const Matrix cofactor{cross(row[1], row[2]), cross(row[2], row[0]), cross(row[0], row[1])};
  return unit((determinant() < 0 ? -1.0 : 1.0) * times(cofactor, n));
}

double Transform::even_scale() const {
  const double size = std::cbrt(std::abs(determinant()));
  Matrix transposed{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) transposed[i][j] = row[j][i];
  const Matrix square = product(transposed, row);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      if (std::abs(square[i][j] - (i == j ? size * size : 0)) > 1e-9 * size * size) return 0;
  return size;
}

Transform Transform::after(const Transform &first) const { return {product(row, first.row), place(first.moved_m)}; }

Triangle transformed(const Triangle &t, const Transform &by) {
  Triangle out = t;
  for (std::size_t c = 0; c < 3; ++c) {
    out.corner[c] = by.place(t.corner[c]);
    if (length(t.corner_normal[c]) > 0) out.corner_normal[c] = by.normal(t.corner_normal[c]);
  }
  if (by.determinant() < 0) {
    std::swap(out.corner[1], out.corner[2]);
    std::swap(out.corner_normal[1], out.corner_normal[2]);
    std::swap(out.texture[1], out.texture[2]);
  }
  return out;
}

}  // namespace greenray
