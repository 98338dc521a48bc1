// SPDX-License-Identifier: GPL-3.0-or-later
// CHOLMOD's supernodal factorisation over OpenBLAS.
#include <cholmod.h>

#include <algorithm>
#include <stdexcept>

#include "cholesky_methods.h"

namespace formwright::bench {
namespace {

class Cholmod : public CholeskyMethod {
 public:
  explicit Cholmod(int ordering) {
    cholmod_start(&common_);
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
    common_.postorder = 1;
    common_.print = 0;
  }
  ~Cholmod() override {
    cholmod_free_factor(&factor_, &common_);
    cholmod_finish(&common_);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  void analyze(const SparseMatrix& lower) override {
    cholmod_free_factor(&factor_, &common_);
    cholmod_sparse A = view(lower);
    if (common_.method[0].ordering == CHOLMOD_GIVEN) {
      std::vector<int> order = our_order(lower);
      factor_ = cholmod_analyze_p(&A, order.data(), nullptr, 0, &common_);
    } else {
      factor_ = cholmod_analyze(&A, &common_);
    }
    if (!factor_) throw std::runtime_error("CHOLMOD could not analyse the matrix.");
  }
  void factorize(const SparseMatrix& lower) override {
    cholmod_sparse A = view(lower);
    cholmod_factorize(&A, factor_, &common_);
    if (common_.status != CHOLMOD_OK) throw std::runtime_error("CHOLMOD: the matrix is not positive definite.");
  }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) override {
    Eigen::VectorXd side = b;
    cholmod_dense B{};
    B.nrow = B.nzmax = B.d = static_cast<std::size_t>(b.size());
    B.ncol = 1;
    B.x = side.data();
    B.xtype = CHOLMOD_REAL;
    B.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &B, &common_);
    std::copy_n(static_cast<const double*>(x->x), b.size(), side.data());
    cholmod_free_dense(&x, &common_);
    return side;
  }
  double stored_entries() const override { return static_cast<double>(factor_->xsize); }

 private:
  static cholmod_sparse view(const SparseMatrix& lower) {
    cholmod_sparse A{};
    A.nrow = A.ncol = static_cast<std::size_t>(lower.rows());
    A.nzmax = static_cast<std::size_t>(lower.nonZeros());
    A.p = const_cast<int*>(lower.outerIndexPtr());
    A.i = const_cast<int*>(lower.innerIndexPtr());
    A.x = const_cast<double*>(lower.valuePtr());
    A.stype = -1;
    A.itype = CHOLMOD_INT;
    A.xtype = CHOLMOD_REAL;
    A.dtype = CHOLMOD_DOUBLE;
    A.sorted = A.packed = 1;
    return A;
  }

  cholmod_common common_;
  cholmod_factor* factor_ = nullptr;
};

}  // namespace

std::unique_ptr<CholeskyMethod> cholmod_method(const std::string& order) {
  if (order == "amd") return std::make_unique<Cholmod>(CHOLMOD_AMD);
  if (order == "metis") return std::make_unique<Cholmod>(CHOLMOD_METIS);
  if (order == "ours") return std::make_unique<Cholmod>(CHOLMOD_GIVEN);
  return nullptr;
}

}  // namespace formwright::bench
