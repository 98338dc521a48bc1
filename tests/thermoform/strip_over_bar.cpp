// SPDX-License-Identifier: GPL-3.0-or-later
#include "thermoform/strip_over_bar.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "thermoform/sheet_dynamics.h"

namespace formwright {
namespace {

constexpr double bar_radius_mm = 20, bar_z_mm = 100, half_length_mm = 60, speed_mm_per_s = 100;

/// A bar along y, finely faceted.
TriangleMesh bar() {
  constexpr int around = 720;
  TriangleMesh mesh;
  mesh.V.resize(2 * around, 3);
  mesh.F.resize(2 * around, 3);
  for (int k = 0; k < around; ++k) {
    const double angle = 2 * std::numbers::pi * k / around;
    for (int end = 0; end < 2; ++end)
      mesh.V.row(2 * k + end) << bar_radius_mm * std::cos(angle), end == 0 ? -100 : 100,
          bar_z_mm + bar_radius_mm * std::sin(angle);
    const int a = 2 * k, b = 2 * ((k + 1) % around);
    mesh.F.row(2 * k) << a, b + 1, b;
    mesh.F.row(2 * k + 1) << a, a + 1, b + 1;
  }
  return mesh;
}

/// A strip along x, clamped at its two ends, four cells wide.
SheetMesh strip(int columns) {
  constexpr int rows = 4;
  const double cell = 2 * half_length_mm / columns;
  SheetMesh sheet;
  sheet.columns = columns + 1;
  sheet.rows = rows + 1;
  sheet.flat_mm.resize((columns + 1) * (rows + 1), 2);
  sheet.F.resize(2 * columns * rows, 3);
  int face = 0;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const int v = j * (columns + 1) + i;
      sheet.flat_mm.row(v) << -half_length_mm + i * cell, (j - 0.5 * rows) * cell;
      sheet.clamped.push_back(i == 0 || i == columns);
      if (i == columns || j == rows) continue;
      const int w = v + columns + 1;
      if ((i + j) % 2 == 0) {
        sheet.F.row(face++) << v, v + 1, w + 1;
        sheet.F.row(face++) << v, w + 1, w;
      } else {
        sheet.F.row(face++) << v, v + 1, w;
        sheet.F.row(face++) << v + 1, w + 1, w;
      }
    }
  return sheet;
}

}  // namespace

StripOverBar draw_over_bar(double friction, int columns, double step_mm) {
  // Without Poisson's ratio a strip of St. Venant-Kirchhoff's law pulls as lambda (lambda^2 - 1), and keeps its width.
  ThermoformOptions o;
  o.young_modulus_pa = 2e6;
  o.poisson_ratio = 0;
  o.creep_per_s = 0;
  o.viscosity_s = 0;
  o.slip = friction > 0 ? 1 / friction : 0;
  const auto contact = std::make_shared<const MouldContact>(std::make_shared<const MouldShape>(bar()), Placement{},
                                                            Vec2(400, 400), 0.01);
  const SheetMesh sheet = strip(columns);
  SheetDynamics dynamics(sheet, o, bar_z_mm + bar_radius_mm + 0.6, contact);
  Context context;
  StepLoad load;
  load.gravity_mm_per_s2 = 0;
  constexpr double depth_mm = 60;
  double moved = 0, step = step_mm;
  while (moved < depth_mm) {
    load.clamp_shift = Vec3(0, 0, -std::min(step, depth_mm - moved));
    if (dynamics.step(-load.clamp_shift.z() / speed_mm_per_s, load, 10 * step_mm, context) ==
        SheetDynamics::Outcome::done) {
      moved -= load.clamp_shift.z();
      step = std::min(step_mm, 2 * step);
    } else {
      step /= 2;
      if (step < 1e-4 * step_mm) return {NAN, NAN};
    }
  }
  const auto tension = [&](int column) {
    const int v = sheet.rows / 2 * sheet.columns + column;
    const Vec3 edge = dynamics.x().row(v + 1) - dynamics.x().row(v);
    const double lambda = edge.norm() / (2 * half_length_mm / columns);
    return std::pair(lambda * (lambda * lambda - 1), std::atan2(-edge.z(), edge.x()));
  };
  const auto [free, angle] = tension(columns - 2);
  return {angle, 0.5 * (tension(columns / 2).first + tension(columns / 2 - 1).first) / free};
}

}  // namespace formwright
