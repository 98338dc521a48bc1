// SPDX-License-Identifier: GPL-3.0-or-later
// Lorensen and Cline 1987. The 256 cases are derived at start-up: on each face of the cube the crossings
// are joined so that inside corners stay apart where that is ambiguous (the same rule on both sides of a
// face, hence no cracks), and each loop is triangulated without a diagonal inside a face of the cube
// (such a diagonal could meet its twin in the neighbouring cell, which would not be manifold).
#include "geometry/samples/sculpting/marching_cubes.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"

namespace formwright::samples {
namespace {

// Corner c of a cell sits at (c & 1, c >> 1 & 1, c >> 2 & 1). Edge 4 a + k runs along axis a.
struct CubeTables {
  std::array<std::array<int, 2>, 12> edge_corners{};
  std::array<std::vector<std::array<int, 3>>, 256> triangles;

  CubeTables() {
    int edge = 0;
    for (int axis = 0; axis < 3; ++axis)
      for (int corner = 0; corner < 8; ++corner)
        if ((corner >> axis & 1) == 0) edge_corners[static_cast<std::size_t>(edge++)] = {corner, corner | 1 << axis};
    for (int inside = 1; inside < 255; ++inside) build(inside);
  }

  int edge_between(int a, int b) const {
    for (std::size_t e = 0; e < 12; ++e)
      if ((edge_corners[e][0] == a && edge_corners[e][1] == b) || (edge_corners[e][0] == b && edge_corners[e][1] == a))
        return static_cast<int>(e);
    return -1;
  }

  // The corners of a face, counter-clockwise seen from outside the cube.
  static std::array<int, 4> face_corners(int face) {
    const int axis = face / 2, side = face % 2, u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3;
    const int base = side << axis;
    if (side == 1) return {base, base | u, base | u | v, base | v};
    return {base, base | v, base | u | v, base | u};
  }

  // Two edges of the cube share a face?
  bool share_face(int e, int f) const {
    for (int face = 0; face < 6; ++face) {
      const auto has = [&](int edge) {
        for (int corner : edge_corners[static_cast<std::size_t>(edge)])
          if ((corner >> face / 2 & 1) != face % 2) return false;
        return true;
      };
      if (has(e) && has(f)) return true;
    }
    return false;
  }

  // All triangulations of polygon[i..j], the first without a face diagonal.
  bool triangulate(const std::vector<int>& polygon, std::vector<std::array<int, 3>>& out) const {
    if (polygon.size() == 3) {
      out.push_back({polygon[0], polygon[1], polygon[2]});
      return true;
    }
    const std::size_t n = polygon.size(), before = out.size();
    // The side (0, n-1) belongs to some triangle (n-1, 0, k).
    for (std::size_t k = 1; k + 1 < n; ++k) {
      if (k > 1 && share_face(polygon[0], polygon[k])) continue;
      if (k + 2 < n && share_face(polygon[k], polygon[n - 1])) continue;
      out.resize(before);
      out.push_back({polygon[n - 1], polygon[0], polygon[k]});
      const std::vector<int> left(polygon.begin(), polygon.begin() + static_cast<std::ptrdiff_t>(k) + 1),
          right(polygon.begin() + static_cast<std::ptrdiff_t>(k), polygon.end());
      if ((k == 1 || triangulate(left, out)) && (k + 2 == n || triangulate(right, out))) return true;
    }
    out.resize(before);
    return false;
  }

  void build(int inside) {
    const auto in = [&](int corner) { return (inside >> corner & 1) != 0; };
    // next[e]: where the contour goes from crossing e, so that loops are counter-clockwise seen from outside the solid.
    std::array<int, 12> next;
    next.fill(-1);
    for (int face = 0; face < 6; ++face) {
      const auto c = face_corners(face);
      for (std::size_t k = 0; k < 4; ++k) {
        // Walking counter-clockwise, the contour enters the face where we step from outside to inside
        // and leaves at the next step from inside to outside: inside corners are cut off one by one.
        if (in(c[k]) || !in(c[(k + 1) % 4])) continue;
        std::size_t m = (k + 1) % 4;
        while (in(c[(m + 1) % 4])) m = (m + 1) % 4;
        const int from = edge_between(c[k], c[(k + 1) % 4]), to = edge_between(c[m], c[(m + 1) % 4]);
        next[static_cast<std::size_t>(from)] = to;
      }
    }
    std::array<bool, 12> seen{};
    auto& list = triangles[static_cast<std::size_t>(inside)];
    for (std::size_t e = 0; e < 12; ++e) {
      if (next[e] < 0 || seen[e]) continue;
      std::vector<int> loop;
      for (int at = static_cast<int>(e); !seen[static_cast<std::size_t>(at)]; at = next[static_cast<std::size_t>(at)]) {
        seen[static_cast<std::size_t>(at)] = true;
        loop.push_back(at);
      }
      if (!triangulate(loop, list))
        throw Error(ErrorCode::internal, "sample", "A marching cubes case has no triangulation.");
    }
  }
};

const CubeTables& cube_tables() {
  static const CubeTables tables;
  return tables;
}

struct Block {
  int i, j, k;  // in cells
};

constexpr int leaf_cells = 4;

// Splits blocks until they have leaf_cells a side, dropping those that the surface cannot reach.
std::vector<Block> reachable_blocks(const ImplicitShape& shape, double cell, int root_cells, Context& context) {
  std::vector<Block> blocks{{0, 0, 0}};
  for (int size = root_cells; size > leaf_cells; size /= 2) {
    context.check_cancelled();
    const int half = size / 2;
    std::vector<Block> children;
    children.reserve(blocks.size() * 8);
    for (const Block& b : blocks)
      for (int c = 0; c < 8; ++c)
        children.push_back({b.i + (c & 1) * half, b.j + (c >> 1 & 1) * half, b.k + (c >> 2) * half});
    const double reach = shape.lipschitz * 0.5 * std::sqrt(3.0) * half * cell;
    std::vector<char> keep(children.size(), 0);
    parallel_for(children.size(), 256, [&](std::size_t from, std::size_t to) {
      context.check_cancelled();
      for (std::size_t n = from; n < to; ++n) {
        const Block& b = children[n];
        const Point corner = shape.bounds.low + Point{b.i * cell, b.j * cell, b.k * cell};
        if (corner.x > shape.bounds.high.x || corner.y > shape.bounds.high.y || corner.z > shape.bounds.high.z)
          continue;
        const double h = 0.5 * half * cell;
        keep[n] = std::fabs(shape.field(corner + Point{h, h, h})) <= reach ? 1 : 0;
      }
    });
    blocks.clear();
    for (std::size_t n = 0; n < children.size(); ++n)
      if (keep[n] != 0) blocks.push_back(children[n]);
  }
  return blocks;
}

// What one leaf yields, its vertices named by the grid edges they lie on.
struct Patch {
  std::vector<std::uint64_t> edges;
  std::vector<Point> points;
  std::vector<Corners> triangles;
  int open_sides = 0;  // sides of the leaf that the surface passes: bit 2 axis + (0 low, 1 high)
};

std::uint64_t edge_key(int i, int j, int k, int axis) {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + 1024); };  // a leaf may lie below the bounds
  return part(i) << 42 | part(j) << 22 | part(k) << 2 | static_cast<std::uint64_t>(axis);
}

void march(const ImplicitShape& shape, double cell, const Block& block, Patch& patch) {
  constexpr int n = leaf_cells + 1;
  double value[n][n][n];
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        value[k][j][i] =
            shape.field(shape.bounds.low + Point{(block.i + i) * cell, (block.j + j) * cell, (block.k + k) * cell});
  int vertex_on[3][n][n][n];
  std::fill(&vertex_on[0][0][0][0], &vertex_on[0][0][0][0] + 3 * n * n * n, -1);
  const CubeTables& tables = cube_tables();
  for (int k = 0; k < leaf_cells; ++k)
    for (int j = 0; j < leaf_cells; ++j)
      for (int i = 0; i < leaf_cells; ++i) {
        std::size_t inside = 0;
        for (int c = 0; c < 8; ++c)
          if (value[k + (c >> 2)][j + (c >> 1 & 1)][i + (c & 1)] < 0) inside |= std::size_t{1} << c;
        for (const auto& triangle : tables.triangles[inside]) {
          Corners corners;
          for (std::size_t m = 0; m < 3; ++m) {
            const int edge = triangle[m], axis = edge / 4;
            const int a = tables.edge_corners[static_cast<std::size_t>(edge)][0];
            const int x = i + (a & 1), y = j + (a >> 1 & 1), z = k + (a >> 2);
            int& vertex = vertex_on[axis][z][y][x];
            if (vertex < 0) {
              vertex = static_cast<int>(patch.points.size());
              const double f0 = value[z][y][x];
              const double f1 = value[z + (axis == 2)][y + (axis == 1)][x + (axis == 0)];
              const double t = clamp(f0 / (f0 - f1), 0.2, 0.8);
              Point p{static_cast<double>(block.i + x), static_cast<double>(block.j + y),
                      static_cast<double>(block.k + z)};
              (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += t;
              patch.points.push_back(shape.bounds.low + p * cell);
              patch.edges.push_back(edge_key(block.i + x, block.j + y, block.k + z, axis));
              const int at[3] = {x, y, z};
              for (int side = 0; side < 3; ++side)
                if (side != axis && at[side] % leaf_cells == 0)
                  patch.open_sides |= (at[side] == 0 ? 1 : 2) << (2 * side);
            }
            corners[m] = vertex;
          }
          patch.triangles.push_back(corners);
        }
      }
}

// Open addressing from grid edges to vertices (or from leaves to their places).
class KeyMap {
 public:
  explicit KeyMap(std::size_t count) {
    std::size_t size = 64;
    while (size < count * 2) size *= 2;
    keys_.assign(size, ~std::uint64_t{0});
    values_.resize(size);
  }
  int& find_or_add(std::uint64_t key, int fresh) {
    std::size_t slot = static_cast<std::size_t>((key * 0x9e3779b97f4a7c15ULL) >> 20) & (keys_.size() - 1);
    while (keys_[slot] != key) {
      if (keys_[slot] == ~std::uint64_t{0}) {
        keys_[slot] = key;
        values_[slot] = fresh;
        break;
      }
      slot = (slot + 1) & (keys_.size() - 1);
    }
    return values_[slot];
  }

 private:
  std::vector<std::uint64_t> keys_;
  std::vector<int> values_;
};

Surface joined(const std::vector<Patch>& patches) {
  std::size_t vertices = 0, faces = 0;
  for (const Patch& patch : patches) {
    vertices += patch.points.size();
    faces += patch.triangles.size();
  }
  Surface surface;
  surface.points.reserve(vertices);
  surface.triangles.reserve(faces);
  KeyMap map(vertices);
  std::vector<int> global;
  for (const Patch& patch : patches) {
    global.resize(patch.points.size());
    for (std::size_t v = 0; v < patch.points.size(); ++v) {
      const int fresh = static_cast<int>(surface.points.size());
      global[v] = map.find_or_add(patch.edges[v], fresh);
      if (global[v] == fresh) surface.points.push_back(patch.points[v]);
    }
    for (const Corners& t : patch.triangles)
      surface.triangles.push_back({global[static_cast<std::size_t>(t[0])], global[static_cast<std::size_t>(t[1])],
                                   global[static_cast<std::size_t>(t[2])]});
  }
  return surface;
}

Surface largest_part(Surface surface) {
  std::vector<int> root(surface.points.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int v) {
    while (root[static_cast<std::size_t>(v)] != v) {
      auto& r = root[static_cast<std::size_t>(v)];
      r = root[static_cast<std::size_t>(r)];
      v = r;
    }
    return v;
  };
  for (const Corners& t : surface.triangles) {
    const int a = find(t[0]);
    root[static_cast<std::size_t>(find(t[1]))] = a;
    root[static_cast<std::size_t>(find(t[2]))] = a;
  }
  std::vector<int> size(surface.points.size(), 0);
  for (int v = 0; v < static_cast<int>(root.size()); ++v) ++size[static_cast<std::size_t>(find(v))];
  const int keep = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
  if (size[static_cast<std::size_t>(keep)] == static_cast<int>(root.size())) return surface;
  Surface result;
  std::vector<int> fresh(root.size(), -1);
  for (int v = 0; v < static_cast<int>(root.size()); ++v)
    if (find(v) == keep) {
      fresh[static_cast<std::size_t>(v)] = static_cast<int>(result.points.size());
      result.points.push_back(surface.points[static_cast<std::size_t>(v)]);
    }
  for (const Corners& t : surface.triangles)
    if (fresh[static_cast<std::size_t>(t[0])] >= 0)
      result.triangles.push_back({fresh[static_cast<std::size_t>(t[0])], fresh[static_cast<std::size_t>(t[1])],
                                  fresh[static_cast<std::size_t>(t[2])]});
  return result;
}

}  // namespace

Surface marching_cubes(const ImplicitShape& shape, double cell_mm, Context& context) {
  const Point extent = shape.bounds.high - shape.bounds.low;
  int root = leaf_cells;
  while (root * cell_mm < std::max({extent.x, extent.y, extent.z})) root *= 2;
  std::vector<Block> blocks = reachable_blocks(shape, cell_mm, root, context);
  std::vector<Patch> patches;
  KeyMap known(8 * blocks.size() + 1024);
  const auto leaf_key = [](const Block& b) { return edge_key(b.i, b.j, b.k, 0); };
  for (std::size_t b = 0; b < blocks.size(); ++b) known.find_or_add(leaf_key(blocks[b]), 1);
  // Where the field is steeper than promised a leaf may be missing: follow the surface until it closes.
  for (std::size_t done = 0; done < blocks.size();) {
    const std::size_t count = blocks.size();
    patches.resize(count);
    parallel_for(count - done, 64, [&](std::size_t from, std::size_t to) {
      context.check_cancelled();
      for (std::size_t b = done + from; b < done + to; ++b) march(shape, cell_mm, blocks[b], patches[b]);
    });
    for (std::size_t b = done; b < count; ++b)
      for (int side = 0; side < 6; ++side) {
        if ((patches[b].open_sides >> side & 1) == 0) continue;
        Block beside = blocks[b];
        (side < 2 ? beside.i : side < 4 ? beside.j : beside.k) += side % 2 == 0 ? -leaf_cells : leaf_cells;
        int& seen = known.find_or_add(leaf_key(beside), 0);
        if (seen == 0) {
          seen = 1;
          blocks.push_back(beside);
        }
      }
    done = count;
    if (blocks.size() > 6 * patches.size() + 4096)
      throw Error(ErrorCode::internal, "sample",
                  "The sample's surface leaves its bounds: this is a bug in Formwright.");
  }
  context.check_cancelled();
  Surface surface = joined(patches);
  context.check_cancelled();
  if (surface.triangles.empty())
    throw Error(ErrorCode::internal, "sample", "The sample's field has no surface at this resolution.");
  return largest_part(std::move(surface));
}

double surface_area(const Surface& surface) {
  double area = 0;
  for (const Corners& t : surface.triangles) {
    const Point& a = surface.points[static_cast<std::size_t>(t[0])];
    area += 0.5 * length(cross(surface.points[static_cast<std::size_t>(t[1])] - a,
                               surface.points[static_cast<std::size_t>(t[2])] - a));
  }
  return area;
}

}  // namespace formwright::samples
