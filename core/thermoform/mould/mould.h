// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The solid that the sheet is formed over, and the negative that it is cast in.
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "geometry/booleans/booleans.h"
#include "thermoform/mould/mould_options.h"
#include "thermoform/mould/vents.h"

namespace formwright {

/// `placed` (machine coordinates) made ready to be cut by the plate: vertices within a nanometre of z = 0 are put
/// there; a model that touches the plate in points or lines, where the block around it would hang together by nothing,
/// sinks by a micrometre or some; holes in its lower half are closed straight down to below the plate, and `notes` say
/// so.
TriangleMesh ready_for_plate(const TriangleMesh& placed, std::vector<std::string>& notes);

/// The part of the placed model above the plate, with its foot. Throws Error{invalid_input}, `where` = "mould" or
/// "sink_mm": open, self-intersecting or inside out above the plate; standing on hardly more than a point.
ExactSolid model_on_plate(const TriangleMesh& placed, const ThermoformMouldOptions& options,
                          std::vector<std::string>& notes, Context& context);

struct Mould {
  ExactSolid body;   // what the sheet is formed over: the model, its base plate, less the vents; machine coordinates
  ExactSolid solid;  // what is printed: the body, or the block around it; machine coordinates
};

/// Vents are holes from the base to one diameter above the surface. Throws Error: could_not_solve, cancelled.
Mould make_mould(const ExactSolid& model, const std::vector<Vent>& vents, const ThermoformMouldOptions& options,
                 Context& context);

/// Area of a solid's faces that lie on z = `height_mm` and face down, in mm^2.
double base_area_mm2(const TriangleMesh& solid, double height_mm);

/// Gypsum and water for a cast: a slurry of powder (2.63 g/ml) and water in the given ratio by mass, which sets at
/// about its own volume.
struct Mixture {
  double plaster_g = 0, water_g = 0;
};
Mixture plaster_mixture(double volume_ml, double water_to_plaster_ratio);

}  // namespace formwright
