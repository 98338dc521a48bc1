// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/relief/pieces/parts_plan.h"

#include <algorithm>
#include <string>

#include "base/format.h"
#include "geometry/mesh/measures.h"
#include "job/operations/relief/pieces/placement_view.h"
#include "relief/base/seen_regions.h"

namespace formwright {
namespace {

/// The coordinates that are drawn to the right and upwards, the first reversed where its sign is negative.
struct Side {
  int right, up, towards;
  double right_sign, up_sign;
  std::string title, name;
};

PlacementView view_of(const std::vector<PartPiece>& pieces, const Side& side) {
  PlacementView view;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    TriangleMesh turned = pieces[k].solid.mesh;
    turned.V.col(0) = side.right_sign * pieces[k].solid.mesh.V.col(side.right);
    turned.V.col(1) = side.up_sign * pieces[k].solid.mesh.V.col(side.up);
    turned.V.col(2) = pieces[k].solid.mesh.V.col(side.towards);
    const Region outline = outline_of(turned);
    const std::string number = std::to_string(k + 1);
    for (const std::vector<Vec2>& ring : outline.rings)
      view.add({CutLayer::mark, ring, true, side.name + "-" + number});
    const auto [low, high] = outline.box();
    view.words(number, 0.5 * (low + high), plan_number_height_mm(high - low));
  }
  view.title(side.title);
  return view;
}

PlacementView table(const std::vector<PartPiece>& pieces) {
  BoundingBox whole;
  for (const PartPiece& piece : pieces) {
    const BoundingBox box = bounding_box(piece.solid.mesh);
    whole.add(box.lower);
    whole.add(box.upper);
  }
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const BoundingBox box = bounding_box(pieces[k].solid.mesh);
    std::vector<std::string> row{std::to_string(k + 1)};
    for (const double length : {box.size().x(), box.size().y(), box.size().z(), pieces[k].depth_mm,
                                box.lower.x() - whole.lower.x(), box.lower.y() - whole.lower.y()})
      row.push_back(with_decimals(length, 1));
    rows.push_back(std::move(row));
  }
  return plan_table({"PIECE", "WIDTH", "HEIGHT", "THICK", "BEHIND", "LEFT", "LOW"}, rows, "MM");
}

}  // namespace

CutSheet parts_plan(const std::vector<PartPiece>& pieces) {
  const PlacementView front = view_of(pieces, {0, 1, 2, 1, 1, "FRONT", "piece"}),
                      above = view_of(pieces, {0, 2, 1, 1, -1, "FROM ABOVE", "above"}),
                      right = view_of(pieces, {2, 1, 0, -1, 1, "FROM THE RIGHT", "right"}), list = table(pieces);
  CutSheet sheet;
  sheet.title = "Placement plan";
  const double left = std::min(front.low.x(), above.low.x()), bottom = std::min(front.low.y(), right.low.y());
  const Vec2 corner(plan_gap_mm, 2 * plan_gap_mm + list.size().y());
  const double column = std::max(front.high.x(), above.high.x()) - left + plan_gap_mm,
               row = above.size().y() + plan_gap_mm;
  add_view(sheet, list, Vec2(plan_gap_mm, plan_gap_mm));
  add_view(sheet, above, corner + Vec2(above.low.x() - left, 0));
  add_view(sheet, front, corner + Vec2(front.low.x() - left, row + front.low.y() - bottom));
  add_view(sheet, right, corner + Vec2(column, row + right.low.y() - bottom));
  sheet.width_mm = std::max(corner.x() + column + right.size().x(), plan_gap_mm + list.size().x()) + plan_gap_mm;
  sheet.height_mm = corner.y() + row + std::max(front.high.y(), right.high.y()) - bottom + plan_gap_mm;
  return sheet;
}

}  // namespace formwright
