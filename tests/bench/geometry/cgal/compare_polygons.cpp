// SPDX-License-Identifier: GPL-3.0-or-later
// compare_polygons: polygons and holes triangulated by us and by CGAL. Prints the tables of docs/geometry.md: how many
// fillings are right (no triangle turned over, areas that add up), their smallest angles, the processor time.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "bench/geometry/bench_tools.h"
#include "bench/geometry/cgal/cgal_polygons.h"
#include "formats/shared/polygon_triangulation.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/repair/repair.h"
#include "geometry/samples/samples.h"

namespace {
using namespace formwright;
using Polygon = std::vector<Vec3>;
using bench::PolygonTriangles;
constexpr double to_degrees = 180 / std::numbers::pi;

Vec3 area_vector(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a) / 2; }

double smallest_angle_deg(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto at = [](const Vec3& p, const Vec3& q, const Vec3& r) {
    return std::atan2((q - p).cross(r - p).norm(), (q - p).dot(r - p)) * to_degrees;
  };
  return std::min({at(a, b, c), at(b, c, a), at(c, a, b)});
}

Polygon in_space(const std::vector<Vec2>& flat, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
  Polygon points;
  for (const Vec2& p : flat) points.push_back(turn * Vec3(p.x(), p.y(), 0) + Vec3(100, -20, 3));
  return points;
}

std::vector<Vec2> on_circle(int corners, const std::function<double(int)>& radius) {
  std::vector<Vec2> flat;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, r = radius(i);
    flat.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return flat;
}

struct Set {
  std::string name;
  std::vector<Polygon> polygons;
};

/// Bent: corners off the plane by up to that share of the radius.
Set random_polygons(const std::string& name, int count, int corners, double inner, double bent) {
  Set set{name, {}};
  for (int k = 0; k < count; ++k) {
    std::mt19937 random(static_cast<unsigned>(k));
    std::uniform_real_distribution<double> radius(inner, 1), off(-bent, bent);
    Polygon polygon = in_space(on_circle(corners, [&](int) { return radius(random); }), static_cast<unsigned>(k));
    for (Vec3& p : polygon) p += Vec3(off(random), off(random), off(random));
    set.polygons.push_back(std::move(polygon));
  }
  return set;
}

std::vector<Set> sets() {
  std::vector<Set> all{random_polygons("quadrangles, convex", 20'000, 4, 0.8, 0),
                       random_polygons("quadrangles, bent", 20'000, 4, 0.6, 0.1),
                       random_polygons("8 corners, nearly regular", 10'000, 8, 0.9, 0),
                       random_polygons("8 corners, bent by 5 %", 10'000, 8, 0.9, 0.05),
                       random_polygons("30 corners, concave", 2'000, 30, 0.05, 0),
                       random_polygons("1000 corners, concave", 20, 1'000, 0.3, 0)};
  std::vector<Vec2> comb{{0, -1}, {4000, -1}};
  for (int i = 2000; i-- > 0;)
    comb.insert(comb.end(), {{2.0 * i + 1.5, 10.0}, {2.0 * i + 1.0, 0.0}, {2.0 * i + 0.5, 10.0}});
  all.push_back({"comb of 6002 corners", {in_space(comb, 3)}});
  all.push_back(
      {"square with middles of its sides",
       Set{"", {{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}}}}.polygons});
  all.push_back({"keyhole around a hole",
                 {in_space({{0, 0}, {9, 0}, {9, 9}, {0, 9}, {0, 0}, {3, 3}, {3, 6}, {6, 6}, {6, 3}, {3, 3}}, 5)}});
  return all;
}

void row(const Set& set, const char* method, const std::function<PolygonTriangles(const Polygon&)>& triangulate) {
  std::vector<PolygonTriangles> results(set.polygons.size());
  double seconds = 1e30;
  for (int round = 0; round < 3; ++round) {
    const double before = bench::cpu_seconds();
    for (std::size_t i = 0; i < results.size(); ++i) results[i] = triangulate(set.polygons[i]);
    seconds = std::min(seconds, bench::cpu_seconds() - before);
  }
  std::size_t right = 0, corners = 0;
  std::vector<double> angles;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Polygon& p = set.polygons[i];
    corners += p.size();
    Vec3 whole = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < p.size(); ++k) whole += area_vector(p[0], p[k], p[k + 1]);
    double sum = 0, least = 0;
    for (const auto& t : results[i]) {
      const Vec3 &a = p[static_cast<std::size_t>(t[0])], &b = p[static_cast<std::size_t>(t[1])],
                 &c = p[static_cast<std::size_t>(t[2])];
      const double area = area_vector(a, b, c).dot(whole.normalized());
      sum += std::abs(area), least = std::min(least, area);
      angles.push_back(smallest_angle_deg(a, b, c));
    }
    if (results[i].size() == p.size() - 2 && least >= -1e-12 * whole.norm() &&
        std::abs(sum - whole.norm()) < 1e-9 * whole.norm())
      ++right;
  }
  std::ranges::sort(angles);
  const auto part = [&](std::size_t share) { return angles.empty() ? 0.0 : angles[angles.size() / share]; };
  std::printf("| %s | %s | %zu of %zu | %.3g | %.3g | %.2g |\n", set.name.c_str(), method, right, results.size(),
              part(20), part(2), 1e6 * seconds / static_cast<double>(corners));
}

/// A sample with `count` round holes of about `edges` edges each.
TriangleMesh with_holes(int count, int edges, Context& context) {
  const TriangleMesh mesh = make_sample("bust", 40'000, context).mesh;
  const double radius = mean_edge_length(mesh) * edges / (2 * std::numbers::pi);
  std::vector<Vec3> centres;
  std::mt19937 random(static_cast<unsigned>(edges));
  std::uniform_int_distribution<int> any(0, mesh.vertex_count() - 1);
  for (int attempt = 0; attempt < 10'000 && static_cast<int>(centres.size()) < count; ++attempt) {
    const Vec3 centre = mesh.V.row(any(random));
    if (std::ranges::all_of(centres, [&](const Vec3& c) { return (c - centre).norm() > 3 * radius; }))
      centres.push_back(centre);
  }
  TriangleMesh holed{mesh.V, mesh.F};
  Eigen::Index kept = 0;
  for (int f = 0; f < mesh.face_count(); ++f) {
    const Vec3 middle = (mesh.V.row(mesh.F(f, 0)) + mesh.V.row(mesh.F(f, 1)) + mesh.V.row(mesh.F(f, 2))) / 3;
    if (std::ranges::all_of(centres, [&](const Vec3& c) { return (c - middle).norm() > radius; }))
      holed.F.row(kept++) = mesh.F.row(f);
  }
  holed.F = holed.F.topRows(kept).eval();
  return repair(holed, {}, context).mesh;
}

/// The mesh with fillings of every hole, what they cost beyond `other_seconds`, and how they fold.
void hole_row(const TriangleMesh& holed, int edges, const char* method, double other_seconds,
              const std::function<TriangleMesh()>& fill) {
  const double before = bench::cpu_seconds();
  const TriangleMesh filled = fill();
  const double seconds = bench::cpu_seconds() - before - other_seconds;
  const Adjacency adjacency(filled);
  const Eigen::VectorXd turns = dihedral_angles(filled, adjacency);
  double fold = 0, area = 0;
  std::vector<double> angles;
  const Eigen::VectorXd areas = face_areas(filled);
  for (int f = holed.face_count(); f < filled.face_count(); ++f) {
    area += areas[f];
    for (int k = 0; k < 3; ++k) fold = std::max(fold, std::abs(turns[adjacency.edge_of(3 * f + k)]));
    angles.push_back(
        smallest_angle_deg(filled.V.row(filled.F(f, 0)), filled.V.row(filled.F(f, 1)), filled.V.row(filled.F(f, 2))));
  }
  std::ranges::sort(angles);
  std::printf("| %d | %s | %zu | %s | %.4g | %.6g | %.3g | %.2g |\n", edges, method, boundary_loops(adjacency).size(),
              adjacency.is_manifold() ? "yes" : "no", fold * to_degrees, area,
              angles.empty() ? 0 : angles[angles.size() / 20], seconds);
}

TriangleMesh filled_by_cgal(const TriangleMesh& holed, bool delaunay) {
  const Adjacency adjacency(holed);
  std::vector<std::array<int, 3>> faces;
  for (const std::vector<int>& boundary : boundary_loops(adjacency)) {
    const std::vector<int> loop(boundary.rbegin(), boundary.rend());
    Polygon corners, beyond;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int from = loop[(i + 1) % loop.size()], to = loop[i];
      corners.push_back(holed.V.row(loop[i]));
      beyond.push_back(holed.V.row(
          adjacency.from(previous_halfedge(adjacency.halfedges_of_edge(adjacency.find_edge(from, to))[0]))));
    }
    for (const auto& t : bench::cgal_fill_hole(corners, beyond, delaunay))
      faces.push_back({loop[static_cast<std::size_t>(t[0])], loop[static_cast<std::size_t>(t[1])],
                       loop[static_cast<std::size_t>(t[2])]});
  }
  TriangleMesh filled{holed.V, Triangles(holed.F.rows() + static_cast<Eigen::Index>(faces.size()), 3)};
  filled.F.topRows(holed.F.rows()) = holed.F;
  for (std::size_t i = 0; i < faces.size(); ++i)
    filled.F.row(holed.F.rows() + static_cast<Eigen::Index>(i)) << faces[i][0], faces[i][1], faces[i][2];
  return filled;
}

}  // namespace

int main() {
  std::puts("| polygons | method | right | angle 5 % | angle median | µs a corner |");
  std::puts("|---|---|---:|---:|---:|---:|");
  PolygonTriangulator triangulator;
  for (const Set& set : sets()) {
    row(set, "ours", [&](const Polygon& p) {
      const auto triangles = triangulator.triangulate(p);
      return PolygonTriangles(triangles.begin(), triangles.end());
    });
    row(set, "CGAL, triangulate_faces", [](const Polygon& p) { return bench::cgal_polyline(p); });
    row(set, "CGAL, constrained Delaunay", [](const Polygon& p) { return bench::cgal_delaunay(p); });
  }
  std::puts("\n| edges a hole | method | holes left | manifold | largest fold ° | area mm² | angle 5 % | seconds |");
  std::puts("|---:|---|---:|---|---:|---:|---:|---:|");
  Context context;
  for (const auto& [count, edges] : {std::pair{200, 12}, std::pair{40, 40}, std::pair{4, 150}, std::pair{1, 400}}) {
    const TriangleMesh holed = with_holes(count, edges, context);
    // Ours is a step of repair().
    const double before = bench::cpu_seconds();
    repair(holed, {}, context);
    hole_row(holed, edges, "ours", bench::cpu_seconds() - before, [&] {
      RepairOptions options;
      options.fill_holes_up_to_edges = 500;
      return repair(holed, options, context).mesh;
    });
    hole_row(holed, edges, "CGAL, all triangles", 0, [&] { return filled_by_cgal(holed, false); });
    hole_row(holed, edges, "CGAL, Delaunay triangles first", 0, [&] { return filled_by_cgal(holed, true); });
  }
}
