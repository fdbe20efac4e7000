// Finds which of many boxes touch a given one: a binary tree over their middles, halved along the widest axis.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

#include "patches/base/vec.h"

namespace iso {

template <class V>
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box<V>> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    if (!boxes_.empty()) build(0, order_.size());
  }

  const Box<V>& box(std::uint32_t i) const { return boxes_[i]; }

  // Calls f(i) for every box that has a point in common with `query`, borders included; the order depends on the boxes only.
  template <class F>
  void for_each_touching(const Box<V>& query, F f) const {
    if (!nodes_.empty()) visit(0, query, f);
  }

 private:
  static constexpr std::size_t kLeaf = 4;  // boxes

  struct Node {
    Box<V> box;
    std::uint32_t begin = 0, end = 0;  // of order_
    std::uint32_t right = 0;           // its second half; the first follows it; 0: a leaf
  };

  static bool touch(const Box<V>& a, const Box<V>& b) {
    for (int k = 0; k < V::length(); ++k)
      if (a.hi[k] < b.lo[k] || b.hi[k] < a.lo[k]) return false;
    return true;
  }

  void build(std::size_t begin, std::size_t end) {
    const std::size_t self = nodes_.size();
    nodes_.push_back({{}, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), 0});
    Box<V> middles;
    for (std::size_t i = begin; i < end; ++i) {
      nodes_[self].box.include(boxes_[order_[i]]);
      middles.include(boxes_[order_[i]].middle());
    }
    if (end - begin <= kLeaf) return;
    int axis = 0;
    for (int k = 1; k < V::length(); ++k)
      if (middles.size()[k] > middles.size()[axis]) axis = k;
    const std::size_t half = begin + (end - begin) / 2;
    const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(half), at(end), [&](std::uint32_t a, std::uint32_t b) {
      const double x = boxes_[a].middle()[axis], y = boxes_[b].middle()[axis];
      return x != y ? x < y : a < b;
    });
    build(begin, half);
    nodes_[self].right = static_cast<std::uint32_t>(nodes_.size());
    build(half, end);
  }

  template <class F>
  void visit(std::size_t self, const Box<V>& query, F& f) const {
    const Node& node = nodes_[self];
    if (!touch(node.box, query)) return;
    if (node.right == 0) {
      for (std::uint32_t i = node.begin; i < node.end; ++i)
        if (touch(boxes_[order_[i]], query)) f(order_[i]);
      return;
    }
    visit(self + 1, query, f);
    visit(node.right, query, f);
  }

  std::vector<Box<V>> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace iso
