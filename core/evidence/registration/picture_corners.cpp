// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/registration/picture_corners.h"

#include <cmath>

#include "geometry/planar/plane.h"
#include "base/error.h"
#include "base/data/number_list.h"

namespace formwright {

std::array<Vec2, 4> plane_corners(const std::string& text, const Model& scan, const ScanColours& colours,
                                  const TextureCoordinates& flat_mm) {
  const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_input, "corners", message); };
  const auto numbers = read_number_list(text);
  if (!numbers || numbers->size() != 8)
    refuse("The corners must be four pairs of numbers, such as “120,80 1900,95 1880,2010 110,1990”.");
  if (scan.FT.rows() != scan.mesh.F.rows())
    refuse("The scan has no picture, so corners in pixels cannot be used: leave them out.");
  std::array<Vec2, 4> places;
  for (std::size_t k = 0; k < 4; ++k) {
    bool found = false;
    for (int f = 0; f < scan.mesh.face_count() && !found; ++f) {
      if (colours.width(f) == 0) continue;
      const Vec2 uv((*numbers)[2 * k] / colours.width(f), 1 - (*numbers)[2 * k + 1] / colours.height(f));
      const Vec2 a = scan.UV.row(scan.FT(f, 0)), b = scan.UV.row(scan.FT(f, 1)), c = scan.UV.row(scan.FT(f, 2));
      const double doubled = cross(b - a, c - a);
      if (!(std::abs(doubled) > 1e-16)) continue;
      const Vec3 bary(cross(b - uv, c - uv) / doubled, cross(c - uv, a - uv) / doubled,
                      cross(a - uv, b - uv) / doubled);
      if (bary.minCoeff() < -1e-9) continue;
      places[k].setZero();
      for (int i = 0; i < 3; ++i) places[k] += bary[i] * flat_mm.row(scan.mesh.F(f, i)).transpose();
      found = true;
    }
    if (!found)
      refuse("Corner " + std::to_string(k + 1) +
             " lies on no part of the scan: give pixels of its picture, counted from the top left.");
  }
  return places;
}

std::array<std::optional<Vec2>, 4> picture_corners(const std::array<Vec2, 4>& place_mm, const Model& scan,
                                                   const ScanColours& colours, const TextureCoordinates& flat_mm) {
  std::array<std::optional<Vec2>, 4> pixels;
  if (scan.FT.rows() != scan.mesh.F.rows()) return pixels;
  const PlaneLookup lookup(scan.mesh.F, flat_mm);
  for (std::size_t k = 0; k < 4; ++k) {
    const PlaneLookup::Found found = lookup.find(place_mm[k]);
    if (found.face < 0 || colours.width(found.face) == 0) continue;
    Vec2 uv = Vec2::Zero();
    for (int i = 0; i < 3; ++i) uv += found.barycentric[i] * scan.UV.row(scan.FT(found.face, i)).transpose();
    pixels[k] = Vec2(uv.x() * colours.width(found.face), (1 - uv.y()) * colours.height(found.face));
  }
  return pixels;
}

}  // namespace formwright
