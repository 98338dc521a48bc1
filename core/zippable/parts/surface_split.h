// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// New edges along curves that cross faces: where vertices change their label, and around punctures.
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct LabelledSurface {
  TriangleMesh mesh;            // old vertices keep their numbers, new ones follow
  std::vector<int> face_label;  // per face
};

/// Splits every face whose vertices differ in `label`; `level(a, b)` is where along the edge from a the labels change,
/// at least a tenth of it from either end, or 0 or 1 to go through that vertex. `face_of` gets the old face of each new
/// one.
LabelledSurface split_at_levels(const TriangleMesh& mesh, const Adjacency& adjacency, const std::vector<int>& label,
                                const std::function<double(int, int)>& level, std::vector<int>& face_of);

/// `field` (n x labels) is least, of all labels, in that of each vertex (`label`). Faces are split where two labels'
/// fields are equal, linearly along each edge but at least a tenth of it from either end, and in the middle where three
/// labels meet. Borders beside a vertex of `keep_to` (per vertex; empty: none) go through that vertex instead, along
/// old edges.
LabelledSurface split_by_smallest_field(const TriangleMesh& mesh, const std::vector<int>& label,
                                        const Eigen::MatrixXd& field, const std::vector<char>& keep_to = {});

/// Around each of `vertices`, takes out what is connected to it and nearer than `radius_mm`, cut along a smooth circle,
/// and halves the radius until that is a disc inside the label of the vertex that touches neither other labels nor an
/// opening nor the puncture before it; at last, until it lies within the faces around the vertex. Returns the radii in
/// mm. Vertices are renumbered. Throws Error{invalid_input, "mesh"} when a vertex lies on an opening or beside another
/// label or puncture.
std::vector<double> puncture(LabelledSurface& surface, const std::vector<int>& vertices, double radius_mm);

/// The faces that are kept and their vertices only; `vertex_of` gets the new number of each old vertex, -1 for none.
TriangleMesh kept_faces(const TriangleMesh& mesh, const std::vector<char>& keep, std::vector<int>& vertex_of);

}  // namespace formwright
