// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The makers behind make_sample, one per shape.
#include <functional>

#include "geometry/samples/remeshing/remesh.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright::samples {

Model make_bust(int vertices, Context& context);
Model make_cat(int vertices, Context& context);
Model make_octopus(int vertices, Context& context);
Model make_star(int vertices, Context& context);
Model make_heart(int vertices, Context& context);
Model make_torus(int vertices, Context& context);
Model make_fish(int vertices, Context& context);
Model make_coin(int vertices, Context& context);
Model make_pyramid(int vertices, Context& context);
Model make_t_shape(int vertices, Context& context);
Model make_hemisphere(int vertices, Context& context);
Model make_mountain(int vertices, Context& context);

/// Linear RGB of a surface point with its outward unit normal, both in the coordinates of the mesh.
using Colouring = std::function<Point(const Point& p, const Point& normal)>;

/// Moves a surface so that it stands on y = 0 and is centred on the y axis, and colours its vertices (`colouring` takes
/// the coordinates before). `shift` is what was subtracted.
Model finished(const Surface& surface, const Colouring& colouring, Point* shift = nullptr);

/// Mean edge length of an even mesh of `vertices` vertices on an area.
double edge_length_of(double area_mm2, int vertices);

/// sRGB bytes as linear light.
Point srgb(int red, int green, int blue);

}  // namespace formwright::samples
