// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What eq. (3.2) asks for before anything is linearised: that every visible face keeps its normal.
#include <array>
#include <vector>

#include "relief/view/view_frame.h"
#include "relief/view/visibility.h"

namespace formwright {

/// The sum over visible faces of share_f (1 - n_f . n0_f) = share_f |n_f - n0_f|^2 / 2 in the depth parameter u of
/// ViewFrame. n0_f and n_f are unit normals of the model's face and of the moved one; share_f is the part of the seen
/// picture that the face covers, so that the sum lies between 0 and 2 and needs no unit. It does not change under
/// uniform scaling from the viewpoint.
class NormalTerm {
 public:
  /// Keeps a copy of what it needs. Without visible faces the term is 0.
  /// `painted_weight` (n, or empty): a face's share is multiplied by the mean of its corners' squares, as the energy of
  /// eq. (3.13) multiplies by w_i^2, and the shares still add up to 1.
  NormalTerm(const ViewFrame& frame, const Triangles& F, const Visibility& visibility,
             const Eigen::VectorXd& painted_weight = {});

  /// The term and what Newton's method needs of each face, in the order of `corners`.
  struct FaceModel {
    std::array<double, 3> gradient;
    std::array<double, 6> hessian;  // 00, 11, 22, 10, 20, 21; positive semidefinite, constants cost nothing
  };

  double operator()(const Eigen::VectorXd& u) const;

  /// The value at u; `gradient` (n) is overwritten, `faces` too: Gauss and Newton's model of |n - n0|^2 / 2.
  double linearise(const Eigen::VectorXd& u, Eigen::VectorXd& gradient, std::vector<FaceModel>& faces) const;

  /// The vertices of each counted face.
  const std::vector<std::array<int, 3>>& corners() const { return corners_; }

 private:
  Positions P_, rays_;  // n x 3: a vertex moves along p + u (e_z + kappa p)
  std::vector<std::array<int, 3>> corners_;
  std::vector<Vec3> normal_;   // n0
  std::vector<double> share_;  // they add up to 1
};

}  // namespace formwright
