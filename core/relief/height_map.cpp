// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/height_map.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr std::size_t rows_a_chunk = 16;

/// On the plate, all heights 0.
HeightMap empty_map(PlateSize plate, double pixel_mm) {
  HeightMap map;
  const double nodes_x = std::ceil(plate.width_mm / pixel_mm - 1e-9) + 1,
               nodes_y = std::ceil(plate.height_mm / pixel_mm - 1e-9) + 1;
  if (nodes_x * nodes_y > 64e6)
    throw Error(
        ErrorCode::invalid_input, "pixel_mm",
        "The solid would have more than 64 million points: raise the detail spacing (pixel_mm) or lower the width.");
  map.columns = std::max(2, static_cast<int>(nodes_x));
  map.rows = std::max(2, static_cast<int>(nodes_y));
  map.pitch_x_mm = plate.width_mm / (map.columns - 1);
  map.pitch_y_mm = plate.height_mm / (map.rows - 1);
  map.height_mm.assign(static_cast<std::size_t>(map.columns) * static_cast<std::size_t>(map.rows), 0.0f);
  return map;
}

/// Columns: position on the grid in nodes, height in mm.
Positions on_grid(const Positions& moved, const HeightMap& map, double size_mm) {
  Positions G(moved.rows(), 3);
  G.col(0) = (moved.col(0).array() * size_mm + 0.5 * map.width_mm()) / map.pitch_x_mm;
  G.col(1) = (moved.col(1).array() * size_mm + 0.5 * map.depth_mm()) / map.pitch_y_mm;
  G.col(2) = -size_mm * moved.col(2).array();
  return G;
}

/// Raises the map's nodes to the triangles over them; heights are first limited to [lowest, highest]. `covers`: (face,
/// row, column) -> bool. `raised`: (face, row, column, barycentric coordinates), after a node was raised.
template <class Covers, class Raised>
void raise_to_envelope(HeightMap& map, const Positions& G, const Triangles& F, double lowest, double highest,
                       const Covers& covers, const Raised& raised, Context& context) {
  for (Eigen::Index f = 0; f < F.rows(); ++f) {
    if (f % 65536 == 0) context.check_cancelled();
    const Vec3 a = G.row(F(f, 0)).transpose(), b = G.row(F(f, 1)).transpose(), c = G.row(F(f, 2)).transpose();
    const double doubled = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (doubled == 0) continue;  // edge-on: its neighbours cover the same nodes
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}) - 1e-9)));
    const int x1 = std::min(map.columns - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}) + 1e-9)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}) - 1e-9)));
    const int y1 = std::min(map.rows - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}) + 1e-9)));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double wb = ((x - a.x()) * (c.y() - a.y()) - (y - a.y()) * (c.x() - a.x())) / doubled;
        const double wc = ((b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x())) / doubled;
        const double wa = 1 - wb - wc;
        if (wa < -1e-9 || wb < -1e-9 || wc < -1e-9 || !covers(f, y, x)) continue;
        const auto height = static_cast<float>(std::clamp(wa * a.z() + wb * b.z() + wc * c.z(), lowest, highest));
        if (!(height > map.at(y, x))) continue;
        map.at(y, x) = height;
        raised(f, y, x, Vec3(wa, wb, wc));
      }
  }
}

/// Of a node in the plate's middle's axes, mm.
double x_of(const HeightMap& map, int column) { return column * map.pitch_x_mm - 0.5 * map.width_mm(); }
double y_of(const HeightMap& map, int row) { return row * map.pitch_y_mm - 0.5 * map.depth_mm(); }

/// The band of every node.
std::vector<int> node_bands(const HeightMap& map, const BaseBands& bands, double size_mm) {
  std::vector<int> band;
  band.reserve(map.height_mm.size());
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      band.push_back(bands.of_point(x_of(map, column) / size_mm, y_of(map, row) / size_mm));
  return band;
}

/// Length along z of what is counted along the base's normal at every node, where that is not z: on strips. Else empty.
std::vector<float> lengths_along_z(const HeightMap& map, const BaseSurface& base, double size_mm) {
  std::vector<float> lengths;
  if (base.bands() == nullptr) return lengths;
  for (const int band : node_bands(map, *base.bands(), size_mm))
    lengths.push_back(static_cast<float>(base.bands()->along_z(band)));
  return lengths;
}

/// Heights of the base at the map's nodes, mm; NaN beyond its edge.
std::vector<float> base_heights(const HeightMap& map, const BaseSurface& base, double size_mm, Context& context) {
  std::vector<float> heights(map.height_mm.size());
  parallel_for(static_cast<std::size_t>(map.rows), rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t row = begin; row < end; ++row)
      for (int column = 0; column < map.columns; ++column) {
        const double x = x_of(map, column) / size_mm, y = y_of(map, static_cast<int>(row)) / size_mm;
        // On a border a ray would meet the wall's upper edge, whichever band is meant.
        const BaseBands* const bands = base.bands();
        const std::optional<double> depth =
            bands != nullptr ? bands->depth(bands->of_point(x, y), bands->across(x, y)) : base.depth_at(x, y);
        heights[row * static_cast<std::size_t>(map.columns) + static_cast<std::size_t>(column)] =
            depth ? static_cast<float>(-size_mm * *depth) : NAN;
      }
  });
  return heights;
}

/// How far each covered node may be before the base and behind it, mm. Empty where vertices have no limits of their
/// own.
struct NodeRoom {
  std::vector<float> above, below;
};

/// The map with the envelope at the covered nodes, -infinity elsewhere, and its limits.
HeightMap envelope_over(const CoveringMesh& mesh, double size_mm, PlateSize plate, double pixel_mm,
                        const AllowedSpace& space, NodeRoom& room, Context& context) {
  HeightMap map = empty_map(plate, pixel_mm);
  const auto range = space.base.depth_range(0.5 * plate.width_mm / size_mm, 0.5 * plate.height_mm / size_mm);
  const auto [least, largest] = range.value_or(std::pair{0.0, 0.0});
  const double along_z = space.base.max_along_z();
  map.floor_mm = -size_mm * largest - along_z * space.below_mm;
  map.top_mm = -size_mm * least + along_z * space.above_mm;
  std::ranges::fill(map.height_mm, -INFINITY);
  std::vector<int> band;
  if (mesh.band != nullptr && space.base.bands() != nullptr) band = node_bands(map, *space.base.bands(), size_mm);
  const auto node = [&](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(map.columns) + static_cast<std::size_t>(column);
  };
  const auto covers = [&](Eigen::Index face, int row, int column) {
    return band.empty() || (*mesh.band)[static_cast<std::size_t>(face)] == band[node(row, column)];
  };
  const bool own_limits = mesh.above_mm != nullptr && mesh.below_mm != nullptr;
  if (own_limits) {
    room.above.resize(map.height_mm.size());
    room.below.resize(map.height_mm.size());
  }
  const auto take_room = [&](Eigen::Index face, int row, int column, const Vec3& weights) {
    if (!own_limits) return;
    double above = 0, below = 0;
    for (int k = 0; k < 3; ++k) {
      above += weights[k] * (*mesh.above_mm)[mesh.F(face, k)];
      below += weights[k] * (*mesh.below_mm)[mesh.F(face, k)];
    }
    room.above[node(row, column)] = static_cast<float>(std::min(above, space.above_mm));
    room.below[node(row, column)] = static_cast<float>(std::min(below, space.below_mm));
  };
  raise_to_envelope(map, on_grid(mesh.V, map, size_mm), mesh.F, map.floor_mm, map.top_mm, covers, take_room, context);
  return map;
}

}  // namespace

HeightMap make_height_map(const Positions& moved, const Triangles& F, double size_mm, PlateSize plate, double pixel_mm,
                          double top_mm, Context& context) {
  HeightMap map = empty_map(plate, pixel_mm);
  map.top_mm = top_mm;
  const Positions G = on_grid(moved, map, size_mm);
  raise_to_envelope(
      map, G, F, 0, top_mm, [](Eigen::Index, int, int) { return true; }, [](Eigen::Index, int, int, const Vec3&) {},
      context);
  for (Eigen::Index i = 0; i < G.rows(); ++i)
    if (G(i, 2) > top_mm * (1 - 1e-6)) {
      const int x = std::clamp(static_cast<int>(std::lround(G(i, 0))), 0, map.columns - 1);
      const int y = std::clamp(static_cast<int>(std::lround(G(i, 1))), 0, map.rows - 1);
      map.at(y, x) = static_cast<float>(top_mm);
    }
  return map;
}

HeightMap make_height_map(const CoveringMesh& mesh, double size_mm, PlateSize plate, double pixel_mm,
                          const AllowedSpace& space, Context& context) {
  if (space.base.is_flat() && space.below_mm == 0)
    return make_height_map(mesh.V, mesh.F, size_mm, plate, pixel_mm, space.above_mm, context);
  NodeRoom room;
  HeightMap map = envelope_over(mesh, size_mm, plate, pixel_mm, space, room, context);
  const std::vector<float> base = base_heights(map, space.base, size_mm, context),
                           along_z = lengths_along_z(map, space.base, size_mm);
  const auto floor = static_cast<float>(map.floor_mm), above = static_cast<float>(space.above_mm),
             below = static_cast<float>(space.below_mm);
  for (std::size_t i = 0; i < base.size(); ++i) {
    const float length = along_z.empty() ? 1.0f : along_z[i];
    float& height = map.height_mm[i];
    const bool covered = !std::isinf(height);
    if (std::isnan(base[i])) height = covered ? height : floor;
    else if (!covered) height = base[i];
    else
      height = std::min(std::max(height, base[i] - length * (room.below.empty() ? below : room.below[i])),
                        base[i] + length * (room.above.empty() ? above : room.above[i]));
    height = std::max(height, floor);
  }
  return map;
}

HeightMap make_bed_map(const CoveringMesh& mesh, double size_mm, PlateSize plate, double pixel_mm,
                       const AllowedSpace& space, Context& context) {
  NodeRoom room;
  HeightMap map = envelope_over(mesh, size_mm, plate, pixel_mm, space, room, context);
  const std::vector<float> base = base_heights(map, space.base, size_mm, context),
                           along_z = lengths_along_z(map, space.base, size_mm);
  const auto floor = static_cast<float>(map.floor_mm);
  for (std::size_t i = 0; i < base.size(); ++i) {
    const float length = along_z.empty() ? 1.0f : along_z[i];
    const bool covered = !std::isinf(map.height_mm[i]);
    const float height = std::isnan(base[i]) ? floor : base[i];
    map.height_mm[i] = std::max(floor, covered ? height - length * static_cast<float>(space.below_mm) : height);
  }
  return map;
}

}  // namespace formwright
