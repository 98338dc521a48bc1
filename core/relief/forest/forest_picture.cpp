// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/forest/forest_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "imaging/picture/light.h"
#include "relief/seen/normal_picture.h"

namespace formwright {
namespace {

constexpr int rays_a_side = 2;  // of a pixel
constexpr double picture_height_share = 0.8, more_than_model = 1.35;
constexpr double ambient = 0.12, matt = 0.75, floor_brightness = 0.86, sky_brightness = 1;
constexpr std::size_t picture_lines_a_chunk = 4;
constexpr double horizon_mm = 1e7;

/// Where light comes from: right, up and towards the viewer.
Vec3 light_direction() { return Vec3(-0.55, 0.6, 0.58).normalized(); }

/// sRGB grey of what is lit at this cosine.
std::uint8_t grey_of(double brightness) {
  return byte_of_light()[static_cast<std::size_t>(std::lround(std::clamp(brightness, 0.0, 1.0) * light_levels))];
}
double matt_brightness(double cosine) { return ambient + matt * std::max(0.0, cosine); }

/// Right, up and looking direction.
Eigen::Matrix3d camera_axes(const ForestCamera& camera) {
  const Vec3 look = (camera.look_at_mm - camera.eye_mm).normalized();
  Eigen::Matrix3d axes;
  axes.row(0) = look.cross(Vec3::UnitZ()).normalized();
  axes.row(1) = Vec3(axes.row(0)).cross(look);
  axes.row(2) = look;
  return axes;
}

}  // namespace

ForestCamera camera_of(const ForestViewpoint& viewpoint, double height_share) {
  return {viewpoint.eye_mm, viewpoint.look_at_mm,
          more_than_model * viewpoint.width_mm * std::max(1.0, height_share / picture_height_share)};
}

ForestCamera camera_from_elsewhere(const ForestScene& scene) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Pillar& pillar : scene.pillars)
    for (const Vec2& p : pillar.outline_mm)
      for (const double z : {0.0, pillar.height_mm}) {
        low = low.cwiseMin(Vec3(p.x(), p.y(), z));
        high = high.cwiseMax(Vec3(p.x(), p.y(), z));
      }
  const Vec3 middle = 0.5 * (low + high);
  const auto bearing = [&](const ForestViewpoint& v) {
    return std::atan2(v.eye_mm.y() - middle.y(), v.eye_mm.x() - middle.x());
  };
  // Half-way in the widest gap between neighbouring viewpoints, as seen from the middle.
  std::vector<double> bearings;
  for (const ForestViewpoint& v : scene.viewpoints) bearings.push_back(bearing(v));
  std::ranges::sort(bearings);
  double widest = 0, from = bearings.front();
  for (std::size_t k = 0; k < bearings.size(); ++k) {
    const double next = k + 1 < bearings.size() ? bearings[k + 1] : bearings.front() + 2 * std::numbers::pi;
    // Of equal gaps the first, whatever the last digit of a machine's arc tangent.
    if (next - bearings[k] > widest + 1e-6) {
      widest = next - bearings[k];
      from = bearings[k];
    }
  }
  const double angle = from + 0.5 * std::min(widest, std::numbers::pi), size = (high - low).head<2>().norm();
  constexpr double away = 2.2, raised = 0.9, shown = 1.15;  // of the forest's diagonal
  ForestCamera camera;
  camera.look_at_mm = middle;
  camera.eye_mm = middle + size * Vec3(away * std::cos(angle), away * std::sin(angle), raised);
  camera.width_mm = shown * size;
  return camera;
}

Image picture_of_forest(const StandingForest& forest, const RayCaster& caster, const ForestCamera& camera, int pixels,
                        Context& context) {
  const int width = rays_a_side * pixels,
            height = rays_a_side * std::max(1, static_cast<int>(std::lround(picture_height_share * pixels)));
  Image image(width, height, Rgba{255, 255, 255, 255});
  const Eigen::Matrix3d axes = camera_axes(camera);
  const double distance = (camera.look_at_mm - camera.eye_mm).norm(), pitch = camera.width_mm / width;
  const Vec3 light = axes.transpose() * light_direction().cwiseProduct(Vec3(1, 1, -1));
  parallel_for(static_cast<std::size_t>(height), picture_lines_a_chunk, [&](std::size_t begin, std::size_t end) {
    context.check_cancelled();
    for (std::size_t line = begin; line < end; ++line)
      for (int column = 0; column < width; ++column) {
        const double x = (column + 0.5 - 0.5 * width) * pitch,
                     y = (0.5 * height - static_cast<double>(line) - 0.5) * pitch;
        const Vec3 direction = (axes.transpose() * Vec3(x, y, distance)).normalized();
        double brightness = sky_brightness;
        const auto hit = caster.first_hit(camera.eye_mm, direction, 0, horizon_mm);
        const double floor = direction.z() < 0 ? -camera.eye_mm.z() / direction.z() : INFINITY;
        if (hit && hit->distance < floor) {
          const Vec3 a = forest.mesh.V.row(forest.mesh.F(hit->face, 0)),
                     b = forest.mesh.V.row(forest.mesh.F(hit->face, 1)),
                     c = forest.mesh.V.row(forest.mesh.F(hit->face, 2));
          brightness = matt_brightness((b - a).cross(c - a).normalized().dot(light));
        } else if (std::isfinite(floor) && floor > 0) {
          brightness = floor_brightness;
        }
        const std::uint8_t grey = grey_of(brightness);
        image.at(column, static_cast<int>(line)) = {grey, grey, grey, 255};
      }
  });
  return shrunk(image, rays_a_side, context);
}

Image picture_of_model(const ViewFrame& frame, const Triangles& F, int pixels, Context& context) {
  PictureGrid grid;
  grid.columns = pixels;
  grid.pixel = 1.0 / pixels;
  grid.rows = std::max(1, static_cast<int>(std::ceil(frame.image_height * pixels)));
  const NormalPicture seen = draw_normals(frame, frame.P, F, grid, context);
  const Vec3 light = light_direction();
  Image image(grid.columns, grid.rows, Rgba{0, 0, 0, 0});
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t at = seen.at(row, column);
      if (!seen.covered[at]) continue;
      const std::uint8_t grey = grey_of(matt_brightness(light.dot(Vec3(seen.x[at], seen.y[at], seen.z[at]))));
      image.at(column, grid.rows - 1 - row) = {grey, grey, grey, 255};
    }
  return image;
}

}  // namespace formwright
