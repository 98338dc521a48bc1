// SPDX-License-Identifier: GPL-3.0-or-later
#include "numerics/sparse/front.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "numerics/dense/dense_kernels.h"

namespace formwright {
namespace {

constexpr int block_width = SupernodalForm::block_width;
constexpr double parallel_work = 4e6;  // flops below which a step is not worth waking other threads
constexpr int rows_together = 96;      // of a panel; they stay in the second-level cache while they are solved
constexpr int pack_rows_from = 64;     // packing pays for panels at least that high ...
constexpr int pack_columns_from = 32;  // ... and wide

void for_chunks(bool parallel, int count, int grain, const std::function<void(int, int)>& body) {
  if (!parallel) {
    body(0, count);
    return;
  }
  parallel_for(static_cast<std::size_t>(count), static_cast<std::size_t>(grain),
               [&](std::size_t begin, std::size_t end) { body(static_cast<int>(begin), static_cast<int>(end)); });
}

// Columns of a front, whether they lie in the factor or in the update matrix: pointers such that
// [padded row of the front] is the entry.
struct FrontColumns {
  double* storage;
  int columns, padded_columns, height;
  const UpdateMatrix& update;

  double* operator()(int column) const {  // a padded row number, as for rows
    if (column < columns) {
      const int block = column / block_width, first = block * block_width;
      const auto stride = static_cast<std::size_t>(height - first);
      return storage + block_offset(block, height) + static_cast<std::size_t>(column - first) * stride - first;
    }
    const auto stride = static_cast<std::size_t>(padded(update.size));
    return update.value + static_cast<std::size_t>(column - padded_columns) * stride - padded_columns;
  }
};

}  // namespace

void FrontFactorization::add_child(int s, const Child& child, const UpdateMatrix& update, bool parallel,
                                   FrontScratch& scratch) const {
  const int columns = form_.columns(s);
  const FrontColumns front{factor_ + form_.first_value[s], columns, padded(columns), form_.height(s), update};
  const auto rows = form_.rows_below(child.supernode);
  const int count = child.update.size;
  const auto stride = static_cast<std::size_t>(padded(count));
  auto& runs = scratch.runs;
  runs.clear();
  for (int i = 0; i < count; ++i) {
    const int to = scratch.target[rows[i]];
    if (!runs.empty() && runs.back().to + runs.back().length == to) {
      ++runs.back().length;
    } else {
      runs.push_back({i, to, 1});
    }
  }
  const int run_count = static_cast<int>(runs.size());
  const bool spread = parallel && static_cast<double>(count) * count > 2e5;
  const std::size_t grain =
      spread ? static_cast<std::size_t>(std::max(1, run_count / 32)) : static_cast<std::size_t>(run_count);
  const auto add = [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      for (int k = 0; k < runs[r].length; ++k) {
        const int j = runs[r].from + k;
        const double* from = child.update.value + static_cast<std::size_t>(j) * stride;
        double* to = front(runs[r].to + k);
        for (int i = k; i < runs[r].length; ++i) to[runs[r].to + i] += from[runs[r].from + i];
        for (std::size_t q = r + 1; q < runs.size(); ++q) {
          const auto run = runs[q];
          for (int i = 0; i < run.length; ++i) to[run.to + i] += from[run.from + i];
        }
      }
    }
  };
  if (spread) {
    parallel_for(runs.size(), grain, add);
  } else {
    add(0, runs.size());
  }
}

void FrontFactorization::assemble(int s, const std::vector<Child>& children, const UpdateMatrix& update, bool parallel,
                                  FrontScratch& scratch) const {
  double* storage = factor_ + form_.first_value[s];
  const std::size_t length = form_.first_value[s + 1] - form_.first_value[s];
  std::memset(storage, 0, length * sizeof(double));
  for (std::size_t k = map_.first[s]; k < map_.first[s + 1]; ++k) storage[map_.target[k]] += values_[map_.source[k]];
  if (children.empty()) return;
  const int size = padded(update.size);
  for (int j = 0; j < size; ++j) {  // the lower triangle, from the top of its 4 x 4 blocks on
    std::memset(update.value + static_cast<std::size_t>(j) * static_cast<std::size_t>(size) + (j & ~3), 0,
                static_cast<std::size_t>(size - (j & ~3)) * sizeof(double));
  }
  const int columns = form_.columns(s), below = padded(columns), first = form_.first_column[s];
  for (int j = 0; j < columns; ++j) scratch.target[first + j] = j;
  const auto rows = form_.rows_below(s);
  for (std::size_t i = 0; i < rows.size(); ++i) scratch.target[rows[i]] = below + static_cast<int>(i);
  for (const Child& child : children) add_child(s, child, update, parallel, scratch);
}

// Solves the rows below diagonal block `block` and subtracts their products from all that lies to the right.
void FrontFactorization::eliminate_block(int s, int block, const UpdateMatrix& update, bool fresh, bool parallel,
                                         FrontScratch& scratch) const {
  const int columns = form_.columns(s), height = form_.height(s);
  const int first = block * block_width, width = std::min(block_width, columns - first);
  const auto stride = static_cast<std::size_t>(height - first);
  double* storage = factor_ + form_.first_value[s];
  double* diagonal = storage + block_offset(block, height);
  double* panel = diagonal + padded(width);
  const int rows = height - first - padded(width);
  if (rows == 0) return;
  const double work = static_cast<double>(rows) * width * (width + rows);
  parallel = parallel && work > parallel_work;
  const bool packs = rows >= pack_rows_from && width >= pack_columns_from;
  if (packs && scratch.packed.size() < static_cast<std::size_t>(rows) * static_cast<std::size_t>(width)) {
    scratch.packed.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width));
  }
  const int chunks = (rows + rows_together - 1) / rows_together;
  for_chunks(parallel, chunks, 1, [&](int begin, int end) {
    for (int c = begin; c < end; ++c) {
      const int from = c * rows_together, count = std::min(rows_together, rows - from);
      dense::solve_rows(diagonal, stride, width, panel + from, stride, count);
      if (packs) {
        dense::pack(panel + from, stride, width, count,
                    scratch.packed.data() + static_cast<std::size_t>(from) * static_cast<std::size_t>(width));
      }
    }
  });
  const dense::Rows a = packs ? dense::packed_rows(scratch.packed.data(), width) : dense::panel_rows(panel, stride);
  // What lies to the right: the supernode's later blocks, then the update matrix. Rows of `a` count from the
  // first row below this block.
  struct Region {
    double* value;
    std::size_t stride;
    int offset;  // of its first row and column, in rows of `a`
    int rows, columns;
    dense::Update mode;
  };
  std::vector<Region> regions;
  for (int b = block + 1; b * block_width < columns; ++b) {
    const int start = b * block_width;
    regions.push_back({storage + block_offset(b, height), static_cast<std::size_t>(height - start),
                       start - first - width, height - start, std::min(block_width, columns - start),
                       dense::Update::subtract});
  }
  if (update.size > 0) {
    const int size = padded(update.size);
    const bool overwrite = fresh && block == 0;
    regions.push_back({update.value, static_cast<std::size_t>(size), rows - size, size, size,
                       overwrite ? dense::Update::overwrite : dense::Update::subtract});
  }
  const auto apply = [&](const Region& region, int row_begin, int row_end, int column_begin, int column_end) {
    const dense::Rows shifted{a.data + static_cast<std::size_t>(region.offset / 4) * a.sliver_stride, a.sliver_stride,
                              a.column_stride};
    dense::update_lower(region.value, region.stride, shifted, width, row_begin, row_end, column_begin, column_end,
                        region.mode);
  };
  if (work < parallel_work) {
    for (const Region& region : regions) apply(region, 0, region.rows, 0, region.columns);
    return;
  }
  constexpr int tile_rows = 384, tile_columns = 256;
  struct Piece {
    int region, row, column;
  };
  std::vector<Piece> pieces;
  for (int r = 0; r < static_cast<int>(regions.size()); ++r) {
    for (int column = 0; column < regions[r].columns; column += tile_columns) {
      for (int row = column; row < regions[r].rows; row += tile_rows) pieces.push_back({r, row, column});
    }
  }
  for_chunks(parallel, static_cast<int>(pieces.size()), 1, [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      if (p % 8 == 0) context_.check_cancelled();
      const Region& region = regions[pieces[p].region];
      apply(region, pieces[p].row, std::min(region.rows, pieces[p].row + tile_rows), pieces[p].column,
            std::min(region.columns, pieces[p].column + tile_columns));
    }
  });
}

int FrontFactorization::run(int s, const std::vector<Child>& children, const UpdateMatrix& update, bool parallel,
                            FrontScratch& scratch) const {
  assemble(s, children, update, parallel, scratch);
  const int columns = form_.columns(s), height = form_.height(s), first_column = form_.first_column[s];
  for (int block = 0; block * block_width < columns; ++block) {
    const int first = block * block_width, width = std::min(block_width, columns - first);
    double* diagonal = factor_ + form_.first_value[s] + block_offset(block, height);
    const int failed = dense::factor_diagonal(diagonal, static_cast<std::size_t>(height - first), width,
                                              min_pivot_.data() + first_column + first);
    if (failed >= 0) return first_column + first + failed;
    eliminate_block(s, block, update, children.empty(), parallel, scratch);
  }
  return -1;
}

}  // namespace formwright
