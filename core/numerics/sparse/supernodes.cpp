// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/supernodes.h"

#include <algorithm>
#include <numeric>

namespace formwright {
namespace {

// A supernode while supernodes are being merged.
struct Node {
  int columns = 0;
  int below = 0;     // rows below
  double zeros = 0;  // entries stored that are not in L
  int parent = -1;
  int first_child = -1, next_sibling = -1;
  int first_part = -1, next_part = -1;  // the fundamental supernodes merged into this one, itself excluded
  bool merged = false;
};

double trapezoid(double columns, double below) { return columns * (columns + 1) / 2 + columns * below; }

double factor_work(double columns, double below) {  // sum of (entries of column)^2
  const double top = columns + below;
  const auto squares = [](double m) { return m * (m + 1) * (2 * m + 1) / 6; };
  return squares(top) - squares(below);
}

struct Tree {
  std::vector<int> first_column;  // of the fundamental supernodes, and n
  std::vector<Node> nodes;
};

// Fundamental supernodes (Liu, Ng, Peyton 1993): a column joins the one before it if it is its parent, has no
// other child and the same pattern below.
Tree fundamental(const std::vector<int>& parent, const std::vector<int>& counts) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> children(n, 0), supernode(n);
  for (const int p : parent) {
    if (p != -1) ++children[p];
  }
  Tree tree;
  for (int j = 0; j < n; ++j) {
    const bool joins = j > 0 && parent[j - 1] == j && children[j] == 1 && counts[j - 1] == counts[j] + 1;
    if (!joins) {
      tree.first_column.push_back(j);
      tree.nodes.emplace_back();
    }
    supernode[j] = static_cast<int>(tree.nodes.size()) - 1;
    Node& node = tree.nodes.back();
    ++node.columns;
    node.below = counts[j] - 1;
  }
  tree.first_column.push_back(n);
  for (int s = static_cast<int>(tree.nodes.size()) - 1; s >= 0; --s) {
    const int p = parent[tree.first_column[s + 1] - 1];
    if (p == -1) continue;
    Node& node = tree.nodes[s];
    node.parent = supernode[p];
    node.next_sibling = tree.nodes[node.parent].first_child;
    tree.nodes[node.parent].first_child = s;
  }
  return tree;
}

// Whether to store `zeros` of `entries` for the sake of fewer, wider supernodes.
bool worth_merging(int columns, double zeros, double entries) {
  const double share = zeros / entries;
  if (columns <= 8) return true;
  if (columns <= 24) return share < 0.5;
  if (columns <= 64) return share < 0.12;
  return share < 0.04;
}

void merge_small(Tree& tree) {
  auto& nodes = tree.nodes;
  std::vector<int> children;
  for (int p = 0; p < static_cast<int>(nodes.size()); ++p) {  // children come first
    children.clear();
    for (int c = nodes[p].first_child; c != -1; c = nodes[c].next_sibling) children.push_back(c);
    const auto added = [&](int c) {
      return static_cast<double>(nodes[c].columns) * (nodes[p].columns + nodes[p].below - nodes[c].below);
    };
    std::sort(children.begin(), children.end(), [&](int a, int b) {
      const double za = added(a), zb = added(b);
      return za != zb ? za < zb : a < b;
    });
    int kept = -1;
    for (const int c : children) {
      const double zeros = nodes[p].zeros + nodes[c].zeros + added(c);
      const int columns = nodes[p].columns + nodes[c].columns;
      if (!worth_merging(columns, zeros, trapezoid(columns, nodes[p].below))) {
        nodes[c].next_sibling = kept;
        kept = c;
        continue;
      }
      nodes[p].columns = columns;
      nodes[p].zeros = zeros;
      nodes[c].merged = true;
      // The child's parts, then the child, join the parent's parts; its children become the parent's.
      int* tail = &nodes[c].first_part;
      while (*tail != -1) tail = &nodes[*tail].next_part;
      *tail = c;
      nodes[c].next_part = nodes[p].first_part;
      nodes[p].first_part = nodes[c].first_part;
      for (int g = nodes[c].first_child; g != -1;) {
        const int next = nodes[g].next_sibling;
        nodes[g].parent = p;
        nodes[g].next_sibling = kept;
        kept = g;
        g = next;
      }
    }
    nodes[p].first_child = kept;
  }
}

constexpr int subtrees_per_work = 12;  // a subtree does at most this fraction of all the work

// Numbers the merged supernodes: subtrees first, each in postorder, then the top in postorder.
struct Numbering {
  std::vector<int> sequence;  // nodes
  std::vector<SupernodalForm::Subtree> subtrees;
  int first_top = 0;
};

Numbering number(const Tree& tree) {
  const auto& nodes = tree.nodes;
  const int count = static_cast<int>(nodes.size());
  std::vector<double> work(count, 0);
  double total = 0;
  for (int s = 0; s < count; ++s) {  // parents come after their children here, too
    if (nodes[s].merged) continue;
    const double own = factor_work(nodes[s].columns, nodes[s].below);
    work[s] += own;
    total += own;
    if (nodes[s].parent != -1) work[nodes[s].parent] += work[s];
  }
  Numbering result;
  result.sequence.reserve(count);
  std::vector<int> stack, top;
  const auto walk = [&](int root, const auto& enter, auto& out) {  // postorder without recursion
    stack.assign(1, root);
    std::vector<int> path;
    while (!stack.empty()) {
      const int s = stack.back();
      if (!path.empty() && path.back() == s) {
        path.pop_back();
        stack.pop_back();
        out.push_back(s);
        continue;
      }
      path.push_back(s);
      for (int c = nodes[s].first_child; c != -1; c = nodes[c].next_sibling) {
        if (enter(c)) stack.push_back(c);
      }
    }
  };
  const double maximum = total / subtrees_per_work;
  std::vector<int> roots;
  for (int s = 0; s < count; ++s) {
    if (nodes[s].merged || work[s] > maximum) continue;
    if (nodes[s].parent == -1 || work[nodes[s].parent] > maximum) roots.push_back(s);
  }
  std::sort(roots.begin(), roots.end());
  for (const int root : roots) {
    const int begin = static_cast<int>(result.sequence.size());
    walk(
        root, [](int) { return true; }, result.sequence);
    result.subtrees.push_back({begin, static_cast<int>(result.sequence.size()), work[root]});
  }
  result.first_top = static_cast<int>(result.sequence.size());
  for (int s = 0; s < count; ++s) {
    if (nodes[s].merged || nodes[s].parent != -1 || work[s] <= maximum) continue;
    walk(
        s, [&](int c) { return work[c] > maximum; }, result.sequence);
  }
  // Many tiny subtrees (separate parts of a mesh, say) share one task.
  std::vector<SupernodalForm::Subtree> joined;
  for (const auto& subtree : result.subtrees) {
    if (!joined.empty() && joined.back().flops + subtree.flops <= maximum) {
      joined.back().end = subtree.end;
      joined.back().flops += subtree.flops;
    } else {
      joined.push_back(subtree);
    }
  }
  result.subtrees = std::move(joined);
  return result;
}

// Rows below every supernode, by climbing from the entries of every row of A; rows come out ascending.
void find_rows(const Graph& graph, SupernodalForm& form, const std::vector<int>& below) {
  const int count = form.count();
  form.first_row.assign(count + 1, 0);
  for (int s = 0; s < count; ++s) form.first_row[s + 1] = form.first_row[s] + static_cast<std::size_t>(below[s]);
  form.row.resize(form.first_row[count]);
  std::vector<std::size_t> next(form.first_row.begin(), form.first_row.end() - 1);
  std::vector<int> mark(count, -1);
  for (int k = 0; k < form.n; ++k) {
    const int own = form.supernode_of[k];
    mark[own] = k;
    for (const int u : graph.neighbours(form.permutation.order[k])) {
      const int j = form.permutation.position[u];
      if (j >= k) continue;
      for (int s = form.supernode_of[j]; mark[s] != k; s = form.parent[s]) {
        mark[s] = k;
        form.row[next[s]++] = k;
      }
    }
  }
}

}  // namespace

double SupernodalForm::flops_of(int s) const {
  return factor_work(columns(s), static_cast<double>(first_row[s + 1] - first_row[s]));
}

std::size_t SupernodalForm::bytes() const {
  const std::size_t ints = permutation.order.capacity() + permutation.position.capacity() + first_column.capacity() +
                           parent.capacity() + supernode_of.capacity() + row.capacity();
  return ints * sizeof(int) + (first_row.capacity() + first_value.capacity()) * sizeof(std::size_t);
}

SupernodalForm find_supernodes(const Graph& graph, std::vector<int> order, Context& context) {
  SupernodalForm form;
  form.n = graph.size();
  form.permutation = Permutation::from_order(std::move(order));
  std::vector<int> parent = elimination_tree(graph, form.permutation);
  reorder(postorder(parent), form.permutation, parent);
  context.check_cancelled();
  const std::vector<int> counts = column_counts(graph, form.permutation, parent);
  context.check_cancelled();
  Tree tree = fundamental(parent, counts);
  merge_small(tree);
  const Numbering numbering = number(tree);

  const int count = static_cast<int>(numbering.sequence.size());
  std::vector<int> place(tree.nodes.size(), -1), below(count), final_order;
  final_order.reserve(form.n);
  form.parent.assign(count, -1);
  form.first_column.assign(1, 0);
  form.supernode_of.resize(form.n);
  form.first_value.assign(count + 1, 0);
  for (int s = 0; s < count; ++s) place[numbering.sequence[s]] = s;
  std::vector<int> parts;
  for (int s = 0; s < count; ++s) {
    const int id = numbering.sequence[s];
    const Node& node = tree.nodes[id];
    parts.assign(1, id);
    for (int part = node.first_part; part != -1; part = tree.nodes[part].next_part) parts.push_back(part);
    std::sort(parts.begin(), parts.end());
    for (const int part : parts) {
      for (int j = tree.first_column[part]; j < tree.first_column[part + 1]; ++j) {
        form.supernode_of[final_order.size()] = s;
        final_order.push_back(form.permutation.order[j]);
      }
    }
    form.first_column.push_back(static_cast<int>(final_order.size()));
    if (node.parent != -1) form.parent[s] = place[node.parent];
    below[s] = node.below;
    const int height = padded(node.columns) + padded(node.below);
    const int full = node.columns / SupernodalForm::block_width, rest = node.columns % SupernodalForm::block_width;
    form.first_value[s + 1] =
        form.first_value[s] + block_offset(full, height) +
        static_cast<std::size_t>(rest) * static_cast<std::size_t>(height - full * SupernodalForm::block_width);
    form.entries += trapezoid(node.columns, node.below);
    form.flops += factor_work(node.columns, node.below);
  }
  form.permutation = Permutation::from_order(std::move(final_order));
  form.subtrees = numbering.subtrees;
  form.first_top = numbering.first_top;
  context.check_cancelled();
  find_rows(graph, form, below);
  return form;
}

}  // namespace formwright
