// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cuts that the zipper does not close: which stretches of the ribbon's openings meet there and are closed with
// hook-and-loop tape. Thesis Sec. 5.5, Fig. 5.3.
#include <array>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "zippable/chart/parameterisation.h"
#include "zippable/parts/segmentation.h"

namespace formwright {

/// Where the surface was opened: the loop of a handle, or a slit from one opening to another. Vertices of the surface
/// along it.
struct TapedCut {
  std::vector<Vec3> points_mm;
  bool closed = true;  // the last point is joined to the first, which is not repeated
};

/// Consecutive vertices of the ribbon's boundary on one side of a cut.
struct ClosureRun {
  int first_vertex = 0;          // the next ones follow on the boundary, which begins again behind its last vertex
  std::vector<double> along_mm;  // per vertex, at least two: along the cut, rising or falling
  int edge_count() const { return static_cast<int>(along_mm.size()) - 1; }
};

/// A cut and its two sides. Both have a vertex wherever one of them has: edges between equal `along_mm` are equally
/// long and meet.
struct HandleClosure {
  double length_mm = 0;  // of the cut on the model: along_mm runs from 0 to it
  bool closed = true;    // a loop, whose ends meet
  /// Where the cut runs with the surface to its left (along_mm rises) and to its right (it falls).
  std::array<std::vector<ClosureRun>, 2> sides;
};

/// A stretch of the ribbon's boundary along an opening, between two ends of the zipper.
struct OpeningArc {
  int part = 0;
  bool upper = true;                   // of the part's lines
  double from_mm = 0, to_mm = 0;       // x of both ends, as the boundary is walked
  std::vector<double> places_mm = {};  // x of the corners between
  std::vector<int> grid = {};          // per corner: the place of the part's grid that it is ruled to; no_grid: none
  int first_vertex = 0;                // of the boundary: the end where it begins
};

class TapedCuts {
 public:
  /// Edges of openings belong to the cut that they are copies of: vertices on cuts keep their positions bit by bit
  /// through the division.
  TapedCuts(const Segmentation& segmentation, const Parameterisation& parameterisation,
            const std::vector<TapedCut>& cuts);

  bool empty() const { return cuts_.empty(); }

  /// Gives arcs on both sides of a cut their corners at the same places of it: at both sides' ends of the zipper, where
  /// slits meet it, and where the left side had its own, `grid_step_mm` (per part) apart or more, unless that is closer
  /// than 0.3 `sample_mm` to one of these.
  void share_places(std::vector<OpeningArc>& arcs, const std::vector<double>& grid_step_mm, double sample_mm);

  /// Of arcs with shared places; `vertex_count` of the ribbon's boundary. A loop's along_mm begins at an end of the
  /// zipper on its left side.
  std::vector<HandleClosure> closures(const std::vector<OpeningArc>& arcs, int vertex_count) const;

 private:
  struct Span {
    double from_mm, to_mm;  // x, ascending
    int cut, side;
    double along_from_mm, along_to_mm;
    double along_at(double x_mm) const {
      return along_from_mm + (x_mm - from_mm) / (to_mm - from_mm) * (along_to_mm - along_from_mm);
    }
  };
  struct Place {
    int cut, side;
    double along_mm;
  };
  struct Cut {
    bool closed = true;
    double length_mm = 0, origin_mm = 0;
    std::vector<double> corners_mm, shared_mm;  // along it
    double apart_mm(double a, double b) const;
  };

  const std::vector<Span>& line(int part, bool upper) const;
  /// On the span that holds the path from x towards another place.
  std::optional<Place> at(int part, bool upper, double x_mm, double towards_mm) const;
  void place_on(OpeningArc& arc, double grid_step_mm) const;
  double from_origin_mm(const Cut& cut, double along_mm, double near_mm) const;

  std::map<std::pair<int, bool>, std::vector<Span>> lines_;  // by part and whether upper
  std::vector<double> period_mm_;
  std::vector<Cut> cuts_;
};

}  // namespace formwright
