// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/mould/registration_keys.h"

#include <algorithm>
#include <cmath>

#include "geometry/queries/point_distance.h"
#include "geometry/queries/ray_caster.h"
#include "thermoform/mould/solid_shapes.h"

namespace formwright {
namespace {

constexpr double margin_mm = 0.8;  // two lines of a 0.4 mm nozzle
constexpr double tip = 0.7;        // of the radius: pins are cones, so that they centre themselves
constexpr int grid_nodes = 24, key_sides = 16;

/// Inside, by the number of surfaces that a ray outwards crosses; the direction is no plane's of a usual model.
bool inside(const RayCaster& caster, const Vec3& p, double size) {
  const Vec3 direction = Vec3(0.6142, 0.3671, 0.6987).normalized();
  return caster.all_hits(p, direction, 0, 2 * size).size() % 2 == 1;
}

}  // namespace

std::vector<RegistrationKey> find_keys(const TriangleMesh& solid, const BoundingBox& box,
                                       const std::array<int, 3>& cells, double diameter_mm, double clearance_mm,
                                       bool upside_down, Context& context) {
  std::vector<RegistrationKey> keys;
  if (diameter_mm <= 0 || cells == std::array{1, 1, 1}) return keys;
  const PointDistance distance(solid);
  const RayCaster caster(solid);
  const auto plane = [&](int axis, int i) {
    return box.lower[axis] + box.size()[axis] * i / cells.at(static_cast<std::size_t>(axis));
  };
  std::array<int, 3> cell{};
  for (cell[2] = 0; cell[2] < cells[2]; ++cell[2])
    for (cell[1] = 0; cell[1] < cells[1]; ++cell[1])
      for (cell[0] = 0; cell[0] < cells[0]; ++cell[0])
        for (int axis = 0; axis < 3; ++axis) {
          if (cell.at(static_cast<std::size_t>(axis)) + 1 == cells.at(static_cast<std::size_t>(axis))) continue;
          context.check_cancelled();
          Vec3 lower, upper;
          for (int k = 0; k < 3; ++k)
            lower[k] = plane(k, cell.at(static_cast<std::size_t>(k))),
            upper[k] = plane(k, cell.at(static_cast<std::size_t>(k)) + 1);
          lower[axis] = upper[axis];
          const int u = (axis + 1) % 3, v = (axis + 2) % 3;
          for (const double size : {1.0, 0.75, 0.5}) {
            const double d = size * diameter_mm, radius = d / 2 + clearance_mm,
                         length = pin_length_mm(d) + clearance_mm;
            const double clear = std::hypot(radius, length) + margin_mm;
            std::vector<Vec3> places;
            for (int i = 0; i < grid_nodes; ++i)
              for (int j = 0; j < grid_nodes; ++j) {
                Vec3 p = lower;
                p[u] += (upper[u] - lower[u]) * (i + 0.5) / grid_nodes;
                p[v] += (upper[v] - lower[v]) * (j + 0.5) / grid_nodes;
                if (std::min({p[u] - lower[u], upper[u] - p[u], p[v] - lower[v], upper[v] - p[v]}) < clear) continue;
                if (!distance.nearest(p, clear) && inside(caster, p, box.diagonal())) places.push_back(p);
              }
            if (places.empty()) continue;
            const auto farthest = [&](const Vec3& from) {
              return *std::ranges::max_element(places, {}, [&](const Vec3& p) { return (p - from).squaredNorm(); });
            };
            const Vec3 first = farthest(0.5 * (lower + upper)), second = farthest(first);
            keys.push_back({axis, cell, first, d, axis == 2 && upside_down});
            if ((second - first).norm() > 2 * clear) keys.push_back({axis, cell, second, d, axis == 2 && upside_down});
            break;
          }
        }
  return keys;
}

ExactSolid with_keys(const ExactSolid& part, const std::array<int, 3>& cell, const std::vector<RegistrationKey>& keys,
                     double clearance_mm, int& pins, int& sockets, Context& context) {
  std::vector<TriangleMesh> added, removed;
  for (const RegistrationKey& key : keys) {
    const double radius = key.diameter_mm / 2, length = pin_length_mm(key.diameter_mm);
    std::array<int, 3> upper = key.lower;
    ++upper.at(static_cast<std::size_t>(key.axis));
    // A prism from within the part to just beyond the cut, so that no faces coincide, then a cone.
    const auto shape = [&](double wider) {
      std::vector<Ring> rings{
          {-0.5 * length, radius + wider}, {0.25 * length, radius + wider}, {length + wider, tip * radius + wider}};
      if (key.points_down) {
        std::ranges::reverse(rings);
        for (Ring& ring : rings) ring.offset_mm *= -1;
      }
      return turned_mesh(key.centre_mm, key.axis, rings, key_sides);
    };
    if (cell == (key.points_down ? upper : key.lower)) added.push_back(shape(0));
    if (cell == (key.points_down ? key.lower : upper)) removed.push_back(shape(clearance_mm));
  }
  pins = static_cast<int>(added.size());
  sockets = static_cast<int>(removed.size());
  ExactSolid result = part;
  if (pins > 0) result = unite(result, ExactSolid::from_mesh(collected(added), "key_diameter_mm", context), context);
  if (sockets > 0)
    result = subtract(result, ExactSolid::from_mesh(collected(removed), "key_diameter_mm", context), context);
  return result;
}

}  // namespace formwright
