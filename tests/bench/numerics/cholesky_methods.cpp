// SPDX-License-Identifier: GPL-3.0-or-later
#include "cholesky_methods.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <stdexcept>

#include "numerics/ordering/nested_dissection.h"

namespace formwright::bench {
namespace {

class Ours : public CholeskyMethod {
 public:
  void analyze(const SparseMatrix& lower) override { cholesky_.analyze(lower, {}, context_); }
  void factorize(const SparseMatrix& lower) override { cholesky_.factorize(lower, context_); }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) override {
    Eigen::MatrixXd x = b;
    cholesky_.solve(x);
    return x;
  }
  double stored_entries() const override { return cholesky_.factor_entries(); }

 private:
  Context context_;
  SparseCholesky cholesky_;
};

/// What Eigen calls an ordering functor; it knows the pattern of the whole matrix.
struct OurOrdering {
  using PermutationType = Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int>;
  void operator()(const SparseMatrix& whole, PermutationType& permutation) const {
    const std::vector<int> order = our_order(whole.triangularView<Eigen::Lower>());
    permutation.indices() = Eigen::Map<const Eigen::VectorXi>(order.data(), static_cast<Eigen::Index>(order.size()));
  }
};

template <class Ordering>
class ByEigen : public CholeskyMethod {
 public:
  void analyze(const SparseMatrix& lower) override { cholesky_.analyzePattern(lower); }
  void factorize(const SparseMatrix& lower) override {
    cholesky_.factorize(lower);
    if (cholesky_.info() != Eigen::Success) throw std::runtime_error("Eigen: the matrix is not positive definite.");
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) override { return cholesky_.solve(b); }
  double stored_entries() const override {
    return static_cast<double>(cholesky_.matrixL().nestedExpression().nonZeros());
  }

 private:
  Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower, Ordering> cholesky_;
};

}  // namespace

std::vector<int> our_order(const SparseMatrix& lower) {
  Context context;
  return nested_dissection(graph_of(lower), {}, context);
}

std::unique_ptr<CholeskyMethod> cholesky_method(const std::string& name) {
  if (name == "ours") return std::make_unique<Ours>();
  if (name == "eigen-amd") return std::make_unique<ByEigen<Eigen::AMDOrdering<int>>>();
  if (name == "eigen-ours") return std::make_unique<ByEigen<OurOrdering>>();
  if (name.starts_with("cholmod-")) return cholmod_method(name.substr(8));
  return nullptr;
}

#ifdef FORMWRIGHT_WITHOUT_CHOLMOD
std::unique_ptr<CholeskyMethod> cholmod_method(const std::string&) { return nullptr; }
#endif

}  // namespace formwright::bench
