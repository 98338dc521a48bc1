// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A design as files, and the maker's own division into parts from one.
#include <vector>

#include "base/bytes.h"
#include "zippable/zippable_design.h"

namespace formwright {

/// segments.json: {"punctures": [[x, y, z] or [[x, y, z], ...], ...], "loops": [curve, ...], "lines": [curve, ...],
/// "start": [x, y, z], "end": [x, y, z]}, each optional, in the model's coordinates: where parts are punctured (a hole,
/// or a cut along a path), closed borders of parts, borders that end on others, and points in the first and the last
/// part. A curve is a list of points or {"points": [...], "snap": true}. Throws Error{invalid_input, "segments"} naming
/// what is wrong.
ZippableParts read_segments(ByteView bytes);

/// Everything that later steps need of a design: parts, the curve's samples, the ribbon in space and in the plane.
Bytes write_design_json(const ParameterisedModel& model, const ZippableDesign& design);

/// The parts alone, checked before anything is made of them: of each whether it is a cylinder, and if not, why.
Bytes write_parts_json(const ParameterisedModel& model);

/// The parts with u, v (mm), the part's number and the distortion of every vertex; vertices are split where parts meet
/// and along cuts.
Bytes write_parameterised_ply(const ParameterisedModel& model, Context& context);

/// The zipper's course on the surface as OBJ polylines, one an opening-to-opening piece.
Bytes write_curve_obj(const ZippableDesign& design);

/// The ribbon's outline at true size, 1 user unit = 1 mm: the zipper's sides ("zipper"), stretches along openings
/// ("opening") and rulings ("ruling") as groups. Pieces may overlap.
Bytes write_ribbon_svg(const ZippableDesign& design);

}  // namespace formwright
