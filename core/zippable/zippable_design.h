// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From a model to the one ribbon that zips up into it: parts, parameterisation, curve, ribbon. Thesis Sec. 5.2.
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "geometry/queries/point_distance.h"
#include "zippable/curve/crease_alignment.h"
#include "zippable/fabric_colours.h"
#include "zippable/proposal.h"
#include "zippable/ribbon/ribbon.h"
#include "zippable/ribbon/ribbon_bend.h"
#include "zippable/zippable_options.h"

namespace formwright {

/// What a maker has decided about the parts; empty: limbs are found.
struct ZippableParts {
  std::vector<Vec3> punctures;               // in the mesh's coordinates
  std::vector<DrawnCurve> curves;            // in the mesh's coordinates
  std::vector<std::vector<Vec3>> cuts = {};  // punctures that are cuts, in the mesh's coordinates
  std::optional<Vec3> start = {}, end = {};  // in the parts where the zipper begins and ends
};

/// A model divided and parameterised: what does not depend on windings, order and sampling.
struct ParameterisedModel {
  double scale = 1;   // from the given mesh to mm
  TriangleMesh mesh;  // in mm, whole
  Proposal proposal;
  Parameterisation parameterisation;
  int start_part = 0, end_part = 0;  // as the maker's points name them, from 1; 0: anywhere
  // Where windings follow creases:
  std::optional<FeatureLines> features;
  std::shared_ptr<CreaseSystem> crease_system;
  double seconds_parts = 0, seconds_parameterisation = 0;
};

/// The largest dimension of an object whose size nobody set: the file's, where that can be meant in mm, else 300.
double automatic_size_mm(double size_in_file);

/// `mesh`: connected, manifold, oriented.
/// Throws Error: invalid_input ("mesh", "segments", or a parameter), could_not_solve, cancelled.
ParameterisedModel parameterise_model(const TriangleMesh& mesh, const ZippableParts& parts,
                                      const ZippableOptions& options, Context& context);

/// The division alone, whether or not its parts are cylinders: `proposal.segmentation.problems` says it.
/// Throws Error as parameterise_model does, but not for a drawn part that is no cylinder.
ParameterisedModel divide_model(const TriangleMesh& mesh, const ZippableParts& parts, const ZippableOptions& options,
                                Context& context);

/// Equal keys, equal parameterised models of equal meshes and parts.
std::string parameterisation_key(const ZippableOptions& options, const ZippableParts& parts = {});

struct ZippableDesign {
  int traversal_count = 0;         // orders to choose from
  int traversal_number = 1;        // which of them, from 1
  RankedTraversal traversal;       // the chosen one
  std::optional<RibbonBend> bend;  // the tightest
  ZipperCurve curve;
  std::optional<CreaseAlignment> alignment;  // where windings follow creases
  Ribbon ribbon;
  std::optional<FabricColours> fabrics;                             // of two colours
  std::optional<SurfaceDistance> ribbon_to_model, model_to_ribbon;  // mm; only where options.measure_distances
  std::vector<std::string> notes;
  double seconds_curve = 0, seconds_ribbon = 0, seconds_distance = 0;
};

/// Throws Error: invalid_input (a parameter), cancelled.
ZippableDesign design_zippable(const ParameterisedModel& model, const ZippableOptions& options, Context& context);

}  // namespace formwright
