// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/seen/seen_difference.h"

#include "relief/seen/picture_similarity.h"

namespace formwright {

SeenComparison::SeenComparison(const ViewFrame& frame, const Triangles& F, double pixel_factor, Context& context)
    : frame_(frame), F_(F), model_(draw_normals(frame, frame.P, F, eye_grid(frame, pixel_factor), context)) {}

SeenDifference SeenComparison::with(const Positions& moved, Context& context) const {
  const NormalPicture relief = draw_normals(frame_, moved, F_, model_.grid, context);
  return {picture_similarity(model_, relief, light_directions(usual_light_count), context),
          false_edges_percent(model_, relief, context)};
}

}  // namespace formwright
