// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>

#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// The projective map of the plane that takes four points to four others; not finite where there is none. OpenCV keeps
/// points as floats: exact to a ten-millionth of their distance from the origin.
Eigen::Matrix3d projective_map(const std::array<Vec2, 4>& from, const std::array<Vec2, 4>& to);

}  // namespace formwright
