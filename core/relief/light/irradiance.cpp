// SPDX-License-Identifier: GPL-3.0-or-later
#include "relief/light/irradiance.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace formwright {
namespace {

constexpr std::size_t lit_points_per_chunk = 256;
constexpr double rays_between_reports = 1e6;

/// How far a ray runs before it leaves the box and can meet nothing more.
double way_out(const LitObject& object, const Vec3& from, const Vec3& direction) {
  double far = INFINITY;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) continue;
    const double wall = direction[k] > 0 ? object.high[k] : object.low[k];
    far = std::min(far, std::max(0.0, (wall - from[k]) / direction[k]));
  }
  return far;
}

}  // namespace

LitObject::LitObject(const TriangleMesh& mesh)
    : rays(std::make_shared<RayCaster>(mesh)),
      low(mesh.V.rows() > 0 ? Vec3(mesh.V.colwise().minCoeff()) : Vec3(0, 0, 0)),
      high(mesh.V.rows() > 0 ? Vec3(mesh.V.colwise().maxCoeff()) : Vec3(0, 0, 0)) {}

Irradiance irradiance(const LitObject& object, const SurfacePoints& points, const LightSamples& light,
                      Context& context) {
  const auto count = static_cast<std::size_t>(points.place.rows());
  Irradiance result(count);
  // A box grown by the clearance: rays may start a little outside.
  const double near = 1e-9 * (object.high - object.low).norm();
  const auto one_point = [&](std::size_t i) {
    const auto row = static_cast<Eigen::Index>(i);
    const Vec3 normal = points.normal.row(row).transpose();
    const Vec3 from = points.place.row(row).transpose() + points.clearance * normal;
    const auto blocked = [&](const Vec3& direction, double far) {
      far = std::min(far, way_out(object, from, direction) + near);
      return far > near && object.rays->first_hit(from, direction, near, far).has_value();
    };
    double lit = 0, open = 0;
    for (const FarLight& part : light.far) {
      const double cosine = normal.dot(part.direction);
      if (cosine <= 0 || part.direction.z() <= 0 || part.irradiance == 0) continue;
      open += part.irradiance * cosine;
      if (!blocked(part.direction, INFINITY)) lit += part.irradiance * cosine;
    }
    for (const NearLight& part : light.near) {
      const Vec3 way = part.place - from;
      const double distance = way.norm();
      if (!(distance > 0)) continue;
      const Vec3 direction = way / distance;
      const double cosine = normal.dot(direction);
      const double shining = part.facing.squaredNorm() > 0 ? -part.facing.dot(direction) : 1;
      if (cosine <= 0 || shining <= 0) continue;
      const double share = part.intensity * shining * cosine / (distance * distance);
      open += share;
      if (!blocked(direction, distance)) lit += share;
    }
    result.lit[i] = lit;
    result.open[i] = open;
  };
  const double samples = static_cast<double>(std::max<std::size_t>(1, light.far.size() + light.near.size()));
  const std::size_t block = std::max(lit_points_per_chunk, static_cast<std::size_t>(rays_between_reports / samples));
  for (std::size_t done = 0; done < count; done += block) {
    context.progress(static_cast<double>(done) / static_cast<double>(count));
    parallel_for(std::min(block, count - done), lit_points_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (i % 16 == 0) context.check_cancelled();
        one_point(done + i);
      }
    });
  }
  return result;
}

void add(Irradiance& a, const Irradiance& b) {
  for (std::size_t i = 0; i < a.lit.size(); ++i) {
    a.lit[i] += b.lit[i];
    a.open[i] += b.open[i];
  }
}

}  // namespace formwright
