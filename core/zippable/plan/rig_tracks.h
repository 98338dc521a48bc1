// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where the fastening rig of thesis Fig. 5.19 holds the zipper beside one piece of cloth.
//
// A track holds the row of teeth of one tape: its middle runs where the zipper's curve was before the edge made room
// for it. The tape comes up through a narrower slot along the track's inner side, so that the cover holds the teeth
// down.
#include <vector>

#include "fabrication/planar/thick_lines.h"
#include "zippable/plan/pieces/plan_pieces.h"
#include "zippable/plan/pieces/tape_runs.h"

namespace formwright {

struct RigSizes {
  double track_mm = 4;     // width of a track
  double slot_mm = 1.6;    // width of the slot above it
  double opening_mm = 10;  // diameter where the tape is slid in
  double wall_mm = 1.5;    // left standing between tracks, at least
  double offset_mm = 3;    // from the cloth's edge to the middle of the track
};

struct RigTrack {
  bool left = true;               // which tape
  std::vector<Vec2> middle_mm;    // of the track; leads to the openings included
  std::vector<Vec2> slot_mm;      // middle of the slot, the same
  std::vector<Vec2> openings_mm;  // centres; at one end at least, or none where there is no room
  double along_cloth_mm = 0;      // without the leads
};

/// Of one piece: `cloth_mm` its finished outline, `edges` the polylines of its zipper edges with the cloth to their
/// left, `edge_left` which tape each takes. Tracks end where they would come nearer than a wall to another one, nearer
/// to their edge than the offset, under the cloth, or be shorter than 10 mm; `left_out_mm` says how much of the edges
/// has none.
struct RigTracks {
  std::vector<RigTrack> tracks;
  double left_out_mm = 0;
};
RigTracks rig_tracks(const Polygon& cloth_mm, const std::vector<std::vector<Vec2>>& edges,
                     const std::vector<char>& edge_left, const RigSizes& sizes);

/// How far a track with its opening reaches from the cloth, at most.
double rig_reach_mm(const RigSizes& sizes);

}  // namespace formwright
