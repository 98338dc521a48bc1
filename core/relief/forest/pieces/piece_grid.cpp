// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/pieces/piece_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double proud_mm = 0.05, proud_share = 0.1;  // of the thickness, where that is less
constexpr std::size_t rows_a_chunk = 8;

double edge_length(const Pillar& pillar, int edge) {
  return (corner(pillar.outline_mm, edge + 1) - corner(pillar.outline_mm, edge)).norm();
}

/// Places on an edge from the left to the right end of a strip.
struct StripPlaces {
  int edge;
  double from, to;
};

std::vector<StripPlaces> places_of(const PlanView& plan, const Pillar& pillar, const WallPiece& piece,
                                   double inset_mm) {
  std::vector<StripPlaces> places;
  for (const WallStrip& s : piece.strips)
    places.push_back({s.edge, place_on_edge(plan, pillar, s.edge, s.from), place_on_edge(plan, pillar, s.edge, s.to)});
  const auto inset = [&](const StripPlaces& at) {
    return std::min(inset_mm / edge_length(pillar, at.edge), 0.25 * (at.to - at.from));
  };
  places.front().from += inset(places.front());
  places.back().to -= inset(places.back());
  return places;
}

int steps_of(double length_mm, double pixel_mm) {
  return std::max(1, static_cast<int>(std::ceil(length_mm / pixel_mm - 1e-9)));
}

class RayDepth {
 public:
  RayDepth(const ForestRelief& relief, int piece, const ForestView& view)
      : relief_(relief), piece_(piece), view_(view) {
    far_ = 2 * (relief.surface.V.rowwise() - view.eye().transpose()).rowwise().norm().maxCoeff();
  }
  /// Distance ahead at which a ray meets the piece; nothing where it does not.
  std::optional<double> operator()(double aside, double above) const {
    const Vec3 direction = view_.ray_direction(aside, above);
    const auto hit = relief_.caster->first_hit(view_.eye(), direction, 0, far_);
    if (!hit || relief_.face_piece[static_cast<std::size_t>(hit->face)] != piece_) return std::nullopt;
    return hit->distance * view_.plan().forward.dot(direction.head<2>());
  }

 private:
  const ForestRelief& relief_;
  int piece_;
  const ForestView& view_;
  double far_ = 0;
};

/// Nodes beside the silhouette that their rays miss get the mean of their neighbours.
void fill_missed(PieceGrid& grid, const std::vector<char>& hit, const std::vector<double>& otherwise) {
  const std::vector<double> met = grid.front;
  for (int row = 0; row < grid.rows(); ++row)
    for (int column = 0; column < grid.columns(); ++column) {
      if (hit[grid.node(column, row)]) continue;
      double sum = 0;
      int count = 0;
      for (int r = std::max(0, row - 1); r <= std::min(grid.rows() - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(grid.columns() - 1, column + 1); ++c)
          if (hit[grid.node(c, r)]) {
            sum += met[grid.node(c, r)];
            ++count;
          }
      const auto at = static_cast<std::size_t>(column);
      grid.front[grid.node(column, row)] =
          count > 0 ? std::clamp(sum / count, std::min(grid.reach[at].near, otherwise[at]), otherwise[at])
                    : grid.reach[at].surface;
    }
}

/// Sight may end between two columns, and triangles join them: both have the space that the narrower one has.
void narrow_to_neighbours(std::vector<WallReach>& columns, std::vector<WallReach>& middles) {
  const auto room = [](const WallReach& reach) { return reach.surface - reach.near; };
  std::vector<double> narrowest;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    narrowest.push_back(room(columns[c]));
    for (const std::size_t m : {c - 1, c})
      if (m < middles.size())
        narrowest.back() = std::min({narrowest.back(), room(middles[m]), room(columns[m]), room(columns[m + 1])});
  }
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c].near = columns[c].surface - narrowest[c];
  for (std::size_t m = 0; m < middles.size(); ++m)
    middles[m].near = middles[m].surface - std::min({room(middles[m]), narrowest[m], narrowest[m + 1]});
}

}  // namespace

void part_crosswise_cells(std::vector<char>& covered, int columns, int rows) {
  const auto at = [&](int column, int row) -> char& {
    return covered[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns - 1) +
                   static_cast<std::size_t>(column)];
  };
  for (bool changes = true; changes;) {
    changes = false;
    for (int row = 1; row + 1 < rows; ++row)
      for (int column = 1; column + 1 < columns; ++column) {
        char &lower_left = at(column - 1, row - 1), &lower_right = at(column, row - 1);
        const char upper_left = at(column - 1, row), upper_right = at(column, row);
        if (lower_left != upper_right || lower_right != upper_left || lower_left == lower_right) continue;
        (lower_left ? lower_left : lower_right) = 0;
        changes = true;
      }
  }
}

bool PieceGrid::any_covered() const {
  return std::ranges::any_of(covered, [](char cell_covered) { return cell_covered != 0; });
}

double node_count(const PlanView& plan, const Pillar& pillar, const WallPiece& piece, const PieceGridSizes& sizes) {
  double columns = 1;
  for (const StripPlaces& s : places_of(plan, pillar, piece, sizes.border_inset_mm))
    columns += std::ceil((s.to - s.from) * edge_length(pillar, s.edge) / sizes.pixel_mm);
  return columns * std::ceil(pillar.height_mm / sizes.pixel_mm + 1);
}

PieceGrid piece_grid(const ForestRelief& relief, int piece, const ForestView& view, const ReliefSpace& space,
                     const PieceGridSizes& sizes, const Context& context) {
  const WallPiece& wall = relief.pieces[static_cast<std::size_t>(piece)];
  const Pillar& pillar = space.pillar(wall.pillar);
  const PlanView& plan = view.plan();
  PieceGrid grid;
  grid.pillar = wall.pillar;
  grid.piece = piece;
  std::vector<int> edge;  // of each column
  for (const StripPlaces& s : places_of(plan, pillar, wall, sizes.border_inset_mm)) {
    const int steps = steps_of((s.to - s.from) * edge_length(pillar, s.edge), sizes.pixel_mm);
    const Vec2 &a = corner(pillar.outline_mm, s.edge), &b = corner(pillar.outline_mm, s.edge + 1);
    for (int k = grid.aside.empty() ? 0 : 1; k <= steps; ++k) {
      grid.aside.push_back(plan.tangent(a + (s.from + (s.to - s.from) * k / steps) * (b - a)));
      edge.push_back(s.edge);
    }
  }
  const auto reach_at = [&](double aside, int on_edge) { return space.reach(wall.pillar, on_edge, aside); };
  for (std::size_t c = 0; c < grid.aside.size(); ++c) grid.reach.push_back(reach_at(grid.aside[c], edge[c]));
  const double bottom = sizes.border_inset_mm, top = pillar.height_mm - sizes.border_inset_mm;
  const int row_steps = steps_of(top - bottom, sizes.pixel_mm);
  for (int k = 0; k <= row_steps; ++k) grid.z_mm.push_back(bottom + (top - bottom) * k / row_steps);

  const double eye_z = view.eye().z(), proud = std::min(proud_mm, proud_share * space.space().above_mm);
  // Distances ahead are shorter than those along the ray by the length of its direction.
  const auto farthest = [&](const WallReach& reach, double aside) {
    return space.space().below_mm > 0 ? reach.far : reach.surface - proud / std::sqrt(1 + aside * aside);
  };
  std::vector<double> limit, middle_aside;
  std::vector<WallReach> middle_reach;
  for (std::size_t c = 1; c < grid.aside.size(); ++c) {
    middle_aside.push_back(0.5 * (grid.aside[c - 1] + grid.aside[c]));
    middle_reach.push_back(reach_at(middle_aside.back(), edge[c]));
  }
  narrow_to_neighbours(grid.reach, middle_reach);
  for (std::size_t c = 0; c < grid.aside.size(); ++c) limit.push_back(farthest(grid.reach[c], grid.aside[c]));
  const RayDepth depth(relief, piece, view);
  const std::size_t columns = grid.aside.size(), rows = grid.z_mm.size();
  grid.front.assign(columns * rows, 0);
  grid.covered.assign((columns - 1) * (rows - 1), 0);
  grid.middle_front.assign(grid.covered.size(), 0);
  std::vector<char> hit(grid.front.size(), 0);
  const auto stands_within = [&](double ahead, double z, double surface) {
    const double front_z = eye_z + (z - eye_z) / surface * ahead;
    return front_z > 0 && front_z < pillar.height_mm;
  };
  parallel_for(rows, rows_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t row = begin; row < end; ++row) {
      for (std::size_t c = 0; c < columns; ++c) {
        const WallReach& reach = grid.reach[c];
        const std::size_t node = row * columns + c;
        grid.front[node] = reach.surface;
        if (const auto met = depth(grid.aside[c], (grid.z_mm[row] - eye_z) / reach.surface)) {
          grid.front[node] = std::clamp(*met, std::min(reach.near, limit[c]), limit[c]);
          hit[node] = 1;
        }
      }
      if (row + 1 == rows) continue;
      const double z = 0.5 * (grid.z_mm[row] + grid.z_mm[row + 1]);
      for (std::size_t c = 0; c + 1 < columns; ++c) {
        const WallReach& reach = middle_reach[c];
        const auto met = depth(middle_aside[c], (z - eye_z) / reach.surface);
        if (!met) continue;
        const double last = farthest(reach, middle_aside[c]);
        if (reach.near >= last) continue;
        const double ahead = std::clamp(*met, std::min(reach.near, last), last);
        const std::size_t cell = row * (columns - 1) + c;
        grid.middle_front[cell] = ahead;
        grid.covered[cell] = stands_within(ahead, z, reach.surface);
      }
    }
  });
  part_crosswise_cells(grid.covered, grid.columns(), grid.rows());
  fill_missed(grid, hit, limit);
  return grid;
}

}  // namespace formwright
