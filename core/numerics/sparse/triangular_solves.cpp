// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/triangular_solves.h"

#include <algorithm>

#include "base/parallel.h"
#include "numerics/dense/dense_solves.h"

namespace formwright {
namespace {

constexpr double parallel_entries = 5e5;  // of L; below, threads cost more than they gain

// z: the supernode's own rows, padded, then the rows below, padded.
template <int Sides>
void forward_supernode(const SupernodalForm& form, const double* factor, int s, double* z) {
  const int columns = form.columns(s), height = form.height(s);
  const double* storage = factor + form.first_value[s];
  for (int block = 0, first = 0; first < columns; ++block, first += SupernodalForm::block_width) {
    dense::forward_block<Sides>(storage + block_offset(block, height), static_cast<std::size_t>(height - first),
                                std::min(SupernodalForm::block_width, columns - first), height - first,
                                z + first * Sides);
  }
}

template <int Sides>
void backward_supernode(const SupernodalForm& form, const double* factor, int s, double* z) {
  const int columns = form.columns(s), height = form.height(s);
  const double* storage = factor + form.first_value[s];
  for (int block = (columns - 1) / SupernodalForm::block_width; block >= 0; --block) {
    const int first = block * SupernodalForm::block_width;
    dense::backward_block<Sides>(storage + block_offset(block, height), static_cast<std::size_t>(height - first),
                                 std::min(SupernodalForm::block_width, columns - first), height - first,
                                 z + first * Sides);
  }
}

// Moves between a vector and z; `row(i)` tells where the i-th row below is.
template <int Sides>
void forward_step(const SupernodalForm& form, const double* factor, int s, double* y, std::vector<double>& z,
                  const auto& row) {
  const int columns = form.columns(s), height = form.height(s);
  z.assign(static_cast<std::size_t>(height) * Sides, 0.0);
  std::copy_n(y, columns * Sides, z.begin());
  forward_supernode<Sides>(form, factor, s, z.data());
  std::copy_n(z.begin(), columns * Sides, y);
  const double* below = z.data() + static_cast<std::size_t>(padded(columns)) * Sides;
  const auto rows = form.rows_below(s);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    double* target = row(rows[i]);
    for (int c = 0; c < Sides; ++c) target[c] += below[i * Sides + static_cast<std::size_t>(c)];
  }
}

}  // namespace

template <int Sides>
void forward_solve(const SupernodalForm& form, const double* factor, double* y) {
  const auto sides = static_cast<std::size_t>(Sides);
  const int top_column = form.first_column[form.first_top];
  // A subtree changes its own rows and rows of the top; the latter are collected and added in a fixed order.
  const auto top_length = static_cast<std::size_t>(form.n - top_column) * sides;
  std::vector<std::vector<double>> collected(form.subtrees.size());
  const auto run = [&](std::size_t begin, std::size_t end) {
    std::vector<double> z;
    for (std::size_t k = begin; k < end; ++k) {
      collected[k].assign(top_length, 0.0);
      const auto row = [&](int r) {
        return r < top_column ? y + static_cast<std::size_t>(r) * sides
                              : collected[k].data() + static_cast<std::size_t>(r - top_column) * sides;
      };
      for (int s = form.subtrees[k].begin; s < form.subtrees[k].end; ++s) {
        forward_step<Sides>(form, factor, s, y + static_cast<std::size_t>(form.first_column[s]) * sides, z, row);
      }
    }
  };
  parallel_for(form.subtrees.size(), form.entries < parallel_entries ? form.subtrees.size() : 1, run);
  double* top = y + static_cast<std::size_t>(top_column) * sides;
  for (const auto& part : collected) {
    for (std::size_t i = 0; i < top_length; ++i) top[i] += part[i];
  }
  std::vector<double> z;
  for (int s = form.first_top; s < form.count(); ++s) {
    forward_step<Sides>(form, factor, s, y + static_cast<std::size_t>(form.first_column[s]) * sides, z,
                        [&](int r) { return y + static_cast<std::size_t>(r) * sides; });
  }
}

template <int Sides>
void backward_solve(const SupernodalForm& form, const double* factor, double* y) {
  const auto sides = static_cast<std::size_t>(Sides);
  const auto step = [&](int s, std::vector<double>& z) {
    const int columns = form.columns(s), height = form.height(s);
    double* own = y + static_cast<std::size_t>(form.first_column[s]) * sides;
    z.assign(static_cast<std::size_t>(height) * sides, 0.0);
    std::copy_n(own, columns * Sides, z.begin());
    double* below = z.data() + static_cast<std::size_t>(padded(columns)) * sides;
    for (const int r : form.rows_below(s)) {
      std::copy_n(y + static_cast<std::size_t>(r) * sides, Sides, below);
      below += Sides;
    }
    backward_supernode<Sides>(form, factor, s, z.data());
    std::copy_n(z.begin(), columns * Sides, own);
  };
  std::vector<double> buffer;
  for (int s = form.count() - 1; s >= form.first_top; --s) step(s, buffer);
  parallel_for(form.subtrees.size(), form.entries < parallel_entries ? form.subtrees.size() : 1,
               [&](std::size_t begin, std::size_t end) {
                 std::vector<double> z;
                 for (std::size_t k = begin; k < end; ++k) {
                   for (int s = form.subtrees[k].end - 1; s >= form.subtrees[k].begin; --s) step(s, z);
                 }
               });
}

template void forward_solve<1>(const SupernodalForm&, const double*, double*);
template void forward_solve<dense::few_sides>(const SupernodalForm&, const double*, double*);
template void forward_solve<dense::many_sides>(const SupernodalForm&, const double*, double*);
template void backward_solve<1>(const SupernodalForm&, const double*, double*);
template void backward_solve<dense::few_sides>(const SupernodalForm&, const double*, double*);
template void backward_solve<dense::many_sides>(const SupernodalForm&, const double*, double*);

namespace {

// The supernodes from those of the entries up to the roots, ascending.
void add_path(const SupernodalForm& form, const SparseVector& b, std::vector<int>& path) {
  std::vector<int> starts;
  for (const int i : b.index) starts.push_back(form.supernode_of[form.permutation.position[i]]);
  std::sort(starts.begin(), starts.end());
  starts.erase(std::unique(starts.begin(), starts.end()), starts.end());
  // Ascending starts: a path that meets an earlier one meets it in a supernode already listed.
  std::vector<int> merged;
  for (const int start : starts) {
    std::vector<int> own;
    for (int s = start; s != -1; s = form.parent[s]) {
      if (std::binary_search(path.begin(), path.end(), s)) break;
      own.push_back(s);
    }
    merged.resize(path.size() + own.size());
    std::merge(path.begin(), path.end(), own.begin(), own.end(), merged.begin());
    path.swap(merged);
  }
}

template <int Sides>
void sparse_forward_together(const SupernodalForm& form, const double* factor, std::span<const SparseVector* const> b,
                             std::span<SparseVector* const> y) {
  constexpr auto sides = static_cast<std::size_t>(Sides);
  std::vector<int> path;
  for (const SparseVector* side : b) add_path(form, *side, path);
  // Columns of the path are numbered through; `offset` tells where each supernode's begin.
  std::vector<int> offset(path.size() + 1, 0);
  for (std::size_t t = 0; t < path.size(); ++t) offset[t + 1] = offset[t] + form.columns(path[t]);
  std::vector<double> local(static_cast<std::size_t>(offset.back()) * sides, 0.0);
  for (std::size_t c = 0; c < b.size(); ++c) {
    for (std::size_t k = 0; k < b[c]->index.size(); ++k) {
      const int position = form.permutation.position[b[c]->index[k]], s = form.supernode_of[position];
      const auto t = static_cast<std::size_t>(std::lower_bound(path.begin(), path.end(), s) - path.begin());
      local[static_cast<std::size_t>(offset[t] + position - form.first_column[s]) * sides + c] += b[c]->value[k];
    }
  }
  std::vector<double> z;
  for (std::size_t t = 0; t < path.size(); ++t) {
    std::size_t at = t + 1;  // rows ascend, and so do the supernodes of the path that hold them
    forward_step<Sides>(
        form, factor, path[t], local.data() + static_cast<std::size_t>(offset[t]) * sides, z, [&](int r) {
          while (r >= form.first_column[path[at] + 1]) ++at;
          return local.data() + static_cast<std::size_t>(offset[at] + r - form.first_column[path[at]]) * sides;
        });
  }
  for (std::size_t c = 0; c < y.size(); ++c) {
    y[c]->index.clear();
    y[c]->value.clear();
    for (std::size_t t = 0; t < path.size(); ++t) {
      const int first = form.first_column[path[t]];
      for (int j = offset[t]; j < offset[t + 1]; ++j) {
        const double value = local[static_cast<std::size_t>(j) * sides + c];
        if (value == 0) continue;
        y[c]->index.push_back(first + j - offset[t]);
        y[c]->value.push_back(value);
      }
    }
  }
}

}  // namespace

void sparse_forward(const SupernodalForm& form, const double* factor, std::span<const SparseVector* const> b,
                    std::span<SparseVector* const> y) {
  if (b.size() == 1) {
    sparse_forward_together<1>(form, factor, b, y);
  } else {
    sparse_forward_together<dense::many_sides>(form, factor, b, y);
  }
}

}  // namespace formwright
