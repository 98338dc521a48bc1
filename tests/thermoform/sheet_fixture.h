// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sheets and shapes that the thermoforming tests share.
#include <cmath>
#include <numbers>
#include <random>

#include "thermoform/forming.h"

namespace formwright::thermoform_test {

/// A small square machine; no vertex moves more than 1 mm in a step.
inline ThermoformOptions fine_stepping_machine(int triangles) {
  ThermoformOptions o;
  o.sheet_x_mm = o.sheet_y_mm = 140;
  o.clamp_opening_x_mm = o.clamp_opening_y_mm = 120;
  o.platform_travel_mm = 80;
  o.triangles = triangles;
  o.step_mm = 1;
  return o;
}

/// The sheet stretched and bulged, every vertex shaken a little: a state with all kinds of strain in it.
inline Positions shaken(const SheetMesh& sheet, double amplitude_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shake(-1, 1);
  Positions x(sheet.flat_mm.rows(), 3);
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const double u = sheet.flat_mm(i, 0), v = sheet.flat_mm(i, 1);
    x.row(i) << 1.1 * u + amplitude_mm * shake(random), 1.05 * v + 0.05 * u + amplitude_mm * shake(random),
        0.01 * (u * u - 0.5 * v * v) + amplitude_mm * shake(random);
  }
  return x;
}

/// Surface of revolution about z from a profile (radius, height), closed at both ends on the axis. A negative radius
/// stands for half the side of a square ring.
template <class Profile>
TriangleMesh revolved(const Profile& profile, int around) {
  TriangleMesh mesh;
  const auto rings = static_cast<int>(profile.size());
  std::vector<Vec3> V;
  std::vector<Eigen::Vector3i> F;
  std::vector<int> first;
  for (const auto& [r, z] : profile) {
    first.push_back(static_cast<int>(V.size()));
    const int count = r == 0 ? 1 : around;
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      const double reach = r >= 0 ? r : -r / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
      V.emplace_back(reach * std::cos(angle), reach * std::sin(angle), z);
    }
  }
  for (int ring = 0; ring + 1 < rings; ++ring) {
    const bool lower_point = profile[static_cast<std::size_t>(ring)].first == 0,
               upper_point = profile[static_cast<std::size_t>(ring) + 1].first == 0;
    for (int k = 0; k < around; ++k) {
      const int next = (k + 1) % around;
      const int a = first[static_cast<std::size_t>(ring)] + (lower_point ? 0 : k),
                b = first[static_cast<std::size_t>(ring)] + (lower_point ? 0 : next);
      const int c = first[static_cast<std::size_t>(ring) + 1] + (upper_point ? 0 : k),
                d = first[static_cast<std::size_t>(ring) + 1] + (upper_point ? 0 : next);
      if (!lower_point) F.emplace_back(a, b, upper_point ? c : d);
      if (!upper_point) F.emplace_back(a, d, c);
    }
  }
  mesh.V.resize(static_cast<Eigen::Index>(V.size()), 3);
  for (std::size_t i = 0; i < V.size(); ++i) mesh.V.row(static_cast<Eigen::Index>(i)) = V[i].transpose();
  mesh.F.resize(static_cast<Eigen::Index>(F.size()), 3);
  for (std::size_t i = 0; i < F.size(); ++i) mesh.F.row(static_cast<Eigen::Index>(i)) = F[i].transpose();
  return mesh;
}

/// A pyramid of square base, tip up.
inline TriangleMesh pyramid(double side_mm, double height_mm) {
  TriangleMesh mesh;
  const double s = side_mm / 2;
  mesh.V.resize(5, 3);
  mesh.V << -s, -s, 0, s, -s, 0, s, s, 0, -s, s, 0, 0, 0, height_mm;
  mesh.F.resize(6, 3);
  mesh.F << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 0, 2, 1, 0, 3, 2;
  return mesh;
}

inline FormedResult form(const TriangleMesh& mesh, const ThermoformOptions& options) {
  Context context;
  const Placement as_it_is;
  return form_sheet(std::make_shared<const MouldShape>(mesh), as_it_is, options, context);
}

}  // namespace formwright::thermoform_test
