// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/pieces/forest_relief.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "relief/base/group_borders.h"
#include "relief/forest/plan/wall_reach.h"

namespace formwright {
namespace {

constexpr std::size_t rays_a_chunk = 1024;
constexpr double min_room_mm = 0.06;  // along a ray: less holds no relief, and would only bend what is beside it

double depth_of(double kappa, double z, double share) { return -1 / kappa + share * (z + 1 / kappa); }

/// The piece of every ray, and the planes between them, which are upright.
class PieceBorders : public GroupBorders {
 public:
  PieceBorders(const ForestView& view, double kappa, const std::vector<WallPiece>& pieces, const ReliefSpace& space)
      : view_(view), kappa_(kappa), pieces_(pieces), space_(space) {
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (borders_.empty() || borders_.back() != pieces[k].from()) {
        groups_.push_back(-1);
        borders_.push_back(pieces[k].from());
      }
      groups_.push_back(static_cast<int>(k));
      borders_.push_back(pieces[k].to());
    }
    groups_.push_back(-1);
  }

  int bands() const override { return static_cast<int>(groups_.size()); }
  int group(int band) const override { return groups_[static_cast<std::size_t>(band)]; }
  double place(const Vec3& p) const override { return view_.ray_point(view_.to_world(p, kappa_)).aside; }
  double border(int border) const override { return borders_[static_cast<std::size_t>(border)]; }
  double off(int border, const Vec3& p) const override {
    const Vec2 world = view_.to_world(p, kappa_).head<2>();
    return view_.plan().aside(world) - this->border(border) * view_.plan().ahead(world);
  }
  std::optional<Vec2> limits(int band, int border, const Vec3& p, bool) const override {
    const WallPiece& piece = pieces_[static_cast<std::size_t>(group(band))];
    const double t = this->border(border);
    const WallReach reach = space_.reach(piece.pillar, piece.strip_at(t).edge, t);
    const double ahead = view_.ray_point(view_.to_world(p, kappa_)).ahead;
    return Vec2(depth_of(kappa_, p.z(), reach.near / ahead), depth_of(kappa_, p.z(), reach.far / ahead));
  }

 private:
  const ForestView& view_;
  double kappa_;
  const std::vector<WallPiece>& pieces_;
  const ReliefSpace& space_;
  std::vector<int> groups_;
  std::vector<double> borders_;
};

/// The piece on a ray, -1 for none. As in BaseBands::of_ray, a ray on a border belongs to what begins there.
int piece_at(const std::vector<WallPiece>& pieces, double t) {
  const auto after = std::ranges::upper_bound(pieces, t, {}, [](const WallPiece& piece) { return piece.from(); });
  if (after == pieces.begin()) return -1;
  const auto found = after - 1;
  return t < found->to() ? static_cast<int>(found - pieces.begin()) : -1;
}

}  // namespace

DepthBounds wall_bounds(const ForestView& view, const ViewFrame& frame, const ReliefSpace& space,
                        std::vector<WallPiece>& pieces, const ReliefOptions& options, const Visibility& visibility,
                        int& pieces_without_vertices, Context& context) {
  const auto n = static_cast<std::size_t>(frame.P.rows());
  std::vector<RayPoint> rays(n);
  std::vector<WallReach> reach(n);
  std::vector<int> piece(n);
  std::vector<char> held(n, 0);
  parallel_for(n, rays_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p = frame.P.row(static_cast<Eigen::Index>(i)).transpose();
      rays[i] = view.ray_point(view.to_world(p, frame.kappa));
      piece[i] = piece_at(pieces, rays[i].aside);
      if (piece[i] < 0) continue;
      const WallPiece& wall = pieces[static_cast<std::size_t>(piece[i])];
      reach[i] = space.reach(wall.pillar, wall.strip_at(rays[i].aside).edge, rays[i].aside);
      held[i] = (options.bounded_vertices == BoundedVertices::all || visibility.vertex[i] != 0) &&
                (reach[i].far - reach[i].near) * std::hypot(1, rays[i].aside) > min_room_mm;
    }
  });
  std::vector<int> vertices(pieces.size(), 0);
  for (std::size_t i = 0; i < n; ++i)
    if (held[i]) ++vertices[static_cast<std::size_t>(piece[i])];
  std::vector<int> renumbered(pieces.size(), -1);
  std::vector<WallPiece> kept;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (vertices[k] == 0) continue;
    renumbered[k] = static_cast<int>(kept.size());
    kept.push_back(pieces[k]);
  }
  pieces_without_vertices = static_cast<int>(pieces.size() - kept.size());
  pieces.swap(kept);

  DepthBounds bounds;
  bounds.nearest = bounds.farthest = frame.P.col(2);
  bounds.bounded = held;
  bounds.group.assign(n, 0);
  bounds.groups = static_cast<int>(pieces.size());
  for (std::size_t i = 0; i < n; ++i) {
    const int own = piece[i] < 0 ? -1 : renumbered[static_cast<std::size_t>(piece[i])];
    if (own >= 0) bounds.group[i] = own;
    if (!held[i]) continue;
    const auto row = static_cast<Eigen::Index>(i);
    bounds.nearest[row] = depth_of(frame.kappa, frame.P(row, 2), reach[i].near / rays[i].ahead);
    bounds.farthest[row] = depth_of(frame.kappa, frame.P(row, 2), reach[i].far / rays[i].ahead);
  }
  bounds.missed = static_cast<int>(std::ranges::count(bounds.bounded, 0));
  return bounds;
}

ForestRelief solve_on_walls(ReliefSolver& solver, const ForestView& view, const ReliefSpace& space,
                            std::vector<WallPiece> pieces, const ReliefOptions& options, Context& context) {
  ForestRelief result;
  result.pieces = std::move(pieces);
  const ViewFrame& frame = solver.frame();
  const DepthBounds bounds = wall_bounds(view, frame, space, result.pieces, options, solver.visibility(),
                                         result.pieces_without_vertices, context);
  if (result.pieces.empty())
    throw Error(ErrorCode::invalid_input, "scene",
                "The pieces of a model are narrower than its triangles: choose wider pillars, or a model with more "
                "vertices.");
  const PieceBorders borders(view, frame.kappa, result.pieces, space);
  result.relief = solver.solve(options, bounds, borders, context);
  const ReliefPieces& cut = result.relief.pieces;
  result.surface = {view.to_world(cut.V, frame.kappa), cut.F};
  for (const int band : cut.band) result.face_piece.push_back(borders.group(band));
  if (!result.surface.V.allFinite())
    throw Error(ErrorCode::could_not_solve, "",
                "The relief did not converge on these pillars: set them closer together or simplify the model.");
  if (result.surface.F.rows() > 0) result.caster = std::make_shared<const RayCaster>(result.surface);
  return result;
}

}  // namespace formwright
