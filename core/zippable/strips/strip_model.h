// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A model as strips of paper in the manner of Mitani & Suzuki 2004, "Making papercraft toys from meshes using
// strip-based approximate unfolding" ([MS04] of the thesis): parts along feature lines, bands by distance from their
// borders, each band without inner vertices, unfolded. What the thesis compares its papercraft with (Sec. 5.4,
// Fig. 5.21).
//
// Theirs removes inner vertices by collapsing edges; here a band's borders are sampled anew and filled with the
// triangles whose sides are shortest in sum, as on our ribbon, so that both are judged by the same filling.
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "base/context.h"
#include "base/data/parameters.h"
#include "fabrication/sheet/cut_sheet.h"
#include "fabrication/planar/polygon.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

struct StripOptions {
  double width_mm = 20;
  std::optional<double> size_mm;
  double feature_degrees = 50;
  double bed_x_mm = 600, bed_y_mm = 300;
  bool compare = true;

  static constexpr auto parameters = std::tuple{
      parameter(
          "width_mm", &StripOptions::width_mm, "Strip width", unit::mm, 0.1, 10000,
          "Approximate distance between the two edges of a strip. Narrower strips follow the model better and make more pieces.")
          .slider(5, 100)
          .group("Strips"),
      parameter(
          "size_mm", &StripOptions::size_mm, "Size", unit::mm, 1, 100000,
          "Largest dimension of the finished object. Automatic: the size in the file if it is from 50 to 3000 mm, else 300 mm.")
          .slider(50, 1000)
          .group("Strips"),
      parameter("feature_degrees", &StripOptions::feature_degrees, "Feature lines", unit::degrees, 5, 180,
                "Edges that bend by more than this angle become borders between parts. Smaller gives more parts.")
          .slider(20, 90)
          .group("Strips"),
      parameter("bed_x_mm", &StripOptions::bed_x_mm, "Sheet width", unit::mm, 20, 10000, "Width of one sheet of paper.")
          .slider(100, 1500)
          .group("Sheets"),
      parameter("bed_y_mm", &StripOptions::bed_y_mm, "Sheet depth", unit::mm, 20, 10000, "Depth of one sheet of paper.")
          .slider(100, 1500)
          .group("Sheets"),
      parameter("compare", &StripOptions::compare, "Compare",
                "Also designs a zippable of the same width and reports its figures beside those of the strips.")
          .group("Strips")};
};

/// One flat piece.
struct StripPiece {
  std::vector<Vec3> positions_mm;  // in space
  std::vector<Vec2> flat_mm;
  Triangles F;         // no vertex off the boundary of its band
  Polygon outline_mm;  // of the flat piece, counter-clockwise
};

struct StripModel {
  int parts = 0, bands = 0;
  std::vector<StripPiece> pieces;  // none overlaps itself, each fits the bed
  TriangleMesh formed;             // all of them in space
  double isometry_error = 0;       // largest relative change of an edge by unfolding
  std::vector<std::string> notes;
};

/// `mesh` in mm, connected and manifold; `limb` as distance_bands takes it. Throws Error: invalid_input ("bed_x_mm": a
/// strip does not fit), cancelled.
StripModel make_strips(const TriangleMesh& mesh, const std::vector<int>& limb, const StripOptions& options,
                       Context& context);

/// Figures by which cutting plans are compared, of finished outlines.
struct PieceFigures {
  int pieces = 0;
  double cut_length_mm = 0;
  double narrowest_mm = 0;  // the least, over the pieces, of twice the area over the outline: the width of a long strip
};
PieceFigures piece_figures(const std::vector<Polygon>& outlines);

/// Outlines on sheets of the bed's size, cut, with numbers engraved. Throws as `nest` does.
std::vector<CutSheet> strip_sheets(const StripModel& model, const StripOptions& options, Context& context);

}  // namespace formwright
