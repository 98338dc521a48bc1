// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Exact constructive solid geometry: union, difference, intersection and planar cuts of closed meshes.
//
// Booleans are CGAL's corefinement with exact constructions; planar cuts are our own on the same exact points, capped
// by a constrained Delaunay triangulation, so that a chain of operations rounds once, at its end. Rounding to double
// moves no vertex by more than 2^-53 of its coordinates: 1.4e-14 mm at 128 mm. That is as deep as walls of the result
// may cross each other.
#include <memory>
#include <string_view>

#include "base/context.h"
#include "geometry/mesh/triangle_mesh.h"

namespace formwright {

/// A closed solid with exact vertices; immutable, cheap to copy, for one thread at a time. May be empty.
class ExactSolid {
 public:
  ExactSolid() = default;

  /// Takes a closed, manifold mesh in mm whose faces look outwards (cavities inwards).
  /// Throws Error{invalid_input, where} for an open, inverted or self-intersecting one, naming the fix;
  /// Error{cancelled}.
  static ExactSolid from_mesh(const TriangleMesh& mesh, std::string_view where, Context& context);

  /// The part of `mesh` above z = `height_mm`, capped flat there. The mesh may be open, and may do as it likes, below.
  /// Parts that overlap each other but are sound in themselves are united.
  /// Throws Error{invalid_input, where} as from_mesh, for what lies above; Error{cancelled}.
  static ExactSolid above(const TriangleMesh& mesh, double height_mm, std::string_view where, Context& context);

  /// The part where coordinate `axis` (0, 1, 2) is at least (`upper`) or at most `offset_mm`, capped flat.
  /// Throws Error: could_not_solve (a section that touches itself), cancelled.
  ExactSolid half(int axis, double offset_mm, bool upper, Context& context) const;

  /// The section at z = `top_mm`, drawn straight down to `bottom_mm` < `top_mm`. Empty where nothing rises above
  /// top_mm. Throws as half.
  ExactSolid section_prism(double top_mm, double bottom_mm, Context& context) const;

  bool empty() const;
  int face_count() const;
  /// Rounded to double; closed and manifold. Empty for the empty solid.
  TriangleMesh mesh() const;
  double volume_mm3() const;  // of mesh()

  struct Surface;  // of exact points, in booleans_surface.h
  explicit ExactSolid(std::shared_ptr<const Surface> surface) : surface_(std::move(surface)) {}
  const Surface& surface() const;

 private:
  std::shared_ptr<const Surface> surface_;  // null: empty
};

// Results are regularised: faces that only touch do not stay as sheets within.
// Throw Error: could_not_solve (the result would touch itself along an edge or at a point, which no mesh for a printer
// may), cancelled.
ExactSolid unite(const ExactSolid& a, const ExactSolid& b, Context& context);
ExactSolid subtract(const ExactSolid& a, const ExactSolid& b, Context& context);
ExactSolid intersect(const ExactSolid& a, const ExactSolid& b, Context& context);

}  // namespace formwright
