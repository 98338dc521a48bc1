// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/elimination_tree.h"

namespace formwright {

Permutation Permutation::from_order(std::vector<int> order) {
  Permutation permutation;
  permutation.order = std::move(order);
  permutation.position.resize(permutation.order.size());
  for (std::size_t k = 0; k < permutation.order.size(); ++k) {
    permutation.position[permutation.order[k]] = static_cast<int>(k);
  }
  return permutation;
}

std::vector<int> elimination_tree(const Graph& graph, const Permutation& permutation) {
  const int n = graph.size();
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (int k = 0; k < n; ++k) {
    for (const int u : graph.neighbours(permutation.order[k])) {
      for (int i = permutation.position[u]; i != -1 && i < k;) {
        const int next = ancestor[i];
        ancestor[i] = k;  // path compression
        if (next == -1) parent[i] = k;
        i = next;
      }
    }
  }
  return parent;
}

std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> child(n, -1), sibling(n, -1), post, stack;
  for (int j = n - 1; j >= 0; --j) {
    if (parent[j] == -1) continue;
    sibling[j] = child[parent[j]];
    child[parent[j]] = j;
  }
  post.reserve(n);
  for (int root = 0; root < n; ++root) {
    if (parent[root] != -1) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int j = stack.back();
      if (child[j] == -1) {
        post.push_back(j);
        stack.pop_back();
      } else {
        stack.push_back(child[j]);
        child[j] = sibling[child[j]];
      }
    }
  }
  return post;
}

void reorder(const std::vector<int>& post, Permutation& permutation, std::vector<int>& parent) {
  const int n = static_cast<int>(post.size());
  std::vector<int> place(n), order(n), relabelled(n);
  for (int k = 0; k < n; ++k) place[post[k]] = k;
  for (int k = 0; k < n; ++k) {
    const int p = parent[post[k]];
    relabelled[k] = p == -1 ? -1 : place[p];
    order[k] = permutation.order[post[k]];
  }
  parent = std::move(relabelled);
  permutation = Permutation::from_order(std::move(order));
}

std::vector<int> column_counts(const Graph& graph, const Permutation& permutation, const std::vector<int>& parent) {
  const int n = graph.size();
  std::vector<int> count(n), first(n, -1), furthest(n, -1), previous_leaf(n, -1), ancestor(n);
  for (int j = 0; j < n; ++j) {
    ancestor[j] = j;
    count[j] = first[j] == -1 ? 1 : 0;  // a leaf of the tree
    for (int i = j; i != -1 && first[i] == -1; i = parent[i]) first[i] = j;
  }
  for (int j = 0; j < n; ++j) {
    if (parent[j] != -1) --count[parent[j]];  // j itself is not in its parent's column
    for (const int u : graph.neighbours(permutation.order[j])) {
      const int i = permutation.position[u];
      if (i <= j || first[j] <= furthest[i]) continue;  // not a leaf of row i's subtree
      furthest[i] = first[j];
      const int previous = previous_leaf[i];
      previous_leaf[i] = j;
      ++count[j];
      if (previous == -1) continue;
      int common = previous;  // least common ancestor of the two leaves, with path compression
      while (common != ancestor[common]) common = ancestor[common];
      for (int s = previous; s != common;) {
        const int above = ancestor[s];
        ancestor[s] = common;
        s = above;
      }
      --count[common];
    }
    if (parent[j] != -1) ancestor[j] = parent[j];
  }
  for (int j = 0; j < n; ++j) {
    if (parent[j] != -1) count[parent[j]] += count[j];
  }
  return count;
}

}  // namespace formwright
