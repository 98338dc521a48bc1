// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Windings along creases: the zipper's lines are moved a little along y, so that those beside a crease that runs nearly
// like them lie on it. Thesis Sec. 5.5 leaves this open.
//
// Lines stay straight in coordinates (x, y + D). D is the smoothest field (least Dirichlet energy on the surface) that
// is 0 on all borders and openings and takes every crease's vertices to the nearest line. A spiral falls by one spacing
// a turn: it cannot stay on a ring all around, so that where the nearest line is farther than `release` spacings off
// nothing is asked, and the line changes over there.
#include <memory>
#include <mutex>

#include "numerics/sparse/sparse_cholesky.h"
#include "zippable/parts/feature_lines.h"
#include "zippable/curve/zipper_curve.h"

namespace formwright {

struct CreaseAlignmentOptions {
  double steepest_rad = 0.55;  // between a crease and the lines, for these to follow it
  double release = 0.4;        // of the spacing of lines; less where the change-over would be shorter than two spacings
  double min_spacing = 0.6;    // of the even spacing; the most is its inverse
};

/// What D's equations have in common however lines are placed: analysed once for a model, which is most of the work.
class CreaseSystem {
 public:
  /// Throws Error: cancelled, out_of_memory.
  CreaseSystem(const Segmentation& segmentation, Context& context);

  /// D per vertex: `spring` pulls it to `value` at a vertex. From several threads, one after the other. Throws Error:
  /// cancelled.
  struct Pull {
    int vertex = 0;
    double spring = 0, value_mm = 0;
  };
  Eigen::VectorXd field(const std::vector<Pull>& pulls, Context& context);

  /// On a border of its part or an opening, where D is 0.
  bool on_a_line(int vertex) const { return on_a_line_[static_cast<std::size_t>(vertex)] != 0; }
  const Adjacency& adjacency() const { return adjacency_; }

 private:
  Adjacency adjacency_;
  std::vector<char> on_a_line_;
  SparseMatrix lower_;
  std::mutex mutex_;
  SparseCholesky cholesky_;
};

struct CreaseAlignment {
  Parameterisation parameterisation;           // with y + D for y
  double crease_mm = 0;                        // how much of the creases runs like the lines
  double off_before_mm = 0, off_after_mm = 0;  // mean distance in y from there to the nearest line
  double min_spacing = 1, max_spacing = 1;     // of the even one, of any triangle
};

/// `system` and `features` of the segmentation's mesh, `lines` as they are placed. No triangle is turned over, borders
/// do not move. Throws Error: cancelled.
CreaseAlignment align_to_creases(const Segmentation& segmentation, const Parameterisation& parameterisation,
                                 CreaseSystem& system, const FeatureLines& features,
                                 const std::vector<SpiralLine>& lines, const CreaseAlignmentOptions& options,
                                 Context& context);

}  // namespace formwright
