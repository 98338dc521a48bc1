// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/queries/point_distance.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "geometry/queries/triangle_bvh.h"

namespace formwright {

struct PointDistance::Implementation {
  TriangleBvh bvh;
};

PointDistance::PointDistance(const TriangleMesh& mesh)
    : implementation_(std::make_unique<Implementation>(Implementation{TriangleBvh(mesh)})) {
  if (mesh.face_count() == 0)
    throw Error(ErrorCode::invalid_input, "mesh", "The mesh has no triangles to measure a distance to.");
}
PointDistance::~PointDistance() = default;
PointDistance::PointDistance(PointDistance&&) noexcept = default;
PointDistance& PointDistance::operator=(PointDistance&&) noexcept = default;

namespace {

/// On the segment p-q, as the weight of q.
double weight_on_segment(const Vec3& query, const Vec3& p, const Vec3& q) {
  const Vec3 along = q - p;
  const double squared = along.squaredNorm();
  return squared > 0 ? std::clamp((query - p).dot(along) / squared, 0.0, 1.0) : 0;
}

}  // namespace

NearestPoint nearest_on_triangle(const Vec3& query, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, normal = ab.cross(ac), aq = query - a;
  const double squared = normal.squaredNorm();
  NearestPoint result;
  if (squared > 0) {
    const double v = normal.dot(aq.cross(ac)) / squared, w = normal.dot(ab.cross(aq)) / squared;
    if (v >= 0 && w >= 0 && v + w <= 1) {
      result.barycentric = Vec3(1 - v - w, v, w);
      result.point = a + v * ab + w * ac;
      result.distance = (query - result.point).norm();
      return result;
    }
  }
  // Outside the prism over the triangle: the nearest point lies on one of the three sides.
  const Vec3* const corner[3] = {&a, &b, &c};
  double best = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3 &p = *corner[k], &q = *corner[(k + 1) % 3];
    const double t = weight_on_segment(query, p, q);
    const Vec3 point = t == 1 ? q : Vec3(p + t * (q - p));
    if (const double distance = (query - point).squaredNorm(); distance < best) {
      best = distance;
      result.point = point;
      result.barycentric.setZero();
      result.barycentric[k] = 1 - t;
      result.barycentric[(k + 1) % 3] = t;
    }
  }
  result.distance = std::sqrt(best);
  return result;
}

std::optional<NearestPoint> PointDistance::nearest(const Vec3& query, double limit) const {
  NearestPoint best;
  double squared = limit * limit;
  implementation_->bvh.near_point(query, squared, [&](const TriangleBvh::Block& block) {
    for (std::size_t lane = 0; lane < TriangleBvh::width && block.face[lane] >= 0; ++lane) {
      NearestPoint candidate =
          nearest_on_triangle(query, block.position(0, lane), block.position(1, lane), block.position(2, lane));
      candidate.face = block.face[lane];
      if (best.face < 0 ? candidate.distance > limit
                        : candidate.distance > best.distance ||
                              (candidate.distance == best.distance && candidate.face > best.face))
        continue;
      best = candidate;
      // A little more than the square, so that a face at the same distance is still looked at.
      squared = best.distance * best.distance * (1 + 1e-14);
    }
  });
  return best.face >= 0 ? std::optional(best) : std::nullopt;
}

SurfaceDistance surface_distance(const TriangleMesh& from, const PointDistance& to, double spacing, Context& context) {
  if (!(spacing > 0))
    throw Error(ErrorCode::invalid_input, "spacing", "The spacing between measured points must be positive.");
  struct Sum {
    double maximum = 0, distance = 0, squared = 0, area = 0;
    void add(double d, double weight) {
      maximum = std::max(maximum, d);
      distance += weight * d;
      squared += weight * d * d;
      area += weight;
    }
  };
  constexpr std::size_t grain = 256;
  const auto measure = [&](std::size_t count, const std::function<void(std::size_t, Sum&)>& one) {
    std::vector<Sum> sums((count + grain - 1) / grain);
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
      context.check_cancelled();
      for (std::size_t i = begin; i < end; ++i) one(i, sums[begin / grain]);
    });
    Sum total;
    for (const Sum& sum : sums) {
      total.maximum = std::max(total.maximum, sum.maximum);
      total.distance += sum.distance;
      total.squared += sum.squared;
      total.area += sum.area;
    }
    return total;
  };

  const auto distance_of = [&](const Vec3& p) { return to.nearest(p)->distance; };
  std::vector<char> used(static_cast<std::size_t>(from.vertex_count()), 0);
  for (Eigen::Index i = 0; i < from.F.size(); ++i) used[static_cast<std::size_t>(from.F.data()[i])] = 1;
  context.progress(0, "Measuring distances");
  const Sum vertices = measure(used.size(), [&](std::size_t v, Sum& sum) {
    if (used[v]) sum.add(distance_of(from.V.row(static_cast<Eigen::Index>(v))), 0);
  });
  context.progress(0.3);
  const Sum faces = measure(static_cast<std::size_t>(from.face_count()), [&](std::size_t index, Sum& sum) {
    const auto f = static_cast<Eigen::Index>(index);
    const Vec3 a = from.V.row(from.F(f, 0)), b = from.V.row(from.F(f, 1)), c = from.V.row(from.F(f, 2));
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing), 1.0, 1000.0));
    // Centres of the n^2 small triangles that a regular division gives: equal areas, equal weights.
    const double weight = 0.5 * (b - a).cross(c - a).norm() / (static_cast<double>(n) * n);
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (int half = 0; half < (i + j + 1 < n ? 2 : 1); ++half) {
          const double shift = (half == 0 ? 1.0 : 2.0) / 3;
          sum.add(distance_of(a + (i + shift) / n * (b - a) + (j + shift) / n * (c - a)), weight);
        }
  });
  SurfaceDistance result;
  result.maximum = std::max(vertices.maximum, faces.maximum);
  if (faces.area > 0) {
    result.mean = faces.distance / faces.area;
    result.root_mean_square = std::sqrt(faces.squared / faces.area);
  }
  return result;
}

double hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b, double spacing, Context& context) {
  const double forth = surface_distance(a, PointDistance(b), spacing, context).maximum;
  return std::max(forth, surface_distance(b, PointDistance(a), spacing, context).maximum);
}

}  // namespace formwright
