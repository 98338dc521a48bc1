// SPDX-License-Identifier: GPL-3.0-or-later
// compare_simplify MESH TARGET METHOD: simplifies by one method and prints how well, as JSON. simplify_table.mjs runs
// it and makes the table of docs/geometry.md.
//   MESH    SAMPLE_VERTICES such as bust_40000, cube_LEVELS (a cube whose faces are split that often), or FILE.obj
//   METHOD  ours, plane, triangle, probabilistic_plane or probabilistic_triangle of CGAL; with "+smooth" CGAL's own
//           smoothing follows, with "+ours" our improvement of triangles
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/data/json.h"
#include "base/peak_memory.h"
#include "bench/geometry/bench_tools.h"
#include "bench/geometry/cgal/cgal_simplify.h"
#include "formats/mesh_io.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/measures.h"
#include "geometry/mesh/simplify.h"
#include "geometry/mesh/subdivide.h"
#include "geometry/mesh/triangle_improvement.h"
#include "geometry/queries/point_distance.h"
#include "geometry/repair/repair.h"
#include "geometry/samples/samples.h"
#include "relief/height_map.h"
#include "relief/relief.h"

namespace {
using namespace formwright;
constexpr double to_degrees = 180 / std::numbers::pi;

struct Subject {
  TriangleMesh mesh;
  ReliefOptions view;
};

Subject subject(const std::string& name, Context& context) {
  Subject s;
  s.view.width_mm = 100;
  if (name.ends_with(".obj")) {
    std::ifstream file(name, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    s.mesh = read_model(as_bytes(text), name, context).mesh;
  } else {
    const std::string shape = name.substr(0, name.rfind('_'));
    const int number = std::stoi(name.substr(std::min(name.size(), shape.size() + 1)));
    if (shape == "cube") {
      s.mesh = subdivide(test::cube(), SubdivisionScheme::midpoint, number, context);
    } else {
      s.mesh = make_sample(shape, number, context).mesh;
      for (const SampleInfo& info : sample_catalog())
        if (info.name == shape) {
          s.view.direction = {info.view_direction.x(), info.view_direction.y(), info.view_direction.z()};
          s.view.up = {info.view_up.x(), info.view_up.y(), info.view_up.z()};
        }
    }
  }
  s.mesh = repair(s.mesh, {}, context).mesh;
  return s;
}

/// Our improvement of triangles behind CGAL's collapses, with the quadrics that ours would have gathered.
TriangleMesh improved(const TriangleMesh& before, const bench::CgalSimplified& simplified, Context& context) {
  constexpr double normal_variance = 1e-3;
  const BoundingBox box = bounding_box(before);
  const auto placed = [&](const auto& row) { return Vec3((Vec3(row) - box.centre()) / box.diagonal()); };
  const std::vector<int>& new_of = simplified.new_vertex_of;
  std::vector<Vec3> position;
  for (const auto& row : simplified.mesh.V.rowwise()) position.push_back(placed(row));
  std::vector<Quadric> quadric(position.size());
  std::vector<Freedom> freedom(position.size(), Freedom::flip);
  std::vector<char> used(position.size(), 0);
  for (const int v : new_of) {
    if (v < 0) continue;
    char& seen = used[static_cast<std::size_t>(v)];
    if (seen != 0) freedom[static_cast<std::size_t>(v)] = Freedom::move;
    seen = 1;
  }
  for (int f = 0; f < before.face_count(); ++f) {
    const auto corner = [&](int k) { return placed(before.V.row(before.F(f, k))); };
    const Vec3 a = corner(0), b = corner(1), c = corner(2), cross = (b - a).cross(c - a);
    if (!(cross.norm() > 0)) continue;
    const Quadric q = Quadric::plane((a + b + c) / 3, cross.normalized(), normal_variance, cross.norm() / 6);
    for (int k = 0; k < 3; ++k)
      if (const int v = new_of[static_cast<std::size_t>(before.F(f, k))]; v >= 0)
        quadric[static_cast<std::size_t>(v)] += q;
  }
  double max_error = 0;
  for (std::size_t v = 0; v < position.size(); ++v)
    if (freedom[v] == Freedom::move) max_error = std::max(max_error, quadric[v](position[v]));
  CollapsibleMesh mesh{Adjacency(simplified.mesh)};
  improve_triangles(mesh, position, quadric, freedom, max_error, context);
  TriangleMesh result = simplified.mesh;
  for (int v = 0; v < result.vertex_count(); ++v)
    result.V.row(v) = position[static_cast<std::size_t>(v)] * box.diagonal() + box.centre();
  for (int f = 0; f < result.face_count(); ++f)
    for (int k = 0; k < 3; ++k) result.F(f, k) = mesh.from(3 * f + k);
  return result;
}

TriangleMesh simplified(const TriangleMesh& mesh, int target, const std::string& method, Context& context) {
  if (method == "ours") return simplify(mesh, {target, false}, context);
  const std::string quadrics = method.substr(0, method.find('+')), then = method.substr(quadrics.size());
  const std::array names{"plane", "triangle", "probabilistic_plane", "probabilistic_triangle"};
  const auto found = std::ranges::find(names, quadrics);
  if (found == names.end() || (then != "" && then != "+smooth" && then != "+ours"))
    throw std::invalid_argument("There is no method called " + method + ".");
  const bench::CgalSimplified result = bench::cgal_simplify(
      mesh, target, static_cast<bench::CgalQuadrics>(found - names.begin()), then == "+smooth", context);
  return then == "+ours" ? improved(mesh, result, context) : result.mesh;
}

Json angles(const TriangleMesh& mesh) {
  const Eigen::VectorXd minimum = corner_angles(mesh).rowwise().minCoeff() * to_degrees;
  std::vector<double> sorted(minimum.begin(), minimum.end());
  std::ranges::sort(sorted);
  return {{"min", sorted.front()}, {"5_percent", sorted[sorted.size() / 20]}, {"median", sorted[sorted.size() / 2]}};
}

/// Mean angle between a face's normal and that of the other surface at the nearest point, weighted by area.
double normal_angle_deg(const TriangleMesh& from, const TriangleMesh& to) {
  const PointDistance surface(to);
  const Positions normals = face_normals(from), other = face_normals(to);
  const Eigen::VectorXd areas = face_areas(from);
  double sum = 0;
  for (int f = 0; f < from.face_count(); ++f) {
    const Vec3 centre = (from.V.row(from.F(f, 0)) + from.V.row(from.F(f, 1)) + from.V.row(from.F(f, 2))) / 3;
    const double cosine = normals.row(f).dot(other.row(surface.nearest(centre)->face));
    sum += areas[f] * std::acos(std::clamp(cosine, -1.0, 1.0)) * to_degrees;
  }
  return sum / areas.sum();
}

/// Points along the edges that `chosen` names, a tenth of the mean edge apart.
template <class Chosen>
std::vector<Vec3> points_along(const TriangleMesh& mesh, const Adjacency& adjacency, const Chosen& chosen) {
  const double spacing = mean_edge_length(mesh) / 10;
  std::vector<Vec3> points;
  for (int e = 0; e < adjacency.edge_count(); ++e) {
    if (!chosen(e)) continue;
    const Edge edge = adjacency.edges()[static_cast<std::size_t>(e)];
    const Vec3 a = mesh.V.row(edge.lower), b = mesh.V.row(edge.higher);
    const int steps = 1 + static_cast<int>((b - a).norm() / spacing);
    for (int i = 0; i <= steps; ++i) points.push_back(a + (b - a) * i / steps);
  }
  return points;
}

/// The largest distance from those points of the full mesh to the same edges of the simplified one.
template <class Chosen>
Json line_distance(const TriangleMesh& full, const TriangleMesh& small, double diagonal, const Chosen& chosen) {
  const Adjacency full_adjacency(full), small_adjacency(small);
  const std::vector<Vec3> points = points_along(full, full_adjacency, chosen(full, full_adjacency));
  if (points.empty()) return nullptr;
  // Edges as triangles without width, which PointDistance allows.
  TriangleMesh lines{small.V, Triangles(small_adjacency.edge_count(), 3)};
  Eigen::Index count = 0;
  const auto keep = chosen(small, small_adjacency);
  for (int e = 0; e < small_adjacency.edge_count(); ++e) {
    const Edge edge = small_adjacency.edges()[static_cast<std::size_t>(e)];
    if (keep(e)) lines.F.row(count++) << edge.lower, edge.higher, edge.higher;
  }
  if (count == 0) return nullptr;
  lines.F = lines.F.topRows(count).eval();
  const PointDistance distance(lines);
  double largest = 0;
  for (const Vec3& p : points) largest = std::max(largest, distance.nearest(p)->distance);
  return 100 * largest / diagonal;
}

struct SolvedRelief {
  HeightMap map;
  double normal_error_deg = 0;
};

SolvedRelief solved_relief(const TriangleMesh& mesh, const ReliefOptions& view, Context& context) {
  ReliefSolver solver(mesh, view, context);
  const Relief relief = solver.solve(view, context);
  const PlateSize plate{view.width_mm, view.width_mm * solver.frame().image_height};
  return {make_height_map(relief.moved, solver.F(), view.width_mm, plate, 0.4, view.thickness_mm, context),
          relief.normal_error.mean_deg_image};
}

/// Height of a map at a point of the plate, both from 0 to 1.
double height_at(const HeightMap& map, double x, double y) {
  const double column = x * (map.columns - 1), row = y * (map.rows - 1);
  const int c = std::min(static_cast<int>(column), map.columns - 2), r = std::min(static_cast<int>(row), map.rows - 2);
  const double s = column - c, t = row - r;
  return (1 - t) * ((1 - s) * map.at(r, c) + s * map.at(r, c + 1)) +
         t * ((1 - s) * map.at(r + 1, c) + s * map.at(r + 1, c + 1));
}

/// The relief of the simplified mesh against that of the full one, where both are above the bare plate.
Json relief_difference(const TriangleMesh& full, const TriangleMesh& small, const ReliefOptions& view,
                       Context& context) {
  const SolvedRelief expected = solved_relief(full, view, context), got = solved_relief(small, view, context);
  const HeightMap& map = expected.map;
  double squares = 0, slope_angle = 0;
  int count = 0;
  for (int r = 0; r + 1 < map.rows; ++r)
    for (int c = 0; c + 1 < map.columns; ++c) {
      const auto at = [&](int row, int column) {
        return height_at(got.map, static_cast<double>(column) / (map.columns - 1),
                         static_cast<double>(row) / (map.rows - 1));
      };
      const double h = map.at(r, c), hx = map.at(r, c + 1), hy = map.at(r + 1, c);
      const double g = at(r, c), gx = at(r, c + 1), gy = at(r + 1, c);
      if (std::min({h, hx, hy, g, gx, gy}) <= 0) continue;
      squares += (h - g) * (h - g);
      const Vec3 a(-(hx - h) / map.pitch_x_mm, -(hy - h) / map.pitch_y_mm, 1),
          b(-(gx - g) / map.pitch_x_mm, -(gy - g) / map.pitch_y_mm, 1);
      slope_angle += std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * to_degrees;
      ++count;
    }
  return {{"height_rms_mm", std::sqrt(squares / std::max(1, count))},
          {"normal_mean_deg", slope_angle / std::max(1, count)},
          {"normal_error_deg", got.normal_error_deg},
          {"normal_error_of_full_deg", expected.normal_error_deg}};
}

Json report(const std::string& name, int target, const std::string& method) {
  Context context;
  const Subject s = subject(name, context);
  const double diagonal = bounding_box(s.mesh).diagonal();
  TriangleMesh small;
  double seconds = 0;
  const std::optional<double> growth = test::peak_growth_mb([&] {
    const double before = bench::cpu_seconds();
    small = simplified(s.mesh, target, method, context);
    seconds = bench::cpu_seconds() - before;
  });
  const Adjacency before(s.mesh), after(small);
  Json result{{"mesh", name},
              {"method", method},
              {"vertices_before", s.mesh.vertex_count()},
              {"vertices", small.vertex_count()},
              {"seconds", seconds},
              {"manifold", after.is_manifold()},
              {"same_topology", euler_characteristic(after) == euler_characteristic(before) &&
                                    boundary_loops(after).size() == boundary_loops(before).size()},
              {"angles_deg", angles(small)}};
  if (growth) result["megabytes"] = *growth;
  const double spacing = mean_edge_length(s.mesh) / 2;
  const SurfaceDistance there = surface_distance(s.mesh, PointDistance(small), spacing, context),
                        back = surface_distance(small, PointDistance(s.mesh), spacing, context);
  result["distance_percent"] = {{"full_to_small_max", 100 * there.maximum / diagonal},
                                {"small_to_full_max", 100 * back.maximum / diagonal},
                                {"full_to_small_mean", 100 * there.mean / diagonal},
                                {"small_to_full_mean", 100 * back.mean / diagonal}};
  result["normal_mean_deg"] = normal_angle_deg(s.mesh, small);
  result["boundary_percent"] = line_distance(s.mesh, small, diagonal, [](const TriangleMesh&, const Adjacency& a) {
    return [&a](int e) { return a.is_boundary_edge(e); };
  });
  // A crease of the full mesh turns by more than 60 degrees; that of the simplified one may be a little rounder.
  result["crease_percent"] = line_distance(s.mesh, small, diagonal, [&](const TriangleMesh& mesh, const Adjacency& a) {
    const double least = (&mesh == &s.mesh ? 60 : 45) / to_degrees;
    return [turns = dihedral_angles(mesh, a), least](int e) { return std::abs(turns[e]) > least; };
  });
  result["relief"] = relief_difference(s.mesh, small, s.view, context);
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "compare_simplify MESH TARGET METHOD, such as bust_40000 4000 ours\n");
    return 2;
  }
  try {
    std::cout << report(argv[1], std::stoi(argv[2]), argv[3]).dump(2) << "\n";
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_simplify: %s\n", error.what());
    return 3;
  }
}
