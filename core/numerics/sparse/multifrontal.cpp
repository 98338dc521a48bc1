// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/multifrontal.h"

#include <algorithm>
#include <atomic>
#include <new>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"
#include "numerics/sparse/front.h"

namespace formwright {
namespace {

std::unique_ptr<double[]> allocate(std::size_t count) {
  try {
    return std::unique_ptr<double[]>(new double[std::max<std::size_t>(count, 1)]);  // not initialised
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "matrix",
                "Factorising needs another " + std::to_string(count / 131072 + 1) + " MB: use a coarser mesh.");
  }
}

std::size_t update_length(const SupernodalForm& form, int s) {
  const auto size = static_cast<std::size_t>(padded(static_cast<int>(form.rows_below(s).size())));
  return size * size;
}

// Two stacks of update matrices, for even and odd depths. A supernode's children are the last ones pushed on
// one stack when its own update matrix goes onto the other, so nothing ever has to move.
struct UpdateStacks {
  std::unique_ptr<double[]> memory[2];
  std::size_t used[2] = {0, 0};
};

class Multifrontal {
 public:
  Multifrontal(const SupernodalForm& form, const AssemblyMap& map, const double* values,
               const std::vector<double>& min_pivot, double* factor, Context& context)
      : form_(form), fronts_(form, map, values, min_pivot, factor, context), context_(context) {
    const int count = form.count();
    first_child_.assign(count, -1);
    next_sibling_.assign(count, -1);
    depth_.assign(count, 0);
    for (int s = count - 1; s >= 0; --s) {
      const int p = form.parent[s];
      if (p == -1) continue;
      next_sibling_[s] = first_child_[p];
      first_child_[p] = s;
      depth_[s] = depth_[p] + 1;
    }
    kept_.resize(count);
    job_thread_ = std::this_thread::get_id();
  }

  void run(bool parallel);

 private:
  bool survives(int s) const { return form_.parent[s] == -1 || form_.parent[s] >= form_.first_top; }
  UpdateStacks make_stacks(int begin, int end) const;
  void factor_subtree(const SupernodalForm::Subtree& subtree);
  void factor_top(bool parallel);
  void done(int s);
  void fail(int column) {
    int best = failed_.load();
    while ((best == -1 || column < best) && !failed_.compare_exchange_weak(best, column)) {}
  }

  const SupernodalForm& form_;
  const FrontFactorization fronts_;
  Context& context_;
  std::vector<int> first_child_, next_sibling_, depth_;
  std::vector<std::unique_ptr<double[]>> kept_;  // update matrices that outlive their subtree
  std::atomic<double> work_done_{0};
  std::atomic<int> failed_{-1};
  std::thread::id job_thread_;
};

// The same pushes and pops as in factor_subtree, only counted.
UpdateStacks Multifrontal::make_stacks(int begin, int end) const {
  UpdateStacks stacks;
  std::size_t peak[2] = {0, 0};
  for (int s = begin; s < end; ++s) {
    const int parity = depth_[s] & 1;
    if (!survives(s)) {
      stacks.used[parity] += update_length(form_, s);
      peak[parity] = std::max(peak[parity], stacks.used[parity]);
    }
    for (int c = first_child_[s]; c != -1; c = next_sibling_[c]) stacks.used[1 - parity] -= update_length(form_, c);
  }
  for (int k : {0, 1}) {
    stacks.memory[k] = allocate(peak[k]);
    stacks.used[k] = 0;
  }
  return stacks;
}

void Multifrontal::done(int s) {
  const double work = form_.flops_of(s);
  const double now = work_done_.fetch_add(work) + work;
  if (std::this_thread::get_id() == job_thread_) {
    context_.progress(form_.flops > 0 ? now / form_.flops : 1.0);
  } else {
    context_.check_cancelled();
  }
}

void Multifrontal::factor_subtree(const SupernodalForm::Subtree& subtree) {
  UpdateStacks stacks = make_stacks(subtree.begin, subtree.end);
  FrontScratch scratch;
  scratch.target.resize(form_.n);
  std::vector<FrontFactorization::Child> children;
  std::vector<UpdateMatrix> updates(subtree.end - subtree.begin);
  for (int s = subtree.begin; s < subtree.end; ++s) {
    const int parity = depth_[s] & 1;
    UpdateMatrix& update = updates[s - subtree.begin];
    update.size = static_cast<int>(form_.rows_below(s).size());
    if (survives(s)) {
      kept_[s] = allocate(update_length(form_, s));
      update.value = kept_[s].get();
    } else {
      update.value = stacks.memory[parity].get() + stacks.used[parity];
      stacks.used[parity] += update_length(form_, s);
    }
    children.clear();
    for (int c = first_child_[s]; c != -1; c = next_sibling_[c]) {
      stacks.used[1 - parity] -= update_length(form_, c);
      if (updates[c - subtree.begin].size > 0) children.push_back({c, updates[c - subtree.begin]});
    }
    const int failed = fronts_.run(s, children, update, false, scratch);
    if (failed >= 0) {
      fail(failed);
      return;
    }
    done(s);
  }
}

void Multifrontal::factor_top(bool parallel) {
  FrontScratch scratch;
  scratch.target.resize(form_.n);
  std::vector<FrontFactorization::Child> children;
  for (int s = form_.first_top; s < form_.count(); ++s) {
    UpdateMatrix update;
    update.size = static_cast<int>(form_.rows_below(s).size());
    kept_[s] = allocate(update_length(form_, s));
    update.value = kept_[s].get();
    children.clear();
    for (int c = first_child_[s]; c != -1; c = next_sibling_[c]) {
      const int size = static_cast<int>(form_.rows_below(c).size());
      if (size > 0) children.push_back({c, {kept_[c].get(), size}});
    }
    const int failed = fronts_.run(s, children, update, parallel, scratch);
    if (failed >= 0) {
      fail(failed);
      return;
    }
    for (int c = first_child_[s]; c != -1; c = next_sibling_[c]) kept_[c].reset();
    done(s);
  }
}

void Multifrontal::run(bool parallel) {
  // The heaviest subtrees first, so that the threads end together.
  std::vector<int> sequence(form_.subtrees.size());
  for (std::size_t k = 0; k < sequence.size(); ++k) sequence[k] = static_cast<int>(k);
  std::stable_sort(sequence.begin(), sequence.end(),
                   [&](int a, int b) { return form_.subtrees[a].flops > form_.subtrees[b].flops; });
  parallel_for(sequence.size(), parallel ? 1 : sequence.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) factor_subtree(form_.subtrees[sequence[k]]);
  });
  if (failed_ == -1) factor_top(parallel);
  if (failed_ != -1) {
    throw Error(ErrorCode::could_not_solve, "matrix",
                "The equations have no unique solution: repair the model, or change the borders drawn on it.");
  }
}

}  // namespace

AssemblyMap map_assembly(const SparseMatrix& lower, const Graph& graph, const SupernodalForm& form) {
  const int count = form.count();
  AssemblyMap map;
  map.first.assign(count + 1, 0);
  const auto& order = form.permutation.order;
  const auto& position = form.permutation.position;
  parallel_for(static_cast<std::size_t>(count), 512, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      std::size_t entries = 0;
      for (int k = form.first_column[s]; k < form.first_column[s + 1]; ++k) {
        ++entries;
        for (const int u : graph.neighbours(order[k])) entries += position[u] > k ? 1 : 0;
      }
      map.first[s + 1] = entries;
    }
  });
  for (int s = 0; s < count; ++s) map.first[s + 1] += map.first[s];
  map.source.resize(map.first[count]);
  map.target.resize(map.first[count]);
  // Where column j of the lower triangle keeps row i.
  const int* outer = lower.outerIndexPtr();
  const int* inner = lower.innerIndexPtr();
  const auto find = [&](int i, int j) {
    return static_cast<int>(std::lower_bound(inner + outer[j], inner + outer[j + 1], i) - inner);
  };
  const std::size_t chunk = std::max<std::size_t>(256, static_cast<std::size_t>(count) / 16 + 1);
  parallel_for(static_cast<std::size_t>(count), chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<int> target(form.n);
    for (std::size_t s = begin; s < end; ++s) {
      const int node = static_cast<int>(s), first = form.first_column[s], columns = form.columns(node),
                height = form.height(node);
      for (int j = 0; j < columns; ++j) target[first + j] = j;
      const auto rows = form.rows_below(node);
      for (std::size_t i = 0; i < rows.size(); ++i) target[rows[i]] = padded(columns) + static_cast<int>(i);
      std::size_t next = map.first[s];
      for (int j = 0; j < columns; ++j) {
        const int v = order[first + j], block = j / SupernodalForm::block_width,
                  start = block * SupernodalForm::block_width;
        const std::size_t column = block_offset(block, height) +
                                   static_cast<std::size_t>(j - start) * static_cast<std::size_t>(height - start);
        map.source[next] = find(v, v);
        map.target[next++] = static_cast<std::uint32_t>(column + static_cast<std::size_t>(j - start));
        for (const int u : graph.neighbours(v)) {
          if (position[u] <= first + j) continue;
          map.source[next] = find(std::max(u, v), std::min(u, v));
          map.target[next++] =
              static_cast<std::uint32_t>(column + static_cast<std::size_t>(target[position[u]] - start));
        }
      }
    }
  });
  return map;
}

void factorize_multifrontal(const SupernodalForm& form, const AssemblyMap& map, const double* values,
                            const std::vector<double>& diagonal, SupernodalFactor& factor,
                            const MultifrontalOptions& options, Context& context) {
  // A pivot that is round-off of the diagonal entry it came from is not positive.
  constexpr double roundoff = 1e-15;
  std::vector<double> minimum(form.n);
  for (int k = 0; k < form.n; ++k) minimum[k] = std::max(0.0, roundoff * diagonal[form.permutation.order[k]]);
  if (!factor.value) factor.value = allocate(form.first_value.back());
  Multifrontal(form, map, values, minimum, factor.value.get(), context).run(options.parallel);
}

}  // namespace formwright
