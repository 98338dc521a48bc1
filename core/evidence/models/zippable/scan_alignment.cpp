// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/scan_alignment.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"

namespace formwright {
namespace {

constexpr double huber = 1.345;            // times the scatter: 95 % efficient for normal errors
constexpr double normal_scatter = 1.4826;  // standard deviation over median distance
constexpr Eigen::Index points_of_search = 300;
constexpr int rounds_of_search = 25;

const TriangleMesh& checked(const TriangleMesh& mesh) {
  if (!mesh.V.allFinite()) throw Error(ErrorCode::could_not_solve, "", "The zipped cloth has no finite place there.");
  return mesh;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Frame {
  Vec3 centre;
  Eigen::Matrix3d axes;  // columns, by falling extent
};

Frame frame_of(const Positions& points) {
  const Vec3 centre = points.colwise().mean().transpose();
  const Eigen::MatrixX3d about = points.rowwise() - centre.transpose();
  return {centre, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(about.transpose() * about).eigenvectors()};
}

}  // namespace

Positions evenly_chosen(const Positions& points, Eigen::Index count) {
  if (points.rows() <= count) return points;
  Positions chosen(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) chosen.row(i) = points.row(i * points.rows() / count);
  return chosen;
}

ScannedShape::ScannedShape(const TriangleMesh& mesh, double offset_mm)
    : mesh_(checked(mesh)), offset_mm_(offset_mm), nearest_(mesh_) {}

ScannedShape::Contact ScannedShape::contact(const Vec3& point) const {
  const NearestPoint near = *nearest_.nearest(point);
  const Vec3 a = mesh_.V.row(mesh_.F(near.face, 0)), b = mesh_.V.row(mesh_.F(near.face, 1)),
             c = mesh_.V.row(mesh_.F(near.face, 2));
  Vec3 normal = (b - a).cross(c - a);
  normal /= std::max(normal.norm(), 1e-300);
  // Beside an edge the nearest place is not straight below.
  const Vec3 towards = point - near.point;
  const double side = towards.dot(normal) < 0 ? -1 : 1;
  if (near.distance > 1e-9) normal = side / near.distance * towards;
  return {normal, side * near.distance - offset_mm_};
}

RigidMotion ScannedShape::aligned(const Positions& points, const RigidMotion& start, int max_rounds,
                                  const Context& context) const {
  RigidMotion motion = start;
  std::vector<Contact> contacts(static_cast<std::size_t>(points.rows()));
  for (int round = 0; round < max_rounds; ++round) {
    context.check_cancelled();
    const Positions moved = motion(points);
    parallel_for(contacts.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        contacts[i] = contact(moved.row(static_cast<Eigen::Index>(i)).transpose());
    });
    std::vector<double> sizes;
    for (const Contact& c : contacts) sizes.push_back(std::abs(c.distance_mm));
    const double limit = std::max(huber * normal_scatter * median(sizes), 1e-9);
    const Vec3 centre = moved.colwise().mean().transpose();
    Eigen::Matrix<double, 6, 6> normal_matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Contact& c = contacts[i];
      Eigen::Matrix<double, 6, 1> row;
      row << (moved.row(static_cast<Eigen::Index>(i)).transpose() - centre).cross(c.normal), c.normal;
      const double weight = std::min(1.0, limit / std::max(sizes[i], 1e-300));
      normal_matrix += weight * row * row.transpose();
      right -= weight * c.distance_mm * row;
    }
    // A sphere may turn as it likes.
    normal_matrix.diagonal().array() += 1e-12 * normal_matrix.trace();
    const Eigen::Matrix<double, 6, 1> step = normal_matrix.ldlt().solve(right);
    const double angle = step.head<3>().norm();
    const Eigen::Matrix3d turn =
        angle > 0 ? Eigen::AngleAxisd(std::min(angle, 0.5), step.head<3>() / angle).toRotationMatrix()
                  : Eigen::Matrix3d::Identity();
    motion.shift = turn * (motion.shift - centre) + centre + step.tail<3>();
    motion.linear = turn * motion.linear;
    const double size = (moved.rowwise() - centre.transpose()).rowwise().norm().maxCoeff();
    if (angle * size + step.tail<3>().norm() < 1e-7 * size) break;
  }
  return motion;
}

RigidMotion ScannedShape::found(const Positions& points, const Context& context) const {
  const Frame own = frame_of(points), wanted = frame_of(mesh_.V);
  const Positions few = evenly_chosen(points, points_of_search);
  RigidMotion best;
  double least = -1;
  // Principal axes onto principal axes: in every order, since two may be alike, and in either direction.
  std::array<int, 3> order{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d axes;
      for (int k = 0; k < 3; ++k)
        axes.col(k) = (signs >> k & 1 ? -1 : 1) * own.axes.col(order[static_cast<std::size_t>(k)]);
      RigidMotion start;
      start.linear = wanted.axes * axes.transpose();
      start.shift = wanted.centre - start.linear * own.centre;
      const RigidMotion motion = aligned(few, start, rounds_of_search, context);
      const Eigen::VectorXd off = distances_mm(few, motion).cwiseAbs();
      const double typical = median({off.begin(), off.end()}) + 0.1 * off.mean();
      if (least < 0 || typical < least) least = typical, best = motion;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

Eigen::VectorXd ScannedShape::distances_mm(const Positions& points, const RigidMotion& motion) const {
  const Positions moved = motion(points);
  Eigen::VectorXd distances(points.rows());
  parallel_for(static_cast<std::size_t>(points.rows()), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      distances[static_cast<Eigen::Index>(i)] =
          contact(moved.row(static_cast<Eigen::Index>(i)).transpose()).distance_mm;
  });
  return distances;
}

}  // namespace formwright
