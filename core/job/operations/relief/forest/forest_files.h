// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The files of a forest of pillars.
#include "base/data/json.h"
#include "fabrication/sheet/cut_sheet.h"
#include "imaging/picture/image.h"
#include "relief/forest/forest.h"

namespace formwright {

/// "01", "02", ..., with as many digits as the largest number has, two at least.
std::string numbered(std::size_t index, std::size_t count);

/// The floor at true size, x right and y back: holes for the pins to cut, outlines and turning marks to mark, numbers
/// of pillars to engrave, and where the viewpoints are as notes.
CutSheet floor_plan(const ForestPlan& plan, double hole_diameter_mm);

/// For drawing from above: of each viewpoint its eye, the area that it sees in its range, and the lines of the surfaces
/// that are its own; outlines of pillars; and what of them every two viewpoints see, which nobody or one of them gets.
Json plan_json(const ForestPlan& plan);

/// All pillars where they stand, one group each, in the axes of the floor.
Model standing_pillars(const SolvedForest& forest);

/// "pillar_01.stl", ...: each upright, its pin on z = 0 and its middle at 0. Throws Error: cancelled.
Bytes pillar_files(const SolvedForest& forest, Context& context);

/// The forest from each viewpoint, then from elsewhere. Throws Error: cancelled.
std::vector<Image> forest_pictures(const ForestPlan& plan, const SolvedForest& forest, int pixels, Context& context);

/// "viewpoint_1_bust.png", ... and "elsewhere.png". Throws Error: cancelled.
Bytes picture_files(const ForestPlan& plan, const std::vector<Image>& pictures, Context& context);

/// "model_1.png", ...: each model as its viewpoint sees it. `frames` and `meshes`: of each viewpoint.
/// Throws Error: cancelled.
Bytes model_picture_files(const std::vector<ViewFrame>& frames, const std::vector<const TriangleMesh*>& meshes,
                          Context& context);

/// All pictures side by side, in rows.
Image overview(const std::vector<Image>& pictures);

}  // namespace formwright
