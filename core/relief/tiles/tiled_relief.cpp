// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/tiles/tiled_relief.h"

namespace formwright {
namespace {

TriangleMesh surface_of(const ReliefPieces& cut, int band, double size_mm) {
  std::vector<Eigen::Index> faces;
  for (Eigen::Index f = 0; f < cut.F.rows(); ++f)
    if (cut.band[static_cast<std::size_t>(f)] == band) faces.push_back(f);
  if (faces.empty()) return {};
  Triangles own(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t k = 0; k < faces.size(); ++k) own.row(static_cast<Eigen::Index>(k)) = cut.F.row(faces[k]);
  return {to_scene(cut.V, size_mm), own};
}

}  // namespace

std::vector<ReliefPiece> tiled_relief(const ViewFrame& frame, const BaseBands& bands, const ReliefPieces& cut,
                                      PlateSize plate, const ReliefOptions& options, double tolerance_mm, bool numbered,
                                      Context& context) {
  TileSolidOptions solid;
  solid.room = {options.thickness_mm, options.carve_depth_mm};
  solid.plate_mm = options.plate_mm;
  solid.tolerance_mm = tolerance_mm;
  const std::vector<ReliefTile> tiles = relief_tiles(frame, bands, plate, options.width_mm);
  std::vector<ReliefPiece> pieces;
  for (std::size_t k = 0; k < tiles.size(); ++k) {
    context.progress(static_cast<double>(k) / static_cast<double>(tiles.size()), "Making the pieces");
    const TileGrid grid =
        tile_grid(tiles[k], surface_of(cut, tiles[k].band, options.width_mm), solid.room, options.pixel_mm, context);
    solid.number = numbered ? static_cast<int>(k) + 1 : 0;
    pieces.push_back({tiles[k], tile_solid(tiles[k], grid, solid, context)});
  }
  return pieces;
}

}  // namespace formwright
