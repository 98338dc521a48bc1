// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The fastening rig, thesis Sec. 5.3.1 and Fig. 5.19: for every piece of cloth a base, a layer with tracks for the
// teeth, and a cover with slots for the tape, screwed together along their rim.
#include <vector>

#include "base/context.h"
#include "fabrication/sheet/nesting.h"
#include "zippable/plan/pieces/plan_options.h"
#include "zippable/plan/rig_tracks.h"

namespace formwright {

enum class RigLayer { base, tracks, cover };
inline constexpr int rig_layer_count = 3;

/// One layer for one piece, its lower left corner at the origin.
struct RigPlate {
  RigLayer layer = RigLayer::base;
  int piece = 0;
  Vec2 size_mm{0, 0};
  std::vector<CutPath> paths;  // with the outline
};

struct Rig {
  std::vector<RigPlate> plates;  // base, tracks and cover of the first piece, of the second, ...
  std::vector<CutSheet> sheets;
  int tracks = 0, blind_tracks = 0;  // those without an opening
  int openings = 0, screws = 0;      // through all layers of all pieces
  double track_mm = 0;               // length of all, without leads
  double left_out_mm = 0;            // of the cloth's edges: no room for a track
  int hidden_markers = 0;            // drawn under the cloth, where there is no room beside the track
};

/// Sizes of the parts for a zipper. Throws Error{invalid_input} ("rig", "track_width_mm", "slot_width_mm",
/// "rig_opening_mm") when they do not go together.
RigSizes rig_sizes(const PlanOptions& options, const ZipperModel& zipper);

/// How far a plate goes beyond its cloth, at most, on every side.
double rig_rim_mm(const PlanOptions& options, const RigSizes& sizes);

/// What is on a layer is named after it: outlines "base-P1", "tracks-P1", "cover-P1"; "track-P1-1", "slot-P1-1",
/// "screw-base-P1-1", markers "marker-7-left" on the cover as on the cloth; on the layer note, of every track the
/// middle "middle-P1-1". Cuts are moved by half the kerf into what falls out, outlines outwards. Throws Error:
/// invalid_input ("bed_x_mm": a plate does not fit), cancelled.
Rig make_rig(const FlatDesign& design, const OffsetRibbon& ribbon, const Markers& markers, const PlanPieces& pieces,
             const std::vector<TapeRun>& runs, const PlanOptions& options, const RigSizes& sizes, Context& context);

}  // namespace formwright
