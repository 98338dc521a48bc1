// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zippable_design.h"

#include <algorithm>

#include "base/error.h"
#include "geometry/measures.h"

namespace formwright {

ZippableDesign design_zippable(const TriangleMesh& given, const std::vector<Vec3>& tips, const ZippableOptions& options, Context& context) {
  ZippableDesign design;
  const double size = bounding_box(given).size().maxCoeff();
  if (!(size > 0)) throw Error(ErrorCode::invalid_input, "mesh", "The model has no size.");
  if (options.size_mm) design.scale = *options.size_mm / size;
  const TriangleMesh mesh{given.V * design.scale, given.F};
  const double size_mm = size * design.scale;
  if (options.width_mm > 0.5 * size_mm)
    throw Error(ErrorCode::invalid_input, "width_mm", "The ribbon is wider than half the model's size: choose a smaller width or a larger size_mm.");
  if (options.width_mm < 1e-3 * size_mm)
    throw Error(ErrorCode::invalid_input, "width_mm", "The ribbon is narrower than a thousandth of the model: choose a larger width or a smaller size_mm.");
  Stopwatch watch;
  {
    const auto span = context.span(0, 0.2, "Looking for limbs");
    ProposalOptions proposal;
    proposal.puncture_radius_mm = 0.5 * options.puncture_mm.value_or(0.5 * options.width_mm);
    proposal.parts_max = options.parts_max;
    proposal.prominence = 0.01 * options.prominence_percent;
    for (const Vec3& tip : tips) proposal.tips_mm.push_back(design.scale * tip);
    design.proposal = propose_segmentation(mesh, proposal, context);
  }
  design.notes = design.proposal.notes;
  design.seconds_parts = watch.lap();
  const Segmentation& s = design.proposal.segmentation;
  {
    const auto span = context.span(0.2, 0.8, "Parameterising");
    design.parameterisation = parameterise(s, {}, context);
  }
  design.seconds_parameterisation = watch.lap();
  context.progress(0.8, "Drawing the curve");
  std::vector<RankedTraversal> ranked = ranked_traversals(s, design.parameterisation, options.width_mm);
  design.traversal_count = static_cast<int>(ranked.size());
  if (ranked.empty()) throw Error(ErrorCode::invalid_input, "mesh", "No order visits every part once: join or move parts so that they form a chain.");
  if (options.traversal > design.traversal_count)
    throw Error(ErrorCode::invalid_input, "traversal", "There are only " + std::to_string(design.traversal_count) + " orders of these parts: choose one of them.");
  design.traversal = std::move(ranked[options.traversal - 1]);
  CurveOptions curve;
  curve.width_mm = options.width_mm;
  curve.windings = options.windings;
  curve.sample_mm = options.sample_mm.value_or(0.2 * options.width_mm);
  const LineTracer tracer(s, design.parameterisation);
  design.curve = draw_zipper_curve(s, design.parameterisation, tracer, design.traversal.traversal, design.traversal.crossings, curve, context);
  design.notes.insert(design.notes.end(), design.curve.notes.begin(), design.curve.notes.end());
  design.seconds_curve = watch.lap();
  context.progress(0.85, "Unfolding the ribbon");
  design.ribbon = make_ribbon(s, design.parameterisation, tracer, design.curve, curve, context);
  design.seconds_ribbon = watch.lap();
  context.progress(0.9, "Comparing with the model");
  const double spacing = std::max(0.25 * options.width_mm, 5e-3 * size_mm);
  const TriangleMesh formed = design.ribbon.formed();
  design.ribbon_to_model = surface_distance(formed, PointDistance(mesh), spacing, context);
  design.model_to_ribbon = surface_distance(mesh, PointDistance(formed), spacing, context);
  design.seconds_distance = watch.lap();
  return design;
}

}  // namespace formwright
