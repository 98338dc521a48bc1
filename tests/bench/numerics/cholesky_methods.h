// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The factorisations that are compared, behind one interface.
#include <memory>
#include <string>

#include "numerics/sparse/sparse_cholesky.h"

namespace formwright::bench {

class CholeskyMethod {
 public:
  virtual ~CholeskyMethod() = default;
  /// Order and pattern of L.
  virtual void analyze(const SparseMatrix& lower) = 0;
  virtual void factorize(const SparseMatrix& lower) = 0;
  virtual Eigen::VectorXd solve(const Eigen::VectorXd& b) = 0;
  virtual double stored_entries() const = 0;
};

/// `name`: ours, eigen-amd, eigen-ours (in our order); natively also cholmod-amd, cholmod-metis, cholmod-ours. Null for
/// any other.
std::unique_ptr<CholeskyMethod> cholesky_method(const std::string& name);
/// Null without CHOLMOD.
std::unique_ptr<CholeskyMethod> cholmod_method(const std::string& order);

/// Our nested dissection: k-th eliminated -> row.
std::vector<int> our_order(const SparseMatrix& lower);

}  // namespace formwright::bench
