// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/ribbon/ribbon.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "geometry/mesh/adjacency.h"
#include "zippable/parts/polygon_dissection.h"
#include "zippable/ribbon/ribbon_boundary.h"

namespace formwright {
namespace {

class Rulings {
 public:
  Rulings(const Segmentation& s, const Parameterisation& p, const ZipperCurve& curve, const RibbonBoundary& boundary)
      : s_(s), p_(p), curve_(curve), boundary_(boundary) {}

  std::vector<Chord> chords;
  std::size_t between_windings = 0;  // the first so many of them join neighbouring windings

  void find() {
    for (const auto& strip : boundary_.strips)
      for (std::size_t k = 0; k < line(strip.left_line).grid.size(); ++k) {
        if (line(strip.left_line).grid[k] == no_grid) continue;
        if (const int j = sample_at(strip.right_line, line(strip.left_line).grid[k] - strip.right_shift); j >= 0)
          add(boundary_.place(strip.left_line, k, true), boundary_.place(strip.right_line, j, false));
      }
    between_windings = chords.size();
    for (const auto& strip : boundary_.strips) {
      for (const auto& [grid, place] : strip.upper)
        if (const int j = sample_at(strip.right_line, grid - strip.right_shift); j >= 0)
          add(place, boundary_.place(strip.right_line, j, false));
      for (const auto& [grid, place] : strip.lower)
        if (const int j = sample_at(strip.left_line, grid); j >= 0)
          add(place, boundary_.place(strip.left_line, j, true));
    }
    if (s_.part_count() > 1)
      for (const auto& strip : boundary_.strips) across(strip);
  }

 private:
  const SpiralLine& line(int l) const { return curve_.lines[l]; }
  void add(int a, int b) { chords.push_back({std::min(a, b), std::max(a, b)}); }

  /// The sample of a line at a place of the grid; -1: none.
  int sample_at(int l, int grid) const {
    const auto& places = line(l).grid;
    const auto found = std::lower_bound(places.begin() + 1, places.end() - 1, grid);
    return found != places.end() - 1 && *found == grid ? static_cast<int>(found - places.begin()) : -1;
  }

  double x_of(int l, std::size_t k) const {
    const SpiralLine& spiral = line(l);
    if (k == 0) return spiral.x_low_mm;
    return k + 1 == spiral.grid.size() ? spiral.x_high_mm : spiral.grid[k] * curve_.grid_step_mm[spiral.part];
  }

  /// Between the lower line and the first winding above it, rulings go on into the neighbouring part, to its first
  /// winding.
  void across(const RibbonBoundary::Strip& strip) {
    const int part = line(strip.left_line).part;
    const double end = line(strip.right_line).x_low_mm + strip.right_offset_mm;
    for (std::size_t k = 1; k + 1 < line(strip.left_line).grid.size() && x_of(strip.left_line, k) < end; ++k) {
      const LinePoint there = across_interface(s_, p_, {part, x_of(strip.left_line, k)});
      for (const auto& other : boundary_.strips) {
        const SpiralLine& first = line(other.left_line);
        if (first.part != there.part) continue;
        const double low = first.x_low_mm, high = line(other.right_line).x_low_mm + other.right_offset_mm,
                     period = p_.period_mm[there.part];
        const double x = there.x_mm - period * std::floor((there.x_mm - low) / period);  // in [low, low + period)
        if (x >= high) continue;
        std::size_t nearest = 0;
        for (std::size_t j = 0; j < first.grid.size() && (j == 0 || x_of(other.left_line, j) < high); ++j)
          if (std::abs(x_of(other.left_line, j) - x) < std::abs(x_of(other.left_line, nearest) - x)) nearest = j;
        add(boundary_.place(strip.left_line, k, true), boundary_.place(other.left_line, nearest, true));
        break;
      }
    }
  }

  const Segmentation& s_;
  const Parameterisation& p_;
  const ZipperCurve& curve_;
  const RibbonBoundary& boundary_;
};

}  // namespace

TriangleMesh Ribbon::formed() const {
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(boundary.size()), 3);
  for (std::size_t i = 0; i < boundary.size(); ++i) mesh.V.row(static_cast<Eigen::Index>(i)) = boundary[i].position_mm;
  mesh.F = F;
  return mesh;
}

TriangleMesh Ribbon::flat() const {
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(flat_mm.size()), 3);
  for (std::size_t i = 0; i < flat_mm.size(); ++i)
    mesh.V.row(static_cast<Eigen::Index>(i)) << flat_mm[i].x(), flat_mm[i].y(), 0;
  mesh.F = F;
  return mesh;
}

std::vector<Vec2> unfold(const std::vector<Vec3>& positions, const Triangles& F) {
  TriangleMesh mesh;
  mesh.V.resize(static_cast<Eigen::Index>(positions.size()), 3);
  for (std::size_t i = 0; i < positions.size(); ++i) mesh.V.row(static_cast<Eigen::Index>(i)) = positions[i];
  mesh.F = F;
  const Adjacency adjacency(mesh);
  std::vector<Vec2> flat(positions.size(), Vec2::Zero());
  std::vector<char> placed(F.rows(), 0);
  const auto distance = [&](int a, int b) { return (positions[a] - positions[b]).norm(); };
  // c to the left of the line from a to b.
  const auto put = [&](int a, int b, int c) {
    const double length = distance(a, b);
    const Vec3 ab = positions[b] - positions[a], ac = positions[c] - positions[a];
    const double along = ab.dot(ac) / length, across = ab.cross(ac).norm() / length;
    const Vec2 u = (flat[b] - flat[a]).normalized();
    flat[c] = flat[a] + along * u + across * Vec2(-u.y(), u.x());
  };
  if (F.rows() == 0) return flat;
  flat[F(0, 1)] = Vec2(distance(F(0, 0), F(0, 1)), 0);
  put(F(0, 0), F(0, 1), F(0, 2));
  placed[0] = 1;
  std::vector<int> stack{0};
  while (!stack.empty()) {
    const int f = stack.back();
    stack.pop_back();
    for (int h = 3 * f; h < 3 * f + 3; ++h) {
      const int o = adjacency.opposite(h);
      if (o < 0 || placed[o / 3]) continue;
      placed[o / 3] = 1;
      put(adjacency.from(o), adjacency.to(o), adjacency.from(previous_halfedge(o)));
      stack.push_back(o / 3);
    }
  }
  return flat;
}

Ribbon make_ribbon(const Segmentation& s, const Parameterisation& p, const LineTracer& tracer, const ZipperCurve& curve,
                   const CurveOptions& options, Context& context, const std::vector<TapedCut>& cuts) {
  TapedCuts taped(s, p, cuts);
  RibbonBoundary boundary(s.part_count(), p, tracer, curve, options.sample_mm, taped);
  context.check_cancelled();
  const int count = static_cast<int>(boundary.vertices.size());
  Rulings rulings(s, p, curve, boundary);
  rulings.find();
  const auto position = [&](int v) -> const Vec3& { return boundary.vertices[v].position_mm; };
  Ribbon ribbon;
  ribbon.width_min_mm = 1e300;
  for (std::size_t i = 0; i < rulings.between_windings; ++i) {
    const double width = (position(rulings.chords[i].from) - position(rulings.chords[i].to)).norm();
    ribbon.width_min_mm = std::min(ribbon.width_min_mm, width);
    ribbon.width_mean_mm += width / static_cast<double>(rulings.between_windings);
  }
  const std::vector<Chord> kept = without_crossings(rulings.chords, count);
  ribbon.rulings = static_cast<int>(kept.size());
  std::vector<std::array<int, 3>> faces;
  const auto side = [&](int a, int b) { return (position(a) - position(b)).norm(); };
  // Places on one straight stretch, or both copies of one place on the zipper, make triangles without area: only where
  // nothing else is left.
  const auto flatness = [&](int a, int b, int c) {
    const Vec3 ab = position(b) - position(a), ac = position(c) - position(a), bc = position(c) - position(b);
    const double longest_squared = std::max({ab.squaredNorm(), ac.squaredNorm(), bc.squaredNorm()});
    return ab.cross(ac).norm() > 1e-5 * longest_squared ? 0.0 : 1e6 * options.width_mm;
  };
  for (const auto& polygon : dissect(count, kept)) {
    const auto triangles = cheapest_triangulation(polygon, side, flatness);
    faces.insert(faces.end(), triangles.begin(), triangles.end());
    context.check_cancelled();
  }
  ribbon.F.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (int k = 0; k < 3; ++k) ribbon.F(static_cast<Eigen::Index>(i), k) = faces[i][k];
  std::vector<Vec3> positions;
  for (const RibbonVertex& v : boundary.vertices) positions.push_back(v.position_mm);
  ribbon.flat_mm = unfold(positions, ribbon.F);
  for (const auto& face : faces)
    for (int k = 0; k < 3; ++k) {
      const int a = face[k], b = face[(k + 1) % 3];
      const double length = (positions[a] - positions[b]).norm();
      ribbon.isometry_error =
          std::max(ribbon.isometry_error,
                   std::abs((ribbon.flat_mm[a] - ribbon.flat_mm[b]).norm() - length) / std::max(length, 1e-300));
    }
  for (const auto& piece : curve.pieces)
    for (std::size_t i = 0; i + 1 < piece.size(); ++i)
      ribbon.zipper_mm += (curve.samples[piece[i + 1]].position_mm - curve.samples[piece[i]].position_mm).norm();
  ribbon.opening_arcs = static_cast<int>(boundary.arcs.size());
  ribbon.closures = taped.closures(boundary.arcs, count);
  ribbon.boundary = std::move(boundary.vertices);
  return ribbon;
}

}  // namespace formwright
