// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/parts/parted_relief.h"

#include <algorithm>
#include <string>
#include <utility>

#include "geometry/booleans/booleans.h"
#include "geometry/mesh/measures.h"
#include "relief/base/seen_regions.h"

namespace formwright {
namespace {

constexpr double min_overlap_mm3 = 1e-6;

TriangleMesh surface_before(const ReliefPieces& cut, int part) {
  std::vector<Eigen::Index> faces;
  for (Eigen::Index f = 0; f < cut.F.rows(); ++f)
    if (cut.band[static_cast<std::size_t>(f)] == part) faces.push_back(f);
  return {cut.V, cut.F(faces, Eigen::all)};
}

void refuse_overlaps(const BaseParts& parts, double size_mm, Context& context) {
  std::vector<TriangleMesh> meshes;
  std::vector<BoundingBox> boxes;
  for (int k = 0; k < parts.count(); ++k) {
    meshes.push_back(part_in_scene(parts, k, size_mm));
    boxes.push_back(bounding_box(meshes.back()));
  }
  for (int a = 0; a < parts.count(); ++a)
    for (int b = a + 1; b < parts.count(); ++b) {
      const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
      if (!parts.is_closed(a) || !parts.is_closed(b) || (boxes[i].lower.array() >= boxes[j].upper.array()).any() ||
          (boxes[j].lower.array() >= boxes[i].upper.array()).any())
        continue;
      const ExactSolid common = intersect(ExactSolid::from_mesh(meshes[i], "base_mesh", context),
                                          ExactSolid::from_mesh(meshes[j], "base_mesh", context), context);
      if (!common.empty() && common.volume_mm3() > min_overlap_mm3)
        throw Error(ErrorCode::invalid_input, "base_mesh",
                    "Parts " + std::to_string(a + 1) + " and " + std::to_string(b + 1) +
                        " of the base overlap, and cannot be made one by one: move them apart, or take them as one "
                        "surface (base_mesh_parts).");
    }
}

/// From the top to the bottom, and in a row from left to right.
void sort_for_reading(std::vector<PartPiece>& pieces) {
  const auto low = [](const PartPiece& piece) { return piece.outline_mm.box().first; };
  const auto high = [](const PartPiece& piece) { return piece.outline_mm.box().second; };
  std::ranges::stable_sort(pieces, {}, [&](const PartPiece& piece) { return -high(piece).y(); });
  for (auto first = pieces.begin(); first != pieces.end();) {
    const double bottom = low(*first).y();
    const auto end = std::find_if(
        first, pieces.end(), [&](const PartPiece& piece) { return 0.5 * (low(piece).y() + high(piece).y()) < bottom; });
    std::stable_sort(first, end, [&](const PartPiece& a, const PartPiece& b) { return low(a).x() < low(b).x(); });
    first = end;
  }
}

}  // namespace

std::vector<PartPiece> parted_relief(const BaseParts& parts, const ReliefPieces& cut, const ReliefOptions& options,
                                     double tolerance_mm, bool numbered, Context& context) {
  refuse_overlaps(parts, options.width_mm, context);
  double foremost = INFINITY;
  std::vector<PartPiece> pieces;
  for (int part = 0; part < parts.count(); ++part) {
    const double depth_mm = options.width_mm * parts.mesh(part).V.col(2).minCoeff();
    foremost = std::min(foremost, depth_mm);
    if (parts.seen(part).empty()) continue;
    PartPiece piece;
    piece.part = part;
    piece.depth_mm = depth_mm;
    piece.outline_mm = outline_of({options.width_mm * parts.mesh(part).V, parts.mesh(part).F});
    pieces.push_back(std::move(piece));
  }
  sort_for_reading(pieces);
  PartSolidOptions solid;
  solid.size_mm = options.width_mm;
  solid.thickness_mm = options.thickness_mm;
  solid.carve_depth_mm = options.carve_depth_mm;
  solid.pixel_mm = options.pixel_mm;
  solid.plate_mm = options.plate_mm;
  solid.tolerance_mm = tolerance_mm;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    context.progress(static_cast<double>(k) / static_cast<double>(pieces.size()), "Making the pieces");
    solid.number = numbered ? static_cast<int>(k) + 1 : 0;
    pieces[k].depth_mm -= foremost;
    pieces[k].solid = part_solid(parts, pieces[k].part, surface_before(cut, pieces[k].part), solid, context);
  }
  std::erase_if(pieces, [](const PartPiece& piece) { return piece.solid.mesh.F.rows() == 0; });
  return pieces;
}

}  // namespace formwright
