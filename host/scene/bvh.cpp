#include "scene/bvh.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace greenray {

void Box::include(const Box &other) {
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::min(low[a], other.low[a]);
    high[a] = std::max(high[a], other.high[a]);
  }
}

float Box::half_area() const {
  const float x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  return x < 0 ? 0 : x * y + y * z + z * x;
}

namespace {

constexpr int bins = 32;
constexpr int deepest_by_area = 48;

struct Parting {
  double cost = 1e300;
  std::size_t axis = 0;
  int bin = 0;  // boxes of bins below it go left
};

/// Where a box's centre falls among the bins of a range of centres.
struct Binning {
  float low, scale;
  Binning(float from, float to) : low(from), scale(to > from ? static_cast<float>(bins) / (to - from) : 0) {}
  int operator()(float centre2) const { return std::clamp(static_cast<int>((centre2 - low) * scale), 0, bins - 1); }
};

class Builder {
 public:
  Builder(const std::vector<Box> &boxes, int leaf_size, int together, bool evenly)
      : boxes_(boxes), leaf_size_(leaf_size), together_(together), evenly_(evenly) {
    tree_.order.resize(boxes.size());
    std::iota(tree_.order.begin(), tree_.order.end(), 0);
  }

  BinaryTree build() {
    if (!boxes_.empty()) grow(0, static_cast<int>(boxes_.size()), 0);
    return std::move(tree_);
  }

 private:
  int grow(int first, int count, int depth) {
    const int index = static_cast<int>(tree_.nodes.size());
    tree_.nodes.emplace_back();
    Box box, centres;
    for (int i = first; i < first + count; ++i) {
      const Box &b = box_at(i);
      box.include(b);
      const Box centre{{b.centre2(0), b.centre2(1), b.centre2(2)}, {b.centre2(0), b.centre2(1), b.centre2(2)}};
      centres.include(centre);
    }
    const int middle = part(first, count, depth, box, centres);
    tree_.nodes[static_cast<std::size_t>(index)].box = box;
    if (middle == first) {
      tree_.nodes[static_cast<std::size_t>(index)].first = first;
      tree_.nodes[static_cast<std::size_t>(index)].count = count;
      return index;
    }
    const int left = grow(first, middle - first, depth + 1);
    const int right = grow(middle, first + count - middle, depth + 1);
    tree_.nodes[static_cast<std::size_t>(index)].left = left;
    tree_.nodes[static_cast<std::size_t>(index)].right = right;
    return index;
  }

  const Box &box_at(int i) const { return boxes_[static_cast<std::size_t>(tree_.order[static_cast<std::size_t>(i)])]; }
  double rounded_up(int count) const { return (count + together_ - 1) / together_; }

  /// Reorders the range; returns where the right part begins, or `first` for a leaf.
  int part(int first, int count, int depth, const Box &box, const Box &centres) {
    if (count == 1) return first;
    Parting best;
    if (!evenly_ && depth < deepest_by_area)
      for (std::size_t axis = 0; axis < 3; ++axis) consider(axis, first, count, centres, best);
    const double as_leaf = rounded_up(count) * box.half_area();
    const double step = box.half_area();  // testing the two boxes of one more node
    if (count <= leaf_size_ && (best.cost + step >= as_leaf || best.cost > 1e299)) return first;
    if (best.cost > 1e299) return part_evenly(first, count, centres);
    const Binning bin(centres.low[best.axis], centres.high[best.axis]);
    const auto begin = tree_.order.begin() + first;
    return static_cast<int>(std::partition(begin, begin + count,
                                           [&](int i) {
                                             const Box &b = boxes_[static_cast<std::size_t>(i)];
                                             return bin(b.centre2(best.axis)) < best.bin;
                                           }) -
                            tree_.order.begin());
  }

  void consider(std::size_t axis, int first, int count, const Box &centres, Parting &best) const {
    if (!(centres.high[axis] > centres.low[axis])) return;
    const Binning bin(centres.low[axis], centres.high[axis]);
    std::array<Box, bins> box;
    std::array<int, bins> inside{};
    for (int i = first; i < first + count; ++i) {
      const Box &b = box_at(i);
      const auto k = static_cast<std::size_t>(bin(b.centre2(axis)));
      box[k].include(b);
      ++inside[k];
    }
    std::array<double, bins> right_cost{};
    Box right;
    int right_count = 0;
    for (std::size_t k = bins - 1; k > 0; --k) {
      right.include(box[k]);
      right_count += inside[k];
      right_cost[k] = right_count ? rounded_up(right_count) * right.half_area() : 1e300;
    }
    Box left;
    int left_count = 0;
    for (std::size_t k = 1; k < bins; ++k) {
      left.include(box[k - 1]);
      left_count += inside[k - 1];
      const double cost = left_count ? rounded_up(left_count) * left.half_area() + right_cost[k] : 1e300;
      if (cost < best.cost) best = {cost, axis, static_cast<int>(k)};
    }
  }

  int part_evenly(int first, int count, const Box &centres) {
    std::size_t axis = 0;
    for (std::size_t a = 1; a < 3; ++a)
      if (centres.high[a] - centres.low[a] > centres.high[axis] - centres.low[axis]) axis = a;
    const auto begin = tree_.order.begin() + first;
    std::nth_element(begin, begin + count / 2, begin + count, [&](int a, int b) {
      const float x = boxes_[static_cast<std::size_t>(a)].centre2(axis),
                  y = boxes_[static_cast<std::size_t>(b)].centre2(axis);
      return x < y || (x == y && a < b);
    });
    return first + count / 2;
  }

  const std::vector<Box> &boxes_;
  int leaf_size_, together_;
  bool evenly_;
  BinaryTree tree_;
};

}  // namespace

BinaryTree build_binary_tree(const std::vector<Box> &boxes, int leaf_size, int together, bool evenly) {
  return Builder(boxes, leaf_size, together, evenly).build();
}

}  // namespace greenray
