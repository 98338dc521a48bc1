// SPDX-License-Identifier: GPL-3.0-or-later
#include "zippable/zipping/zipping.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "base/error.h"
#include "base/json.h"
#include "base/parallel.h"
#include "base/random.h"
#include "geometry/io/mesh_io.h"
#include "zippable/plan/planned.h"
#include "zippable/zipping/ribbons.h"
#include "zippable/zipping/zipping_files.h"

namespace formwright {
namespace {

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

TEST(Zipping, OfAHelixRibbonIsTheCylinderAndTendsToItWithTheSquareOfItsColumns) {
  std::vector<double> error;
  for (const int around : {8, 16, 32}) {
    const ZippingResult result = simulated(test::cylinder_ribbon({100, 60, 2, around, 0}));
    EXPECT_TRUE(result.closed() && result.settled);
    EXPECT_LT(result.gap_max_mm, 0.01 * result.pattern.width_mm);
    EXPECT_EQ(result.crossings, 0);
    EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::takes_shape);
    EXPECT_LT(result.strain_mean, 0.003);
    error.push_back(result.comparison.mean_mm);
    // The radius by itself, of places off the rims.
    double radius = 0;
    int count = 0;
    for (Eigen::Index i = 0; i < result.zipped_mm.rows(); ++i)
      if (result.zipped_mm(i, 2) > 15 && result.zipped_mm(i, 2) < 45)
        radius += result.zipped_mm.row(i).head<2>().norm(), ++count;
    EXPECT_NEAR(radius / count, 100 / (2 * std::numbers::pi), 60.0 / (around * around));
  }
  EXPECT_LT(error[2], 0.15);
  EXPECT_GT(std::log2(error[0] / error[1]), 1.5);
  EXPECT_GT(std::log2(error[1] / error[2]), 0.8);  // the cloth's own stretch begins to show
}

TEST(Zipping, OfAConesRibbonIsTheCone) {
  const ZippingResult result = simulated(test::cone_ribbon({100, 50, 2, 16, 0}, 80));
  EXPECT_TRUE(result.closed() && result.settled);
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::takes_shape);
  EXPECT_LT(result.comparison.mean_mm, 0.5);
}

TEST(Zipping, WithoutAZipperStaysFlat) {
  RibbonDesign design = test::cylinder_ribbon({100, 60, 2, 8, 0});
  for (RibbonEdgePlace& place : design.places) {
    place.sample = place.piece = -1;
    place.predicted_mm << place.flat_mm, 0;
  }
  const ZippingResult result = simulated(design);
  EXPECT_TRUE(result.settled);
  EXPECT_FALSE(result.comparison.mirrored);
  EXPECT_LT(result.comparison.largest_mm, 1e-3 * result.pattern.width_mm);
  EXPECT_LT(result.energies.inner_mj(), 1e-6);
}

TEST(Zipping, DependsOnNothingThatItShouldNot) {
  const RibbonDesign design = test::cylinder_ribbon({100, 60, 1, 10, 0});
  const ZippingResult result = simulated(design);
  {
    const ThreadLimit one(1);
    EXPECT_EQ((simulated(design).zipped_mm - result.zipped_mm).cwiseAbs().maxCoeff(), 0);
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
  EXPECT_LT((simulated(twice, stiffer).zipped_mm - 2 * result.zipped_mm).cwiseAbs().maxCoeff(), 1e-6);
  const ZippingResult other = simulated(turned);
  EXPECT_NEAR(other.comparison.mean_mm, result.comparison.mean_mm, 0.01);
  EXPECT_NEAR(other.energies.inner_mj(), result.energies.inner_mj(), 0.01 * result.energies.inner_mj());
}

TEST(Zipping, SaysWhenADesignIsWrong) {
  // One side sewn on by a sixteenth of a turn too far, and a ribbon one side of which grew by a tenth.
  EXPECT_NE(zipping_outcome(simulated(test::cylinder_ribbon({100, 60, 2, 16, 1})), 2), ZippingOutcome::takes_shape);
  RibbonDesign stretched = test::cylinder_ribbon({100, 60, 2, 16, 0});
  for (RibbonEdgePlace& place : stretched.places)
    if (!place.left) place.flat_mm.x() *= 1.1;
  const ZippingResult result = simulated(stretched);
  EXPECT_NE(zipping_outcome(result, 2), ZippingOutcome::takes_shape);
  EXPECT_EQ(zipping_verdict(result, 2).find("It zips into the intended shape"), std::string::npos);
}

TEST(Zipping, IsJudgedByTheToleranceAndByWhatTheClothDoesByItself) {
  ZippingResult result;
  result.pattern.size_mm = 100;
  result.settled = true;
  result.comparison.percentile_95_mm = 1.9;
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::takes_shape);
  result.comparison.percentile_95_mm = 2.8;
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::another_shape);
  result.rest.percentile_95_mm = 2.4;  // it sags that far put into the shape
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::as_the_cloth_does);
  EXPECT_NE(zipping_verdict(result, 2).find("would rest 2.4 mm off"), std::string::npos) << zipping_verdict(result, 2);
  result.comparison.percentile_95_mm = 3.1;
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::another_shape);
  result.comparison.percentile_95_mm = result.rest.percentile_95_mm = 6.5;  // cloth that keeps no shape
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::another_shape);
  result.settled = false;
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::not_settled);
  result.open_seams = 1;
  EXPECT_EQ(zipping_outcome(result, 2), ZippingOutcome::open_seams);
}

TEST(Zipping, FramesStayInTheirPlace) {
  const ZippingResult result = simulated(test::cylinder_ribbon({100, 60, 2, 8, 0}));
  ASSERT_GE(result.frames.size(), 3u);
  EXPECT_LT((result.frames.back().V.cast<double>() - result.zipped_mm).cwiseAbs().maxCoeff(), 1e-4);
  for (std::size_t f = 0; f + 1 < result.frames.size(); ++f) {
    const Eigen::MatrixXd here = result.frames[f].V.cast<double>(), next = result.frames[f + 1].V.cast<double>();
    // Turned on as well as can be, no place can go farther than the cloth is long.
    EXPECT_LT((here - next).rowwise().norm().maxCoeff(),
              2 * (here.colwise().maxCoeff() - here.colwise().minCoeff()).norm())
        << f;
    EXPECT_LT((here.colwise().mean() - next.colwise().mean()).norm(), 0.5 * result.pattern.size_mm) << f;
  }
}

TEST(Zipping, TriesOtherCoursesUntilOneFits) {
  const RibbonDesign cone = test::cone_ribbon({100, 50, 2, 16, 0}, 80);
  ZippingOptions held = quick();
  held.hold_open_percent = 40;
  const ZippingResult one = simulated(cone, held), any = simulated(cone);
  EXPECT_EQ(one.attempts, 1);
  EXPECT_EQ(zipping_outcome(any, 2), ZippingOutcome::takes_shape);
  EXPECT_LE(any.comparison.percentile_95_mm, one.comparison.percentile_95_mm);
  EXPECT_EQ(any.attempts > 1, zipping_outcome(one, 2) != ZippingOutcome::takes_shape);
}

TEST(Zipping, LimbsThatWereTuckedInComeOutWhenPressed) {
  const RibbonDesign octopus = ribbon_of(test::designed("octopus", 15, 100));
  ZippingOptions options = quick();
  options.steps = 40;
  options.hold_open_percent = 40;
  options.press_out_percent = 0;
  const ZippingResult tucked_in = simulated(octopus, options);
  options.press_out_percent = 300;
  const ZippingResult pressed = simulated(octopus, options);
  EXPECT_TRUE(pressed.pressed_out && pressed.closed() && pressed.settled);
  EXPECT_LT(pressed.comparison.percentile_95_mm, 0.5 * tucked_in.comparison.percentile_95_mm);
  EXPECT_LT(pressed.crossings, tucked_in.crossings);
  // Started alike, the two differ only in that.
  EXPECT_EQ(pressed.held_open_percent, tucked_in.held_open_percent);
}

TEST(Zipping, CutHandlesAreClosedByHandLast) {
  RibbonDesign torus = ribbon_of(test::designed("torus", 25, 100));
  ASSERT_EQ(torus.closures.size(), 1u);
  ZippingOptions once = quick();
  once.hold_open_percent = 40;
  once.press_out_percent = 0;
  const ZippingResult closed = simulated(torus, once);
  EXPECT_TRUE(closed.closed() && closed.settled);
  ASSERT_FALSE(closed.pattern.closures.empty());
  EXPECT_LT(closed.gap_max_mm, 0.01 * closed.pattern.width_mm);
  EXPECT_LT(closed.comparison.percentile_95_mm, 0.01 * closed.pattern.size_mm);
  EXPECT_EQ(closed.crossings, 0);
  torus.closures.clear();
  const ZippingResult open = simulated(torus, once);
  EXPECT_GT(open.comparison.percentile_95_mm, 2 * closed.comparison.percentile_95_mm);
}

TEST(Zipping, StuffedClothWithOpeningsComesToRest) {
  ZippingOptions stuffed = quick();
  stuffed.stuffing_pressure_pa = 100;
  stuffed.hold_open_percent = 0;
  const ZippingResult result = simulated(test::cone_ribbon({100, 50, 2, 16, 0}, 80), stuffed);
  EXPECT_TRUE(result.settled);
}

TEST(Balance, TakesForceAndMomentAndNothingElse) {
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
  ASSERT_GT(moment().norm(), 1);
  balance(force, x, area);
  EXPECT_LT(force.colwise().sum().norm(), 1e-12);
  EXPECT_LT(moment().norm(), 1e-10);
  const Positions once = force;
  balance(force, x, area);
  EXPECT_LT((force - once).norm(), 1e-12);
}

TEST(RibbonPattern, HalvesBothSidesOfTheZipperAlike) {
  Context context;
  const RibbonDesign design = test::cylinder_ribbon({100, 60, 2, 16, 0});
  const RibbonPattern coarse = make_ribbon_pattern(design.places, design.triangles, 0, context),
                      fine = make_ribbon_pattern(design.places, design.triangles, 4, context);
  EXPECT_EQ(coarse.seams.size(), 33u);
  EXPECT_EQ(fine.seams.size(), 65u);
  EXPECT_NEAR(fine.width_mm, coarse.width_mm, 1e-9);
  for (const SeamPair& seam : fine.seams)
    EXPECT_LT((fine.predicted_mm.row(seam.left) - fine.predicted_mm.row(seam.right)).norm(), 1e-9);
  for (const ClothTriangle& t : cloth_triangles(fine.flat))
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_LE((fine.flat.V.row(t.vertex[k]) - fine.flat.V.row(t.vertex[(k + 1) % 3])).norm(), 4);
}

TEST(RibbonPattern, RefusesWhatIsNoRibbon) {
  Context context;
  const auto expect_refused = [&](const RibbonDesign& design) {
    try {
      make_ribbon_pattern(design.places, design.triangles, 0, context);
      ADD_FAILURE() << "was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::invalid_input);
      EXPECT_EQ(error.where(), "design");
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
    EXPECT_THROW(read_flat_design(as_bytes(std::string(text))), Error);
}

TEST(Zipping, StopsWhenCancelled) {
  int asked = 0;
  Host host;
  host.cancel_requested = [&] { return ++asked > 50; };
  Context context(host);
  EXPECT_THROW(simulate_zipping(test::cylinder_ribbon({100, 60, 2, 16, 0}), quick(), context), Error);
  EXPECT_LT(asked, 60);
}

TEST(ShapeComparison, FindsTheMotionAndTheMirror) {
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
    EXPECT_EQ(found.mirrored, mirrored);
    EXPECT_LT(found.largest_mm, 1e-12);
  }
}

TEST(ZippingFiles, HoldTheShapeAndTheCourse) {
  Context context;
  const ZippingResult result = simulated(test::cylinder_ribbon({100, 60, 1, 10, 0}));
  ASSERT_GE(result.frames.size(), 3u);
  const ModelFile ply = read_model_file(write_zipped_ply(result, context), "zipped.ply", {}, context);
  EXPECT_EQ(ply.columns.at(0).name, "distance_mm");
  EXPECT_EQ(ply.model.mesh.V, result.zipped_mm);
  const Bytes glb = write_zipping_glb(result, context);
  const std::string text(as_text(glb));
  const std::size_t end = text.find("BIN");
  const Json json = Json::parse(text.substr(20, end - 24));
  EXPECT_EQ(json["meshes"][0]["primitives"][0]["targets"].size(), result.frames.size() - 1);
  EXPECT_EQ(json["meshes"][0]["extras"]["zipped_share"].back(), 1.0);
}

}  // namespace
}  // namespace formwright
