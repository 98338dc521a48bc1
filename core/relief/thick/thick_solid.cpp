// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/thick/thick_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "geometry/booleans/booleans.h"
#include "geometry/mesh/adjacency.h"
#include "geometry/mesh/file_grid.h"
#include "geometry/mesh/measures.h"
#include "geometry/offset/thick_surface.h"

namespace formwright {
namespace {

constexpr double opening_share = 0.5;  // of the wall: the wrap then reaches 13 % farther than the wall
// Of the plate's diagonal and the relief's height: a wall thinner than this is made of triangles of this size, which
// bounds their number.
constexpr double min_opening_share = 1.0 / 400;

/// Lengths chosen so that no faces, edges or corners of the booleans' solids lie in one plane. Others are tried where
/// parts would touch in a single edge or point all the same.
struct Shift {
  double plate_rise;    // of the wall: how far the plate's front lies before that of the front solid
  double beyond_plate;  // of a pixel: how far the front solid reaches beyond the plate
};
constexpr std::array<Shift, 3> shifts{Shift{1e-3, 2.37}, Shift{1.37e-3, 2.71}, Shift{2.11e-3, 3.13}};

/// What happens to heights over the plate's front under the homography that makes rays parallel.
struct Rays {
  double kappa_per_mm;
  double straightened(double height_mm) const { return height_mm / (1 - kappa_per_mm * height_mm); }
  /// By which x and y are multiplied where a height is brought back.
  double narrowing(double straightened_mm) const { return 1 / (1 + kappa_per_mm * straightened_mm); }
};

/// The border of the grid is bare: no place of the surface is seen outside the plate.
void lay_border_bare(HeightMap& map) {
  for (int column = 0; column < map.columns; ++column) map.at(0, column) = map.at(map.rows - 1, column) = 0;
  for (int row = 0; row < map.rows; ++row) map.at(row, 0) = map.at(row, map.columns - 1) = 0;
}

/// Everything behind the surface as seen from the viewpoint, and a plate somewhat larger than that of the relief.
TriangleMesh front_solid(const Positions& moved, const Triangles& F, double kappa, const ThickSolidOptions& options,
                         double beyond_pixels, Context& context) {
  const Rays rays{kappa / options.size_mm};
  Positions straight(moved.rows(), 3);
  for (Eigen::Index i = 0; i < moved.rows(); ++i) straight.row(i) = moved.row(i) / (1 + kappa * moved(i, 2));
  const BaseSurface flat;
  const double below_mm = -rays.straightened(-options.below_mm);
  const AllowedSpace space{flat, rays.straightened(options.above_mm), below_mm};
  // What is carved lies farther out than where its ray meets the plate's front.
  const double half_mm = 0.5 * std::max(options.plate.width_mm, options.plate.height_mm),
               beyond_mm = beyond_pixels * options.pixel_mm + half_mm * (rays.narrowing(-below_mm) - 1);
  const PlateSize plate{options.plate.width_mm + 2 * beyond_mm, options.plate.height_mm + 2 * beyond_mm};
  HeightMap map = make_height_map({straight, F}, options.size_mm, plate, options.pixel_mm, space, context);
  lay_border_bare(map);
  const double front_mm = options.plate_mm + options.below_mm;  // of the plate, above its back
  TriangleMesh solid = make_solid(map, front_mm + map.floor_mm, options.tolerance_mm, context);
  if (solid.F.rows() > options.max_front_triangles)
    throw Error(ErrorCode::invalid_input, "pixel_mm",
                "The front of the thick surface would have " + std::to_string(solid.F.rows()) +
                    " triangles, and at most " + std::to_string(options.max_front_triangles) +
                    " can be joined to its plate: raise the detail spacing (pixel_mm) "
                    "or lower the width.");
  const Vec2 middle_mm(0.5 * plate.width_mm, 0.5 * plate.height_mm);
  for (Eigen::Index i = 0; i < solid.V.rows(); ++i) {
    Vec2 across = solid.V.row(i).head<2>().transpose() - middle_mm;
    double height_mm = solid.V(i, 2) - front_mm;
    if (solid.V(i, 2) > 0) {  // the back stays as it is
      const double narrowing = rays.narrowing(height_mm);
      across *= narrowing;
      height_mm *= narrowing;
    }
    solid.V.row(i) << across.x() + 0.5 * options.plate.width_mm, across.y() + 0.5 * options.plate.height_mm, height_mm;
  }
  return solid;
}

/// The surface, mm, the plate's lower left corner at x = y = 0 and its front at z = 0. What is deeper than the plate is
/// moved along its ray to the plate's back: it is inside the plate either way.
TriangleMesh lying_surface(const Positions& moved, const Triangles& F, double kappa, double back_mm,
                           const ThickSolidOptions& options) {
  TriangleMesh surface{Positions(moved.rows(), 3), F};
  const double deepest = back_mm / options.size_mm;
  for (Eigen::Index i = 0; i < moved.rows(); ++i) {
    Vec3 p = moved.row(i).transpose();
    if (p.z() > deepest) {
      const double stretch = (1 + kappa * deepest) / (1 + kappa * p.z());
      p = Vec3(p.x() * stretch, p.y() * stretch, deepest);
    }
    surface.V.row(i) = options.size_mm * p.transpose();
  }
  surface.V.col(0).array() += 0.5 * options.plate.width_mm;
  surface.V.col(1).array() += 0.5 * options.plate.height_mm;
  surface.V.col(2) *= -1;
  return surface;
}

TriangleMesh box(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh;
  mesh.V.resize(8, 3);
  for (int i = 0; i < 8; ++i)
    mesh.V.row(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(), (i & 4 ? high : low).z();
  mesh.F.resize(12, 3);
  mesh.F << 0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5;
  return mesh;
}

/// Drops parts and hollows of less than `min_volume_mm3`, and counts the others. The signed volume that a connected
/// part of the solid's surface encloses is positive for the outside of a part and negative for a hollow.
void count_parts(ThickSolid& solid, double min_volume_mm3) {
  TriangleMesh& mesh = solid.mesh;
  const Components parts = face_components(Adjacency(mesh));
  std::vector<double> volume(static_cast<std::size_t>(parts.count), 0.0);
  const auto part_of = [&](Eigen::Index f) { return static_cast<std::size_t>(parts.of[static_cast<std::size_t>(f)]); };
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const auto corner = [&](int k) { return Vec3(mesh.V.row(mesh.F(f, k)).transpose()); };
    volume[part_of(f)] += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  Eigen::Index kept = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f)
    if (std::abs(volume[part_of(f)]) >= min_volume_mm3) mesh.F.row(kept++) = mesh.F.row(f);
  mesh.F.conservativeResize(kept, 3);
  for (const double v : volume) {
    if (std::abs(v) < min_volume_mm3) continue;
    solid.volume_mm3 += v;
    ++(v < 0 ? solid.hollows : solid.loose_parts);
  }
  --solid.loose_parts;  // the one with the plate
}

}  // namespace

ThickSolid thick_solid(const Positions& moved, const Triangles& F, double kappa, const ThickSolidOptions& options,
                       Context& context) {
  const double back_mm = options.plate_mm + options.below_mm;
  ThickSolid result;
  const double diagonal_mm = std::hypot(options.plate.width_mm, options.plate.height_mm, options.above_mm + back_mm);
  result.opening_mm = std::max(opening_share * options.wall_mm, min_opening_share * diagonal_mm);
  ThickSurface wall;
  {
    const auto span = context.span(0, 0.4, "Giving the surface a wall");
    wall = thick_surface(lying_surface(moved, F, kappa, back_mm, options),
                         {.wall_mm = options.wall_mm, .opening_mm = result.opening_mm}, context);
  }
  const auto joined = [&](const Shift& shift) {
    const double plate_rise_mm = shift.plate_rise * options.wall_mm;
    const double beyond_mm = wall.reach_mm + back_mm, high_mm = options.above_mm + beyond_mm;
    const Vec3 corner(options.plate.width_mm, options.plate.height_mm, 0), beyond(beyond_mm, beyond_mm, 0);
    const auto solid_box = [&](const Vec3& low, const Vec3& high) {
      return ExactSolid::from_mesh(box(low, high), "mesh", context);
    };
    const ExactSolid behind = [&] {
      const auto span = context.span(0.4, 0.7, "Joining wall and plate");
      const ExactSolid whole = unite(ExactSolid::from_mesh(wall.mesh, "mesh", context),
                                     solid_box(-beyond - beyond_mm * Vec3::UnitZ() - back_mm * Vec3::UnitZ(),
                                               corner + beyond + plate_rise_mm * Vec3::UnitZ()),
                                     context);
      return intersect(whole, solid_box(-(back_mm + 0.5 * beyond_mm) * Vec3::UnitZ(), corner + high_mm * Vec3::UnitZ()),
                       context);
    }();
    const auto span = context.span(0.7, 1, "Cutting the solid to what is seen");
    const TriangleMesh front = front_solid(moved, F, kappa, options, shift.beyond_plate, context);
    return intersect(behind, ExactSolid::from_mesh(front, "mesh", context), context);
  };
  for (std::size_t attempt = 0;; ++attempt) {
    try {
      result.mesh = joined(shifts.at(attempt)).mesh();
      break;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      if (attempt + 1 == shifts.size())
        throw Error(
            ErrorCode::could_not_solve, "wall_mm",
            "Parts of the thick surface touch each other along an edge or at a point only, which no printable "
            "solid may: change wall_mm or pixel_mm by a few hundredths of a millimetre, or make the solid filled.");
    }
  }
  result.mesh.V.col(2).array() += back_mm;
  // What the grid of rays leaves of a thin place: smaller than its cells.
  count_parts(result, std::pow(options.pixel_mm, 3));
  result.mesh = on_file_grid(result.mesh);
  return result;
}

}  // namespace formwright
