// SPDX-License-Identifier: GPL-3.0-or-later
// Hundreds of designs by chance: whatever the punctures, the order, the width and the number of windings, the ribbon is
// one disc that unfolds without distortion, or the refusal is one sentence with its mend.
#include <catch2/catch_test_macros.hpp>

#include <cmath>

#include "base/error.h"
#include "zippable/zippable_design.h"
#include "zippable/zippable_shapes.h"

namespace formwright {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr int trials = 40;  // a trial takes ten times as long
#else
constexpr int trials = 200;
#endif

TEST_CASE("ZippableSweep.Seed20261122GivesOnlyValidDesigns") {
  test::Random random(20261122);
  const std::vector<std::string> names{"star", "heart", "t_shape", "torus", "cat", "bust", "fish", "hemisphere"};
  std::vector<TriangleMesh> meshes;
  Context context;
  for (const std::string& name : names) meshes.push_back(make_sample(name, 900, context).mesh);
  int made = 0, refused = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const auto which = static_cast<std::size_t>(random.below(static_cast<int>(names.size())));
    const TriangleMesh& mesh = meshes[which];
    ZippableOptions options;
    options.width_mm = std::pow(10, random.uniform(0.6, 1.5));
    options.parts_max = 1 + random.below(10);
    if (random.below(3) == 0) options.windings = random.uniform(0.2, 12);
    if (random.below(3) == 0) options.puncture_mm = random.uniform(1, 30);
    options.prominence_percent = random.uniform(1, 30);
    if (random.below(4) == 0) options.traversal = 1 + random.below(6);
    if (random.below(4) == 0) options.sample_mm = options.width_mm * random.uniform(0.05, 2);
    std::vector<Vec3> tips;
    if (random.below(2) == 0)
      for (int k = 2 + random.below(5); k > 0; --k)
        tips.push_back(mesh.V.row(random.below(mesh.vertex_count())).transpose());
    INFO(names[which] + ", trial " + std::to_string(trial) + ", width " + std::to_string(options.width_mm));
    try {
      const ParameterisedModel model = parameterise_model(mesh, {tips, {}}, options, context);
      const ZippableDesign design = design_zippable(model, options, context);
      ++made;
      const TriangleMesh formed = design.ribbon.formed();
      const Adjacency adjacency(formed);
      CHECK(adjacency.is_manifold());
      CHECK(euler_characteristic(adjacency) == 1);
      CHECK(boundary_loops(adjacency).size() == 1u);
      CHECK(adjacency.boundary_edge_count() == formed.vertex_count());
      CHECK(formed.face_count() == formed.vertex_count() - 2);
      CHECK(design.ribbon.opening_arcs == 2 + 2 * design.curve.fermat_spirals);
      CHECK(design.ribbon.isometry_error <= 1e-9);
      CHECK(constraint_residual_mm(model.proposal.segmentation, model.parameterisation) <= 1e-10);
      CHECK((std::isfinite(design.ribbon.zipper_mm) && design.ribbon.zipper_mm > 0));
    } catch (const Error& error) {
      ++refused;
      INFO(error.what());
      CHECK((error.code() == ErrorCode::invalid_input || error.code() == ErrorCode::could_not_solve));
      CHECK(std::string(error.what()).find(':') != std::string::npos);  // what is wrong: what helps
      CHECK(std::string(error.what()).back() == '.');
    }
  }
  CHECK(made > trials / 2);
  SUCCEED("made " << made);
  SUCCEED("refused " << refused);
}

}  // namespace
}  // namespace formwright
