// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/triangle_bvh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr int leaf_size = TriangleBvh::width;
constexpr int bin_count = 16;
/// Below this many triangles a subtree is one task: few enough tasks, and the same ones on any machine.
constexpr int task_size = 8192;
/// Deeper than this the split falls at the median, which bounds the depth of degenerate input.
constexpr int deepest_heuristic = 32;

/// Four triangles are tested at the price of one.
float blocks(int triangles) { return static_cast<float>((triangles + leaf_size - 1) / leaf_size); }

}  // namespace

struct TriangleBvh::Builder {
  struct Box {
    std::array<float, 3> lower, upper;
    Box() {
      lower.fill(std::numeric_limits<float>::infinity());
      upper.fill(-std::numeric_limits<float>::infinity());
    }
    void add(const Box& other) {
      for (std::size_t k = 0; k < 3; ++k) {
        lower[k] = other.lower[k] < lower[k] ? other.lower[k] : lower[k];
        upper[k] = other.upper[k] > upper[k] ? other.upper[k] : upper[k];
      }
    }
    void add_point(const std::array<float, 3>& point) {
      for (std::size_t k = 0; k < 3; ++k) {
        lower[k] = point[k] < lower[k] ? point[k] : lower[k];
        upper[k] = point[k] > upper[k] ? point[k] : upper[k];
      }
    }
    float half_area() const {
      if (!(lower[0] <= upper[0])) return 0;
      const float x = upper[0] - lower[0], y = upper[1] - lower[1], z = upper[2] - lower[2];
      return x * y + y * z + z * x;
    }
    float middle(std::size_t k) const { return 0.5f * (lower[k] + upper[k]); }
  };

  struct Range {
    int begin, end;
    Box box;
    int size() const { return end - begin; }
  };

  struct Reference {
    Box box;
    std::int32_t face;
  };
  std::vector<Reference> references;  // leaf by leaf once built

  /// Splits where the surface area heuristic over binned centres is least.
  std::pair<Range, Range> split(const Range& range, int depth) {
    Reference* const begin = references.data() + range.begin;
    Reference* const end = references.data() + range.end;
    std::array<float, 3> first{}, scale{};
    {
      Box centres;
      for (const Reference* r = begin; r < end; ++r)
        centres.add_point({r->box.middle(0), r->box.middle(1), r->box.middle(2)});
      for (std::size_t k = 0; k < 3; ++k) {
        const float extent = centres.upper[k] - centres.lower[k];
        first[k] = centres.lower[k];
        scale[k] = extent > 0 && depth <= deepest_heuristic ? static_cast<float>(bin_count) / extent : 0;
        if (!std::isfinite(scale[k])) scale[k] = 0;
      }
    }
    const auto bin_of = [&](const Box& box, std::size_t k) {
      const int bin = static_cast<int>((box.middle(k) - first[k]) * scale[k]);
      return static_cast<std::size_t>(std::min(bin, bin_count - 1));
    };
    std::array<std::array<Box, bin_count>, 3> bins;
    std::array<std::array<int, bin_count>, 3> counts{};
    for (const Reference* r = begin; r < end; ++r)
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t bin = bin_of(r->box, k);
        bins[k][bin].add(r->box);
        ++counts[k][bin];
      }

    float best_cost = std::numeric_limits<float>::infinity();
    std::size_t best_axis = 3, best_bin = 0;
    Box best_left, best_right;
    for (std::size_t k = 0; k < 3; ++k) {
      if (scale[k] == 0) continue;
      std::array<Box, bin_count> right;  // bins b and above
      std::array<int, bin_count> right_count{};
      for (std::size_t b = bin_count; b-- > 0;) {
        right[b] = bins[k][b];
        right_count[b] = counts[k][b];
        if (b + 1 == bin_count) continue;
        right[b].add(right[b + 1]);
        right_count[b] += right_count[b + 1];
      }
      Box left;
      int left_count = 0;
      for (std::size_t b = 0; b + 1 < bin_count; ++b) {
        left.add(bins[k][b]);
        left_count += counts[k][b];
        if (left_count == 0 || right_count[b + 1] == 0) continue;
        const float cost =
            left.half_area() * blocks(left_count) + right[b + 1].half_area() * blocks(right_count[b + 1]);
        if (cost < best_cost) {
          best_cost = cost;
          best_axis = k;
          best_bin = b;
          best_left = left;
          best_right = right[b + 1];
        }
      }
    }
    if (best_axis == 3) return halves(range);  // coinciding centres, or deep: any halves will do
    Reference* left = begin;
    for (Reference* right = end;;) {
      while (left < right && bin_of(left->box, best_axis) <= best_bin) ++left;
      while (left < right && bin_of((right - 1)->box, best_axis) > best_bin) --right;
      if (left >= right) break;
      std::swap(*left, *(right - 1));
    }
    const int middle = static_cast<int>(left - references.data());
    return {{range.begin, middle, best_left}, {middle, range.end, best_right}};
  }

  std::pair<Range, Range> halves(const Range& range) const {
    const int middle = range.begin + range.size() / 2;
    return {whole(range.begin, middle), whole(middle, range.end)};
  }
  Range whole(int begin, int end) const {
    Range range{begin, end, {}};
    for (int i = begin; i < end; ++i) range.box.add(references[static_cast<std::size_t>(i)].box);
    return range;
  }

  /// Up to four parts of a range, the one of largest area split first.
  std::vector<Range> parts(const Range& range, int depth) {
    std::vector<Range> result{range};
    while (static_cast<int>(result.size()) < width) {
      std::size_t largest = result.size();
      float area = -1;
      for (std::size_t i = 0; i < result.size(); ++i)
        if (result[i].size() > leaf_size && result[i].box.half_area() > area) {
          largest = i;
          area = result[i].box.half_area();
        }
      if (largest == result.size()) break;
      auto [left, right] = split(result[largest], depth);
      result[largest] = left;
      result.push_back(right);
    }
    return result;
  }

  /// Nodes and leaves of one subtree; children are numbered within it until it is appended.
  struct Subtree {
    std::vector<Node> nodes;
    std::vector<Range> leaves;
  };
  /// A range that became a task of its own instead of a child.
  struct Task {
    Range range;
    std::int32_t parent;
    std::size_t slot;
    int depth;
  };

  std::int32_t build(const Range& range, int depth, Subtree& tree, std::vector<Task>* tasks) {
    const auto index = static_cast<std::int32_t>(tree.nodes.size());
    tree.nodes.emplace_back();
    const std::vector<Range> children = parts(range, depth);
    for (std::size_t i = 0; i < width; ++i) {
      const Range child_range = i < children.size() ? children[i] : Range{0, 0, {}};
      std::int32_t child = 0;
      if (child_range.size() <= leaf_size) {
        child = ~static_cast<std::int32_t>(tree.leaves.size());
        tree.leaves.push_back(child_range);
      } else if (tasks != nullptr && child_range.size() <= task_size) {
        tasks->push_back({child_range, index, i, depth + 1});
      } else {
        child = build(child_range, depth + 1, tree, tasks);
      }
      Node& node = tree.nodes[static_cast<std::size_t>(index)];
      for (std::size_t k = 0; k < 3; ++k) {
        node.lower[k][i] = child_range.box.lower[k];
        node.upper[k][i] = child_range.box.upper[k];
      }
      node.child[i] = child;
    }
    return index;
  }
};

TriangleBvh::TriangleBvh(const TriangleMesh& mesh) : sphere_(search_sphere(mesh)) {
  const int count = mesh.face_count();
  if (count == 0) return;

  Builder builder;
  builder.references.resize(static_cast<std::size_t>(count));
  const double widening = 1e-6 * sphere_.radius + std::numeric_limits<float>::min();
  for (int f = 0; f < count; ++f) {
    Builder::Box& box = builder.references[static_cast<std::size_t>(f)].box;
    builder.references[static_cast<std::size_t>(f)].face = f;
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double a = mesh.V(mesh.F(f, 0), k), b = mesh.V(mesh.F(f, 1), k), c = mesh.V(mesh.F(f, 2), k);
      // Rounding to the nearest float errs by 6e-8 of the radius, far less than the widening.
      box.lower[axis] = static_cast<float>(std::min({a, b, c}) - sphere_.centre[k] - widening);
      box.upper[axis] = static_cast<float>(std::max({a, b, c}) - sphere_.centre[k] + widening);
    }
  }

  std::vector<Builder::Task> tasks;
  Builder::Subtree tree;
  builder.build(builder.whole(0, count), 0, tree, &tasks);
  std::vector<Builder::Subtree> subtrees(tasks.size());
  parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) builder.build(tasks[t].range, tasks[t].depth, subtrees[t], nullptr);
  });
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    const auto node_offset = static_cast<std::int32_t>(tree.nodes.size());
    const auto leaf_offset = static_cast<std::int32_t>(tree.leaves.size());
    tree.nodes[static_cast<std::size_t>(tasks[t].parent)].child[tasks[t].slot] = node_offset;
    for (Node node : subtrees[t].nodes) {
      for (std::int32_t& child : node.child) child = is_leaf(child) ? child - leaf_offset : child + node_offset;
      tree.nodes.push_back(node);
    }
    tree.leaves.insert(tree.leaves.end(), subtrees[t].leaves.begin(), subtrees[t].leaves.end());
  }

  nodes_ = std::move(tree.nodes);
  blocks_.resize(tree.leaves.size());
  parallel_for(blocks_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      Block& block = blocks_[b] = Block{};
      block.face.fill(-1);
      for (int i = tree.leaves[b].begin; i < tree.leaves[b].end; ++i) {
        const auto lane = static_cast<std::size_t>(i - tree.leaves[b].begin);
        const int f = block.face[lane] = builder.references[static_cast<std::size_t>(i)].face;
        for (int c = 0; c < 3; ++c)
          for (int k = 0; k < 3; ++k)
            block.corner[static_cast<std::size_t>(c)][static_cast<std::size_t>(k)][lane] = mesh.V(mesh.F(f, c), k);
      }
    }
  });
}

}  // namespace formwright
