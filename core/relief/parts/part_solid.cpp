// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/parts/part_solid.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "geometry/booleans/booleans.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/file_grid.h"
#include "geometry/mesh/measures.h"
#include "geometry/mesh/mesh_lists.h"
#include "relief/tiles/relief_tile.h"
#include "relief/tiles/tile_solid.h"
#include "relief/view/straight_view.h"

namespace formwright {
namespace {

constexpr double inset_mm = 0.01;       // of the relief within what is seen, so that it never touches the part's side
constexpr double min_height_mm = 0.02;  // less is no relief
constexpr double clear_mm = 0.01;       // that added or cut bodies pass the part's surface by, where they only reach it
constexpr double root_mm = 0.5;         // of what is added, within the part
constexpr double max_root_share = 0.5, max_clear_share = 0.25;  // of what the ray goes through
constexpr double same_line_mm = 1e-5;
constexpr double flat = 1e-9;  // of a back, relative to the part's size

/// A body between two depths over some of the triangles.
TriangleMesh body_between(const PlaneTriangles& net, const std::vector<char>& chosen, const std::vector<double>& front,
                          const std::vector<double>& back, double kappa, double size_mm) {
  std::vector<int> vertex(net.points.size(), -1);
  std::vector<Vec3> places;
  std::vector<Eigen::Vector3i> faces;
  std::set<std::pair<int, int>> border;  // directed edges without a neighbour
  const auto place_at = [&](std::size_t i, double z) -> Vec3 {
    const Vec3 p = size_mm * on_ray(net.points[i], z, kappa);
    return {p.x(), p.y(), -p.z()};
  };
  const auto vertex_at = [&](int i) {
    const auto at = static_cast<std::size_t>(i);
    if (vertex[at] < 0) {
      vertex[at] = static_cast<int>(places.size());
      places.push_back(place_at(at, front[at]));
      places.push_back(place_at(at, back[at]));
    }
    return vertex[at];
  };
  for (std::size_t f = 0; f < net.triangles.size(); ++f) {
    if (!chosen[f]) continue;
    const Eigen::Vector3i& t = net.triangles[f];
    const int a = vertex_at(t[0]), b = vertex_at(t[1]), c = vertex_at(t[2]);
    faces.emplace_back(a, b, c);
    faces.emplace_back(a + 1, c + 1, b + 1);
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      if (border.erase({to, from}) == 0) border.emplace(from, to);
  }
  for (const auto& [from, to] : border) {
    faces.emplace_back(to, from, from + 1);
    faces.emplace_back(to, from + 1, to + 1);
  }
  return mesh_of(places, faces);
}

/// Adds triangles until those around every point hang together, so that a body over them is manifold.
void join_fans(const PlaneTriangles& net, std::vector<char>& chosen) {
  for (bool changed = true; changed;) {
    changed = false;
    std::set<std::pair<int, int>> border;
    for (std::size_t f = 0; f < net.triangles.size(); ++f)
      for (Eigen::Index k = 0; chosen[f] && k < 3; ++k) {
        const int a = net.triangles[f][k], b = net.triangles[f][(k + 1) % 3];
        if (border.erase({b, a}) == 0) border.emplace(a, b);
      }
    std::vector<int> leaving(net.points.size(), 0);
    for (const auto& [from, to] : border) ++leaving[static_cast<std::size_t>(from)];
    for (std::size_t f = 0; f < net.triangles.size(); ++f)
      for (Eigen::Index k = 0; !chosen[f] && k < 3; ++k)
        if (leaving[static_cast<std::size_t>(net.triangles[f][k])] > 1) chosen[f] = changed = true;
  }
}

/// Where what is added or taken away begins and ends, of every point.
struct Body {
  std::vector<char> chosen;  // triangles
  std::vector<double> front, back;
};

enum class Change { none, raised, carved };

Change change_of(const FrontSample& sample, double min_height) {
  if (!sample.covered) return Change::none;
  if (sample.relief < sample.base - min_height) return Change::raised;
  return sample.relief > sample.base + min_height ? Change::carved : Change::none;
}

/// What is raised, with a root in the part; or what is carved, from before the part.
Body changed_body(const PartFront& front, Change wanted, const PartSolidOptions& options) {
  const double unit = 1 / options.size_mm;
  Body body;
  std::vector<Change> change;
  for (const FrontSample& sample : front.samples) {
    change.push_back(change_of(sample, min_height_mm * unit));
    const double passes = sample.leaves - sample.base, clear = std::min(clear_mm * unit, max_clear_share * passes);
    if (wanted == Change::raised) {
      const double begins = change.back() == Change::none ? sample.base + clear : sample.relief;
      body.front.push_back(begins);
      const double left = sample.leaves - std::max(begins, sample.base);
      body.back.push_back(std::max(begins, sample.base) +
                          std::max(std::min(root_mm * unit, max_root_share * left), 1e-3 * clear));
    } else {
      body.front.push_back(sample.base - (options.thickness_mm + 1) * unit);
      body.back.push_back(change.back() == Change::carved   ? sample.relief
                          : change.back() == Change::raised ? sample.relief
                                                            : sample.base - clear);
    }
  }
  for (const Eigen::Vector3i& t : front.net.triangles) {
    const auto is_wanted = [&](Eigen::Index k) { return change[static_cast<std::size_t>(t[k])] == wanted; };
    body.chosen.push_back(is_wanted(0) || is_wanted(1) || is_wanted(2));
  }
  join_fans(front.net, body.chosen);
  return body;
}

/// What is sunk into a flat back that looks straight away from the viewer. Empty where there is none with room.
std::vector<TriangleMesh> back_grooves(const TriangleMesh& solid, int number) {
  const BoundingBox box = bounding_box(solid);
  const double near_back = flat * box.diagonal();
  std::vector<std::vector<Vec2>> triangles;
  for (Eigen::Index f = 0; f < solid.F.rows(); ++f) {
    std::vector<Vec2> corners;
    for (Eigen::Index k = 0; k < 3; ++k)
      if (solid.V(solid.F(f, k), 2) <= box.lower.z() + near_back)
        corners.insert(corners.begin(), solid.V.row(solid.F(f, k)).head<2>().transpose());  // seen from the front
    if (corners.size() == 3) triangles.push_back(std::move(corners));
  }
  // Points along straight sides would pull its middle.
  const Region back = cleaned(surrounded_by(triangles), same_line_mm, 0);
  const auto largest = std::ranges::max_element(back.rings, {}, [](const auto& ring) { return Region{{ring}}.area(); });
  if (largest == back.rings.end()) return {};
  std::vector<TriangleMesh> grooves = number_grooves(*largest, number, box.size().z());
  for (TriangleMesh& groove : grooves) groove.V.col(2).array() += box.lower.z();
  return grooves;
}

ExactSolid united(const std::vector<TriangleMesh>& bodies, Context& context) {
  ExactSolid all;
  for (const TriangleMesh& body : bodies) {
    const ExactSolid one = ExactSolid::from_mesh(body, "mesh", context);
    all = all.empty() ? one : unite(all, one, context);
  }
  return all;
}

bool any(const std::vector<char>& chosen) { return std::ranges::find(chosen, 1) != chosen.end(); }

}  // namespace

TriangleMesh part_in_scene(const BaseParts& parts, int part, double size_mm) {
  TriangleMesh scene{to_scene(parts.mesh(part).V, size_mm), parts.mesh(part).F};
  if (signed_volume(scene) < 0) scene.F.col(1).swap(scene.F.col(2));
  return scene;
}

PartSolid part_solid(const BaseParts& parts, int part, const TriangleMesh& relief, const PartSolidOptions& options,
                     Context& context) {
  PartSolid solid;
  const double unit = 1 / options.size_mm, kappa = parts.kappa();
  const Region seen = grown(parts.seen(part), -inset_mm * unit);
  if (seen.empty()) return solid;
  PartFrontOptions sampling;
  sampling.above = options.thickness_mm * unit;
  sampling.below = options.carve_depth_mm * unit;
  sampling.pitch = options.pixel_mm * unit;
  sampling.tolerance = options.tolerance_mm * unit;
  const PartFront front = part_front(parts, part, seen, relief, sampling, context);
  const auto body_of = [&](const Body& body) {
    return body_between(front.net, body.chosen, body.front, body.back, kappa, options.size_mm);
  };
  std::vector<TriangleMesh> grooves;
  if (parts.is_closed(part)) {
    const TriangleMesh own = part_in_scene(parts, part, options.size_mm);
    if (options.number > 0) grooves = back_grooves(own, options.number);
    ExactSolid exact = ExactSolid::from_mesh(own, "base_mesh", context);
    const Body carved = changed_body(front, Change::carved, options),
               raised = changed_body(front, Change::raised, options);
    if (any(carved.chosen))
      exact = subtract(exact, ExactSolid::from_mesh(body_of(carved), "base_mesh", context), context);
    if (any(raised.chosen)) exact = unite(exact, ExactSolid::from_mesh(body_of(raised), "base_mesh", context), context);
    if (!grooves.empty()) exact = subtract(exact, united(grooves, context), context);
    solid.mesh = exact.mesh();
  } else {
    Body whole;
    whole.chosen.assign(front.net.triangles.size(), 1);
    double deepest = -INFINITY;
    for (const FrontSample& sample : front.samples) {
      whole.front.push_back(sample.relief);
      deepest = std::max({deepest, sample.relief, sample.base});
    }
    whole.back.assign(front.samples.size(), deepest + options.plate_mm * unit);
    solid.mesh = body_of(whole);
    if (options.number > 0) grooves = back_grooves(solid.mesh, options.number);
    if (!grooves.empty())
      solid.mesh =
          subtract(ExactSolid::from_mesh(solid.mesh, "base_mesh", context), united(grooves, context), context).mesh();
  }
  solid.numbered = !grooves.empty();
  solid.mesh = on_file_grid(solid.mesh);
  solid.volume_mm3 = signed_volume(solid.mesh);
  solid.watertight = Adjacency(solid.mesh).is_closed();
  return solid;
}

}  // namespace formwright
