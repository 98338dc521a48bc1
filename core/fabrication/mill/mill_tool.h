// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A height field, a tool's shape, and where the one may stand over the other: grey-scale morphology.
#include <vector>

#include "base/context.h"
#include "fabrication/mill/mill_options.h"

namespace formwright {

/// Heights at the nodes of a regular grid in mm, row by row from the lower left; z is 0 on the stock and negative
/// below.
struct HeightField {
  int columns = 0, rows = 0;
  double pitch_x_mm = 1, pitch_y_mm = 1;
  std::vector<float> z_mm;

  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
  float& at(int row, int column) { return z_mm[index(row, column)]; }
  float at(int row, int column) const { return z_mm[index(row, column)]; }
  HeightField transposed() const;
};

struct MillTool {
  ToolShape shape = ToolShape::ball;
  double diameter_mm = 3, v_angle_degrees = 60, v_tip_mm = 0;

  /// Height of the tool's surface over its tip at this distance from its axis; infinite outside of it.
  double profile_mm(double distance_mm) const;
};

/// The tool's surface over the nodes around it.
struct ToolFootprint {
  struct Node {
    int row, column;
    float height_mm;
  };
  std::vector<Node> nodes;
  int reach_rows = 0, reach_columns = 0;
};

/// With the tool's axis `shift_columns` (0 to 1) of a node's distance to the right of node (0, 0).
ToolFootprint footprint(const MillTool& tool, const HeightField& grid, double shift_columns = 0);

/// The tool's surface for a tip that runs from one node to the next of its row: its steep outer part, beyond 0.7 of the
/// radius, is swept by a node's distance to either side. Where both nodes keep off the field by this, so does
/// everything between them beyond 0.7 of the radius; within it a curved tool can be too low by p^2 / 8 of its second
/// derivative, p the distance of nodes.
ToolFootprint swept_footprint(const MillTool& tool, const HeightField& grid);

/// The lowest place of the tool's tip over every node at which no node of the field is cut into: dilation by the tool
/// turned upside down.
HeightField lowest_tips(const HeightField& field, const ToolFootprint& tool, const Context& context);

/// What the tool leaves: the field cut down to the tool's surface wherever its tip stands at `tips` (+infinity:
/// nowhere).
void carve(HeightField& field, const HeightField& tips, const ToolFootprint& tool, const Context& context);

/// Height of the ridges a ball leaves between lines on a plane: R - sqrt(R^2 - (s/2)^2).
double scallop_mm(double diameter_mm, double stepover_mm);

}  // namespace formwright
