// Unevenly spaced places of a table, found in constant time.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

namespace greenray {

class Axis {
 public:
  Axis() = default;
  /// nodes: ascending, at least two.
  explicit Axis(std::vector<double> nodes) : nodes_(std::move(nodes)) {
    constexpr std::size_t bins_per_node = 16;
    const std::size_t bins = bins_per_node * nodes_.size();
    per_bin_ = static_cast<double>(bins) / (nodes_.back() - nodes_.front());
    std::size_t k = 0;
    for (std::size_t bin = 0; bin <= bins; ++bin) {
      const double at = nodes_.front() + static_cast<double>(bin) / per_bin_;
      while (k + 2 < nodes_.size() && nodes_[k + 1] <= at) ++k;
      first_.push_back(static_cast<std::uint32_t>(k));
    }
  }

  std::size_t size() const { return nodes_.size(); }
  double operator[](std::size_t i) const { return nodes_[i]; }
  double front() const { return nodes_.front(); }
  double back() const { return nodes_.back(); }
  const std::vector<double> &nodes() const { return nodes_; }

  /// Cell and the fraction of the way to its upper end; beyond the ends: 0 or 1 there.
  struct Place {
    std::size_t cell;
    double fraction;
  };
  Place find(double x) const {
    if (!(x > nodes_.front())) return {0, 0};
    if (x >= nodes_.back()) return {nodes_.size() - 2, 1};
    std::size_t k = first_[static_cast<std::size_t>((x - nodes_.front()) * per_bin_)];
    while (k + 2 < nodes_.size() && nodes_[k + 1] <= x) ++k;
    return {k, std::clamp((x - nodes_[k]) / (nodes_[k + 1] - nodes_[k]), 0.0, 1.0)};
  }

 private:
  std::vector<double> nodes_;
  std::vector<std::uint32_t> first_;  // cell at the start of each bin
  double per_bin_ = 0;
};

}  // namespace greenray
