// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The energy of eq. (3.9) beside the forms that the thesis compares it with in Figs. 3.4 to 3.6, all as sums of squares
// that are linear in the depth parameter u of ViewFrame. With rays e_z + kappa p = kappa x0 and s = 1 + kappa u,
//
//   L D_s x0 = L p + L D_u (e_z + kappa p)
//
// holds for every kappa, also in the limit of a far view.
#include "numerics/sparse_matrix.h"
#include "relief/view/view_frame.h"

namespace formwright::test {

/// E(u) = |rows u + constant|^2.
struct LeastSquares {
  SparseMatrix rows;  // 3n x n
  Eigen::VectorXd constant;

  double operator()(const Eigen::VectorXd& u) const { return (rows * u + constant).squaredNorm(); }
  Eigen::VectorXd gradient(const Eigen::VectorXd& u) const { return 2 * (rows.transpose() * (rows * u + constant)); }
};

class EnergyForms {
 public:
  EnergyForms(const ViewFrame& frame, Triangles F);

  /// Eq. (3.9).
  LeastSquares proposed() const;
  /// Eq. (3.9) without lambda_i / lambda0_i: the Laplacian that depends on scale, left in Fig. 3.4.
  LeastSquares scale_dependent() const;
  /// Eq. (3.7): every term is divided by the mean curvature H0_i, left in Fig. 3.6. |H0_i| counts as at least
  /// `floor_share` of its mean, because it is zero where the surface is flat.
  LeastSquares curvature_divided(double floor_share) const;

  /// Eq. (3.9) with Laplacian L and areas A of the surface deformed by `deformed`, Fig. 3.5, middle. L x of a surface
  /// that is t times as large is L0 x0 / t. So the target is (L0 x0)_i / t_i with t = 1 + kappa `deformed`.
  LeastSquares updated(const Eigen::VectorXd& deformed) const;
  /// Eq. (3.6) with L, A and H of the surface deformed by `deformed`. Floor of |H| and |H0| as above.
  LeastSquares updated_normals(const Eigen::VectorXd& deformed, double floor_share) const;

  /// Largest |H0_i| over the smallest, after the floor.
  double curvature_range(double floor_share) const;

 private:
  /// The surface at one place. `laplacian`: A times L, that is the cotangent matrix.
  struct Surface {
    SparseMatrix laplacian;
    Eigen::VectorXd area;
    Positions mean_curvature_normal;  // (L x)_i
    Eigen::VectorXd curvature;        // |L x|, negative where it points inwards
  };
  Surface surface_at(const Positions& P) const;
  /// L x of the model's vertices with the operators of `surface`.
  Positions laplacian_of_model(const Surface& surface) const;
  LeastSquares rows_of(const Surface& surface, const Eigen::VectorXd& weight, const Positions& own_slope,
                       const Positions& constant) const;

  ViewFrame frame_;
  Triangles F_;
  Positions rays_;  // e_z + kappa p
  Surface model_;
};

}  // namespace formwright::test
