// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The viewer's axes: where eqs. (3.3)-(3.4) put the viewpoint o, and the plate of the relief.
#include "geometry/mesh/triangle_mesh.h"
#include "relief/view/relief_options.h"

namespace formwright {

/// Normalised view coordinates: x right, y up, z away from the viewer; the plate's front is the plane
/// z = 0, the model seen on that plane is 1 wide, its centre of width and height is x = y = 0.
/// `kappa` = 1 / distance of the viewpoint from the plate, so the viewpoint is (0, 0, -1/kappa);
/// kappa = 0 is the orthographic limit, in which nothing loses digits.
///
/// A vertex p moves along its ray by a depth parameter u:   p + u (e_z + kappa p)
/// which in the thesis's terms is lambda / lambda0 = 1 + kappa u.
struct ViewFrame {
  Positions P;  // n x 3, the model in these coordinates
  double kappa = 0;
  Eigen::Matrix3d axes;     // rows: right, up, looking direction, in the model's axes
  Vec3 centre;              // the model point that became (0, 0, 0)
  double scale = 1;         // normalised length = scale * model length
  double image_height = 0;  // height of the model seen on the plate, its width being 1

  /// Moved positions for u (n), in view coordinates.
  Positions moved(const Eigen::VectorXd& u) const;
  /// z of the moved vertices.
  Eigen::VectorXd depth(const Eigen::VectorXd& u) const;
  /// The u that brings each vertex to the depth z.
  double u_for_depth(int vertex, double z) const { return (z - P(vertex, 2)) / (1 + kappa * P(vertex, 2)); }
  /// From view coordinates to the scaled model's: axes of the model, `size` long per normalised unit
  /// (the relief's width in mm), origin where the model has it.
  Positions to_model(const Positions& view_positions, double size) const;
  Vec3 to_model(const Vec3& view_position, double size) const;
  /// Unit vector from the viewpoint to a point (the looking direction when orthographic).
  Vec3 ray_direction(const Vec3& view_position) const;
};

/// Places the model before the viewer that `options` describe.
/// Throws Error{invalid_input}: direction or up of length 0 or parallel, a model without extent across the
/// view, a viewpoint inside the model or so near that its front is within a tenth of the distance.
ViewFrame make_view_frame(const TriangleMesh& mesh, const ReliefOptions& options);

}  // namespace formwright
