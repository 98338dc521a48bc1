// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The rays from the viewpoint to the vertices of a model.
#include "relief/view/view_frame.h"

namespace formwright {

struct SightRay {
  Vec3 origin, direction;
  double vertex_distance;
};

/// From the viewpoint, or, straight on, from a plane in front of everything. `frame` must outlive it.
class Sight {
 public:
  explicit Sight(const ViewFrame& frame)
      : frame_(frame),
        front_(frame.P.col(2).minCoeff() - 1),
        reach_(4 * (frame.P.rowwise().norm().maxCoeff() + 1) + (frame.kappa > 0 ? 1 / frame.kappa : 0)) {}

  SightRay at(Eigen::Index vertex) const {
    const Vec3 p = frame_.P.row(vertex).transpose();
    if (frame_.kappa == 0) return {Vec3(p.x(), p.y(), front_), Vec3::UnitZ(), p.z() - front_};
    const Vec3 origin(0, 0, -1 / frame_.kappa);
    return {origin, (p - origin).normalized(), (p - origin).norm()};
  }
  /// A distance along any ray beyond everything.
  double reach() const { return reach_; }

 private:
  const ViewFrame& frame_;
  double front_, reach_;
};

inline bool has_corner(const Triangles& F, int face, Eigen::Index vertex) {
  return F(face, 0) == vertex || F(face, 1) == vertex || F(face, 2) == vertex;
}

}  // namespace formwright
