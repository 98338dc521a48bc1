// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch_test_macros.hpp>

#include <algorithm>
#include <cmath>

#include "evidence/diagnosis/diagnosis.h"
#include "evidence/models/zippable/tucked_limbs.h"
#include "evidence/models/zippable/zippable_model.h"
#include "evidence/virtual_zippable.h"
#include "geometry/mesh/adjacency.h"
#include "zippable/plan/planned.h"

namespace formwright {
namespace {

struct TuckedCase {
  const char* shape;
  std::optional<double> limb;  // HiddenMaking::tucked_limb
  unsigned seed;
  bool scan;
};

struct TuckedAnswer {
  std::string expected, words;
  std::vector<std::string> named;
};

TuckedAnswer diagnosed_limb(const TuckedCase& hidden) {
  Context context;
  std::mt19937 random(hidden.seed);
  const FlatDesign design = test::designed(hidden.shape, 25, 200);
  virtual_lab::HiddenMaking making = virtual_lab::draw_making(random);
  making.tucked_limb = hidden.limb;
  virtual_lab::ZippableObservation observation;
  if (hidden.scan) observation.scan_points = 1500, observation.zipped_lengths = observation.flat_lengths = 0;
  const ZippableModel model({virtual_lab::make_zippable("object", design, making, observation, random)}, context);
  SimulationBag bag(model);
  DiagnosisOptions options;
  options.pairs = false;
  const Diagnosis d = diagnose(bag, options, context);
  TuckedAnswer answer{"tucked_in_" + std::to_string(virtual_lab::hidden_limb(design, making)), "", {}};
  for (const int cause : d.verdict) answer.named.push_back(model.causes()[static_cast<std::size_t>(cause)].name);
  if (!d.verdict.empty() && d.verdict.front() == d.causes.front().cause)
    answer.words = model.in_words(d.verdict.front(), d.causes.front().values);
  return answer;
}

TEST_CASE("TuckedLimbs.ARibbonClosesToOneSurfaceAndItsLimbsComeInTheOrderOfTheZipper") {
  Context context;
  const RibbonPattern pattern = pattern_of(ribbon_of(test::designed("star", 25, 200)), 12, context);
  const ClosedShape shape = closed_shape(pattern);
  CHECK(vertex_components(Adjacency(shape.mesh)).count == 1);
  for (const SeamPair& pair : pattern.seams)
    CHECK(shape.vertex[static_cast<std::size_t>(pair.left)] == shape.vertex[static_cast<std::size_t>(pair.right)]);
  const std::vector<RibbonLimb> limbs = limbs_of(pattern, context);
  REQUIRE(limbs.size() == 5);
  for (std::size_t i = 0; i + 1 < limbs.size(); ++i)
    CHECK(limbs[i].zipper_mm.front()[0] < limbs[i + 1].zipper_mm.front()[0]);
}

TEST_CASE("TuckedLimbs.SayWhichMarksLieOnThem") {
  RibbonLimb limb;
  limb.zipper_mm = {{95, 215}};
  CHECK(limb_place(limb, 30) == "with marks 4 to 7");
  limb.zipper_mm = {{95, 215}, {295, 301}};
  CHECK(limb_place(limb, 30) == "with marks 4 to 7 and 10");
  limb.zipper_mm = {{119, 121}};
  CHECK(limb_place(limb, 30) == "with mark 4");
  limb.zipper_mm = {{101, 119}};
  CHECK(limb_place(limb, 30) == "100 mm along the zipper");
}

TEST_CASE("TuckedLimbs.AreNamedByLengths") {
  for (const TuckedCase& hidden : {TuckedCase{"star", 0.3, 7, false}, TuckedCase{"cat", 0.0, 5, false}}) {
    CAPTURE(hidden.shape);
    const TuckedAnswer answer = diagnosed_limb(hidden);
    CHECK(answer.named == std::vector{answer.expected});
    CHECK(answer.words.starts_with("The part with marks "));
  }
}

TEST_CASE("TuckedLimbs.AreNamedByAScan") {
  const TuckedAnswer answer = diagnosed_limb({"cat", 0.0, 5, true});
  CHECK(answer.named == std::vector{answer.expected});
}

TEST_CASE("TuckedLimbs.AreNotNamedWhereAllAreOut") {
  CHECK(diagnosed_limb({"star", std::nullopt, 11, false}).named.empty());
  CHECK(diagnosed_limb({"cat", std::nullopt, 12, false}).named.empty());
}

TEST_CASE("TuckedLimbs.AreLeftOutOfWhatIsOnlyPredicted") {
  Context context;
  std::mt19937 random(3);
  const FlatDesign design = test::designed("star", 25, 200);
  const MeasuredZippable object =
      virtual_lab::make_zippable("object", design, {virtual_lab::usual_cloth()}, {}, random);
  const ZippableModel with({object}, context), without({object}, context, TuckedLimbs::are_left_out);
  CHECK(with.causes().size() == without.causes().size() + 5);
  CHECK(with.predict(0, with.nominal(), context) == without.predict(0, without.nominal(), context));
}

}  // namespace
}  // namespace formwright
