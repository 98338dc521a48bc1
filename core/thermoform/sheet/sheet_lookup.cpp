// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/sheet/sheet_lookup.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/mesh/measures.h"

namespace formwright {

SheetLookup::SheetLookup(const FormedSheet& sheet) : sheet_(sheet), normals_(vertex_normals(sheet.mesh)) {
  lower_ = sheet.sheet_mm.colwise().minCoeff().transpose();
  const Vec2 size = sheet.sheet_mm.colwise().maxCoeff().transpose() - lower_;
  const double side =
      std::sqrt(std::max(size.x() * size.y(), 1e-12) / std::max<double>(1, 0.5 * sheet.mesh.face_count()));
  columns_ = std::clamp(static_cast<int>(size.x() / side), 1, 4096);
  rows_ = std::clamp(static_cast<int>(size.y() / side), 1, 4096);
  cell_ = Vec2(size.x() / columns_, size.y() / rows_).cwiseMax(1e-12);
  faces_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
  for (int f = 0; f < sheet.mesh.face_count(); ++f) {
    Vec2 low = Vec2::Constant(1e300), high = Vec2::Constant(-1e300);
    for (int k = 0; k < 3; ++k) {
      low = low.cwiseMin(sheet.sheet_mm.row(sheet.mesh.F(f, k)).transpose());
      high = high.cwiseMax(sheet.sheet_mm.row(sheet.mesh.F(f, k)).transpose());
    }
    const auto column = [&](double x) {
      return std::clamp(static_cast<int>((x - lower_.x()) / cell_.x()), 0, columns_ - 1);
    };
    const auto row = [&](double y) { return std::clamp(static_cast<int>((y - lower_.y()) / cell_.y()), 0, rows_ - 1); };
    for (int j = row(low.y() - 1e-9); j <= row(high.y() + 1e-9); ++j)
      for (int i = column(low.x() - 1e-9); i <= column(high.x() + 1e-9); ++i)
        faces_[static_cast<std::size_t>(j * columns_ + i)].push_back(f);
  }
}

std::optional<SheetPoint> SheetLookup::find(const Vec2& p) const {
  const Vec2 at = (p - lower_).cwiseQuotient(cell_);
  constexpr double slack = 1e-9;
  if (!(at.x() >= -slack && at.y() >= -slack && at.x() <= columns_ + slack && at.y() <= rows_ + slack))
    return std::nullopt;
  const int i = std::clamp(static_cast<int>(at.x()), 0, columns_ - 1),
            j = std::clamp(static_cast<int>(at.y()), 0, rows_ - 1);
  std::optional<SheetPoint> best;
  double minimum = -1e-6;
  for (const int f : faces_[static_cast<std::size_t>(j * columns_ + i)]) {
    const Vec2 a = sheet_.sheet_mm.row(sheet_.mesh.F(f, 0)), b = sheet_.sheet_mm.row(sheet_.mesh.F(f, 1)),
               c = sheet_.sheet_mm.row(sheet_.mesh.F(f, 2));
    const double doubled = (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
    if (!(doubled > 0)) continue;
    const double v = ((p - a).x() * (c - a).y() - (p - a).y() * (c - a).x()) / doubled,
                 w = ((b - a).x() * (p - a).y() - (b - a).y() * (p - a).x()) / doubled;
    const Vec3 barycentric(1 - v - w, v, w);
    if (barycentric.minCoeff() > minimum) {
      minimum = barycentric.minCoeff();
      const Vec3 inside = barycentric.cwiseMax(0.0);
      best = SheetPoint{f, inside / inside.sum()};
    }
  }
  return best;
}

Vec3 SheetLookup::middle(const SheetPoint& point) const {
  Vec3 p = Vec3::Zero();
  for (int k = 0; k < 3; ++k) p += point.barycentric[k] * sheet_.mesh.V.row(sheet_.mesh.F(point.face, k)).transpose();
  return p;
}

Vec3 SheetLookup::outer(const SheetPoint& point) const {
  Vec3 normal = Vec3::Zero();
  for (int k = 0; k < 3; ++k) normal += point.barycentric[k] * normals_.row(sheet_.mesh.F(point.face, k)).transpose();
  const double length = normal.norm();
  return length > 1e-12 ? Vec3(middle(point) + 0.5 * thickness_mm(point) / length * normal) : middle(point);
}

double SheetLookup::thickness_mm(const SheetPoint& point) const {
  double thickness = 0;
  for (int k = 0; k < 3; ++k) thickness += point.barycentric[k] * sheet_.thickness_mm[sheet_.mesh.F(point.face, k)];
  return thickness;
}

}  // namespace formwright
