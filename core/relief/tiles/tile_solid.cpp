// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/tiles/tile_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "geometry/booleans/booleans.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/file_grid.h"
#include "geometry/mesh/measures.h"
#include "geometry/mesh/mesh_lists.h"
#include "relief/forest/plan/pillar.h"
#include "relief/right_triangle_network.h"

namespace formwright {
namespace {

struct MeshParts {
  std::vector<Vec3> places;
  std::vector<Eigen::Vector3i> faces;

  int add(const Vec3& place) {
    places.push_back(place);
    return static_cast<int>(places.size()) - 1;
  }
  /// Two corners at one place make an edge of a triangle.
  void face(int a, int b, int c) {
    if (a != b && b != c && c != a) faces.emplace_back(a, b, c);
  }
  TriangleMesh mesh() const { return mesh_of(places, faces); }
};

/// Columns without a length are one node.
GridNode same_place(const TileGrid& grid, GridNode p) {
  const auto c = static_cast<std::size_t>(p.x);
  return grid.high_mm[c] > grid.low_mm[c] ? p : GridNode{p.x, 0};
}

/// The front, and its rim as it runs counter-clockwise from the lower left.
struct Front {
  MeshParts parts;
  std::vector<GridNode> node;  // of each vertex
  std::vector<int> vertex_of;  // of each node, -1
  std::vector<int> rim;        // vertices
};

Front front_of(const TileGrid& grid, double tolerance_mm, const auto& place, Context& context) {
  const int columns = grid.columns(), rows = grid.rows;
  const auto height = [&](GridNode p) { return grid.height_mm[grid.node(p.x, p.y)]; };
  RightTriangleNetwork network(columns, rows, static_cast<float>(tolerance_mm),
                               [&](GridNode a, GridNode b, GridNode m) -> float {
                                 if (grid.is_corner(m.x, m.y)) return INFINITY;
                                 return static_cast<float>(std::abs(0.5 * (height(a) + height(b)) - height(m)));
                               });
  network.find_bounds(context);
  network.collect();
  Front front;
  front.vertex_of.assign(grid.height_mm.size(), -1);
  const auto vertex = [&](GridNode p) {
    const GridNode at = same_place(grid, p);
    int& found = front.vertex_of[grid.node(at.x, at.y)];
    if (found < 0) {
      found = front.parts.add(place(grid.place(at.x, at.y), height(at)));
      front.node.push_back(at);
    }
    front.vertex_of[grid.node(p.x, p.y)] = found;
    return found;
  };
  for (std::size_t t = 0; t < network.corners.size(); t += 3) {
    const int a = vertex(network.corners[t]), b = vertex(network.corners[t + 1]), c = vertex(network.corners[t + 2]);
    front.parts.face(a, b, c);
  }
  const auto visit = [&](int x, int y) {
    const int found = front.vertex_of[grid.node(x, y)];
    if (found >= 0 && (front.rim.empty() || front.rim.back() != found)) front.rim.push_back(found);
  };
  for (int x = 0; x + 1 < columns; ++x) visit(x, 0);
  for (int y = 0; y + 1 < rows; ++y) visit(columns - 1, y);
  for (int x = columns - 1; x > 0; --x) visit(x, rows - 1);
  for (int y = rows - 1; y > 0; --y) visit(0, y);
  if (front.rim.size() > 1 && front.rim.front() == front.rim.back()) front.rim.pop_back();
  return front;
}

/// Below the rim a ring of as many vertices at one depth, which lie on straight lines, so that each side of the back
/// needs its two corners only. Returns these, in the order of the rim, at z = 0.
std::vector<int> add_sides(Front& front, const TileGrid& grid, double ring_mm, double back_mm, const auto& place) {
  MeshParts& parts = front.parts;
  const std::size_t count = front.rim.size();
  std::vector<int> ring, corner, corners;  // of each rim vertex, the corners' -1 between them
  for (const int top : front.rim) {
    const GridNode at = front.node[static_cast<std::size_t>(top)];
    const Vec2 on_tile = grid.place(at.x, at.y);
    ring.push_back(parts.add(place(on_tile, -ring_mm)));
    corner.push_back(-1);
    if (!grid.is_corner(at.x, at.y)) continue;
    const Vec3 below = place(on_tile, -back_mm);
    corner.back() = parts.add(Vec3(below.x(), below.y(), 0));
    corners.push_back(corner.back());
  }
  std::size_t first = 0;
  while (corner[first] < 0) ++first;
  int below = corner[first];
  for (std::size_t step = 0; step < count; ++step) {
    const std::size_t k = (first + step) % count, next = (k + 1) % count;
    parts.face(front.rim[next], front.rim[k], ring[k]);
    parts.face(front.rim[next], ring[k], ring[next]);
    parts.face(ring[next], ring[k], below);
    if (corner[next] >= 0) {
      parts.face(ring[next], below, corner[next]);
      below = corner[next];
    }
  }
  return corners;
}

/// The back at z = 0 with what is cut out of it: that of a plate over the same corners, in which the booleans are
/// quick.
void add_sunk_back(MeshParts& parts, const std::vector<int>& corners, const Outline& outline, double plate_mm,
                   const std::vector<TriangleMesh>& grooves, Context& context) {
  ExactSolid sunk, plate = ExactSolid::from_mesh(prism(outline, 0, plate_mm), "mesh", context);
  for (const TriangleMesh& groove : grooves) {
    const ExactSolid one = ExactSolid::from_mesh(groove, "mesh", context);
    sunk = sunk.empty() ? one : unite(sunk, one, context);
  }
  const TriangleMesh cut = subtract(plate, sunk, context).mesh();
  std::map<std::array<double, 2>, int> corner_at;
  for (const int corner : corners) {
    const Vec3& place = parts.places[static_cast<std::size_t>(corner)];
    corner_at[{place.x(), place.y()}] = corner;
  }
  std::vector<int> vertex_of(static_cast<std::size_t>(cut.V.rows()), -1);
  for (Eigen::Index i = 0; i < cut.V.rows(); ++i) {
    const Vec3 place = cut.V.row(i).transpose();
    if (place.z() == plate_mm) continue;  // top and sides of that plate are not those of the piece
    const auto found = corner_at.find({place.x(), place.y()});
    vertex_of[static_cast<std::size_t>(i)] = found != corner_at.end() ? found->second : parts.add(place);
  }
  for (Eigen::Index f = 0; f < cut.F.rows(); ++f) {
    const auto vertex = [&](int k) { return vertex_of[static_cast<std::size_t>(cut.F(f, k))]; };
    if (vertex(0) >= 0 && vertex(1) >= 0 && vertex(2) >= 0) parts.face(vertex(0), vertex(1), vertex(2));
  }
}

}  // namespace

TileSolid tile_solid(const ReliefTile& tile, const TileGrid& grid, const TileSolidOptions& options, Context& context) {
  TileSolid solid;
  solid.back_mm = options.room.below_mm + options.plate_mm;
  const auto lying = [&](const Vec2& place, double height) {
    const Vec3 off = tile.raised(place, height) - tile.origin;
    return Vec3(off.dot(tile.right), off.dot(tile.up), off.dot(tile.normal) + solid.back_mm);
  };
  Front front = front_of(grid, options.tolerance_mm, lying, context);
  MeshParts& parts = front.parts;
  const std::vector<int> corners =
      add_sides(front, grid, options.room.below_mm + 0.5 * options.plate_mm, solid.back_mm, lying);
  Outline back;
  for (const int corner : corners) back.push_back(parts.places[static_cast<std::size_t>(corner)].head<2>());
  std::vector<TriangleMesh> grooves;
  if (options.number > 0) grooves = number_grooves(back, options.number, options.plate_mm);
  solid.numbered = !grooves.empty();
  if (solid.numbered) add_sunk_back(parts, corners, back, options.plate_mm, grooves, context);
  else
    for (std::size_t k = 2; k < corners.size(); ++k) parts.face(corners[0], corners[k], corners[k - 1]);
  solid.mesh = parts.mesh();
  solid.corner_mm = solid.mesh.V.leftCols<2>().colwise().minCoeff().transpose();
  solid.mesh.V.leftCols<2>().rowwise() -= solid.corner_mm.transpose();
  solid.mesh = on_file_grid(solid.mesh);
  solid.volume_mm3 = signed_volume(solid.mesh);
  solid.watertight = Adjacency(solid.mesh).is_closed();
  return solid;
}

TriangleMesh in_place(const TileSolid& solid, const ReliefTile& tile) {
  TriangleMesh placed = solid.mesh;
  for (Eigen::Index i = 0; i < placed.V.rows(); ++i) {
    const Vec3 p = solid.mesh.V.row(i).transpose();
    placed.V.row(i) =
        (tile.on_plane(p.head<2>() + solid.corner_mm) + (p.z() - solid.back_mm) * tile.normal).transpose();
  }
  return on_file_grid(placed);
}

}  // namespace formwright
