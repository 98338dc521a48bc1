// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Formed sheets whose map to the flat sheet is known in closed form, and models for them.
#include <cmath>
#include <numbers>

#include "geometry/mesh/measures.h"
#include "geometry/queries/ray_caster.h"
#include "thermoform/sheet/formed_sheet.h"
#include "thermoform/print/print_options.h"

namespace formwright::test {

inline void fill_columns(FormedSheet& sheet, double thickness_mm) {
  const Eigen::Index n = sheet.mesh.V.rows();
  sheet.thickness_mm = Eigen::VectorXd::Constant(n, thickness_mm);
  sheet.stretch = Eigen::VectorXd::Ones(n);
  sheet.contact_s = Eigen::VectorXd::Ones(n);
}

/// columns x rows squares over [-x, x] x [-y, y].
inline TriangleMesh grid_mesh(double x_mm, double y_mm, int columns, int rows) {
  TriangleMesh mesh;
  mesh.V.resize((columns + 1) * (rows + 1), 3);
  mesh.F.resize(2 * columns * rows, 3);
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i)
      mesh.V.row(j * (columns + 1) + i) << x_mm * (2.0 * i / columns - 1), y_mm * (2.0 * j / rows - 1), 0;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, f = 2 * (j * columns + i);
      mesh.F.row(f) << a, a + 1, a + columns + 2;
      mesh.F.row(f + 1) << a, a + columns + 2, a + columns + 1;
    }
  return mesh;
}

/// Sheet with sticking contact in a cone of wall angle `alpha` from the horizontal: h / h0 = (1 + cos a) / 2 *
/// (1 - S sin a / H)^(sec a - 1) at slant S from the rim (uniform free cap). With u = 1 - S sin a / H, which is the
/// height left above, the material at u was at the radius R u^((sec a + 1) / 2) of the flat disc: volume is conserved.
struct Cone {
  double alpha = std::numbers::pi / 3, radius_mm = 60, sheet_mm = 0.5;

  double height_mm() const { return radius_mm * std::tan(alpha); }
  double flat_radius_mm(double u) const { return radius_mm * std::pow(u, (1 / std::cos(alpha) + 1) / 2); }
  double thickness_mm(double u) const {
    return sheet_mm * (1 + std::cos(alpha)) / 2 * std::pow(u, 1 / std::cos(alpha) - 1);
  }
  Vec3 surface(double u, double angle) const {
    const double r = radius_mm * u;
    return {r * std::cos(angle), r * std::sin(angle), height_mm() * (1 - u)};
  }
  Vec2 flat(const Vec3& p) const {
    const double r = p.head<2>().norm();
    return r > 0 ? Vec2(p.head<2>() / r * flat_radius_mm(r / radius_mm)) : Vec2(0, 0);
  }

  /// rings + 1 circles of `sectors` points, the last shrunk to the apex; faces outwards and upwards.
  TriangleMesh mesh(int rings, int sectors) const {
    TriangleMesh cone;
    cone.V.resize(rings * sectors + 1, 3);
    cone.F.resize((2 * rings - 1) * sectors, 3);
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < sectors; ++j)
        cone.V.row(i * sectors + j) =
            surface(1 - static_cast<double>(i) / rings, 2 * std::numbers::pi * j / sectors).transpose();
    const int apex = rings * sectors;
    cone.V.row(apex) = surface(0, 0).transpose();
    Eigen::Index f = 0;
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < sectors; ++j) {
        const int a = i * sectors + j, b = i * sectors + (j + 1) % sectors;
        if (i + 1 == rings) {
          cone.F.row(f++) << a, b, apex;
          continue;
        }
        cone.F.row(f++) << a, b, b + sectors;
        cone.F.row(f++) << a, b + sectors, a + sectors;
      }
    return cone;
  }

  FormedSheet sheet(int rings, int sectors) const {
    FormedSheet formed;
    formed.mesh = mesh(rings, sectors);
    fill_columns(formed, 0);
    formed.sheet_mm.resize(formed.mesh.V.rows(), 2);
    for (Eigen::Index i = 0; i < formed.sheet_mm.rows(); ++i) {
      const Vec3 p = formed.mesh.V.row(i);
      formed.sheet_mm.row(i) = flat(p).transpose();
      formed.thickness_mm[i] = thickness_mm(std::min(1.0, p.head<2>().norm() / radius_mm));
      formed.stretch[i] = formed.thickness_mm[i] > 1e-3 * sheet_mm ? sheet_mm / formed.thickness_mm[i] : 1000;
    }
    return formed;
  }
};

/// A sheet that has come straight down onto a model in machine coordinates, `cells` squares a side: sheet_mm is where
/// it came from. Not how sheets behave, but any map will do to print by.
inline FormedSheet dropped_sheet(const TriangleMesh& model, double side_mm, int cells, double thickness_mm) {
  FormedSheet sheet;
  sheet.mesh = grid_mesh(side_mm / 2, side_mm / 2, cells, cells);
  sheet.sheet_mm = sheet.mesh.V.leftCols(2);
  const RayCaster rays(model);
  for (Eigen::Index i = 0; i < sheet.mesh.V.rows(); ++i) {
    const Vec3 from(sheet.mesh.V(i, 0), sheet.mesh.V(i, 1), 1000);
    if (const auto hit = rays.first_hit(from, -Vec3::UnitZ(), 0, 1000)) sheet.mesh.V(i, 2) = 1000 - hit->distance;
  }
  sheet.mesh.V += thickness_mm / 2 * vertex_normals(sheet.mesh);
  fill_columns(sheet, thickness_mm);
  return sheet;
}

/// A square opening with a rim of 10 mm about it.
inline ThermoformPrintOptions plain_options(double opening_mm, double dots_per_inch) {
  ThermoformPrintOptions options;
  options.clamp_opening_x_mm = options.clamp_opening_y_mm = opening_mm;
  options.sheet_x_mm = options.sheet_y_mm = opening_mm + 20;
  options.dots_per_inch = dots_per_inch;
  return options;
}

}  // namespace formwright::test
