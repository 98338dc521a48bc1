// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/pieces/pillar_solid.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "base/format.h"
#include "geometry/booleans/booleans.h"
#include "geometry/mesh/file_grid.h"
#include "geometry/mesh/measures.h"
#include "imaging/drawing/drawing.h"

namespace formwright {
namespace {

constexpr int pin_corners = 48;
constexpr double pin_wall_mm = 0.5;                         // of pillar around the pin
constexpr double mark_width_mm = 0.8, mark_depth_mm = 0.5;  // of the groove
constexpr double number_height_mm = 2.2, number_stroke_mm = 0.4, number_depth_mm = 0.4, number_gap_mm = 0.5;
constexpr double max_into_pillar_mm = 2, into_pillar_share = 0.25;

/// From the pin to beyond the outline.
TriangleMesh mark_groove(const Pillar& pillar, const Vec2& pin) {
  double end = pin.y();
  for (const Vec2& p : pillar.outline_mm) end = std::max(end, p.y());
  const double half = 0.5 * mark_width_mm;
  const Outline groove{
      {pin.x() - half, pin.y()}, {pin.x() + half, pin.y()}, {pin.x() + half, end + 1}, {pin.x() - half, end + 1}};
  return prism(groove, -mark_depth_mm, std::min(mark_depth_mm, into_pillar_share * pillar.height_mm));
}

/// Grooves of the number in the underside, on the other side of the pin than the mark, mirrored to be read from below.
/// None where there is no room for them.
std::vector<TriangleMesh> number_grooves(const Pillar& pillar, int number, const Vec2& pin, double pin_diameter_mm) {
  const Vec2 middle = pin - Vec2(0, 0.5 * pin_diameter_mm + number_gap_mm + 0.5 * number_height_mm);
  std::vector<TriangleMesh> grooves;
  for (const Stroke& stroke : outlined({Vec2::Zero(), number_height_mm, std::to_string(number)}).strokes) {
    const auto placed = [&](const Vec2& p) { return Vec2(middle.x() - p.x(), middle.y() + p.y()); };
    const Vec2 from = placed(stroke.from), to = placed(stroke.to), along = (to - from).normalized(),
               half(-0.5 * number_stroke_mm * along.y(), 0.5 * number_stroke_mm * along.x());
    const Vec2 begin = from - 0.5 * number_stroke_mm * along, end = to + 0.5 * number_stroke_mm * along;
    const Outline groove{begin - half, end - half, end + half, begin + half};
    for (const Vec2& p : groove)
      if (!is_inside(pillar.outline_mm, p) || distance_to_outline(pillar.outline_mm, p) < number_stroke_mm) return {};
    grooves.push_back(prism(groove, -number_depth_mm, std::min(number_depth_mm, into_pillar_share * pillar.height_mm)));
  }
  return grooves;
}

/// The largest part: carving can cut crumbs loose, and pieces can enclose hollows.
TriangleMesh largest_part(const TriangleMesh& mesh) {
  const std::vector<int> part = vertex_components(Adjacency(mesh)).of;
  std::map<int, double> volume;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    const Vec3 a = mesh.V.row(mesh.F(f, 0)), b = mesh.V.row(mesh.F(f, 1)), c = mesh.V.row(mesh.F(f, 2));
    volume[part[static_cast<std::size_t>(mesh.F(f, 0))]] += a.dot(b.cross(c));
  }
  if (volume.size() < 2) return mesh;
  const int largest = std::ranges::max_element(volume, {}, [](const auto& one) { return one.second; })->first;
  TriangleMesh result;
  std::vector<int> moved(part.size(), -1);
  std::vector<Vec3> places;
  result.F.resize(mesh.F.rows(), 3);
  Eigen::Index faces = 0;
  for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
    if (part[static_cast<std::size_t>(mesh.F(f, 0))] != largest) continue;
    for (int k = 0; k < 3; ++k) {
      int& vertex = moved[static_cast<std::size_t>(mesh.F(f, k))];
      if (vertex < 0) {
        vertex = static_cast<int>(places.size());
        places.emplace_back(mesh.V.row(mesh.F(f, k)));
      }
      result.F(faces, k) = vertex;
    }
    ++faces;
  }
  result.F.conservativeResize(faces, 3);
  result.V.resize(static_cast<Eigen::Index>(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) result.V.row(static_cast<Eigen::Index>(i)) = places[i].transpose();
  return result;
}

}  // namespace

Vec2 checked_pin_place(const Pillar& pillar, int number, const BasePin& pin) {
  const Vec2 place = place_of_pin(pillar.outline_mm);
  const double room = is_inside(pillar.outline_mm, place) ? distance_to_outline(pillar.outline_mm, place) : 0;
  if (room < 0.5 * pin.diameter_mm + pin_wall_mm)
    throw Error(ErrorCode::invalid_input, "pin_diameter_mm",
                "Pillar " + std::to_string(number) + " is too narrow for its pin: make the pin at most " +
                    with_digits(std::max(0.0, std::floor(20 * (room - pin_wall_mm)) / 10), 3) +
                    " mm thick, or the pillar wider.");
  // On the grid of files, so that the solid can be moved to its pin without rounding.
  constexpr double steps_a_mm = 1024;
  return (place * steps_a_mm).array().round() / steps_a_mm;
}

PillarSolid pillar_solid(const Pillar& pillar, int number, const BasePin& pin, std::span<const PieceSolids> pieces,
                         Context& context) {
  PillarSolid result;
  result.pin_mm = checked_pin_place(pillar, number, pin);
  const auto exact = [&](const TriangleMesh& mesh) { return ExactSolid::from_mesh(mesh, "scene", context); };
  const double into_pillar = std::min(max_into_pillar_mm, into_pillar_share * pillar.height_mm);
  // Grooves are cut first: they must not go into the pin.
  ExactSolid solid = subtract(exact(prism(pillar.outline_mm, 0, pillar.height_mm)),
                              exact(mark_groove(pillar, result.pin_mm)), context);
  for (const TriangleMesh& groove : number_grooves(pillar, number, result.pin_mm, pin.diameter_mm))
    solid = subtract(solid, exact(groove), context);
  solid =
      unite(solid, exact(prism(round_outline(result.pin_mm, pin.diameter_mm, pin_corners), -pin.depth_mm, into_pillar)),
            context);
  for (const PieceSolids& piece : pieces)
    if (piece.room.F.rows() > 0) solid = subtract(solid, exact(piece.room), context);
  for (const PieceSolids& piece : pieces) solid = unite(solid, exact(piece.raised), context);
  result.mesh = largest_part(on_file_grid(solid.mesh()));
  result.volume_mm3 = signed_volume(result.mesh);
  result.watertight = Adjacency(result.mesh).is_closed();
  return result;
}

}  // namespace formwright
