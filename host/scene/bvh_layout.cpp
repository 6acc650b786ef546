// From binary trees to the device's wide nodes and blocks of triangles.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include "scene/bvh.hpp"

namespace greenray {
namespace {

constexpr float huge_box_m = 1e30f;
constexpr int tree_stack = 128;      // TREE_STACK of kernels/shared/geometry.h
constexpr int leaf_kind_sphere = 1;  // LEAF_KIND_SPHERE
constexpr int triangle_scalars = static_cast<int>(surface32::TRIANGLE_SCALARS);
constexpr std::size_t most_primitives = std::size_t{1} << 26;

float down(double x) { return std::nextafter(static_cast<float>(x), -huge_box_m); }
float up(double x) { return std::nextafter(static_cast<float>(x), huge_box_m); }

Box box_of(const Triangle &t, double grow_m) {
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [low, high] = std::minmax({t.corner[0][a], t.corner[1][a], t.corner[2][a]});
    box.low[a] = down(low - grow_m);
    box.high[a] = up(high + grow_m);
  }
  return box;
}

Box box_of(const Sphere &s, double grow_m) {
  Box box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.low[a] = down(s.centre[a] - s.radius_m - grow_m);
    box.high[a] = up(s.centre[a] + s.radius_m + grow_m);
  }
  return box;
}

surface32::GeometryBounds bounds_of(const Surfaces &surfaces) {
  Box all;
  for (const Triangle &t : surfaces.triangles) all.include(box_of(t, 0));
  for (const Sphere &s : surfaces.spheres) all.include(box_of(s, 0));
  surface32::GeometryBounds bounds{};
  bounds.triangles = static_cast<int>(surfaces.triangles.size());
  bounds.spheres = static_cast<int>(surfaces.spheres.size());
  if (surfaces.empty()) return bounds;
  float extent = 0;
  for (std::size_t a = 0; a < 3; ++a) extent = std::max({extent, std::abs(all.low[a]), std::abs(all.high[a])});
  bounds.dilation_m = std::ldexp(extent, -21);
  bounds.clearance_m = std::ldexp(extent, -18);
  for (std::size_t a = 0; a < 3; ++a) {
    bounds.low[a] = all.low[a] - bounds.dilation_m;
    bounds.high[a] = all.high[a] + bounds.dilation_m;
  }
  return bounds;
}

/// The numbers of TriangleScalar for one triangle, in double.
std::array<double, 15> scalars_of(const Triangle &t, double dilation_m) {
  const Triple e1 = t.corner[1] - t.corner[0], e2 = t.corner[2] - t.corner[0];
  const Triple area2 = cross(e1, e2), normal = unit(area2);
  const double inverse = 1 / dot(area2, area2);
  const Triple u = inverse * cross(e2, area2), v = inverse * cross(area2, e1);  // u . e1 = 1, u . e2 = 0, and so on
  const Triple &o = t.corner[0];
  return {normal[0],
          normal[1],
          normal[2],
          -dot(normal, o),
          u[0],
          u[1],
          u[2],
          -dot(u, o),
          v[0],
          v[1],
          v[2],
          -dot(v, o),
          dilation_m * length(u),
          dilation_m * length(v),
          dilation_m * length(u + v)};
}

surface32::SurfaceTriangle record_of(const Triangle &t) {
  surface32::SurfaceTriangle r{};
  const Triple area = t.area_vector_m2(), normal = unit(area);
  for (std::size_t a = 0; a < 3; ++a) r.normal[a] = static_cast<float>(normal[a]);
  r.area_m2 = static_cast<float>(length(area));
  for (std::size_t c = 0; c < 3; ++c) {
    const bool flat = length(t.corner_normal[c]) == 0;
    for (std::size_t a = 0; a < 3; ++a) {
      r.corner[c][a] = static_cast<float>(t.corner[c][a]);
      r.corner_normal[c][a] = flat ? r.normal[a] : static_cast<float>(t.corner_normal[c][a]);
    }
    for (std::size_t k = 0; k < 2; ++k) r.texture[c][k] = static_cast<float>(t.texture[c][k]);
  }
  r.material = t.material;
  r.light = t.light;
  return r;
}

/// Writes nodes of `lanes` (at least two) children from two binary trees, one of triangles and one of spheres.
class Layout {
 public:
  Layout(SurfaceTree &out, const Surfaces &surfaces) : out_(out), surfaces_(surfaces), width_(std::max(out.lanes, 2)) {}

  void lay(const BinaryTree &triangles, const BinaryTree &spheres) {
    std::vector<Part> parts;
    if (!triangles.nodes.empty()) parts.push_back({&triangles, 0});
    if (!spheres.nodes.empty()) parts.push_back({&spheres, 0});
    out_.stack_needed = 1 + lay_node(parts);
    out_.node_count = out_.children.size() / static_cast<std::size_t>(width_);
  }

 private:
  struct Part {
    const BinaryTree *tree;
    int node;
    const BinaryNode &get() const { return tree->nodes[static_cast<std::size_t>(node)]; }
    bool is_leaf() const { return get().left < 0; }
  };

  /// The parts, the largest opened again and again until a node is full.
  void open(std::vector<Part> &parts) const {
    while (static_cast<int>(parts.size()) < width_) {
      Part *largest = nullptr;
      for (Part &p : parts)
        if (!p.is_leaf() && (!largest || p.get().box.half_area() > largest->get().box.half_area())) largest = &p;
      if (!largest) return;
      const Part opened = *largest;
      *largest = {opened.tree, opened.get().left};
      parts.push_back({opened.tree, opened.get().right});
    }
  }

  /// returns: stack entries that a search below this node can need beyond the node's own
  int lay_node(std::vector<Part> parts) {
    open(parts);
    const auto width = static_cast<std::size_t>(width_);
    const std::size_t index = out_.children.size() / width;
    out_.children.resize(out_.children.size() + width, ~0);
    out_.boxes.resize(out_.boxes.size() + 6 * width);
    for (std::size_t k = 0; k < width; ++k)
      for (std::size_t a = 0; a < 3; ++a) {
        const bool is_there = k < parts.size();
        out_.boxes[(index * 6 + a) * width + k] = is_there ? parts[k].get().box.low[a] : huge_box_m;
        out_.boxes[(index * 6 + 3 + a) * width + k] = is_there ? parts[k].get().box.high[a] : -huge_box_m;
      }
    int deepest = 0;
    for (std::size_t k = 0; k < parts.size(); ++k) {
      int child = 0;
      if (parts[k].is_leaf()) {
        child = lay_leaf(parts[k]);
      } else {
        child = static_cast<int>(out_.children.size() / width);
        deepest = std::max(deepest, lay_node({parts[k]}));
      }
      out_.children[index * width + k] = child;
    }
    return static_cast<int>(parts.size()) - 1 + std::max(deepest, 1);
  }

  int lay_leaf(const Part &part) {
    const BinaryNode &leaf = part.get();
    const int *ids = part.tree->order.data() + leaf.first;
    if (part.tree->nodes.data() == sphere_nodes_)
      return code(lay_spheres(ids, leaf.count), leaf.count, leaf_kind_sphere);
    return code(lay_triangles(ids, leaf.count), (leaf.count + out_.lanes - 1) / out_.lanes, 0);
  }
  static int code(int first, int count, int kind) { return ~(first << 5 | (count - 1) << 1 | kind); }

  int lay_triangles(const int *ids, int count) {
    const auto lanes = static_cast<std::size_t>(out_.lanes), scalars = static_cast<std::size_t>(triangle_scalars);
    const std::size_t first = out_.block_ids.size() / lanes;
    const std::size_t blocks = (static_cast<std::size_t>(count) + lanes - 1) / lanes;
    out_.block_ids.resize((first + blocks) * lanes, -1);
    out_.blocks.resize((first + blocks) * lanes * scalars, 0.0f);
    for (std::size_t i = 0; i < blocks * lanes; ++i) {
      const std::size_t block = first + i / lanes, lane = i % lanes;
      float *to = out_.blocks.data() + block * scalars * lanes + lane;
      if (i >= static_cast<std::size_t>(count)) {  // a plane at a distance that no path reaches: normal 0
        to[surface32::TRIANGLE_PLANE * lanes + 3 * lanes] = 1;
        continue;
      }
      out_.block_ids[block * lanes + lane] = ids[i];
      const auto values = scalars_of(surfaces_.triangles[static_cast<std::size_t>(ids[i])],
                                     static_cast<double>(out_.bounds.dilation_m));
      for (std::size_t s = 0; s < scalars; ++s) to[s * lanes] = static_cast<float>(values[s]);
    }
    return static_cast<int>(first);
  }

  /// Spheres keep their places in out_.spheres; a leaf holds one.
  int lay_spheres(const int *ids, int count) {
    if (count != 1) throw std::logic_error("a leaf holds one sphere");
    return ids[0];
  }

  SurfaceTree &out_;
  const Surfaces &surfaces_;
  int width_;

 public:
  const BinaryNode *sphere_nodes_ = nullptr;
};

void lay_out(SurfaceTree &tree, const Surfaces &surfaces, const BinaryTree &triangles, const BinaryTree &spheres) {
  tree.boxes.clear(), tree.children.clear(), tree.blocks.clear(), tree.block_ids.clear();
  Layout layout(tree, surfaces);
  layout.sphere_nodes_ = spheres.nodes.data();
  layout.lay(triangles, spheres);
}

}  // namespace

SurfaceTree build_surface_tree(const Surfaces &surfaces, int lanes, TreeBuilder builder) {
  const auto begin = std::chrono::steady_clock::now();
  if (surfaces.triangles.size() > most_primitives || surfaces.spheres.size() > most_primitives)
    throw std::length_error("more than 67 million triangles or spheres");
  SurfaceTree tree;
  tree.lanes = lanes;
  tree.bounds = bounds_of(surfaces);
  std::vector<Box> triangle_boxes, sphere_boxes;
  const double grow_m = static_cast<double>(tree.bounds.dilation_m);
  for (const Triangle &t : surfaces.triangles) {
    triangle_boxes.push_back(box_of(t, grow_m));
    tree.triangles.push_back(record_of(t));
  }
  for (const Sphere &s : surfaces.spheres) {
    sphere_boxes.push_back(box_of(s, grow_m));
    surface32::SurfaceSphere r{};
    for (std::size_t a = 0; a < 3; ++a) r.centre[a] = static_cast<float>(s.centre[a]);
    r.radius_m = static_cast<float>(s.radius_m), r.material = s.material, r.light = s.light;
    tree.spheres.push_back(r);
  }
  const int leaf_size = lanes == 1 ? 4 : lanes;
  const BinaryTree spheres = build_binary_tree(sphere_boxes, 1, 1);
  const BinaryTree triangles = builder == TreeBuilder::embree
                                   ? build_binary_tree_by_embree(triangle_boxes, leaf_size, lanes)
                                   : build_binary_tree(triangle_boxes, leaf_size, lanes);
  lay_out(tree, surfaces, triangles, spheres);
  if (tree.stack_needed > tree_stack)  // a tree as lopsided as that: part evenly instead
    lay_out(tree, surfaces, build_binary_tree(triangle_boxes, leaf_size, lanes, true),
            build_binary_tree(sphere_boxes, 1, 1, true));
  tree.build_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return tree;
}

}  // namespace greenray
