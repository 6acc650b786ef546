// Aimed caustic photons: the same light as without aim, in fewer photons, whatever the projection maps missed.
#include "render/caustic_aim.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "render/room_looks.hpp"
#include "render/room_photons.hpp"
#include "scene/bvh.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

/// A small glass ball and a mirror in a box that a lamp, a point light or the Sun lights through layers of a strong
/// gradient.
RoomScene glass_ball(const std::string &light, bool aimed, bool bent) {
  return parse_room(
      "ball.toml",
      std::string("greenray = 1\n") +
          (bent ? "[atmosphere]\nfield = { kind = \"layers\", height_m = [0.0, 1.0], refractivity = [0.0, 0.4] }\n"
                : "") +
          "[camera]\nfrom = [0.5, 0.1, 0.5]\nto = [0.5, 0.9, 0.2]\nfov_deg = 70\nresolution = [24, 16]\n"
          "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\n"
          "[[material]]\nname = \"mirror\"\nkind = \"mirror\"\nreflectance = 0.9\n"
          "[[quad]]\ncorner = [0, 0, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 1, 0]\nreflectance = 0.5\n"
          "[[quad]]\ncorner = [0, 1, 0]\nedge_u = [1, 0, 0]\nedge_v = [0, 0, 1]\nreflectance = 0.5\n"
          "[[quad]]\nname = \"lamp\"\ncorner = [0.3, 0.3, 0.99]\nedge_u = [0, 0.2, 0]\nedge_v = [0.2, 0, 0]\n"
          "reflectance = 0.0\n"
          "[[sphere]]\ncentre = [0.55, 0.5, 0.25]\nradius_m = 0.09\nmaterial = \"glass\"\n"
          "[[quad]]\ncorner = [0.1, 0.6, 0.3]\nedge_u = [0.05, 0, 0]\nedge_v = [0, 0.02, 0.05]\nmaterial = "
          "\"mirror\"\n" +
          light + "[spectrum]\nsamples = 1\n[photons]\nemitted = 200000\ncaustic_share = 0.5\naimed = " +
          (aimed ? "true\n" : "false\n"));
}

const char *const lights[] = {
    "[[light]]\nkind = \"point\"\nfrom = [0.4, 0.4, 0.9]\npower_W = 5.0\n",
    "[[light]]\nkind = \"spot\"\nfrom = [0.4, 0.4, 0.95]\nto = [0.5, 0.5, 0.2]\ncone_deg = 80\npower_W = 5.0\n",
    "[[light]]\nkind = \"area\"\nsurface = \"lamp\"\npower_W = 5.0\n",
    "[[light]]\nkind = \"sun\"\naltitude_deg = 50\nirradiance_W_m2 = 5.0\n",
    "[[light]]\nkind = \"point\"\nfrom = [0.4, 0.4, 0.9]\npower_W = 5.0\n"
    "[[light]]\nkind = \"sun\"\naltitude_deg = 60\nazimuth_deg = 120\nirradiance_W_m2 = 5.0\nphoton_weight = 3.0\n"};

struct Spread {
  double mean = 0, variance = 0;  // of one pass
  void add(double x) {
    sum_ += x, squares_ += x * x, ++n_, mean = sum_ / n_,
                                        variance = (squares_ / n_ - mean * mean) * n_ / std::max(n_ - 1, 1.0);
  }
  double error2() const { return variance / n_; }

 private:
  double sum_ = 0, squares_ = 0, n_ = 0;
};

double power_in(PhotonMap &map) {
  double sum = 0;
  for (const float x : map.read().power_W) sum += static_cast<double>(x);
  return sum;
}

/// Everything that traces photons of a scene.
struct Rig {
  explicit Rig(const RoomScene &s)
      : scene(s),
        looks(room_looks(scene)),
        air(room_air(scene, looks.wavelength_nm, false)),
        tree(build_surface_tree(scene.surfaces, SurfaceScene::lanes_for(*shared_device()))),
        tracer(shared_device(), tree, air, looks) {
    options.size = scene.camera.resolution;
  }
  RoomScene scene;
  RoomOptions options;
  RoomLooks looks;
  AirTable air;
  SurfaceTree tree;
  RoomTracer tracer;
};

/// Power that lands in the caustic map, over the passes.
Spread caustic_power(const RoomScene &scene, int passes, bool &aimed) {
  Rig rig(scene);
  rig.options.passes = passes;
  RoomPlan plan = plan_room(scene, rig.options);
  RoomPhotons photons(rig.scene, rig.options, shared_device(), rig.tracer, rig.looks, rig.tree.bounds, false);
  photons.fit(plan, 0, true);
  aimed = photons.aimed_cells() > 0;
  Spread power;
  for (int pass = 0; pass < passes; ++pass) {
    photons.trace(plan, pass);
    power.add(power_in(*photons.mapper().caustic()));
  }
  return power;
}

TEST(CausticAim, SameLightInFewerPhotons) {
  // oracle: photons that are not aimed; a Poisson process's variance falls with the number that land
  // tolerance: 5 standard errors of the mean power; of the variance: half, expected a tenth and less (16 passes know it
  //            to 40 %)
  for (const bool bent : {false, true})
    for (const char *const light : lights) {
      bool aimed = false, not_aimed = true;
      const Spread with = caustic_power(glass_ball(light, true, bent), 16, aimed);
      const Spread without = caustic_power(glass_ball(light, false, bent), 16, not_aimed);
      EXPECT_TRUE(aimed) << light;
      EXPECT_FALSE(not_aimed) << light;
      EXPECT_GT(without.mean, 0.0);
      EXPECT_NEAR(with.mean, without.mean, 5 * std::sqrt(with.error2() + without.error2())) << light << bent;
      EXPECT_LT(with.variance, 0.5 * without.variance) << light << bent;
      std::cout << light << "bent " << bent << ": power " << with.mean << " / " << without.mean << ", variance "
                << with.variance / without.variance << "\n";
    }
}

TEST(CausticAim, UnbiasedWhateverTheMapsMissed) {
  // oracle: as above; the maps are spoilt: three cells of four are forgotten
  // tolerance: 5 standard errors
  const RoomScene scene = glass_ball(lights[0], true, true);
  Rig rig(scene);
  share_photons(rig.looks, 50000, rig.looks.light_power_W_nm);
  rig.tracer.set_lights(rig.looks.lights);
  PhotonBatch batch;
  batch.photons = 50000, batch.chunk = 64, batch.slots = {64, 0};
  CausticAim aim = find_caustic_aim(rig.tracer, rig.looks, batch);
  room_twin::LightProjection &p = aim.lights.lights[0];
  const int kept = p.marked / 4;
  ASSERT_GT(kept, 1);
  const double whole = room_twin::PROJECTION_CELLS, explored = static_cast<double>(p.explored);
  for (int i = 0; i < p.marked; ++i)
    aim.lights.weights[static_cast<std::size_t>(aim.lights.cells[static_cast<std::size_t>(i)])] =
        static_cast<float>(1 / (i < kept ? explored + (1 - explored) * whole / kept : explored));
  p.marked = kept;
  rig.tracer.set_aim(aim.lights);
  PhotonMap map(shared_device(), {(batch.chunks() + 1) * 64, 1, 0, 0});
  const Bounds box{{0, 0, 0}, {1, 1, 1}};
  Spread spoilt;
  PhotonTotals totals;
  for (std::uint32_t pass = 0; pass < 24; ++pass) {
    batch.pass = pass;
    rig.tracer.store_caustics(batch, map, totals);
    map.build(batch.chunks() * 64, box, 0.1);
    spoilt.add(power_in(map));
  }
  bool aimed = true;
  const Spread without = caustic_power(glass_ball(lights[0], false, true), 24, aimed);
  EXPECT_NEAR(spoilt.mean, without.mean, 5 * std::sqrt(spoilt.error2() + without.error2()));
}

TEST(CausticAim, CellsAreThoseThatMeetTheGlass) {
  // oracle: geometry: from a point, straight, the ball's cone is 1 - sqrt(1 - (r/d)^2) over 2 of all directions
  // tolerance: marked cells hold it, and at most four times as much with those at the rim and their neighbours
  const RoomScene scene =
      parse_room("ball.toml",
                 "greenray = 1\n[camera]\nfrom = [0.5, 0.1, 0.5]\nto = [0.5, 0.9, 0.2]\n"
                 "[[material]]\nname = \"glass\"\nkind = \"dielectric\"\nindex = 1.5\n"
                 "[[sphere]]\ncentre = [0, 0, -1]\nradius_m = 0.3\nmaterial = \"glass\"\n"
                 "[[light]]\nkind = \"point\"\nfrom = [0.0, 0.8, -0.4]\npower_W = 5.0\n[spectrum]\nsamples = 1\n");
  Rig rig(scene);
  PhotonBatch batch;
  batch.photons = 1000;
  const CausticAim aim = find_caustic_aim(rig.tracer, rig.looks, batch);
  const double expected = 0.5 * (1 - std::sqrt(1 - 0.09)) * static_cast<int>(room_twin::PROJECTION_CELLS);
  EXPECT_GT(static_cast<double>(aim.marked), expected);
  EXPECT_LT(static_cast<double>(aim.marked), 4 * expected);
}

}  // namespace
}  // namespace greenray
