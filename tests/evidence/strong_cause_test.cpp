// SPDX-License-Identifier: GPL-3.0-or-later
// A cause so strong that the calibration without it is dragged to where nothing points back.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "evidence/diagnosed.h"
#include "evidence/diagnosis/simulation_choice.h"
#include "evidence/fit/usual_strengths.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using evidence_test::diagnosed;
using evidence_test::ToyModel;

constexpr int ripple = 1;
constexpr Eigen::Index tilt_parameter = 1, ripple_parameter = 3;

Eigen::VectorXd rippled(const ForwardModel& model, double strength) {
  Eigen::VectorXd u = model.nominal();
  u[ripple_parameter] = strength;
  return u;
}

TEST_CASE("StrongCause.IsTheNearestOfSomeStrengthsWhereItIsMuchNearer") {
  ToyModel model(300);
  Context context;
  const auto found_beside = [&](double strength) {
    model.measure(rippled(model, strength), 0.05, 2);
    SimulationBag bag(model);
    const auto objective = mean_distance_objective(model, 0.05);
    const Predictions at_nominal = *bag.run(model.nominal(), context, "");
    return strong_cause_instead_of(objective->value(residuals(model, at_nominal), model.nominal()), bag, *objective,
                                   context, "");
  };
  const auto found = found_beside(1.2);
  REQUIRE(found);
  CHECK(found->cause == ripple);
  CHECK(found->u == rippled(model, 1));
  CHECK(found->predictions.front() == model.predict(0, found->u, context));
  CHECK(found_beside(1.7)->u == rippled(model, 2));
  CHECK_FALSE(found_beside(0.35));  // little is left
  CHECK_FALSE(found_beside(0));
}

/// Its tilt can be turned until it does nearly what a strong ripple does; both ways back from there lead uphill, and
/// there the ripple does nothing. What it leaves looks like a sag, which an extension has.
class DraggedToy : public ToyModel {
 public:
  explicit DraggedToy(bool simulates_sag) : ToyModel(500) {
    if (!simulates_sag) with_sag_ = std::make_unique<DraggedToy>(true);
    sags_ = simulates_sag;
  }
  double known_misfit() const override { return 0.008; }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    const double tilt = std::clamp(u[tilt_parameter], 0.0, 2.0), share = 0.5 * tilt;
    Eigen::VectorXd rest = u;
    rest[tilt_parameter] = std::min(u[tilt_parameter], 0.0) + 0.4 * tilt * (2 - tilt);
    rest[ripple_parameter] *= 1 - share;
    Eigen::MatrixXd y = ToyModel::predict(object, rest, context);
    const Eigen::ArrayXd z = measurement_place().col(1).array();
    const Eigen::ArrayXd dragged = (3 * std::numbers::pi * z).cos() + (sags_ ? 0.0 : 1.0) * sag();
    y.col(1) += (1.2 * share * share * (3 - 2 * share) * dragged).matrix();
    return y;
  }
  void measure_ripple(double strength, unsigned seed) {
    measure(rippled(*this, strength), 0.05, seed);
    if (with_sag_) with_sag_->measurement() = measurement();
  }
  std::vector<SimulationExtension> extensions() const override {
    if (!with_sag_) return {};
    return {{"sag", "Sag", "", "", with_sag_.get(), ExtensionTrial::fit}};
  }

 private:
  const Eigen::MatrixX2d& measurement_place() const { return measurements().front().place; }
  Eigen::ArrayXd sag() const { return 0.3 * (std::numbers::pi * measurement_place().col(0).array()).sin(); }
  bool sags_ = false;
  std::unique_ptr<DraggedToy> with_sag_;
};

TEST_CASE("StrongCause.IsNotTakenForAnExtensionOfTheSimulation") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    DraggedToy model(false);
    model.measure_ripple(1.05, seed);
    Context context;
    const SimulationChoice choice = choose_simulation(model, context);
    REQUIRE(choice.u[tilt_parameter] > 1.5);  // else the model does not do what it is for
    CHECK(choice.taken().empty());
    const Diagnosis d = diagnosed(model);
    REQUIRE(d.verdict == std::vector<int>{ripple});
    CHECK_THAT(d.causes.front().strength, WithinAbs(1.05, 0.03));
  }
}

}  // namespace
}  // namespace formwright
