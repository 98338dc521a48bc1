// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What vectors of the plane need beyond Eigen.
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// |a| |b| sin(angle from a to b): positive where b points to the left of a; twice the area of the triangle 0, a, b.
inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace formwright
