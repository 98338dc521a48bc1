// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipping.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <cmath>

#include "base/error.h"
#include "base/data/json.h"
#include "base/parallel.h"
#include "base/random.h"
#include "formats/mesh_io.h"
#include "zippable/plan/planned.h"
#include "zippable/zipping/ribbons.h"
#include "zippable/zipping/zipping_files.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

ZippingOptions quick() {
  ZippingOptions options;
  options.steps = 60;
  options.frames = 5;
  options.bending_n_mm = 0.02;
  return options;
}

ZippingResult simulated(const RibbonDesign& design, const ZippingOptions& options = quick()) {
  Context context;
  return simulate_zipping(design, options, context);
}

TEST_CASE("Zipping.OfAHelixRibbonIsTheCylinderAndTendsToItWithTheSquareOfItsColumns") {
  std::vector<double> error;
  for (const int around : {8, 16, 32}) {
    const ZippingResult result = simulated(test::cylinder_ribbon({100, 60, 2, around, 0}));
    CHECK((result.closed() && result.settled));
    CHECK(result.gap_max_mm < 0.01 * result.pattern.width_mm);
    CHECK(result.crossings == 0);
    CHECK(zipping_outcome(result, 2) == ZippingOutcome::takes_shape);
    CHECK(result.strain_mean < 0.003);
    error.push_back(result.comparison.mean_mm);
    // The radius by itself, of places off the rims.
    double radius = 0;
    int count = 0;
    for (Eigen::Index i = 0; i < result.zipped_mm.rows(); ++i)
      if (result.zipped_mm(i, 2) > 15 && result.zipped_mm(i, 2) < 45)
        radius += result.zipped_mm.row(i).head<2>().norm(), ++count;
    CHECK_THAT(radius / count, WithinAbs(100 / (2 * std::numbers::pi), 60.0 / (around * around)));
  }
  CHECK(error[2] < 0.15);
  CHECK(std::log2(error[0] / error[1]) > 1.5);
  CHECK(std::log2(error[1] / error[2]) > 0.8);  // the cloth's own stretch begins to show
}

TEST_CASE("Zipping.OfAConesRibbonIsTheCone") {
  const ZippingResult result = simulated(test::cone_ribbon({100, 50, 2, 16, 0}, 80));
  CHECK((result.closed() && result.settled));
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::takes_shape);
  CHECK(result.comparison.mean_mm < 0.5);
}

TEST_CASE("Zipping.WithoutAZipperStaysFlat") {
  RibbonDesign design = test::cylinder_ribbon({100, 60, 2, 8, 0});
  for (RibbonEdgePlace& place : design.places) {
    place.sample = place.piece = -1;
    place.predicted_mm << place.flat_mm, 0;
  }
  const ZippingResult result = simulated(design);
  CHECK(result.settled);
  CHECK_FALSE(result.comparison.mirrored);
  CHECK(result.comparison.largest_mm < 1e-3 * result.pattern.width_mm);
  CHECK(result.energies.inner_mj() < 1e-6);
}

TEST_CASE("Zipping.DependsOnNothingThatItShouldNot") {
  const RibbonDesign design = test::cylinder_ribbon({100, 60, 1, 10, 0});
  const ZippingResult result = simulated(design);
  {
    const ThreadLimit one(1);
    CHECK((simulated(design).zipped_mm - result.zipped_mm).cwiseAbs().maxCoeff() == 0);
  }
  RibbonDesign twice = design, turned = design;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (std::size_t i = 0; i < design.places.size(); ++i) {
    twice.places[i].flat_mm *= 2, twice.places[i].predicted_mm *= 2;
    turned.places[i].flat_mm = Eigen::Rotation2Dd(1.1) * design.places[i].flat_mm + Vec2(30, -7);
    turned.places[i].predicted_mm = turn * design.places[i].predicted_mm + Vec3(5, 6, 7);
  }
  // Twice the size with the same stretch stiffness and four times the bending stiffness is the same shape, twice as
  // large.
  ZippingOptions stiffer = quick();
  stiffer.bending_n_mm = 4 * *quick().bending_n_mm;
  CHECK((simulated(twice, stiffer).zipped_mm - 2 * result.zipped_mm).cwiseAbs().maxCoeff() < 1e-6);
  const ZippingResult other = simulated(turned);
  CHECK_THAT(other.comparison.mean_mm, WithinAbs(result.comparison.mean_mm, 0.01));
  CHECK_THAT(other.energies.inner_mj(), WithinAbs(result.energies.inner_mj(), 0.01 * result.energies.inner_mj()));
}

TEST_CASE("Zipping.SaysWhenADesignIsWrong") {
  // One side sewn on by a sixteenth of a turn too far, and a ribbon one side of which grew by a tenth.
  CHECK(zipping_outcome(simulated(test::cylinder_ribbon({100, 60, 2, 16, 1})), 2) != ZippingOutcome::takes_shape);
  RibbonDesign stretched = test::cylinder_ribbon({100, 60, 2, 16, 0});
  for (RibbonEdgePlace& place : stretched.places)
    if (!place.left) place.flat_mm.x() *= 1.1;
  const ZippingResult result = simulated(stretched);
  CHECK(zipping_outcome(result, 2) != ZippingOutcome::takes_shape);
  CHECK(zipping_verdict(result, 2).find("It zips into the intended shape") == std::string::npos);
}

TEST_CASE("Zipping.IsJudgedByTheToleranceAndByWhatTheClothDoesByItself") {
  ZippingResult result;
  result.pattern.size_mm = 100;
  result.settled = true;
  result.comparison.percentile_95_mm = 1.9;
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::takes_shape);
  result.comparison.percentile_95_mm = 2.8;
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::another_shape);
  result.rest.percentile_95_mm = 2.4;  // it sags that far put into the shape
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::as_the_cloth_does);
  {
    INFO(zipping_verdict(result, 2));
    CHECK(zipping_verdict(result, 2).find("would rest 2.4 mm away") != std::string::npos);
  }
  result.comparison.percentile_95_mm = 3.1;
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::another_shape);
  result.comparison.percentile_95_mm = result.rest.percentile_95_mm = 6.5;  // cloth that keeps no shape
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::another_shape);
  result.settled = false;
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::not_settled);
  result.open_seams = 1;
  CHECK(zipping_outcome(result, 2) == ZippingOutcome::open_seams);
}

TEST_CASE("Zipping.FramesStayInTheirPlace") {
  const ZippingResult result = simulated(test::cylinder_ribbon({100, 60, 2, 8, 0}));
  REQUIRE(result.frames.size() >= 3u);
  CHECK((result.frames.back().V.cast<double>() - result.zipped_mm).cwiseAbs().maxCoeff() < 1e-4);
  for (std::size_t f = 0; f + 1 < result.frames.size(); ++f) {
    const Eigen::MatrixXd here = result.frames[f].V.cast<double>(), next = result.frames[f + 1].V.cast<double>();
    // Turned on as well as can be, no place can go farther than the cloth is long.
    INFO(f);
    CHECK((here - next).rowwise().norm().maxCoeff() <
          2 * (here.colwise().maxCoeff() - here.colwise().minCoeff()).norm());
    CHECK((here.colwise().mean() - next.colwise().mean()).norm() < 0.5 * result.pattern.size_mm);
  }
}

TEST_CASE("Zipping.TriesOtherCoursesUntilOneFits") {
  const RibbonDesign cone = test::cone_ribbon({100, 50, 2, 16, 0}, 80);
  ZippingOptions held = quick();
  held.hold_open_percent = 40;
  const ZippingResult one = simulated(cone, held), any = simulated(cone);
  CHECK(one.attempts == 1);
  CHECK(zipping_outcome(any, 2) == ZippingOutcome::takes_shape);
  CHECK(any.comparison.percentile_95_mm <= one.comparison.percentile_95_mm);
  CHECK((any.attempts > 1) == (zipping_outcome(one, 2) != ZippingOutcome::takes_shape));
}

TEST_CASE("Zipping.LimbsThatWereTuckedInComeOutWhenPressed") {
  const RibbonDesign octopus = ribbon_of(test::designed("octopus", 15, 100));
  ZippingOptions options = quick();
  options.steps = 40;
  options.hold_open_percent = 40;
  options.press_out_percent = 0;
  const ZippingResult tucked_in = simulated(octopus, options);
  options.press_out_percent = 300;
  const ZippingResult pressed = simulated(octopus, options);
  CHECK((pressed.pressed_out && pressed.closed() && pressed.settled));
  CHECK(pressed.comparison.percentile_95_mm < 0.5 * tucked_in.comparison.percentile_95_mm);
  CHECK(pressed.crossings < tucked_in.crossings);
  // Started alike, the two differ only in that.
  CHECK(pressed.held_open_percent == tucked_in.held_open_percent);
}

TEST_CASE("Zipping.CutHandlesAreClosedByHandLast") {
  RibbonDesign torus = ribbon_of(test::designed("torus", 25, 100));
  REQUIRE(torus.closures.size() == 1u);
  ZippingOptions once = quick();
  once.hold_open_percent = 40;
  once.press_out_percent = 0;
  const ZippingResult closed = simulated(torus, once);
  CHECK((closed.closed() && closed.settled));
  REQUIRE_FALSE(closed.pattern.closures.empty());
  CHECK(closed.gap_max_mm < 0.01 * closed.pattern.width_mm);
  CHECK(closed.comparison.percentile_95_mm < 0.01 * closed.pattern.size_mm);
  CHECK(closed.crossings == 0);
  torus.closures.clear();
  const ZippingResult open = simulated(torus, once);
  CHECK(open.comparison.percentile_95_mm > 2 * closed.comparison.percentile_95_mm);
}

TEST_CASE("Zipping.StuffedClothWithOpeningsComesToRest") {
  ZippingOptions stuffed = quick();
  stuffed.stuffing_pressure_pa = 100;
  stuffed.hold_open_percent = 0;
  const ZippingResult result = simulated(test::cone_ribbon({100, 50, 2, 16, 0}, 80), stuffed);
  CHECK(result.settled);
}

TEST_CASE("Balance.TakesForceAndMomentAndNothingElse") {
  Random random(5);
  Positions x(40, 3), force(40, 3);
  Eigen::VectorXd area(40);
  for (Eigen::Index i = 0; i < 40; ++i) {
    for (int k = 0; k < 3; ++k) x(i, k) = random.uniform(-50, 50), force(i, k) = random.uniform(-1, 1);
    area[i] = random.uniform(0.5, 2);
  }
  const auto moment = [&] {
    Vec3 sum = Vec3::Zero();
    for (Eigen::Index i = 0; i < 40; ++i) sum += Vec3(x.row(i)).cross(Vec3(force.row(i)));
    return sum;
  };
  REQUIRE(moment().norm() > 1);
  balance(force, x, area);
  CHECK(force.colwise().sum().norm() < 1e-12);
  CHECK(moment().norm() < 1e-10);
  const Positions once = force;
  balance(force, x, area);
  CHECK((force - once).norm() < 1e-12);
}

TEST_CASE("RibbonPattern.HalvesBothSidesOfTheZipperAlike") {
  Context context;
  const RibbonDesign design = test::cylinder_ribbon({100, 60, 2, 16, 0});
  const RibbonPattern coarse = make_ribbon_pattern(design.places, design.triangles, 0, context),
                      fine = make_ribbon_pattern(design.places, design.triangles, 4, context);
  CHECK(coarse.seams.size() == 33u);
  CHECK(fine.seams.size() == 65u);
  CHECK_THAT(fine.width_mm, WithinAbs(coarse.width_mm, 1e-9));
  for (const SeamPair& seam : fine.seams)
    CHECK((fine.predicted_mm.row(seam.left) - fine.predicted_mm.row(seam.right)).norm() < 1e-9);
  for (const ClothTriangle& t : cloth_triangles(fine.flat))
    for (std::size_t k = 0; k < 3; ++k)
      CHECK((fine.flat.V.row(t.vertex[k]) - fine.flat.V.row(t.vertex[(k + 1) % 3])).norm() <= 4);
}

TEST_CASE("RibbonPattern.RefusesWhatIsNoRibbon") {
  Context context;
  const auto expect_refused = [&](const RibbonDesign& design) {
    try {
      make_ribbon_pattern(design.places, design.triangles, 0, context);
      FAIL_CHECK("was accepted");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalid_input);
      CHECK(error.where() == "design");
    }
  };
  const RibbonDesign good = test::cylinder_ribbon({100, 60, 1, 6, 0});
  RibbonDesign bad = good;
  bad.triangles(2, 1) = 999;
  expect_refused(bad);
  bad = good;
  bad.triangles.row(0).swap(bad.triangles.row(1));
  std::swap(bad.triangles(0, 0), bad.triangles(0, 1));
  expect_refused(bad);
  bad = good;
  for (RibbonEdgePlace& place : bad.places)
    if (place.sample == 3 && place.left) place.sample = -1;
  expect_refused(bad);
  for (const char* text :
       {"", "{}",
        R"({"format": "formwright zippable design", "pieces": [], "ribbon": {"boundary": [1], "triangles": []}})"})
    CHECK_THROWS_AS(read_flat_design(as_bytes(std::string(text))), Error);
}

TEST_CASE("Zipping.StopsWhenCancelled") {
  int asked = 0;
  Host host;
  host.cancel_requested = [&] { return ++asked > 50; };
  Context context(host);
  CHECK_THROWS_AS(simulate_zipping(test::cylinder_ribbon({100, 60, 2, 16, 0}), quick(), context), Error);
  CHECK(asked < 60);
}

TEST_CASE("ShapeComparison.FindsTheMotionAndTheMirror") {
  test::Random random(2);
  Positions x(6, 3);
  for (int i = 0; i < 6; ++i) x.row(i) = random.in_cube();
  const Eigen::VectorXd weight = Eigen::VectorXd::LinSpaced(6, 1, 2);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2, Vec3::UnitY()).toRotationMatrix();
  for (const bool mirrored : {false, true}) {
    Positions to = x * turn.transpose();
    if (mirrored) to.col(1) *= -1;
    to.rowwise() += Eigen::RowVector3d(1, 2, 3);
    const ShapeComparison found = compare_shapes(x, to, weight);
    CHECK(found.mirrored == mirrored);
    CHECK(found.largest_mm < 1e-12);
  }
}

TEST_CASE("ZippingFiles.HoldTheShapeAndTheCourse") {
  Context context;
  const ZippingResult result = simulated(test::cylinder_ribbon({100, 60, 1, 10, 0}));
  REQUIRE(result.frames.size() >= 3u);
  const ModelFile ply = read_model_file(write_zipped_ply(result, context), "zipped.ply", {}, context);
  CHECK(ply.columns.at(0).name == "distance_mm");
  CHECK(ply.model.mesh.V == result.zipped_mm);
  const Bytes glb = write_zipping_glb(result, context);
  const std::string text(as_text(glb));
  const std::size_t end = text.find("BIN");
  const Json json = Json::parse(text.substr(20, end - 24));
  CHECK(json["meshes"][0]["primitives"][0]["targets"].size() == result.frames.size() - 1);
  CHECK(json["meshes"][0]["extras"]["zipped_share"].back() == 1.0);
}

}  // namespace
}  // namespace formwright
