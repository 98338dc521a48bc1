// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sharp points of the mould that have met the inside of a sheet triangle: each is glued there by a stiff spring, as
// vertices are glued when they touch.
#include <span>
#include <vector>

#include "thermoform/block_matrix.h"
#include "thermoform/membrane.h"

namespace formwright {

struct PointContact {
  int point = -1, face = -1;
  Vec3 barycentric;
  Vec3 place;  // where that point of the face is held
  double fraction = 0;  // of the step in which it was met
  // Where friction is finite: what has slid is held by the full stiffness along `normal` only, and softly beside.
  bool slid = false;
  Vec3 normal = Vec3::Zero();
};

class PointContacts {
 public:
  /// `points`: at rest, as the mould is. `cell_mm`: about an edge of the sheet's triangles. `stiffness`: N/mm.
  PointContacts(std::vector<Vec3> points, double cell_mm, double stiffness);

  /// Finds points that faces of `F` come within half their thickness (m) of while their corners go straight from `from` to `to`.
  /// Faces whose corners are all held are left out. New contacts are appended. Returns their number.
  int find(const Triangles& F, const Positions& from, const Positions& to, std::span<const double> thickness_mm, const HeldVertices& held,
           double tolerance_mm);

  /// Adds the springs' forces and, unless null, their stiffness.
  void add_forces(const Triangles& F, const Positions& x, Positions& force, BlockMatrix* matrix) const;

  /// After a step that ended at `x`: where the pull along the face exceeds `friction` times that across it, the sheet slides over
  /// the point until it does not. `faces_of`: the triangles around a vertex.
  void slide(const Triangles& F, const Positions& x, double friction, const std::vector<std::vector<int>>& faces_of);

  const std::vector<PointContact>& contacts() const { return contacts_; }
  std::size_t point_count() const { return points_.size(); }
  const std::vector<Vec3>& points() const { return points_; }
  /// Forgets the contacts found since there were `count` of them.
  void roll_back(std::size_t count);

 private:
  /// N, on the face, with the face's corners at `x`.
  Vec3 pull_of(const PointContact& contact, const Triangles& F, const Positions& x) const;
  /// The points in a box, ascending within each cell.
  void collect(const Vec3& lower, const Vec3& upper, std::vector<int>& points) const;

  struct Cell {
    std::uint64_t key;
    int point;
  };
  std::vector<Vec3> points_;
  std::vector<Cell> cells_;  // sorted by key
  std::vector<char> used_;
  std::vector<PointContact> contacts_;
  /// Where each face was when the points within `margin_mm_` of its box were listed: while no corner has gone farther, it can
  /// meet no others.
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> listed_at_;
  std::vector<std::vector<int>> listed_;
  double cell_mm_, margin_mm_, stiffness_;
};

}  // namespace formwright
