// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sharp points of the mould that have met the inside of a sheet triangle: each is glued there by a stiff spring, as
// vertices are glued when they touch.
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "thermoform/solver/block_matrix.h"
#include "thermoform/sheet/membrane.h"

namespace formwright {

struct PointContact {
  int point = -1, face = -1;
  Vec3 barycentric;
  Vec3 place;           // where that point of the face is held
  double fraction = 0;  // of the step in which it was met
  // Where friction is finite: what has slid is held by the full stiffness along `normal` only, and softly beside.
  bool slid = false;
  Vec3 normal = Vec3::Zero();
};

class PointContacts {
 public:
  /// `points`: at rest, as the mould is. `cell_mm`: about an edge of the sheet's triangles. `stiffness`: N/mm.
  PointContacts(std::vector<Vec3> points, double cell_mm, double stiffness);

  /// Finds points that faces of `F` come within `radius_mm` (m) of while their corners go straight from `from` to `to`.
  /// Faces whose corners are all held are left out. `clear_mm(v)` is any lower bound of the distance of from's
  /// vertex v from all points. New contacts are appended. Returns their number.
  int find(const Triangles& F, const Positions& from, const Positions& to, std::span<const double> radius_mm,
           const HeldVertices& held, double tolerance_mm, const std::function<double(int vertex)>& clear_mm);

  /// Adds the springs' forces and, unless null, their stiffness.
  void add_forces(const Triangles& F, const Positions& x, Positions& force, BlockMatrix* matrix) const;

  /// After a step that ended at `x`: where the pull along the face exceeds `friction` times that across it, the sheet
  /// slides over the point until it does not. `faces_of`: the triangles around a vertex.
  void slide(const Triangles& F, const Positions& x, double friction, const std::vector<std::vector<int>>& faces_of);

  /// Before slide(): points under a face that is `carried` without them are let go, for good, where the pull along the
  /// face exceeds `friction` times that across it.
  void let_go(const Triangles& F, const Positions& x, double friction, const std::function<bool(int face)>& carried);

  const std::vector<PointContact>& contacts() const { return contacts_; }
  std::size_t point_count() const { return points_.size(); }
  const std::vector<Vec3>& points() const { return points_; }
  /// Forgets the contacts found since there were `count` of them.
  void roll_back(std::size_t count);

 private:
  /// N, on the face, with the face's corners at `x`.
  Vec3 pull_of(const PointContact& contact, const Triangles& F, const Positions& x) const;
  struct Pull {
    Vec3 normal, along;
    double across;
    bool slides(double friction) const { return along.norm() > friction * std::abs(across); }
  };
  /// pull_of along the face and across it.
  Pull pull_apart(const PointContact& contact, const Triangles& F, const Positions& x) const;
  struct Candidate {
    double fraction;
    PointContact contact;
  };
  /// What was found around a face when it was at `place`: the points within `reach_mm` of it, nearest first by a
  /// lower bound of their distance.
  struct Neighbourhood {
    std::array<Vec3, 3> place;
    double reach_mm = -1;
    struct Near {
      double distance_mm;
      int point;
    };
    std::vector<Near> points;
  };
  void survey(const std::array<Vec3, 3>& corner, double reach_mm, Neighbourhood& around) const;
  void look(const Triangles& F, int face, const Positions& from, const Positions& to, double radius_mm,
            const HeldVertices& held, double tolerance_mm, const std::function<double(int)>& clear_mm,
            std::vector<Candidate>& found);
  /// Calls visit(point) for the points in a box, ascending within each cell.
  template <class Visit>
  void collect(const Vec3& lower, const Vec3& upper, Visit&& visit) const;

  struct Cell {
    std::uint64_t key;
    int point;
  };
  std::vector<Vec3> points_;
  std::vector<Cell> cells_;  // sorted by key
  std::vector<char> used_;
  std::vector<PointContact> contacts_;
  std::vector<Neighbourhood> around_;  // per face
  /// How far the fastest vertex has come at the end of each step so far, summed up; a face need not be looked at before
  /// that is `due_mm_` (while a step is tried, with the way of the fastest vertex in it).
  double travelled_mm_ = 0;
  std::vector<double> due_mm_;
  Positions last_from_;
  double cell_mm_, stiffness_;
};

}  // namespace formwright
