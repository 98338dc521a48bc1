// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A dense Cholesky factor that gets more rows.
#include <Eigen/Core>

namespace formwright::dense {

/// The lower triangle of `L` holds the rows before `from` of a Cholesky factor, and the rows from <= i < end of the
/// matrix; these become rows of the factor. Panels of columns are made from left to right [GV13, 4.2.9]; their rows are
/// shared among threads, with the same bits for any number of them. False where the matrix is not positive definite to
/// working precision: the new rows are then undefined. Entries above the diagonal are overwritten.
bool grow_cholesky(Eigen::MatrixXd& L, Eigen::Index from, Eigen::Index end);

}  // namespace formwright::dense
