// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/zippable/zippable_model.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/models/zippable/zipper_place.h"
#include "evidence/models/zippable/zippable_proposals.h"
#include "evidence/virtual_zippable.h"
#include "zippable/plan/planned.h"
#include "zippable/zipping/ribbons.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

std::string message_of(const std::string& csv) {
  try {
    read_measured_lengths(to_bytes(csv));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

int parameter_named(const ForwardModel& model, const std::string& name) {
  for (std::size_t p = 0; p < model.parameters().size(); ++p)
    if (model.parameters()[p].name == name) return static_cast<int>(p);
  FAIL("no parameter " << name);
  return -1;
}

/// A ribbon that zips up into a cylinder once around of 100 mm, with marks 10 mm apart.
MeasuredZippable cylinder(std::vector<MeasuredLength> lengths) {
  MeasuredZippable object;
  object.name = "cylinder";
  object.design = test::cylinder_ribbon({100, 60, 2, 24, 0});
  object.setup.bending_n_mm = 0.002;
  object.marker_spacing_mm = 10;
  object.lengths = std::move(lengths);
  return object;
}

TEST_CASE("MeasuredLengths.AreReadAsAMakerWritesThem") {
  const std::vector<MeasuredLength> lengths = read_measured_lengths(to_bytes(
      "from,to,state,length_mm,sigma_mm,expected_mm\r\n12,40,zipped,143.5,,140\r\n\r\n3L, 7R ,flat,20,0.25,\n5,6,zipped,,,9\n"));
  REQUIRE(lengths.size() == 2);
  CHECK(lengths[0].from.number == 12);
  CHECK(lengths[0].to.number == 40);
  CHECK_FALSE(lengths[0].flat);
  CHECK(lengths[0].length_mm == 143.5);
  CHECK(lengths[0].sigma_mm == 0.5);
  CHECK(lengths[1].flat);
  CHECK(lengths[1].from.left);
  CHECK_FALSE(lengths[1].to.left);
  CHECK(lengths[1].sigma_mm == 0.25);
}

TEST_CASE("MeasuredLengths.SayWhichLineIsWrong") {
  const std::string head = "from,to,state,length_mm,sigma_mm\n";
  CHECK(message_of("") == "lengths.csv, line 1: the file is empty: the header is from,to,state,length_mm,sigma_mm.");
  CHECK(message_of("from,to,length_mm\n").find("the column “state” is missing") != std::string::npos);
  CHECK(message_of(head + "1,2,zipped,10\n1,2,wet,10\n").find("line 3: “state” must be flat or zipped") !=
        std::string::npos);
  CHECK(message_of(head + "1,2,zipped,1O\n").find("“length_mm” must be a number") != std::string::npos);
  CHECK(message_of(head + "1,2,zipped,nan\n").find("“length_mm” must be a number") != std::string::npos);
  CHECK(message_of(head + "1,2,zipped,-3\n").find("“length_mm” must be above 0") != std::string::npos);
  CHECK(message_of(head + "1,2,zipped,3,0\n").find("“sigma_mm” must be above 0") != std::string::npos);
  CHECK(message_of(head + "1,2,flat,3\n").find("a mark needs its side: write 1L or 1R") != std::string::npos);
  CHECK(message_of(head + "2,2,zipped,3\n").find("the same place") != std::string::npos);
  CHECK(message_of(head + "a,2,zipped,3\n").find("“from” must be the number of a mark") != std::string::npos);
}

TEST_CASE("ZippableModel.LengthsOnACylinderAreThoseOfItsCircumference") {
  // Marks a whole turn apart lie above each other; half a turn apart, across the cylinder.
  const double turn = std::hypot(100.0, 30.0);
  Context context;
  MeasuredZippable object = cylinder({});
  const RibbonPattern pattern = pattern_of(object.design, 0, context);
  CHECK_THAT(pattern.zipper_mm, WithinAbs(2 * turn, 1e-9));
  object.marker_spacing_mm = turn / 8;
  for (int from = 2; from < 6; ++from)
    for (const int marks : {4, 8}) object.lengths.push_back({{from, true}, {from + marks, true}, false, 1, 0.1});
  const ZippableModel model({object}, context);
  const Eigen::VectorXd u = model.nominal();
  const auto expected = [](double circumference, double rise, bool half) {
    return half ? std::hypot(circumference / 3.14159265358979, rise / 2) : rise;
  };
  Eigen::MatrixXd lengths = model.predict(0, u, context);
  for (Eigen::Index i = 0; i < lengths.rows(); ++i)
    CHECK_THAT(lengths(i, 0), WithinAbs(expected(100, 30, i % 2 == 0), 0.4));
  Eigen::VectorXd larger = u;
  larger[parameter_named(model, "plan_scale")] = 0.05;
  const Eigen::MatrixXd grown = model.predict(0, larger, context);
  for (Eigen::Index i = 0; i < lengths.rows(); ++i)
    CHECK_THAT(grown(i, 0) / lengths(i, 0), WithinAbs(1.05, 2e-3));  // the cloth bends less where it is larger
  Eigen::VectorXd tape = u;
  tape[parameter_named(model, "tape_scale")] = 0.05;
  CHECK((model.predict(0, tape, context) - 1.05 * lengths).norm() < 1e-9);
}

TEST_CASE("ZippableModel.FlatLengthsAreThoseOfThePlane") {
  Context context;
  // Columns are 100 / 24 mm apart along x: marks at each on the left side, 4 columns from one to the other.
  MeasuredZippable object = cylinder({{{4, true}, {8, true}, true, 1, 0.1}});
  object.marker_spacing_mm = std::hypot(100.0, 30.0) / 24;
  const ZippableModel model({object}, context);
  const double column = 100.0 / 24, rise = 30.0 / 24;
  CHECK_THAT(model.predict(0, model.nominal(), context)(0, 0), WithinAbs(4 * std::hypot(column, rise), 1e-9));
  Eigen::VectorXd u = model.nominal();
  u[parameter_named(model, "cloth_stretch_along")] = 0.1;
  u[parameter_named(model, "more_gap_mm")] = 3;  // is sewn later
  CHECK_THAT(model.predict(0, u, context)(0, 0), WithinAbs(4 * std::hypot(1.1 * column, rise), 1e-9));
}

TEST_CASE("ZippableModel.AScanThatLiesAnywhereIsFoundAgain") {
  Context context;
  const FlatDesign design = test::designed("cat", 25, 150);
  std::mt19937 random(3);
  virtual_lab::ZippableObservation observation;
  observation.zipped_lengths = observation.flat_lengths = 0;
  observation.scan_points = 1200;
  observation.scan_sigma_mm = 0.1;
  virtual_lab::HiddenMaking making{virtual_lab::usual_cloth()};
  const MeasuredZippable object = virtual_lab::make_zippable("cat", design, making, observation, random);
  const ZippableModel model({object}, context);
  const Eigen::MatrixXd off = model.predict(0, model.nominal(), context);
  // It was made with smaller triangles, so that smaller ones of ours are nearer to it.
  Eigen::VectorXd finer = model.nominal();
  finer[parameter_named(model, "finer_cloth")] = 1;
  const double coarse_mm = off.cwiseAbs().mean(), finer_mm = model.predict(0, finer, context).cwiseAbs().mean();
  CAPTURE(coarse_mm, finer_mm);
  CHECK(coarse_mm < 1);
  CHECK(finer_mm < 0.5 * coarse_mm);
  MeasuredZippable moved = object;
  moved.scan_mm = (object.scan_mm * Eigen::AngleAxisd(2.1, Vec3(1, 2, 3).normalized()).toRotationMatrix()).rowwise() +
                  Eigen::RowVector3d(-40, 300, 7);
  const ZippableModel same({moved}, context);
  CHECK_THAT(same.predict(0, same.nominal(), context).cwiseAbs().mean(), WithinAbs(off.cwiseAbs().mean(), 1e-3));
  // Cloth zips up as well inside out.
  MeasuredZippable mirrored = object;
  mirrored.scan_mm.col(0) *= -1;
  const ZippableModel inside_out({mirrored}, context);
  CHECK_THAT(inside_out.predict(0, inside_out.nominal(), context).cwiseAbs().mean(),
             WithinAbs(off.cwiseAbs().mean(), 1e-3));
}

TEST_CASE("ZippableModel.IsTheSameForTheSameParameters") {
  Context context;
  const MeasuredZippable object =
      cylinder({{{2, true}, {9, true}, false, 1, 0.1}, {{3, true}, {14, true}, false, 1, 0.1}});
  const ZippableModel a({object}, context), b({object}, context);
  Eigen::VectorXd u = a.nominal();
  u[parameter_named(a, "more_gap_mm")] = 1;
  a.predict(0, a.nominal(), context);  // what was simulated before does not matter
  CHECK(a.predict(0, u, context) == b.predict(0, u, context));
}

TEST_CASE("ZippableModel.RefusesAFlatLengthFromOnePieceToAnother") {
  Context context;
  MeasuredZippable object = cylinder({{{1, true}, {14, true}, true, 1, 0.1}});
  for (Eigen::Index f = 0; f < object.design.triangles.rows(); ++f)
    object.design.turn_of_triangle_rad.push_back(static_cast<double>(f));
  CHECK_THROWS_AS(ZippableModel({object}, context), Error);
}

struct Hidden {
  const char *cause, *shape;
  unsigned seed;
};

/// What the diagnosis says of an object of 200 mm in which a cause is hidden.
std::pair<std::vector<std::string>, MakingProfile> diagnosed_zippable(const Hidden& hidden) {
  Context context;
  std::mt19937 random(hidden.seed);
  const FlatDesign design = test::designed(hidden.shape, 25, 200);
  virtual_lab::HiddenMaking making = virtual_lab::draw_making(random);
  if (std::string(hidden.cause) != "none") virtual_lab::hide_cause(hidden.cause, 1, 200, 25, random, making);
  const ZippableModel model({virtual_lab::make_zippable("object", design, making, {}, random)}, context);
  SimulationBag bag(model);
  DiagnosisOptions options;
  options.pairs = false;
  const Diagnosis d = diagnose(bag, options, context);
  std::vector<std::string> names;
  for (const int cause : d.verdict) names.push_back(model.causes()[static_cast<std::size_t>(cause)].name);
  return {names, model.profile_at(d.extended.u)};
}

TEST_CASE("ZippableModel.NamesAWiderZipperAndMakesUpForItOnAnotherShape") {
  const auto [names, profile] = diagnosed_zippable({"zipper_gap", "star", 104});
  CHECK(names == std::vector<std::string>{"zipper_gap"});
  const double found = profile.parameters.value("more_gap_mm", 0.0);
  std::mt19937 random(104);
  virtual_lab::HiddenMaking making = virtual_lab::draw_making(random);
  virtual_lab::hide_cause("zipper_gap", 1, 200, 25, random, making);
  CHECK_THAT(found, WithinAbs(making.options.more_gap_mm, 0.3));
  // A heart by the usual plan, and by the one that makes up for what was found.
  Context context;
  const RibbonPattern heart = pattern_of(ribbon_of(test::designed("heart", 25, 200)), 0, context);
  const auto off_mm = [&](double gap) {
    ZippingOptions options = making.options;
    options.more_gap_mm = gap;
    const ZippedAtRest rest = zipped_at_rest(heart, options, heart.predicted_mm, context);
    return compare_shapes(rest.x, heart.predicted_mm, Eigen::VectorXd::Ones(rest.x.rows())).mean_mm;
  };
  const double before = off_mm(making.options.more_gap_mm), after = off_mm(making.options.more_gap_mm - found);
  CHECK(after < 0.5 * before);
}

TEST_CASE("ZippableModel.NamesMarksOfAnotherSize") {
  CHECK(diagnosed_zippable({"marks_scale", "star", 108}).first == std::vector<std::string>{"marks_scale"});
}

TEST_CASE("ZippableModel.NamesNothingWhereNothingIsHidden") {
  CHECK(diagnosed_zippable({"none", "star", 11}).first.empty());
}

TEST_CASE("MakingProfile.IsReadAsItWasWrittenAndRefusedOtherwise") {
  MakingProfile profile;
  profile.name = "Kitchen";
  profile.parameters["more_gap_mm"] = 1.25;
  profile.from = {"star"};
  const MakingProfile read = read_making_profile(to_bytes(write_making_profile(profile)));
  CHECK(read.name == "Kitchen");
  CHECK(read.parameters == profile.parameters);
  CHECK(read.from == profile.from);
  const Json merged = with_making_profile({{"more_gap_mm", 2}, {"coil", "5"}}, read);
  CHECK(merged["more_gap_mm"] == 2);
  for (const char* wrong :
       {"{}", "[1]", R"({"format":"formwright-making-profile","version":1,"parameters":{"more_gap_mm":99}})",
        R"({"format":"formwright-making-profile","version":1,"parameters":{"wings":1}})"})
    CHECK_THROWS_AS(read_making_profile(to_bytes(wrong)), Error);
}

}  // namespace
}  // namespace formwright
