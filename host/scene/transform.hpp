// Where an object stands: scaled, then turned about x, y and z in this order, then moved.
#pragma once
#include <array>

#include "scene/surfaces.hpp"

namespace greenray {

/// world = matrix (place) + moved_m
struct Transform {
  std::array<Triple, 3> row{Triple{1, 0, 0}, Triple{0, 1, 0}, Triple{0, 0, 1}};
  Triple moved_m{0, 0, 0};

  static Transform of(const Triple &scale, const Triple &turned_deg, const Triple &moved_m);
  Triple place(const Triple &p) const;
  Triple normal(const Triple &n) const;  // by the inverse transpose, unit
  double determinant() const;
  /// The same change of lengths along every direction, or 0 where it differs: what a sphere allows.
  double even_scale() const;
  Transform after(const Transform &first) const;
};

Triangle transformed(const Triangle &t, const Transform &by);  // outsides stay outside, mirrored or not

}  // namespace greenray
