// Paths through media that bend them: where they land, against closed forms and against small steps.
#include <gtest/gtest.h>

#include "support_code/surfaces.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// n^2 = a + b h exactly, as a medium for the table's builder.
LayeredMedium linear_index2(double a, double b, double top_m) {
  LayeredMedium medium;
  medium.refractivity = [=](double h, double) {
    const double n = std::sqrt(a + b * h);
    return Dual{n - 1, b / (2 * n)};
  };
  medium.density_kg_m3 = [](double) { return 1.0; };
  medium.top_m = top_m;
  return medium;
}

/// A wall across x, 40 m wide and high.
void add_wall(Surfaces &scene, double x_m) {
  const Triple a{x_m, -20, -20}, b{x_m, 20, -20}, c{x_m, 20, 20}, d{x_m, -20, 20};
  scene.triangles.push_back({{a, b, c}, {}, {}, 0, -1});
  scene.triangles.push_back({{a, c, d}, {}, {}, 0, -1});
}

std::vector<surface32::PathEnd> on_device(const Surfaces &scene, const AirTable &air,
                                          const std::vector<surface32::PathStart> &starts, int lanes = 0,
                                          double longest_sag_m = 0) {
  const auto device = shared_device(lanes);
  SurfaceScene s(device, build_surface_tree(scene, SurfaceScene::lanes_for(*device)), air, longest_sag_m);
  return s.trace(starts);
}

TEST(Curve, LandsWhereTheParabolaSays) {
  // oracle: closed form: with n^2 = a + b h a ray is z = z0 + p_z s + (b/4) s^2, x = p_x s; s at the wall is x/p_x
  // tolerance: 1 mm after 10 m, asked of curved photons (measured: under 0.01 mm)
  const double a = 1.2, b = 0.15, wall_m = 10;
  const AirTable air = build_air_table(linear_index2(a, b, 6), {550}, {0, 6, 10, 1e-5, 4096});
  EXPECT_LE(air.error_m, 1e-9);  // n^2 is linear: the cells are exact
  Surfaces scene;
  add_wall(scene, wall_m);
  std::vector<surface32::PathStart> starts;
  std::vector<double> expected_m;
  for (int i = 0; i < 400; ++i) {
    const double z0 = 0.5 + 0.01 * i, elevation = 0.2 * std::sin(0.7 * i) - 0.1;
    const double n = std::sqrt(a + b * z0), px = n * std::cos(elevation), pz = n * std::sin(elevation), s = wall_m / px;
    const double turn = -2 * pz / b, lowest = pz < 0 ? z0 + pz * turn + b / 4 * turn * turn : z0;
    const double z = z0 + pz * s + b / 4 * s * s;
    if (lowest < 0 || z > 6) continue;  // it leaves the part of the medium where n^2 is linear
    starts.push_back(path_start({0, 0.3, z0}, {px, 0, pz}));
    expected_m.push_back(z);
  }
  ASSERT_GT(starts.size(), 150u);
  for (const int lanes : {1, 8}) {
    const auto ends = on_device(scene, air, starts, lanes);
    double worst_m = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      ASSERT_EQ(ends[i].outcome, surface32::PATH_SURFACE) << i;
      worst_m = std::max(worst_m, std::abs(static_cast<double>(ends[i].place[2]) - expected_m[i]));
    }
    EXPECT_LT(worst_m, 1e-3);
    RecordProperty("worst_mm_lanes_" + std::to_string(lanes), std::to_string(1000 * worst_m));
  }
}

TEST(Curve, IndexAndLengthAtTheEnd) {
  // oracle: |momentum| = n(z), whatever the way there; length by 20000 chords of the closed-form parabola
  // tolerance: float: 1e-6 of n, 1e-5 of 10 m
  const double a = 1.0, b = 0.1;
  const AirTable air = build_air_table(linear_index2(a, b, 7), {550}, {0, 7, 10, 1e-5, 4096});
  Surfaces scene;
  add_wall(scene, 10);
  const double z0 = 1, n = std::sqrt(a + b * z0), px = n * std::cos(0.2), pz = n * std::sin(0.2), s = 10 / px;
  const auto end = on_device(scene, air, {path_start({0, 0, z0}, {px, 0, pz})}).front();
  const Triple p = triple_of(end.momentum);
  EXPECT_NEAR(length(p), std::sqrt(a + b * static_cast<double>(end.place[2])), 2e-6);
  EXPECT_NEAR(p[0], px, 1e-6);
  double chords_m = 0;
  for (int i = 0; i < 20000; ++i) {
    const double s0 = s * i / 20000, s1 = s * (i + 1) / 20000;
    chords_m += std::hypot(px * (s1 - s0), pz * (s1 - s0) + b / 4 * (s1 * s1 - s0 * s0));
  }
  EXPECT_NEAR(static_cast<double>(end.path_m), chords_m, 1e-4);
}

/// The 2004 room's medium as levels of refractivity: constant, a ramp, and a steep layer under the ceiling.
LayeredMedium laboratory(double strength) {
  LayeredMedium medium;
  const std::vector<double> h{0, 1.6, 2.4, 3.0}, r{0.3 * strength, 0.3 * strength, 0.2 * strength, 0};
  medium.refractivity = [=](double z, double) {
    std::size_t i = 0;
    while (i + 2 < h.size() && z > h[i + 1]) ++i;
    const double slope = (r[i + 1] - r[i]) / (h[i + 1] - h[i]);
    return Dual{r[i] + slope * (z - h[i]), slope};
  };
  medium.density_kg_m3 = [](double) { return 1.0; };
  medium.kinks_m = {1.6, 2.4};
  medium.top_m = 3.0;
  return medium;
}

/// d2r/dsigma2 = grad(n^2)/2 by the classical Runge-Kutta method in steps of four millimetres, until it meets
/// something.
struct SmallSteps {
  const LayeredMedium &medium;
  double force(double z) const {
    const double h = std::clamp(z, 0.0, medium.top_m);
    const Dual n = medium.refractivity(h, 550);
    return z == h ? (1 + n.value) * n.slope : 0;
  }
  template <class Meet>
  Met until_met(Triple &at, Triple p, double step, int steps, const Meet &meet) const {
    for (int i = 0; i < steps; ++i) {
      const double z = at[2], v = p[2], k1 = force(z), k2 = force(z + step / 2 * v),
                   k3 = force(z + step / 2 * v + step * step / 4 * k1), k4 = force(z + step * v + step * step / 2 * k2);
      const Triple next{at[0] + step * p[0], at[1] + step * p[1], z + step * v + step * step / 6 * (k1 + k2 + k3)};
      if (const Met met = meet(at, next - at); met.primitive >= 0) {
        at = at + met.sigma * (next - at);
        return met;
      }
      at = next;
      p[2] += step / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    return {};
  }
};

double index_at(const LayeredMedium &medium, double z) {
  return 1 + medium.refractivity(std::clamp(z, 0.0, medium.top_m), 550).value;
}

class CurveThroughCells : public ::testing::TestWithParam<double> {};

TEST_P(CurveThroughCells, LandsLikeSmallSteps) {
  // oracle: Runge-Kutta of the ray equation in steps of 4 mm on the medium itself, brute force on every chord
  //         |momentum| = n at the end, wherever along an arc that is
  // tolerance: the table's 0.1 mm and float, 0.3 mm together, where neither an edge nor a shallow angle decides; of n
  //         0.1 mm along its steepest slope of 0.3/m
  const double strength = GetParam(), margin_m = 4e-4;
  const LayeredMedium medium = laboratory(strength);
  const AirTable air = build_air_table(medium, {550}, {0, 3, 6, 1e-4, 4096});
  EXPECT_LE(air.error_m, 1e-4);
  Surfaces scene = soup(40, 4, 1.5, 21);
  for (Triangle &t : scene.triangles)
    for (Triple &c : t.corner) c[2] += 1.5;
  for (Sphere &s : scene.spheres) s.centre[2] += 1.5;
  std::mt19937 engine(4);
  std::vector<surface32::PathStart> starts;
  std::vector<Triple> from, momentum;
  for (int i = 0; i < 100; ++i) {
    const Triple place = random_triple(engine, -1.5, 1.5) + Triple{0, 0, 1.5};
    const Triple p = index_at(medium, place[2]) * random_direction(engine);
    bool in_sphere = false;
    for (const Sphere &s : scene.spheres) in_sphere = in_sphere || length(place - s.centre) < s.radius_m;
    if (in_sphere) continue;  // outside the medium's assumptions: a path bends only in air
    from.push_back(place), momentum.push_back(p);
    starts.push_back(path_start(place, p));
  }
  const auto ends = on_device(scene, air, starts), in_short_arcs = on_device(scene, air, starts, 0, 0.01);
  int decided = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    Triple certain = from[i], possible = from[i];
    const SmallSteps steps{medium};
    const Met sure = steps.until_met(certain, momentum[i], 4e-3, 800, [&](const Triple &at, const Triple &chord) {
      return brute_force(scene, at, chord, 1, 0).certain;
    });
    const Met maybe = steps.until_met(possible, momentum[i], 4e-3, 800, [&](const Triple &at, const Triple &chord) {
      return brute_force(scene, at, chord, 1, margin_m).possible;
    });
    if (sure.primitive != maybe.primitive) continue;  // an edge or a limb within the margin
    ++decided;
    ASSERT_EQ(ends[i].primitive, sure.primitive) << i;
    ASSERT_EQ(in_short_arcs[i].primitive, sure.primitive) << i;
    if (sure.primitive < 0) continue;
    const Triple normal = triple_of(ends[i].normal), p = triple_of(ends[i].momentum);
    const double steepness = std::abs(dot(normal, p)) / length(p);
    EXPECT_NEAR(length(p), index_at(medium, static_cast<double>(ends[i].place[2])), 3e-5 * strength + 2e-7) << i;
    EXPECT_LT(length(triple_of(ends[i].place) - certain), 3e-4 / steepness) << i;
    EXPECT_LT(length(triple_of(in_short_arcs[i].place) - certain), 3e-4 / steepness) << i;
  }
  EXPECT_GT(decided, static_cast<int>(starts.size() * 8 / 10));
}

INSTANTIATE_TEST_SUITE_P(Strengths, CurveThroughCells, ::testing::Values(1.0, 0.3, 1e-3));

/// n^2 by straight lines between heights, 30 to 50 times as bent as the cross room's.
struct PiecewiseLinear {
  std::vector<double> height_m, index2;
  std::size_t piece(double z) const {
    std::size_t i = 0;
    while (i + 2 < height_m.size() && z >= height_m[i + 1]) ++i;
    return i;
  }
  double slope(std::size_t i) const { return (index2[i + 1] - index2[i]) / (height_m[i + 1] - height_m[i]); }
  double at(double z) const { return index2[piece(z)] + slope(piece(z)) * (z - height_m[piece(z)]); }
  LayeredMedium medium() const {
    LayeredMedium m;
    m.refractivity = [*this](double z, double) {
      const double n = std::sqrt(at(z));
      return Dual{n - 1, slope(piece(z)) / (2 * n)};
    };
    m.density_kg_m3 = [](double) { return 1.0; };
    m.kinks_m.assign(height_m.begin() + 1, height_m.end() - 1);
    m.top_m = height_m.back();
    return m;
  }
};

/// A piece of a parabola and what may be met on it.
struct Parabola {
  Triple place, momentum;
  double bend, end;
  Triple at(double s) const { return place + s * momentum + Triple{0, 0, bend * s * s}; }
  double climb(double s) const { return momentum[2] + 2 * bend * s; }
};

/// A triangle ready for many questions.
struct Facet {
  explicit Facet(const Triangle &t) : corner(t.corner), normal(unit(t.area_vector_m2())) {
    for (std::size_t k = 0; k < 3; ++k) inward[k] = unit(cross(normal, corner[(k + 1) % 3] - corner[k]));
  }
  double inside(const Triple &p) const {
    double least = 1e300;
    for (std::size_t k = 0; k < 3; ++k) least = std::min(least, dot(inward[k], p - corner[k]));
    return least;
  }
  std::array<Triple, 3> corner;
  Triple normal;
  std::array<Triple, 3> inward;
};

/// The triangle's plane is met where nz bend s^2 + n.p s + h = 0; both solutions, in double, on every triangle.
void meet_by_force(const std::vector<Facet> &scene, const Parabola &way, double margin_m, BruteForce &found) {
  const auto note = [](Met &nearest, double s, std::size_t i) {
    if (s < nearest.sigma) nearest = {s, static_cast<int>(i)};
  };
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const Triple &n = scene[i].normal;
    const double a = n[2] * way.bend, b = dot(n, way.momentum), h = dot(n, way.place - scene[i].corner[0]);
    const double root = b * b - 4 * a * h;
    if (root < -4 * std::abs(a) * margin_m) continue;
    const double q = -0.5 * (b + std::copysign(std::sqrt(std::max(root, 0.0)), b));
    for (const double s : {h / q, q / a}) {
      if (!(s > -1 && s < way.end + 1)) continue;
      const Triple speed{way.momentum[0], way.momentum[1], way.climb(s)};
      const double steepness = std::max(std::abs(dot(n, speed)) / length(speed), 1e-3), reach = margin_m / steepness,
                   late = reach / length(speed), inside = scene[i].inside(way.at(s));
      if (inside > -reach && s > -late && s < way.end + late) note(found.possible, s, i);
      if (root > 0 && steepness > 1e-2 && inside > reach && s > late && s < way.end - late) note(found.certain, s, i);
    }
  }
}

/// From kink to kink until the path is out of the medium, or beyond 12 m from the axis.
BruteForce follow_by_force(const std::vector<Facet> &scene, const PiecewiseLinear &air, Triple place, Triple momentum,
                           double margin_m) {
  BruteForce found;
  std::size_t piece = air.piece(place[2]);
  double passed = 0;
  for (int i = 0; i < 200; ++i) {
    const double bend = air.slope(piece) / 4, z = place[2], p = momentum[2];
    double end = 1e300;
    int step = 0;
    for (const int side : {0, 1}) {
      const double rise = air.height_m[piece + static_cast<std::size_t>(side)] - z, root = p * p + 4 * bend * rise;
      if (root < 0) continue;
      for (const double s : {(-p + std::sqrt(root)) / (2 * bend), (-p - std::sqrt(root)) / (2 * bend)})
        if (s > 1e-9 && s < end) end = s, step = side ? 1 : -1;
    }
    if (step == 0) break;
    BruteForce here;
    const Parabola way{place, momentum, bend, end};
    meet_by_force(scene, way, margin_m, here);
    for (auto [to, from] : {std::pair{&found.certain, &here.certain}, {&found.possible, &here.possible}})
      if (to->primitive < 0 && from->primitive >= 0) *to = {passed + from->sigma, from->primitive};
    if (found.certain.primitive >= 0 || std::max(std::abs(place[0]), std::abs(place[1])) > 12) break;
    passed += end;
    place = way.at(end), momentum[2] = way.climb(end);
    place[2] = air.height_m[piece + (step > 0 ? 1 : 0)];
    if ((step < 0 && piece == 0) || (step > 0 && piece + 2 == air.height_m.size())) break;
    piece = step > 0 ? piece + 1 : piece - 1;
  }
  return found;
}

class CurveOnDevice : public ::testing::TestWithParam<int> {};

TEST_P(CurveOnDevice, MillionCurvesLikeBruteForce) {
  // oracle: parabolas from kink to kink against the plane of every triangle, in double
  // tolerance: none. A hit within 20 um / sin(angle with the surface) of an edge may be taken or not: 6 roundings of
  // the
  //            scene's 20 m for each of five layers
  const PiecewiseLinear air{{-6, -2, -1, 1.5, 2, 6}, {1.5, 1.3, 1.45, 1.2, 1.35, 1.0}};
  PiecewiseLinear raised = air;
  for (double &h : raised.height_m) h += 6;
  const AirTable table = build_air_table(raised.medium(), {550}, {0, 12, 20, 1e-4, 4096});
  EXPECT_LE(table.error_m, 1e-7);
  Surfaces scene = soup(60, 0, 4, 17);
  for (Triangle &t : scene.triangles) {
    const Triple middle = (1.0 / 3) * (t.corner[0] + t.corner[1] + t.corner[2]);
    for (Triple &c : t.corner) c = middle + 2.5 * (c - middle) + Triple{0, 0, 6};
  }
  const std::size_t count = GetParam() == 8 ? 1000000 : 100000;
  std::mt19937 engine(31);
  std::vector<surface32::PathStart> starts;
  std::erase_if(scene.triangles, [](const Triangle &t) {
    return std::any_of(t.corner.begin(), t.corner.end(), [](const Triple &c) {
      return std::max({std::abs(c[0]), std::abs(c[1]), 2 * std::abs(c[2] - 6)}) > 11.9;
    });
  });
  ASSERT_GT(scene.triangles.size(), 40u);
  for (std::size_t i = 0; i < count; ++i) {
    const Triple place = random_triple(engine, -5, 5) + Triple{0, 0, 6};
    Triple d = random_direction(engine);
    if (i % 4 == 0) d = unit({d[0], d[1], 0.05 * d[2]});
    starts.push_back(path_start(place, std::sqrt(raised.at(place[2])) * d));
  }
  const auto ends = on_device(scene, table, starts, GetParam());
  const std::vector<Facet> facets(scene.triangles.begin(), scene.triangles.end());
  int wrong = 0, met = 0, undecided = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const BruteForce b =
        follow_by_force(facets, raised, triple_of(starts[i].place), triple_of(starts[i].momentum), 2e-5);
    const int ours = ends[i].outcome == surface32::PATH_SURFACE ? ends[i].primitive : -1;
    met += ours >= 0;
    undecided += b.certain.primitive != b.possible.primitive;
    if (ours == b.certain.primitive || (ours >= 0 && ours == b.possible.primitive)) continue;
    if (++wrong < 4)
      ADD_FAILURE() << i << ": met " << ours << ", for certain " << b.certain.primitive << " at " << b.certain.sigma
                    << ", possibly " << b.possible.primitive << " at " << b.possible.sigma;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(undecided, static_cast<int>(count / 100));
  EXPECT_GT(met, static_cast<int>(count / 10));
  EXPECT_LT(met, static_cast<int>(count * 9 / 10));
}

INSTANTIATE_TEST_SUITE_P(Lanes, CurveOnDevice, ::testing::Values(1, 8));

TEST(Curve, NoGapsBetweenNeighboursAndCells) {
  // oracle: a closed room: no path that starts inside gets out, though cells end at its floor, ceiling and in between
  // tolerance: none
  Surfaces room = ball(4, 1.4, {0, 0, 1.5});
  const LayeredMedium medium = laboratory(1);
  const AirTable air = build_air_table(medium, {550}, {0, 3, 6, 1e-4, 4096});
  // A box whose floor and ceiling are exactly where the cells end.
  const Triple low{-2, -2, 0}, high{2, 2, 3};
  const auto corner = [&](int i) {
    return Triple{i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1], i & 4 ? high[2] : low[2]};
  };
  Surfaces box;
  for (const auto &q :
       {std::array<int, 4>{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
    box.triangles.push_back({{corner(q[0]), corner(q[1]), corner(q[2])}, {}, {}, 0, -1});
    box.triangles.push_back({{corner(q[0]), corner(q[2]), corner(q[3])}, {}, {}, 0, -1});
  }
  std::mt19937 engine(8);
  for (const Surfaces &scene : {room, box}) {
    std::vector<surface32::PathStart> starts;
    for (int i = 0; i < 200000; ++i) {
      const Triple place = random_triple(engine, -0.75, 0.75) + Triple{0, 0, 1.5};
      Triple d = random_direction(engine);
      if (i % 4 == 0) d = unit(scene.triangles[static_cast<std::size_t>(i) % scene.triangles.size()].corner[0] - place);
      if (i % 16 == 1) d = unit({d[0], d[1], 0});
      starts.push_back(path_start(place, index_at(medium, place[2]) * d));
    }
    const auto ends = on_device(scene, air, starts);
    int lost = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (ends[i].outcome == surface32::PATH_SURFACE) continue;
      if (++lost < 4)
        ADD_FAILURE() << "outcome " << ends[i].outcome << " from " << starts[i].place[0] << " " << starts[i].place[1]
                      << " " << starts[i].place[2] << " along " << starts[i].momentum[0] << " " << starts[i].momentum[1]
                      << " " << starts[i].momentum[2] << " to " << ends[i].place[0] << " " << ends[i].place[1] << " "
                      << ends[i].place[2];
    }
    EXPECT_EQ(lost, 0);
  }
}

TEST(Curve, SameWithoutBendingAsStraight) {
  // oracle: the kernel without curve code
  // tolerance: 1e-5 m of 5 m: the same planes, solved by a quadratic
  const Surfaces scene = soup(500, 10, 2, 31);
  std::mt19937 engine(2);
  std::vector<surface32::PathStart> starts;
  for (int i = 0; i < 20000; ++i) starts.push_back(path_start(random_triple(engine, -2, 2), random_direction(engine)));
  const auto straight = on_device(scene, uniform_air(0, {550}), starts);
  AirTable nearly = uniform_air(0, {550});  // a bend that no float can see makes the curve code be compiled
  nearly.largest_bend_per_m = 1e-30;
  const auto curved = on_device(scene, nearly, starts);
  int different = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (straight[i].primitive != curved[i].primitive) {
      ++different;
      continue;
    }
    if (straight[i].primitive < 0) continue;
    EXPECT_LT(length(triple_of(straight[i].place) - triple_of(curved[i].place)), 2e-4) << i;
  }
  EXPECT_LE(different, 2);  // rays that graze an edge
}

TEST(Curve, TwinAndDeviceAgree) {
  // oracle: the host twin, the same text as C++
  // tolerance: the device may contract products and sums: 1e-5 of the scene's 5 m
  const LayeredMedium medium = laboratory(1);
  const AirTable air = build_air_table(medium, {550}, {0, 3, 6, 1e-4, 4096});
  const Surfaces scene = soup(300, 8, 2, 77);
  const TwinScene twin(scene, air);
  std::mt19937 engine(6);
  std::vector<surface32::PathStart> starts;
  for (int i = 0; i < 5000; ++i) {
    const Triple place = random_triple(engine, -2, 2);
    starts.push_back(path_start(place, index_at(medium, place[2]) * random_direction(engine)));
  }
  const auto ends = on_device(scene, air, starts, 8, 0.2);
  int different = 0;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    const surface32::PathEnd end = twin.trace(starts[i]);
    if (end.primitive != ends[i].primitive || length(triple_of(end.place) - triple_of(ends[i].place)) > 1e-3)
      ++different;
  }
  EXPECT_LE(different, 5);  // of 5000: grazing
}

TEST(Curve, OutcomesWithoutSurfaces) {
  // oracle: what the words mean: nothing to meet is escape; a number that is none is said to be none
  // tolerance: none
  const AirTable air = build_air_table(laboratory(1), {550}, {0, 3, 6, 1e-4, 4096});
  const float nan = std::nanf("");
  surface32::PathStart bad = path_start({0, 0, 1}, {1.3, 0, 0});
  bad.momentum[1] = nan;
  const auto ends = on_device({}, air, {path_start({0, 0, 1}, {0, 0, 1.3}), path_start({0, 0, 1}, {1.3, 0, 0}), bad});
  EXPECT_EQ(ends[0].outcome, surface32::PATH_ESCAPED);
  EXPECT_EQ(ends[1].outcome, surface32::PATH_ESCAPED);
  EXPECT_EQ(ends[2].outcome, surface32::PATH_NOT_FINITE);
}

}  // namespace
}  // namespace greenray
