// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A forest of pillars and the viewpoints around it: x right and y back in the floor plan, z up from the floor, mm.
// Thesis, Figs. 3.13 and 3.14.
#include <array>
#include <string>
#include <vector>

#include "relief/forest/plan/pillar.h"

namespace formwright {

/// A place from which the pieces of one model line up.
struct ForestViewpoint {
  Vec3 eye_mm{0, 0, 0};
  Vec3 look_at_mm{0, 0, 0};                   // the middle of the model, which seems to stand there
  double width_mm = 0;                        // the model's width where it seems to stand
  std::array<double, 3> direction{0, 0, -1};  // in which the viewer looks at the model, in the model's axes
  std::array<double, 3> up{0, 1, 0};          // upwards in the picture, in the model's axes
  std::string model;                          // its name, for messages and files
};

struct ForestScene {
  std::vector<ForestViewpoint> viewpoints;
  std::vector<Pillar> pillars;
};

inline constexpr int max_viewpoints = 12, max_pillars = 400, max_outline_corners = 256;

/// What must hold of viewpoints before ForestView and make_view_frame take them: there are some, not too many, with
/// numbers in range, and none looks at its own place or straight up or down. Throws Error{invalid_input, "scene"}.
void check_viewpoints(const ForestScene& scene);

/// What must hold before anything is solved, check_viewpoints included; `gap_mm` is how far apart pillars must stand at
/// least. Throws Error{invalid_input, "scene"} with the numbers of what is wrong, which count from 1: numbers out of
/// range; an outline without area or that crosses itself; pillars that overlap or stand too close; a viewpoint in a
/// pillar, or with all pillars behind it.
void check_forest(const ForestScene& scene, double gap_mm);

/// Corners counter-clockwise.
void orient_outlines(ForestScene& scene);

}  // namespace formwright
