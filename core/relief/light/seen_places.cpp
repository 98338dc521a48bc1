// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/seen_places.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/index.h"
#include "base/parallel.h"
#include "geometry/mesh/measures.h"

namespace formwright {
namespace {

constexpr std::size_t sight_rows_per_chunk = 8;

struct Sight {
  Vec3 from, direction;
};

/// Lines of sight through the pixels of a view, past a box.
class Eye {
 public:
  Eye(const PictureView& view, const LitObject& object) : view_(view) {
    const double angle = view.aside_deg * std::numbers::pi / 180;
    towards_ = Vec3(std::sin(angle), 0, std::cos(angle));
    right_ = Vec3(std::cos(angle), 0, -std::sin(angle));
    const double reach = std::max(object.low.cwiseAbs().maxCoeff(), object.high.cwiseAbs().maxCoeff());
    start_ = 4 * reach + 4 * view.pixel_mm * std::max(view.columns, view.rows);
  }

  Sight through(int row, int column) const {
    const Vec3 point = (column + 0.5 - 0.5 * view_.columns) * view_.pixel_mm * right_ +
                       Vec3(0, (row + 0.5 - 0.5 * view_.rows) * view_.pixel_mm, 0);
    if (view_.distance_mm <= 0) return {point + start_ * towards_, -towards_};
    const Vec3 eye = view_.distance_mm * towards_;
    return {eye, (point - eye).normalized()};
  }

 private:
  const PictureView& view_;
  Vec3 towards_, right_;
  double start_;
};

/// visit(pixel, sight, hit or nothing) for every pixel, on several threads.
template <class Visit>
void for_pixels(const PictureView& view, const LitObject& object, Context& context, const Visit& visit) {
  const Eye eye(view, object);
  parallel_for(index(view.rows), sight_rows_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      context.check_cancelled();
      for (int column = 0; column < view.columns; ++column) {
        const Sight sight = eye.through(static_cast<int>(row), column);
        visit(row * index(view.columns) + index(column), sight,
              object.rays->first_hit(sight.from, sight.direction, 0, INFINITY));
      }
    }
  });
}

int pixels_across(double length_mm, double pixel_mm) {
  return std::max(1, static_cast<int>(std::lround(length_mm / pixel_mm)));
}

}  // namespace

PictureView picture_of_plate(PlateSize plate, double pixel_mm, double distance_mm) {
  return {distance_mm, 0, pixels_across(plate.width_mm, pixel_mm), pixels_across(plate.height_mm, pixel_mm), pixel_mm};
}

PictureView picture_around(const LitObject& solid, double pixel_mm, double distance_mm, double aside_deg) {
  const Vec3 reach = solid.low.cwiseAbs().cwiseMax(solid.high.cwiseAbs());
  const double aside = std::hypot(reach.x(), reach.z());
  double half_width = aside, half_height = reach.y();
  if (distance_mm > 0) {
    // A cylinder about the upright: its outline, and its nearest place.
    const double distance = std::max(distance_mm, 2 * aside);
    half_width *= distance / std::sqrt(distance * distance - aside * aside);
    half_height *= distance / (distance - aside);
  }
  return {distance_mm, aside_deg, pixels_across(2 * half_width, pixel_mm), pixels_across(2 * half_height, pixel_mm),
          pixel_mm};
}

std::vector<double> SeenRelief::values(const LitRelief& relief, const std::vector<double>& of_nodes) const {
  std::vector<double> result(covered.size(), 0);
  for (std::size_t p = 0; p < covered.size(); ++p)
    if (covered[p]) result[p] = relief.at(of_nodes, point[p].x(), point[p].y());
  return result;
}

SeenRelief see_relief(const PictureView& view, const LitObject& solid, Context& context) {
  SeenRelief seen;
  seen.covered.assign(view.pixels(), 0);
  seen.point.assign(view.pixels(), Vec2(0, 0));
  for_pixels(view, solid, context, [&](std::size_t pixel, const Sight& sight, const std::optional<RayHit>& hit) {
    if (!hit) return;
    seen.covered[pixel] = 1;
    seen.point[pixel] = (sight.from + hit->distance * sight.direction).head<2>();
  });
  return seen;
}

std::vector<double> SeenModel::values(const std::vector<double>& of_places) const {
  std::vector<double> result(place_of_pixel.size(), 0);
  for (std::size_t p = 0; p < result.size(); ++p)
    if (place_of_pixel[p] >= 0) result[p] = of_places[index(place_of_pixel[p])];
  return result;
}

SeenModel see_model(const PictureView& view, const LitObject& model, const TriangleMesh& mesh, double clearance_mm,
                    Context& context) {
  const Positions normals = vertex_normals(mesh);
  std::vector<Vec3> place(view.pixels()), normal(view.pixels());
  std::vector<char> covered(view.pixels(), 0);
  for_pixels(view, model, context, [&](std::size_t pixel, const Sight& sight, const std::optional<RayHit>& hit) {
    if (!hit) return;
    const Vec3 on_face = sight.from + hit->distance * sight.direction;
    const Vec3 corner[3] = {mesh.V.row(mesh.F(hit->face, 0)).transpose(), mesh.V.row(mesh.F(hit->face, 1)).transpose(),
                            mesh.V.row(mesh.F(hit->face, 2)).transpose()};
    // Of a face that is seen from inside, the other side is meant.
    const double side = (corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(sight.direction) > 0 ? -1 : 1;
    Vec3 lifted(0, 0, 0), sum(0, 0, 0);
    for (int k = 0; k < 3; ++k) {
      const Vec3 of_corner = side * normals.row(mesh.F(hit->face, k)).transpose();
      const double below = std::min(0.0, (on_face - corner[k]).dot(of_corner));
      lifted += hit->barycentric[k] * (on_face - below * of_corner);
      sum += hit->barycentric[k] * of_corner;
    }
    covered[pixel] = 1;
    place[pixel] = lifted;
    normal[pixel] = sum.norm() > 0 ? sum.normalized() : Vec3(-sight.direction);
  });
  SeenModel seen;
  seen.place_of_pixel.assign(view.pixels(), -1);
  seen.places.clearance = clearance_mm;
  int count = 0;
  for (std::size_t p = 0; p < covered.size(); ++p)
    if (covered[p]) seen.place_of_pixel[p] = count++;
  seen.places.place.resize(count, 3);
  seen.places.normal.resize(count, 3);
  for (std::size_t p = 0; p < covered.size(); ++p)
    if (covered[p]) {
      seen.places.place.row(seen.place_of_pixel[p]) = place[p].transpose();
      seen.places.normal.row(seen.place_of_pixel[p]) = normal[p].transpose();
    }
  return seen;
}

}  // namespace formwright
