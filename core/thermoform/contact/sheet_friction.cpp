// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/contact/sheet_friction.h"

#include <Eigen/Dense>

namespace formwright {
namespace {

constexpr float stiffness_across = 100;  // times the vertex's own
constexpr double firmer_each_time = 0.5;

}  // namespace

SheetFriction::SheetFriction(const SheetMesh& sheet, double coefficient, double stiffness)
    : coefficient_(coefficient),
      stiffness_(stiffness),
      clamped_(sheet.clamped),
      starts_(sheet.clamped.size()),
      normal_(sheet.clamped.size(), Vec3::UnitZ()),
      drag_(sheet.clamped.size(), Vec3::Zero()) {
  auto faces_of = std::make_shared<std::vector<std::vector<int>>>(clamped_.size());
  for (int f = 0; f < static_cast<int>(sheet.F.rows()); ++f)
    for (int k = 0; k < 3; ++k) (*faces_of)[static_cast<std::size_t>(sheet.F(f, k))].push_back(f);
  faces_of_ = std::move(faces_of);
}

void SheetFriction::constrain(int vertex, const Vec3& slip_mm, double dt_s, Vec3& force,
                              std::array<Float4, 3>& diagonal) const {
  const auto v = static_cast<std::size_t>(vertex);
  const Vec3& n = normal_[v];
  const double lag = stiffness_ * slide_lag_s / dt_s;
  force += drag_[v] - lag * slip_mm;
  force -= force.dot(n) * n;
  const float across = stiffness_across * (diagonal[0][0] + diagonal[1][1] + diagonal[2][2]);
  for (std::size_t i = 0; i < 3; ++i) diagonal[i][i] += static_cast<float>(lag);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      diagonal[j][i] += across * static_cast<float>(n[static_cast<int>(i)] * n[static_cast<int>(j)]);
}

void SheetFriction::decide(const Positions& force, bool settling, HeldVertices& held) {
  for (std::size_t v = 0; v < held.size(); ++v) {
    if (held[v] == moves_freely || clamped_[v]) continue;
    const Vec3 pull = force.row(static_cast<Eigen::Index>(v));
    const double across = pull.dot(normal_[v]);
    const Vec3 along = pull - across * normal_[v];
    const double maximum = coefficient_ * std::abs(across), size = along.norm();
    const bool slides = size > maximum * (held[v] == sliding ? 1 : 1 + firmer_each_time * starts_[v]);
    if (slides && settling && held[v] == stuck) ++starts_[v];
    if (slides) {
      held[v] = sliding;
      drag_[v] = -maximum / size * along;
    } else {
      held[v] = stuck;
    }
  }
}

}  // namespace formwright
