// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Appearance-mimicking surfaces, thesis chapter 3: the relief that looks like the model from one viewpoint and
// stays within hard bounds.
#include <functional>
#include <memory>
#include <string>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"
#include "numerics/qp/bounded_qp.h"
#include "relief/base/base_surface.h"
#include "relief/base/relief_pieces.h"
#include "relief/normal_error.h"
#include "relief/view/relief_options.h"
#include "relief/view/view_frame.h"
#include "relief/view/visibility.h"

namespace formwright {

/// A solved relief. Normalised lengths are in units of the width; `*_mm` are in millimetres.
struct Relief {
  Eigen::VectorXd u;                             // n, depth parameter of ViewFrame, within its bounds exactly
  Positions moved;                               // n x 3, view coordinates
  Eigen::VectorXd lambda_mm;                     // n, distance from the viewpoint along the ray
  Eigen::VectorXd lambda_min_mm, lambda_max_mm;  // 0 and +inf where no bound applies
  double energy = 0, energy_linear = 0;          // eq. (3.13), free of units
  NormalError normal_error, normal_error_linear;
  double bound_violation_max_mm = 0;  // over all bounded vertices, of the final positions
  double order_violation_max_mm = 0;  // over all depth-order rows
  int order_rows = 0;
  int order_rows_left_out = 0;   // those that the bounds contradict
  int vertices_beyond_base = 0;  // free, because their rays miss the base
  int balanced_steps = 0;        // of BalancedSolver; 0 for Appearance::detail
  Positions seen,
      seen_linear;      // n x 3, what looks like the model: `moved`, in steps before it is cut; and plain scaling
  ReliefPieces pieces;  // on a base in steps or parts; else empty
  Eigen::VectorXd above_mm, below_mm;  // where limits of depth are painted, else empty: of each vertex of `moved` or of
                                       // the pieces, how far it may be before the base and behind it
  BoundedQpSolution qp;                // statistics; qp.u is in the gauge of mean s = 1
};

/// Everything that depends on the mesh, the viewpoint and the weights alone, the factorisation included: other bounds
/// (thickness, painted regions) and other sizes (width) are solved without factoring again.
class ReliefSolver {
 public:
  /// `mesh`: manifold and oriented (repair it first), in any unit.
  /// Throws Error: invalid_input (see make_view_frame; nothing visible; too many vertices), could_not_solve, cancelled,
  /// out_of_memory. `painted_weight`: Painting::weight of the mesh's vertices.
  ReliefSolver(const TriangleMesh& mesh, const ReliefOptions& options, Context& context,
               Eigen::VectorXd painted_weight = {});

  /// Options and weights with equal keys share a solver.
  static std::string key(const ReliefOptions& options, const Eigen::VectorXd& painted_weight = {});

  /// `base`: in view coordinates, of the same options. `painting`: its regions and depths count; its weights are those
  /// that the solver was made with.
  /// Throws Error: invalid_input (see depth_bounds; any appearance but detail on a base in steps or parts),
  /// could_not_solve, cancelled.
  Relief solve(const ReliefOptions& options, const BaseSurface& base, Context& context, const Painting& painting = {});
  /// On a base in parts that move in groups: `bounds` as depth_bounds would give them for it. The appearance must be
  /// `detail`. `Relief::pieces` has the parts, `Relief::seen` the surface before it is cut.
  Relief solve(const ReliefOptions& options, const DepthBounds& bounds, const GroupBorders& borders, Context& context);
  /// On a flat base.
  Relief solve(const ReliefOptions& options, Context& context) { return solve(options, BaseSurface(), context); }

  const ViewFrame& frame() const { return frame_; }
  const Triangles& F() const { return F_; }
  const Visibility& visibility() const { return visibility_; }
  double seconds_setup() const { return seconds_setup_; }          // view, rays, energy
  double seconds_factorise() const { return seconds_factorise_; }  // ordering and factorisation
  double memory_mb() const;

 private:
  /// `cut`: divides the joint surface `u` of parts with the scales `m`; null where it is one.
  using Cut = std::function<ReliefPieces(const Eigen::VectorXd& u, const Eigen::VectorXd& m)>;
  Relief solve_within(const ReliefOptions& options, const DepthBounds& bounds, const Cut& cut, Context& context);
  BoundedQpSolution solve_on_base(BoundedQpConstraints& constraints, const DepthBounds& bounds,
                                  const BoundedQpOptions& options, Context& context);
  /// Moves `u` from the optimum of eq. (3.13) to the balanced relief; the number of steps.
  int balance(const ReliefOptions& options, const DepthBounds& bounds, const BoundedQpConstraints& constraints,
              Eigen::VectorXd& u, Context& context);

  ViewFrame frame_;
  Triangles F_;
  Eigen::VectorXd painted_weight_;  // n, or empty
  Visibility visibility_;
  std::vector<InequalityRow> order_rows_;
  std::unique_ptr<class AppearanceEnergy> energy_;
  std::unique_ptr<class BalancedSolver> balanced_;  // made by the first solve that needs it
  BoundedQp qp_;
  double seconds_setup_ = 0, seconds_factorise_ = 0;

 public:
  ~ReliefSolver();
};

}  // namespace formwright
