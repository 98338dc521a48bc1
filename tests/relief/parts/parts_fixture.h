// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bases of several parts, in mm as a file has them, and reliefs on them.
#include "geometry/test_meshes.h"
#include "relief/base/base_parts.h"
#include "relief/base/base_shape.h"
#include "relief/relief.h"

namespace formwright::test {

inline TriangleMesh box_mm(const Vec3& low, const Vec3& high) {
  TriangleMesh box = cube();
  const Vec3 from = box.V.colwise().minCoeff().transpose(), size = box.V.colwise().maxCoeff().transpose() - from;
  for (Eigen::Index i = 0; i < box.V.rows(); ++i)
    box.V.row(i) = (low + (box.V.row(i).transpose() - from).cwiseQuotient(size).cwiseProduct(high - low)).transpose();
  return box;
}

inline ReliefOptions options_on_parts(Projection projection) {
  ReliefOptions options;
  options.width_mm = 100;
  options.thickness_mm = 4;
  options.projection = projection;
  options.pixel_mm = 1;
  return options;
}

struct OnParts {
  ReliefOptions options;
  ViewFrame frame;
  Triangles F;
  std::shared_ptr<const BaseParts> parts;
  Relief relief;
};

inline OnParts relief_on(const TriangleMesh& base_mm, const ReliefOptions& options, const TriangleMesh& model) {
  Context context;
  ReliefSolver solver(model, options, context);
  const TriangleMesh base = base_from_file(base_mm, options);
  auto parts = std::make_shared<const BaseParts>(base, solver.frame().kappa, context);
  Relief relief = solver.solve(options, BaseSurface(base, std::nullopt, parts), context);
  return {options, solver.frame(), solver.F(), parts, std::move(relief)};
}

inline OnParts relief_on(const TriangleMesh& base_mm, const ReliefOptions& options, int levels = 4) {
  return relief_on(base_mm, options, icosphere(levels));
}

}  // namespace formwright::test
