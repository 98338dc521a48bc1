// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The constraints (5.2) to (5.4) of the thesis solved by substitution: every coordinate of every triangle corner is
// a sum of at most one variable of its own and a few that whole parts share, so that whatever values the variables
// take, seams match, lines are straight and interfaces meet under a half turn.
//
// Variables: x and y of a vertex inside a part; x on an opening (its height is shared); one position along an
// interface, which is x on both sides, from either end. Shared: the height of each part (its lower line lies at 0), the
// length of each interface, or the period of a part that is alone. A corner on the left of a part's cut gets the period
// on top.
#include <Eigen/Core>
#include <array>
#include <map>
#include <vector>

#include "zippable/parts/segmentation.h"

namespace formwright {

using CornerCoordinates =
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;  // corner 3 f + k of face f a row, mm

struct SharedTerm {
  int shared;  // index of a shared variable
  double factor;
  bool operator<(const SharedTerm& other) const {
    return shared != other.shared ? shared < other.shared : factor < other.factor;
  }
};

/// sign * local variable + sum of shared ones.
struct ChartCoordinate {
  int local = -1;  // -1: none
  double sign = 1;
  int terms = 0;  // index into the chart's sums; 0 is the empty one
};

class SeamlessChart {
 public:
  /// Needs a valid segmentation. Throws Error{could_not_solve, "mesh"} when a part cannot be cut from line to line.
  explicit SeamlessChart(const Segmentation& segmentation);

  int local_count() const { return local_count_; }
  int shared_count() const { return shared_count_; }
  int face_count() const { return static_cast<int>(corners_.size() / 3); }
  const ChartCoordinate& coordinate(int corner, int axis) const { return corners_[corner][axis]; }
  const std::vector<SharedTerm>& sum(int terms) const { return sums_[terms]; }

  /// The corners of a choice of variables (linear, without a constant part). Parallel.
  CornerCoordinates corners(const Eigen::VectorXd& local, const Eigen::VectorXd& shared) const;

  int height_of(int part) const { return part; }  // shared variable
  int length_of(int interface) const {
    return part_count_ + interface;
  }  // shared variable; of a part alone, 0 is its period
  double period_mm(int part, const Eigen::VectorXd& shared) const;

  /// Variables along the interfaces: (interface, place in its vertices, local variable).
  struct InterfaceVariable {
    int interface, place, local;
  };
  const std::vector<InterfaceVariable>& interface_variables() const { return interface_variables_; }

 private:
  int intern(std::vector<SharedTerm> sum);
  void place_lines(const Segmentation& s);
  void cut_part(const Segmentation& s, const Adjacency& adjacency, int part, std::vector<char>& shifted) const;

  int part_count_ = 0, local_count_ = 0, shared_count_ = 0;
  std::vector<std::array<ChartCoordinate, 2>> corners_;
  std::vector<std::vector<SharedTerm>> sums_;
  std::map<std::vector<SharedTerm>, int> known_;
  std::vector<std::vector<SharedTerm>> periods_;
  std::vector<InterfaceVariable> interface_variables_;
  std::vector<std::vector<int>> interface_locals_;
};

}  // namespace formwright
