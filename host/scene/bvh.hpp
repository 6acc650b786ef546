// Bounding volume hierarchy: built over boxes as a binary tree, then widened and laid out for the device
// (kernels/shared/geometry.h).
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "scene/surfaces.hpp"
#include "twin/surface_twin.hpp"

namespace greenray {

struct Box {
  std::array<float, 3> low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  void include(const Box &other);
  float half_area() const;                                                  // 0 for an empty box
  float centre2(std::size_t axis) const { return low[axis] + high[axis]; }  // twice the centre
};

/// Children are nodes of the same list; left < 0 is a leaf over order[first .. first + count).
struct BinaryNode {
  Box box;
  int left = -1, right = -1;
  int first = 0, count = 0;
};

struct BinaryTree {
  std::vector<BinaryNode> nodes;  // root first; empty when there is nothing in it
  std::vector<int> order;         // of the boxes
};

/// Who decides where boxes are parted. embree needs the library at build time (bvh_by_embree_is_built).
enum class TreeBuilder { own, embree };
bool bvh_by_embree_is_built();

/* Binned surface area heuristic over the centres, 32 bins on each axis; leaves hold at most leaf_size boxes.
   together: boxes tested at once in a leaf (cost of a leaf: ceil(count/together))
   source: Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007
   differs: from depth 48 on boxes are parted evenly, so that the depth stays bounded whatever the scene */
BinaryTree build_binary_tree(const std::vector<Box> &boxes, int leaf_size, int together, bool evenly = false);

/// The same by Embree's rtcBuildBVH. errors: RunError where it is not built in, or fails
BinaryTree build_binary_tree_by_embree(const std::vector<Box> &boxes, int leaf_size, int together);

/// Arrays of kernels/shared/geometry.h, for a device with `lanes` lanes.
struct SurfaceTree {
  int lanes = 1;
  std::vector<float> boxes;
  std::vector<int> children;
  std::vector<float> blocks;
  std::vector<int> block_ids;
  std::vector<surface32::SurfaceTriangle> triangles;
  std::vector<surface32::SurfaceSphere> spheres;  // in the order of the scene
  surface32::GeometryBounds bounds{};
  std::size_t node_count = 0;
  int stack_needed = 0;  // entries of TREE_STACK in the worst case
  double build_seconds = 0;
};

/// errors: InputError-free; std::length_error for more primitives than child codes can number (2^26)
SurfaceTree build_surface_tree(const Surfaces &surfaces, int lanes, TreeBuilder builder = TreeBuilder::own);

}  // namespace greenray
