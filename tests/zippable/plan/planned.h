// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Designs of samples as their plans read them.
#include <string_view>

#include "geometry/samples/samples.h"
#include "zippable/design_files.h"
#include "zippable/plan/zippable_plan.h"

namespace formwright::test {

inline FlatDesign designed(std::string_view sample, double width_mm, double size_mm = 150, int vertices = 3000) {
  Context context;
  ZippableOptions options;
  options.width_mm = width_mm;
  options.size_mm = size_mm;
  const ParameterisedModel model =
      parameterise_model(make_sample(sample, vertices, context).mesh, {}, options, context);
  const ZippableDesign design = design_zippable(model, options, context);
  return read_flat_design(write_design_json(model, design));
}

inline ZippablePlan planned(const FlatDesign& design, const PlanOptions& options) {
  Context context;
  return plan_zippable(design, options, context);
}

/// A flat strip in the plane z = 0 along x, whose left zipper side is its lower edge; sides of the same zipper that do
/// not meet in space.
inline FlatDesign strip(double length_mm, double width_mm, int samples) {
  FlatDesign design;
  design.pieces.emplace_back();
  for (int i = 0; i < samples; ++i) {
    const double x = length_mm * i / (samples - 1);
    design.boundary.push_back({Vec3(x, 0, 0), Vec2(x, 0), i, true});
    design.pieces[0].push_back(i);
    design.left_vertex.push_back(i);
    design.right_vertex.push_back(2 * samples - 1 - i);
    design.arclength_mm.push_back(x);
  }
  for (int i = samples; i-- > 0;) {
    const double x = length_mm * i / (samples - 1);
    design.boundary.push_back({Vec3(x, width_mm, 0), Vec2(x, width_mm), i, false});
  }
  design.piece_of.assign(samples, 0);
  design.zipper_mm = length_mm;
  design.F.resize(2 * samples - 2, 3);
  for (int i = 0; i + 1 < samples; ++i) {
    design.F.row(2 * i) << i, i + 1, 2 * samples - 1 - i;
    design.F.row(2 * i + 1) << i + 1, 2 * samples - 2 - i, 2 * samples - 1 - i;
  }
  return design;
}

}  // namespace formwright::test
