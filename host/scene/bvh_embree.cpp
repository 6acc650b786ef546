// The binary tree by Embree's builder, where libembree-dev was found.
#include "scene/bvh.hpp"

#ifdef GREENRAY_WITH_EMBREE
#include <embree3/rtcore.h>

#include <algorithm>
#include <memory>
#endif

namespace greenray {

#ifdef GREENRAY_WITH_EMBREE

bool bvh_by_embree_is_built() { return true; }

namespace {

/// What the builder makes, in its own memory: with leaf.count > 0 a leaf.
struct Made {
  Box box;
  Made *left, *right;
  unsigned *ids;
  unsigned count;
};

void *make_node(RTCThreadLocalAllocator memory, unsigned, void *) {
  return new (rtcThreadLocalAlloc(memory, sizeof(Made), 16)) Made{};
}

void set_children(void *node, void **children, unsigned, void *) {
  static_cast<Made *>(node)->left = static_cast<Made *>(children[0]);
  static_cast<Made *>(node)->right = static_cast<Made *>(children[1]);
}

/// Embree hands each child's bounds to its parent.
void set_bounds(void *, const RTCBounds **, unsigned, void *) {}

void *make_leaf(RTCThreadLocalAllocator memory, const RTCBuildPrimitive *primitives, size_t count, void *) {
  Made *leaf = new (rtcThreadLocalAlloc(memory, sizeof(Made), 16)) Made{};
  leaf->ids = static_cast<unsigned *>(rtcThreadLocalAlloc(memory, count * sizeof(unsigned), 16));
  leaf->count = static_cast<unsigned>(count);
  for (size_t i = 0; i < count; ++i) {
    leaf->ids[i] = primitives[i].primID;
    const RTCBuildPrimitive &p = primitives[i];
    leaf->box.include({{p.lower_x, p.lower_y, p.lower_z}, {p.upper_x, p.upper_y, p.upper_z}});
  }
  return leaf;
}

int take_over(const Made &from, BinaryTree &tree) {
  const auto index = tree.nodes.size();
  tree.nodes.emplace_back();
  if (from.count > 0) {
    tree.nodes[index].box = from.box;
    tree.nodes[index].first = static_cast<int>(tree.order.size());
    tree.nodes[index].count = static_cast<int>(from.count);
    for (unsigned i = 0; i < from.count; ++i) tree.order.push_back(static_cast<int>(from.ids[i]));
    return static_cast<int>(index);
  }
  const int left = take_over(*from.left, tree), right = take_over(*from.right, tree);
  BinaryNode &node = tree.nodes[index];
  node.left = left, node.right = right;
  node.box = tree.nodes[static_cast<std::size_t>(left)].box;
  node.box.include(tree.nodes[static_cast<std::size_t>(right)].box);
  return static_cast<int>(index);
}

}  // namespace

BinaryTree build_binary_tree_by_embree(const std::vector<Box> &boxes, int leaf_size, int together) {
  BinaryTree tree;
  if (boxes.empty()) return tree;
  std::vector<RTCBuildPrimitive> primitives(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Box &b = boxes[i];
    primitives[i] = {b.low[0], b.low[1], b.low[2], 0, b.high[0], b.high[1], b.high[2], static_cast<unsigned>(i)};
  }
  const std::unique_ptr<RTCDeviceTy, void (*)(RTCDevice)> device(rtcNewDevice(nullptr), rtcReleaseDevice);
  const std::unique_ptr<RTCBVHTy, void (*)(RTCBVH)> bvh(rtcNewBVH(device.get()), rtcReleaseBVH);
  RTCBuildArguments arguments = rtcDefaultBuildArguments();
  arguments.buildQuality = RTC_BUILD_QUALITY_MEDIUM;
  arguments.maxBranchingFactor = 2;
  arguments.maxDepth = 64;
  arguments.sahBlockSize = static_cast<unsigned>(together);
  arguments.minLeafSize = 1;
  arguments.maxLeafSize = static_cast<unsigned>(leaf_size);
  arguments.bvh = bvh.get();
  arguments.primitives = primitives.data();
  arguments.primitiveCount = primitives.size();
  arguments.primitiveArrayCapacity = primitives.size();
  arguments.createNode = make_node;
  arguments.setNodeChildren = set_children;
  arguments.setNodeBounds = set_bounds;
  arguments.createLeaf = make_leaf;
  const void *root = rtcBuildBVH(&arguments);
  if (!root)
    throw RunError("Embree could not build the tree (error " + std::to_string(rtcGetDeviceError(device.get())) + ")");
  take_over(*static_cast<const Made *>(root), tree);
  return tree;
}

#else

bool bvh_by_embree_is_built() { return false; }

BinaryTree build_binary_tree_by_embree(const std::vector<Box> &, int, int) {
  throw RunError("this greenray was built without Embree (Debian: libembree-dev)");
}

#endif

}  // namespace greenray
