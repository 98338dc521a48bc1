// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/simulation_choice.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "base/error.h"
#include "evidence/diagnosed.h"
#include "evidence/toy_model.h"
#include "evidence/virtual_lab.h"

namespace formwright {
namespace {
using namespace virtual_lab;
using Catch::Matchers::WithinAbs;
using evidence_test::diagnosed;
using evidence_test::ToyModel;

constexpr Eigen::Index sag = 6;

/// How the sag is tried, and whether it is at one point in fifteen alone, where it is large.
struct Sagging {
  ExtensionTrial trial = ExtensionTrial::fit;
  bool at_few_points = false;
};

/// A toy whose objects sag. Its usual simulation leaves that out.
class SaggingToy : public ForwardModel {
 public:
  SaggingToy(ToyModel toy, bool simulates_sag, Sagging how = {})
      : toy_(std::move(toy)), parameters_(toy_.parameters()), how_(how) {
    ModelParameter p;
    p.name = p.label = "sag";
    p.role = simulates_sag ? ParameterRole::base : ParameterRole::effect;
    p.high = 5;
    p.prior_sd = 0.5;
    p.probe = 0.1;
    parameters_.push_back(p);
    if (!simulates_sag) with_sag_ = std::make_unique<const SaggingToy>(toy_, true, how);
  }

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return toy_.causes(); }
  const std::vector<Measurement>& measurements() const override { return toy_.measurements(); }
  double known_misfit() const override { return toy_.known_misfit(); }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    if (u[3] > max_ripple) throw Error(ErrorCode::could_not_solve, "", "No answer there.");
    Eigen::MatrixXd y = toy_.predict(object, u.head(sag), context);
    const Measurement& m = measurements().front();
    for (Eigen::Index i = 0; i < y.rows(); ++i) y(i, 1) -= u[sag] * shape(i, m.place(i, 0), m.place(i, 1));
    return y;
  }
  double max_ripple = 1e9;  // beyond it has no answer
  std::vector<SimulationExtension> extensions() const override {
    if (!with_sag_) return {};
    return {{"sag", "Sag", "", "", with_sag_.get(), how_.trial}};
  }

 private:
  double shape(Eigen::Index i, double x, double z) const {
    if (how_.at_few_points) return i % 15 == 0 ? 5 : 0;
    return std::sin(std::numbers::pi * x) * std::sin(2 * std::numbers::pi * z);
  }

  ToyModel toy_;
  std::vector<ModelParameter> parameters_;
  Sagging how_;
  std::unique_ptr<const SaggingToy> with_sag_;
};

/// Measured with noise; `value` of one parameter of the toy.
SaggingToy measured(unsigned seed, double sag_mm, Eigen::Index parameter = 0, double value = 0.1, Sagging how = {}) {
  ToyModel toy(400, seed);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(sag + 1);
  truth[parameter] = value;
  truth[sag] = sag_mm;
  Context context;
  const Eigen::MatrixXd places = SaggingToy(toy, true, how).predict(0, truth, context);
  toy.measure(toy.nominal(), 0.05, seed, 0.02);
  toy.measurement().measured += places - toy.predict(0, toy.nominal(), context);
  return {std::move(toy), false, how};
}

TEST_CASE("SimulationChoice.TakesWhatTheDataShow") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const SaggingToy model = measured(seed, 0.4);
    Context context;
    const SimulationChoice choice = choose_simulation(model, context);
    REQUIRE(choice.taken() == std::vector<std::string>{"sag"});
    CHECK_THAT(choice.u[sag], WithinAbs(0.4, 0.03));
    CHECK(choice.tried.front().error_after_mm < 0.7 * choice.tried.front().error_before_mm);
    CHECK(choice.tried.front().log_evidence_gain > 20);
    CHECK(choice.simulations > 0);
  }
}

TEST_CASE("SimulationChoice.LeavesOutWhatTheyDoNot") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Context context;
    // Nothing, and each of the causes.
    for (const Eigen::Index parameter : {0, 2, 3, 5})
      CHECK(choose_simulation(measured(seed, 0, parameter, 0.6), context).taken().empty());
  }
}

/// The usual simulation takes points that lie millimetres off for outliers. They count: the other one explains them.
TEST_CASE("SimulationChoice.WhatTheUsualOneTakesForOutliersCounts") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const SaggingToy model = measured(seed, 0.4, 0, 0.1, {ExtensionTrial::fit, true});
    Context context;
    const SimulationChoice choice = choose_simulation(model, context);
    REQUIRE(choice.taken() == std::vector<std::string>{"sag"});
    CHECK_THAT(choice.u[sag], WithinAbs(0.4, 0.03));
    CHECK(choose_simulation(measured(seed, 0, 0, 0.1, {ExtensionTrial::fit, true}), context).taken().empty());
  }
}

TEST_CASE("SimulationChoice.OneLookDecidesWhetherAFitIsWorthIt") {
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const double sag_mm : {0.0, 0.4}) {
      const Sagging how{ExtensionTrial::fit_if_one_look_promises};
      Context context;
      const SimulationChoice choice = choose_simulation(measured(seed, sag_mm, 0, 0.1, how), context),
                             with_a_fit = choose_simulation(measured(seed, sag_mm), context);
      CHECK(choice.taken() == with_a_fit.taken());
      REQUIRE(choice.tried.size() == 1);
      CHECK(choice.tried.front().fitted == (sag_mm > 0));
      if (sag_mm == 0) CHECK(choice.simulations < with_a_fit.simulations - 5);
    }
}

TEST_CASE("SimulationChoice.WhatTakesLongerIsAdvisedAndNotTaken") {
  int advised = 0;
  for (unsigned seed = 1; seed <= 5; ++seed)
    for (const double sag_mm : {0.0, 0.6}) {
      Context context;
      const SimulationChoice choice =
          choose_simulation(measured(seed, sag_mm, 0, 0.1, {ExtensionTrial::one_look}), context);
      CHECK(choice.taken().empty());
      for (const TriedExtension& t : choice.tried) {
        CHECK_FALSE(t.fitted);
        advised += t.advised;
        CHECK((sag_mm > 0 || !t.advised));
        if (t.advised) CHECK(t.error_after_mm < t.error_before_mm);
      }
    }
  CHECK(advised == 5);
}

TEST_CASE("SimulationChoice.WhatIsLeftOutIsNotBlamedOnTheMachine") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const SaggingToy usual = measured(seed, 0.4);
    CHECK(diagnosed(usual).reading != Reading::none);
    CHECK(diagnosed(*usual.extensions().front().model).reading == Reading::none);
    // A cause beside it is still named.
    const SaggingToy bumped = measured(seed, 0.4, 2, 0.6);
    CHECK(diagnosed(*bumped.extensions().front().model).verdict == std::vector<int>{0});
  }
}

TEST_CASE("SimulationChoice.NothingToChooseCostsNothing") {
  ToyModel toy(100);
  Context context;
  const SimulationChoice choice = choose_simulation(toy, context);
  CHECK(choice.tried.empty());
  CHECK(choice.simulations == 0);
}

TEST_CASE("SimulationChoice.WhereACauseCannotBeTriedTheUsualOneGoesOn") {
  SaggingToy model = measured(1, 0.4);
  model.max_ripple = 0;
  Context context;
  const SimulationChoice choice = choose_simulation(model, context);
  CHECK(choice.taken().empty());
  CHECK(choice.u.size() == 0);
}

TEST_CASE("SimulationChoice.ASheetWithANetworkIsFormedWithOne") {
  std::mt19937 random(3);
  Observation observation;
  observation.points = 400;
  HiddenWorld world;
  world.elastic_law = ElasticLaw::st_venant_kirchhoff;
  world.triangles = 3000;
  const HiddenEffect network{"lasting_network", {{"network_share", 0.35}}};
  ThermoformModelOptions options;
  options.triangles = 2500;
  Context context;
  const ThermoformModel with({make_object(Mould::pyramid, world, {network}, observation, random)}, options),
      without({make_object(Mould::pyramid, world, {}, observation, random)}, options);
  const SimulationChoice choice = choose_simulation(with, context);
  const std::vector<std::string> taken = choice.taken();
  for (const TriedExtension& t : choice.tried)
    UNSCOPED_INFO(t.extension.name << " gains " << t.log_evidence_gain << ", error " << t.error_before_mm << " to "
                                   << t.error_after_mm);
  REQUIRE(std::find(taken.begin(), taken.end(), "lasting_network") != taken.end());
  const ThermoformModel& model = with.extended_by(taken);
  const MachineProfile profile = model.profile_at(choice.u);
  CHECK_THAT(profile.parameters["network_share"].get<double>(), WithinAbs(0.35, 0.15));
  // The next run begins with the profile's simulation.
  ThermoformModelOptions next = options;
  next.profile = profile;
  const ThermoformModel again({with.objects().front()}, next);
  for (const SimulationExtension& extension : again.extensions()) CHECK(extension.name != "lasting_network");
  const std::vector<std::string> taken_without = choose_simulation(without, context).taken();
  CHECK(std::find(taken_without.begin(), taken_without.end(), "lasting_network") == taken_without.end());
}

TEST_CASE("ThermoformModel.AnExtensionIsASettingOfTheProfile") {
  std::mt19937 random(3);
  Observation observation;
  observation.points = 60;
  ThermoformModelOptions options;
  options.triangles = 600;
  const ThermoformModel usual({make_object(Mould::pyramid, {}, {}, observation, random)}, options);
  const ThermoformModel& model = usual.extended_by({"constant_volume"});
  CHECK(model.simulation_options(0, model.nominal()).elastic_law == ElasticLaw::incompressible_neo_hookean);
  CHECK(usual.simulation_options(0, usual.nominal()).elastic_law == ElasticLaw::st_venant_kirchhoff);
  CHECK(model.profile_at(model.nominal()).parameters["elastic_law"] == "incompressible_neo_hookean");
  CHECK(model.extensions().size() == usual.extensions().size() - 1);
  CHECK(model.extensions().front().name == "lasting_network");
  // The same parameters in the same places.
  const ThermoformModel& both = usual.extended_by({"lasting_network", "constant_volume"});
  REQUIRE(both.parameters().size() == usual.parameters().size());
  for (std::size_t p = 0; p < both.parameters().size(); ++p)
    CHECK(both.parameters()[p].name == usual.parameters()[p].name);
  CHECK(both.base_parameters().size() == usual.base_parameters().size() + 1);
  const ThermoformModel& sliding = usual.extended_by({"sliding"});
  CHECK(sliding.simulation_options(0, sliding.nominal()).slip == 0.35);
  CHECK(sliding.profile_at(sliding.nominal()).parameters["slip"] == 0.35);
  const ThermoformModel& finer = usual.extended_by({"finer_sheet"});
  CHECK(finer.simulation_options(0, finer.nominal()).triangles == 1200);
  const ThermoformModel& shorter = usual.extended_by({"shorter_steps"});
  CHECK(shorter.simulation_options(0, shorter.nominal()).step_mm ==
        0.5 * *usual.simulation_options(0, usual.nominal()).step_mm);
  // An object whose set-up has it already needs nothing more.
  CHECK(&model.extended_by({"constant_volume"}) == &model);
}

/// An effect as small as it usually is is no fault, however well the data show it.
TEST_CASE("Diagnosis.WhatIsUsualIsNotNamed") {
  int named_usual = 0, named_large = 0;
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const double strength : {0.1, 0.8}) {
      ToyModel model(400, seed);
      model.set_usual_sd(0.1);
      Eigen::VectorXd truth = model.nominal();
      truth[2] = strength;
      model.measure(truth, 0.03, 70 + seed, 0.02);
      const Diagnosis d = diagnosed(model);
      (strength > 0.5 ? named_large : named_usual) += d.reading == Reading::cause;
      const auto bump =
          std::find_if(d.causes.begin(), d.causes.end(), [](const CauseFinding& f) { return f.cause == 0; });
      CHECK(bump->min_visible_strength > 4 * 0.1);
    }
  CHECK(named_usual == 0);
  CHECK(named_large == 10);
}

}  // namespace
}  // namespace formwright
