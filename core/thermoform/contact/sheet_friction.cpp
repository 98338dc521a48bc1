// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/contact/sheet_friction.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace formwright {
namespace {

constexpr double lag_s_per_mm2 = 2.5e-6;  // small beside the drag: the bar loses no more tension with a tenth of it
constexpr double max_backward_mm = 0.02;  // over which the drag turns round
constexpr double rest_mm = 1e-4;          // what slides less in a step has come to rest
constexpr double min_same_side = 0.5;     // cosine between normals: surfaces that lean apart by less than 60 degrees
constexpr float stiffness_across = 100;   // times the vertex's own
constexpr double firmer_each_time = 0.5;

}  // namespace

Drag drag_of(double maximum, double slip_mm) {
  if (slip_mm >= 0) return {maximum, 0};
  const double stiffness = 2 * maximum / max_backward_mm;
  return {std::max(maximum + stiffness * slip_mm, -maximum), stiffness};
}

PointReach point_reach(double slip) {
  constexpr double min_slip = 0.05, full_slip = 0.25;
  const double share = std::clamp((slip - min_slip) / (full_slip - min_slip), 0.0, 1.0);
  return {0.15 * share, 0.1 * share};
}

SheetFriction::SheetFriction(const SheetMesh& sheet, double coefficient, double stiffness)
    : coefficient_(coefficient),
      stiffness_(stiffness),
      clamped_(sheet.clamped),
      starts_(sheet.clamped.size()),
      area_mm2_(sheet.clamped.size()),
      drag_(sheet.clamped.size()),
      normal_(sheet.clamped.size(), Vec3::UnitZ()),
      direction_(sheet.clamped.size(), Vec3::Zero()) {
  auto faces_of = std::make_shared<std::vector<std::vector<int>>>(clamped_.size());
  for (Eigen::Index f = 0; f < sheet.F.rows(); ++f) {
    const Vec2 a = sheet.flat_mm.row(sheet.F(f, 0)), b = sheet.flat_mm.row(sheet.F(f, 1)),
               c = sheet.flat_mm.row(sheet.F(f, 2));
    const double twice_area = std::abs((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
    for (int k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(sheet.F(f, k));
      area_mm2_[v] += twice_area / 6;
      (*faces_of)[v].push_back(static_cast<int>(f));
    }
  }
  faces_of_ = std::move(faces_of);
}

bool SheetFriction::carried_by_corners(const Triangles& F, int face, const HeldVertices& held) const {
  for (int k = 0; k < 3; ++k) {
    const auto v = static_cast<std::size_t>(F(face, k)), w = static_cast<std::size_t>(F(face, (k + 1) % 3));
    if (held[v] == moves_freely || clamped_[v] || normal_[v].dot(normal_[w]) < min_same_side) return false;
  }
  return true;
}

void SheetFriction::constrain(int vertex, const Vec3& slip_mm, double dt_s, Vec3& force,
                              std::array<Float4, 3>& diagonal) const {
  const auto v = static_cast<std::size_t>(vertex);
  const Vec3 &n = normal_[v], &d = direction_[v];
  const double lag = stiffness_ * lag_s_per_mm2 * area_mm2_[v] / dt_s;
  const Drag drag = drag_of(drag_[v], slip_mm.dot(d));
  force -= drag.force * d + lag * slip_mm;
  force -= force.dot(n) * n;
  const Eigen::Matrix3d held_back = lag * Eigen::Matrix3d::Identity() + drag.stiffness * d * d.transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) diagonal[static_cast<std::size_t>(j)][i] += static_cast<float>(held_back(i, j));
  const float across = stiffness_across * (diagonal[0][0] + diagonal[1][1] + diagonal[2][2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) diagonal[static_cast<std::size_t>(j)][i] += across * static_cast<float>(n[i] * n[j]);
}

void SheetFriction::decide(const Positions& force, const Positions& slip_mm, bool settling, HeldVertices& held) {
  for (std::size_t v = 0; v < held.size(); ++v) {
    if (held[v] == moves_freely || clamped_[v]) continue;
    const auto row = static_cast<Eigen::Index>(v);
    const Vec3 pull = force.row(row);
    const double across = pull.dot(normal_[v]);
    const Vec3 along = pull - across * normal_[v];
    const double maximum = coefficient_ * std::abs(across), size = along.norm();
    const bool goes_on = held[v] == sliding && slip_mm.row(row).dot(direction_[v]) > rest_mm;
    const bool slides = size > 0 && (goes_on || size > maximum * (1 + firmer_each_time * starts_[v]));
    if (slides && settling && held[v] == stuck) ++starts_[v];
    if (slides) {
      held[v] = sliding;
      direction_[v] = along / size;
      drag_[v] = maximum;
    } else {
      held[v] = stuck;
    }
  }
}

}  // namespace formwright
