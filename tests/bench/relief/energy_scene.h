// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A model before the viewer in a slab, every vertex bounded, in which forms of the energy are compared. The scale is
// fixed, because one of the forms depends on it.
#include <functional>
#include <string>
#include <vector>

#include "base/data/json.h"
#include "bench/relief/iterated_energy.h"
#include "imaging/picture/image.h"
#include "relief/seen/normal_picture.h"
#include "relief/view/visibility.h"

namespace formwright::test {

struct SolvedForm {
  std::string form;
  Eigen::VectorXd u;
  double seconds = 0;  // processor time of energy and solution
  bool converged = true;
  int iterations = 0;      // of operators that are updated; 0 where they are the model's
  double last_change = 0;  // of the slab, see IteratedMinimum::change
};

class EnergyScene {
 public:
  /// The slab is `options.thickness_mm` thick, its back in the plane of the plate.
  EnergyScene(std::string name, const TriangleMesh& mesh, const ReliefOptions& options, Context& context);

  const EnergyForms& forms() const { return forms_; }

  /// In the slab scaled about the viewpoint by `distance_ratio`. The result is scaled back: from the viewpoint both
  /// look alike. In a far view the ratio must be 1.
  SolvedForm solve(std::string form, const LeastSquares& energy, double distance_ratio = 1) const;
  /// From the optimum of eq. (3.9) on, with the operators of the surface reached.
  SolvedForm iterated(std::string form, const std::function<LeastSquares(const Eigen::VectorXd&)>& energy_at,
                      double damping) const;

  /// Angles between normals, time and convergence.
  Json row(const std::string& figure, const SolvedForm& solved) const;

  /// The model and `shown` beside each other: above shaded, below the angles between normals. `faceted`: every triangle
  /// has its own normal.
  Image sheet(const std::vector<const SolvedForm*>& shown, double pixel_factor, double max_angle_deg,
              bool faceted) const;

 private:
  /// In the slab scaled about the viewpoint by `ratio`.
  AllowedDepths allowed_at(double ratio) const;
  /// The depth parameters of the surface scaled about the viewpoint by `ratio`.
  Eigen::VectorXd moved_to(const Eigen::VectorXd& u, double ratio) const;
  NormalPicture drawn(const Positions& P, const PictureGrid& grid, bool faceted) const;

  std::string name_;
  double thickness_percent_;
  Context& context_;
  Triangles F_;
  ViewFrame frame_;
  Visibility visibility_;
  EnergyForms forms_;
  AllowedDepths allowed_;
};

}  // namespace formwright::test
