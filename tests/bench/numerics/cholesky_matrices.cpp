// SPDX-License-Identifier: GPL-3.0-or-later
// cholesky_matrices FOLDER UNKNOWNS...: writes what the crafts factor, at about those sizes, as
// FOLDER/NAME_UNKNOWNS.matrix.
//   relief            the energy of eq. (3.13) of the bust, one vertex pinned, as the bounded quadratic program factors
//   it parameterisation  the Hessian of the octopus's symmetric Dirichlet energy where Newton's iteration ends cloth
//   the Hessian of the octopus's ribbon as cloth, put into the octopus's shape with every seam closed
#include <algorithm>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>

#include "geometry/operators/intrinsic_delaunay.h"
#include "geometry/samples/samples.h"
#include "matrix_file.h"
#include "relief/appearance_energy.h"
#include "zippable/design_files.h"
#include "zippable/chart/newton_system.h"
#include "zippable/zippable_design.h"
#include "zippable/zipping/zipping_system.h"

namespace {
using namespace formwright;

SparseMatrix relief_matrix(int unknowns, Context& context) {
  const TriangleMesh mesh = make_sample("bust", unknowns, context).mesh;
  const ViewFrame frame = make_view_frame(mesh, {});
  SparseMatrix Q = AppearanceEnergy(frame, mesh.F, Eigen::VectorXd::Ones(frame.P.rows())).lower_hessian(context);
  Q *= 1 / Q.diagonal().mean();
  for (SparseMatrix::InnerIterator it(Q, 0); it; ++it) it.valueRef() = it.row() == 0 ? 1.0 : 0.0;
  return Q;
}

ParameterisedModel octopus(int vertices, Context& context) {
  ZippableOptions options;
  options.size_mm = 100;
  options.width_mm = 15;
  return parameterise_model(make_sample("octopus", vertices, context).mesh, {}, options, context);
}

SparseMatrix parameterisation_matrix(int unknowns, Context& context) {
  const ParameterisedModel model = octopus(unknowns / 2, context);
  const Segmentation& s = model.proposal.segmentation;
  const IntrinsicTriangulation intrinsic = intrinsic_triangulation(s.mesh);
  const CornerCoordinates& uv = model.parameterisation.corners_mm;
  const SeamlessChart chart(s);
  NewtonSystem system(chart, context);
  system.assemble([&](int f) {
    const auto length = [&](int k) { return intrinsic.length[static_cast<std::size_t>(3 * f + k)]; };
    const ReferenceTriangle reference = reference_triangle(length(0), length(1), length(2));
    const auto corner = [&](int k) { return Vec2(uv.row(3 * f + k).transpose()); };
    DirichletTerms t = symmetric_dirichlet_terms(reference, {corner(0), corner(1), corner(2)}, true);
    t.hessian *= reference.area;
    return t;
  });
  return system.lower_hessian();
}

/// Halving the triangles' edges makes the sizes: the ribbon itself has vertices along its edge only.
SparseMatrix cloth_matrix(int unknowns, Context& context) {
  ZippableOptions options;
  options.width_mm = 15;
  const ParameterisedModel model = octopus(20000, context);
  const RibbonDesign ribbon =
      ribbon_of(read_flat_design(write_design_json(model, design_zippable(model, options, context))));
  double edge_mm = 8;
  RibbonPattern pattern = make_ribbon_pattern(ribbon.places, ribbon.triangles, edge_mm, context, ribbon.closures);
  while (3 * pattern.flat.vertex_count() < unknowns) {
    edge_mm *= 0.8;
    pattern = make_ribbon_pattern(ribbon.places, ribbon.triangles, edge_mm, context, ribbon.closures);
  }
  ZippingSystem system(pattern, {}, context);
  for (SeamThread& thread : system.threads) thread = {10, 0};
  system.anchor_n_per_mm3 = 1e-2 / (pattern.width_mm * pattern.width_mm);
  Positions x = pattern.predicted_mm;
  system.minimise(x, 1, 0, context);
  return system.lower_hessian();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "cholesky_matrices FOLDER NAME_UNKNOWNS..., such as relief_50000\n");
    return 2;
  }
  try {
    Context context;
    for (int k = 2; k < argc; ++k) {
      const std::string wanted = argv[k], name = wanted.substr(0, wanted.find('_'));
      const int unknowns = std::stoi(wanted.substr(std::min(wanted.size(), name.size() + 1)));
      SparseMatrix lower;
      if (name == "relief") lower = relief_matrix(unknowns, context);
      else if (name == "parameterisation") lower = parameterisation_matrix(unknowns, context);
      else if (name == "cloth") lower = cloth_matrix(unknowns, context);
      else throw std::invalid_argument("There is no matrix called " + name + ".");
      const std::string path = std::string(argv[1]) + "/" + wanted + ".matrix";
      bench::write_matrix(path, lower);
      std::printf("%s  %d unknowns, %.1f entries a row\n", path.c_str(), static_cast<int>(lower.rows()),
                  2.0 * static_cast<double>(lower.nonZeros()) / static_cast<double>(lower.rows()) - 1);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "cholesky_matrices: %s\n", error.what());
    return 3;
  }
}
