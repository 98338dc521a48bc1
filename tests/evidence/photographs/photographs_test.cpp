// SPDX-License-Identifier: GPL-3.0-or-later
// Virtual photographs of a bump known by formula, from JPEG files to measured points.
#include <catch2/catch_test_macros.hpp>

#include "base/error.h"
#include "evidence/photographs/measured_truth.h"

namespace formwright {
namespace {

test::Scene usual_scene() {
  test::Scene scene;
  scene.sheet = test::small_mark_sheet();
  return scene;
}

PhotographMeasurement measured(const test::Scene& scene, const test::Taken& taken) {
  Context context;
  return measure_photographs(taken.photographs, scene.sheet, test::options_of(scene), context);
}

TEST_CASE("Photographs.MarksOfABumpAreFoundWhereTheyAre") {
  const test::Scene scene = usual_scene();
  const PhotographMeasurement m = measured(scene, test::take_photographs(scene, {}, test::ring_of_views(8)));
  const test::TruthError e = test::truth_error(m, scene.bump);
  WARN("points " << e.points << " median " << e.median_mm << " 95% " << e.percentile_95_mm << " max " << e.max_mm
                 << " chi2 " << e.chi_square << " within " << e.within_2_sigma << " rms_px " << m.rms_px << " noise "
                 << m.noise << " f " << m.lenses[0].focal_px << " k1 " << m.lenses[0].k1 << " k2 " << m.lenses[0].k2
                 << " outliers " << m.outliers << " find " << m.seconds_find << " solve " << m.seconds_solve);
  for (const auto& n : m.notes) WARN(n);
  CHECK(e.points > 600);
  CHECK(e.median_mm < 0.1);
}

}  // namespace
}  // namespace formwright
