// The tree finds what brute force finds, whoever built it and however wide it is.
#include <gtest/gtest.h>

#include <numeric>

#include "support_code/surfaces.hpp"
#include "support_code/twin_traits.hpp"

namespace greenray {
namespace {

surface32::Segment segment(const Triple &from, const Triple &to) {
  surface32::Segment s{};
  const Triple d = to - from;
  for (std::size_t a = 0; a < 3; ++a) {
    s.place[a] = static_cast<float>(from[a]);
    s.direction[a] = static_cast<float>(d[a]);
  }
  return s;
}

std::vector<surface32::Segment> random_segments(std::size_t count, double size_m, unsigned seed) {
  std::mt19937 engine(seed);
  std::vector<surface32::Segment> segments;
  for (std::size_t i = 0; i < count; ++i) {
    const Triple from = random_triple(engine, -1.2 * size_m, 1.2 * size_m);
    // Every eighth goes along an axis or a plane: zeros in the direction.
    Triple to = random_triple(engine, -1.2 * size_m, 1.2 * size_m);
    if (i % 8 == 0) to[i / 8 % 3] = from[i / 8 % 3];
    if (i % 16 == 0) to[(i / 8 + 1) % 3] = from[(i / 8 + 1) % 3];
    segments.push_back(segment(from, to));
  }
  return segments;
}

/// Segments for which the hit is neither what is certain nor one that an edge moved by the margin would make.
int mismatches(const Surfaces &scene, const std::vector<surface32::Segment> &segments,
               const std::vector<surface32::SegmentHit> &hits, double margin_m) {
  int wrong = 0;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const Triple from = triple_of(segments[i].place), along = triple_of(segments[i].direction);
    const BruteForce b = brute_force(scene, from, along, 1, margin_m);
    const double tolerance = 20 * margin_m / length(along);
    const bool hit = hits[i].primitive >= 0;
    const double sigma = static_cast<double>(hits[i].sigma);
    const bool as_certain =
        hit && hits[i].primitive == b.certain.primitive && std::abs(sigma - b.certain.sigma) < tolerance;
    const bool both_nothing = !hit && b.certain.primitive < 0;
    const bool as_possible = hit && b.possible.primitive == hits[i].primitive;
    // Where something merely possible comes first, it or the certain one are right; where nothing does, only the
    // latter.
    if (!(as_certain || both_nothing || as_possible)) ++wrong;
  }
  return wrong;
}

/// So few that brute force on 1e6 segments takes seconds.
constexpr int few_triangles = 120, few_spheres = 6;

class TreeOnDevice : public ::testing::TestWithParam<int> {};

TEST_P(TreeOnDevice, MillionSegmentsLikeBruteForce) {
  // oracle: Moller & Trumbore's test and the sphere's quadratic on everything, in double
  // tolerance: none. A hit closer to an edge than 8 roundings of the scene's size may be taken or not.
  const double size_m = 5;
  const Surfaces scene = soup(few_triangles, few_spheres, size_m, 7);
  const auto device = shared_device(GetParam());
  SurfaceScene on_device(device, build_surface_tree(scene, SurfaceScene::lanes_for(*device)), uniform_air(0, {550}));
  const auto segments = random_segments(GetParam() == 8 ? 1000000 : 100000, size_m, 11);
  const auto hits = on_device.find(segments);
  EXPECT_EQ(mismatches(scene, segments, hits, size_m * 1e-6), 0);
  const auto met = std::count_if(hits.begin(), hits.end(), [](const auto &h) { return h.primitive >= 0; });
  EXPECT_GT(met, static_cast<long>(segments.size() / 10));
  EXPECT_LT(met, static_cast<long>(segments.size() * 9 / 10));
}

TEST_P(TreeOnDevice, SameHitsFromEveryTree) {
  // oracle: the same search through a tree of another width, or by another builder
  // tolerance: none: equal places are decided by number, so the tree does not matter
  const Surfaces scene = soup(3000, 20, 5, 3);
  const auto segments = random_segments(20000, 5, 12);
  const auto narrow = shared_device(1), wide = shared_device(GetParam());
  SurfaceScene reference(narrow, build_surface_tree(scene, 1), uniform_air(0, {550}));
  const auto expected = reference.find(segments);
  std::vector<TreeBuilder> builders{TreeBuilder::own};
  if (bvh_by_embree_is_built()) builders.push_back(TreeBuilder::embree);
  for (const TreeBuilder builder : builders) {
    SurfaceScene on_device(wide, build_surface_tree(scene, SurfaceScene::lanes_for(*wide), builder),
                           uniform_air(0, {550}));
    const auto hits = on_device.find(segments);
    int different = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) different += hits[i].primitive != expected[i].primitive;
    EXPECT_EQ(different, 0) << "builder " << static_cast<int>(builder);
  }
}

INSTANTIATE_TEST_SUITE_P(Lanes, TreeOnDevice, ::testing::Values(1, 4, 8));

TEST(Tree, HoldsEverythingOnce) {
  // oracle: the scene: each triangle stands in one block, inside the boxes above it
  // tolerance: none
  for (const int lanes : {1, 4, 8}) {
    const Surfaces scene = soup(5000, 30, 5, 5);
    const SurfaceTree tree = build_surface_tree(scene, lanes);
    std::vector<int> seen(scene.triangles.size() + scene.spheres.size());
    const std::size_t width = static_cast<std::size_t>(std::max(lanes, 2));
    for (std::size_t n = 0; n < tree.node_count; ++n)
      for (std::size_t k = 0; k < width; ++k) {
        const int child = tree.children[n * width + k];
        const float *box = tree.boxes.data() + n * 6 * width + k;
        if (child >= 0 || box[0] > box[3 * width]) continue;
        const int code = ~child, first = code >> 5, count = (code >> 1 & 15) + 1;
        for (int b = first; b < first + count; ++b) {
          if (code & 1) {
            ++seen[scene.triangles.size() + static_cast<std::size_t>(b)];
            continue;
          }
          for (int l = 0; l < lanes; ++l) {
            const int id = tree.block_ids[static_cast<std::size_t>(b * lanes + l)];
            if (id < 0) continue;
            ++seen[static_cast<std::size_t>(id)];
            for (const Triple &c : scene.triangles[static_cast<std::size_t>(id)].corner)
              for (std::size_t a = 0; a < 3; ++a) {
                EXPECT_LE(static_cast<double>(box[a * width]), c[a]);
                EXPECT_GE(static_cast<double>(box[(3 + a) * width]), c[a]);
              }
          }
        }
      }
    EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<long>(seen.size())) << lanes;
    EXPECT_LE(tree.stack_needed, 128);
  }
}

TEST(Tree, HardToPartScenes) {
  // oracle: brute force; and the tree's own stack bound
  // tolerance: none
  Surfaces same = soup(1, 0, 1, 1);
  for (int i = 0; i < 3000; ++i) same.triangles.push_back(same.triangles.front());
  Surfaces growing;  // each half as large again as the last: a tree that wants to be a list
  for (int i = 0; i < 40; ++i) {
    const double s = std::pow(10.0, -6 + 0.15 * i);
    growing.triangles.push_back({{Triple{s, 0, 0}, Triple{s, s, 0}, Triple{s, 0, s}}, {}, {}, 0, -1});
  }
  for (const Surfaces &scene : {same, growing}) {
    for (const int lanes : {1, 4, 8}) EXPECT_LE(build_surface_tree(scene, lanes).stack_needed, 128);
    SurfaceScene on_device(shared_device(), build_surface_tree(scene, SurfaceScene::lanes_for(*shared_device())),
                           uniform_air(0, {550}));
    std::mt19937 engine(5);
    std::vector<surface32::Segment> segments;
    for (int i = 0; i < 2000; ++i)
      segments.push_back(segment(random_triple(engine, -2, 2), random_triple(engine, -2, 2)));
    EXPECT_EQ(mismatches(scene, segments, on_device.find(segments), 2e-6), 0);
  }
}

TEST(Tree, NoGapsBetweenNeighbours) {
  // oracle: a closed surface: a path from its inside meets it, wherever it is aimed
  // tolerance: none; paths are aimed at corners, middles of edges, and between
  const Surfaces scene = ball(5, 3, {40, -20, 7});
  SurfaceScene on_device(shared_device(), build_surface_tree(scene, SurfaceScene::lanes_for(*shared_device())),
                         uniform_air(0, {550}));
  std::mt19937 engine(9);
  std::uniform_int_distribution<std::size_t> any(0, scene.triangles.size() - 1);
  std::vector<surface32::Segment> segments;
  for (int i = 0; i < 300000; ++i) {
    const Triangle &t = scene.triangles[any(engine)];
    const Triple aim = i % 3 == 0   ? t.corner[0]
                       : i % 3 == 1 ? 0.5 * (t.corner[0] + t.corner[1])
                                    : t.corner[2] + 0.3 * (t.corner[1] - t.corner[2]);
    const Triple from = Triple{40, -20, 7} + random_triple(engine, -1, 1);
    segments.push_back(segment(from, from + 1.5 * (aim - from)));
  }
  const auto hits = on_device.find(segments);
  EXPECT_EQ(std::count_if(hits.begin(), hits.end(), [](const auto &h) { return h.primitive < 0; }), 0);
}

}  // namespace
}  // namespace greenray
