// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A scan laid flat: as-rigid-as-possible parameterisation, Liu, Zhang, Xu, Gotsman, Gortler 2008 "A Local/Global
// Approach to Mesh Parameterization".
#include <string>
#include <vector>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// The part of a scan that is the formed sheet.
struct ScanPart {
  Model model;                     // one connected part, a disc with holes, with its texture
  int other_parts = 0;             // left out
  int holes = 0;                   // beside the outer border
  std::vector<std::string> notes;  // in words
};

/// The part of largest area among those that are discs (genus 0, with a border). `model` must be repaired: manifold,
/// oriented. Throws Error{invalid_input, "scan"} when there is none: a closed or many-handled scan has to be cut to the
/// sheet's outer face first.
ScanPart sheet_part(const Model& model);

struct FlatScan {
  TextureCoordinates place_mm;  // per vertex, areas counted positive as the faces are seen from outside
  int flipped = 0;              // faces that came out upside down
  double stretch_rms = 0;       // root mean square deviation of the singular values from 1, by area
  int iterations = 0;
};

/// Lays a disc flat, as nearly rigid as it goes. Starts from a harmonic map whose outer border is the border's shadow
/// on its best plane (or a circle, where that shadow crosses itself). Throws Error: could_not_solve, cancelled.
FlatScan flatten(const TriangleMesh& mesh, int iterations, Context& context);

}  // namespace formwright
