// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How far a relief looks from its model, in the viewer's eye.
#include "relief/seen/normal_picture.h"

namespace formwright {

struct SeenDifference {
  double similarity = 1;           // see picture_similarity, under 32 lights
  double false_edges_percent = 0;  // see false_edges_percent
};

/// Keeps the picture of the model and compares others with it. Frame and faces must outlive it.
class SeenComparison {
 public:
  /// Pixels as eye_grid has them, `pixel_factor` times as large. Throws Error: cancelled.
  SeenComparison(const ViewFrame& frame, const Triangles& F, double pixel_factor, Context& context);

  /// `moved`: n x 3, the same vertices elsewhere on their rays, view coordinates. Throws Error: cancelled.
  SeenDifference with(const Positions& moved, Context& context) const;

  const NormalPicture& model() const { return model_; }

 private:
  const ViewFrame& frame_;
  const Triangles& F_;
  NormalPicture model_;
};

}  // namespace formwright
