// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The surfaces that a relief can be worked into instead of a flat plate: thesis Figs. 3.3 and 3.12.
#include <optional>

#include "geometry/mesh/triangle_mesh.h"
#include "relief/base/base_bands.h"
#include "relief/view/relief_options.h"
#include "relief/view/view_frame.h"

namespace formwright {

/// A built-in shape in view coordinates, as an open surface: every point of the plate, and every ray from the viewpoint
/// to the model, meets it. Its foremost places lie on the plane z = 0. All shapes are the same along one direction of
/// the plate, so that few long triangles have them: exactly where they are flat, else within 1e-5 of their
/// depth.
/// `options.base` must not be `flat`. Throws Error{invalid_input}: a cylinder deeper than half its width; waves
/// too short for their number; see base_strips.
TriangleMesh base_shape(const ReliefOptions& options, const ViewFrame& frame);

/// The steps or strips of that shape; nothing where it has none. Throws as base_strips.
std::optional<BaseBands> base_bands(const ReliefOptions& options, const ViewFrame& frame);

/// A mesh from a file, in millimetres with x right, y up and z towards the viewer, the middle of the plate's front
/// at the origin, in view coordinates: turned about its origin, then moved, as the options `base_mesh_...` say. Throws
/// Error{invalid_input, "base_mesh"}: no triangles.
TriangleMesh base_from_file(const TriangleMesh& mesh, const ReliefOptions& options);

}  // namespace formwright
