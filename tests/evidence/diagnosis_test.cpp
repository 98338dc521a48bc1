// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/diagnosis.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <atomic>

#include "base/error.h"
#include "evidence/diagnosis/diagnosis_report.h"
#include "evidence/diagnosis/pair_search.h"
#include "evidence/diagnosis/unseen.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;

using evidence_test::ToyModel;

/// Verdict, reading and each cause's probability follow from the same answers, which add up to 1.
void check_one_answer(const Diagnosis& d) {
  double sum = 0;
  for (const Answer& answer : d.answers) sum += answer.probability;
  CHECK_THAT(sum, WithinAbs(1, 1e-9));
  const Answer& top = d.answers.front();
  std::vector<int> verdict = d.verdict;
  std::sort(verdict.begin(), verdict.end());
  if (d.reading == Reading::none || d.reading == Reading::unknown) {
    CHECK(top.causes.empty());
    CHECK(top.unknown_cause == (d.reading == Reading::unknown));
  } else {
    CHECK(top.causes == verdict);
  }
  for (const CauseFinding& f : d.causes)
    CHECK_THAT(f.probability, WithinAbs(probability_of_cause(d.answers, f.cause), 1e-12));
  for (const FailedCheck& f : d.failed)
    for (const Answer& answer : d.answers) CHECK(answer.causes != f.causes);
}

Diagnosis diagnosed(const ToyModel& model) {
  SimulationBag bag(model);
  Context context;
  Diagnosis d = diagnose(bag, {}, context);
  check_one_answer(d);
  return d;
}

TEST_CASE("Diagnosis.CleanDataAreCalledClean") {
  int alarms = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    ToyModel model(400, seed);
    Eigen::VectorXd truth = model.nominal();
    truth[0] = 0.2;
    model.measure(truth, 0.08, seed, 0.02);
    alarms += diagnosed(model).reading != Reading::none;
  }
  CHECK(alarms <= 1);
}

TEST_CASE("Diagnosis.NamesEachCauseItsStrengthAndTheGain") {
  struct Case {
    int parameter;
    double value;
    int cause;
  };
  for (const Case& c : {Case{2, 0.5, 0}, Case{3, 0.3, 1}, Case{5, -0.6, 2}})
    for (unsigned seed = 1; seed <= 4; ++seed) {
      ToyModel model(400, seed);
      Eigen::VectorXd truth = model.nominal();
      truth[0] = -0.2;
      truth[c.parameter] = c.value;
      model.measure(truth, 0.05, 30 + seed, 0.02);
      const Diagnosis d = diagnosed(model);
      {
        INFO(c.cause << " seed " << seed);
        REQUIRE(d.reading == Reading::cause);
      }
      CHECK(d.verdict == std::vector<int>{c.cause});
      CHECK(d.causes.front().cause == c.cause);
      CHECK_THAT(std::abs(d.causes.front().strength), WithinAbs(std::abs(c.value), 0.08));
      CHECK(d.causes.front().low < d.causes.front().high);
      CHECK(d.held_out.after.mean < 0.8 * d.held_out.before.mean);
      CHECK(d.held_out.after.mean > 0.8 * d.noise_floor);
    }
}

/// The machine turns a cause into other movements than the model does, and has a misfit of the size that the model is
/// known for.
TEST_CASE("Diagnosis.IntervalsHoldTheStrengthThoughTheModelIsAnother") {
  std::mt19937 random(5);
  std::normal_distribution<double> gain(1, 0.05);
  std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi);
  int inside = 0;
  constexpr int cases = 10;
  for (unsigned seed = 1; seed <= cases; ++seed) {
    ToyModel model(400, seed);
    model.set_gain_error(0.05);
    Eigen::VectorXd truth = model.nominal();
    truth[0] = 0.1;
    truth[2] = 0.7 * gain(random);
    model.measure(truth, 0.05, 60 + seed, 0.02);
    // Waves of half the object to all of it.
    const Eigen::MatrixX2d& place = model.measurements().front().place;
    for (int wave = 0; wave < 6; ++wave) {
      const double direction = turn(random), phase = turn(random), cycles = 1 + 0.2 * wave;
      const Eigen::ArrayXd along = std::cos(direction) * place.col(0) + std::sin(direction) * place.col(1);
      model.measurement().measured.col(wave % 2).array() +=
          std::sqrt(2.0 / 3) * model.known_misfit() * (2 * std::numbers::pi * cycles * along + phase).sin();
    }
    const Diagnosis d = diagnosed(model);
    {
      INFO("seed " << seed);
      REQUIRE_FALSE(d.verdict.empty());
      REQUIRE(d.verdict.front() == 0);
    }
    const CauseFinding& bump =
        *std::find_if(d.causes.begin(), d.causes.end(), [](const CauseFinding& f) { return f.cause == 0; });
    CHECK(0.5 * (bump.high - bump.low) >= std::hypot(0.5 * bump.min_visible_strength, 1.96 * 0.05 * bump.strength));
    CHECK(bump.high - bump.low < 0.5);
    inside += bump.low <= 0.7 && 0.7 <= bump.high;
  }
  CHECK(inside >= cases - 2);  // 95 %, less two standard deviations of the count
}

/// Hides a bump of 0.6 and a ripple of 0.4, which are to be named, and returns what is said.
Diagnosis diagnosed_pair(ToyModel& model) {
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 0.6;
  truth[3] = 0.4;
  model.measure(truth, 0.05, 12, 0.02);
  Diagnosis d = diagnosed(model);
  std::vector<int> verdict = d.verdict;
  std::sort(verdict.begin(), verdict.end());
  CHECK(verdict == std::vector<int>{0, 1});
  return d;
}

/// A base parameter that can be turned until it does nearly what the drift does, and from where both ways back lead
/// uphill.
class SwallowingModel : public ToyModel {
 public:
  using ToyModel::ToyModel;
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    const double tilt = std::clamp(u[1], 0.0, 2.0), share = 0.2 + 0.4 * tilt;
    Eigen::VectorXd rest = u;
    rest[1] = std::min(u[1], 0.0) + 0.2 * tilt * (2 - tilt);
    Eigen::MatrixXd y = ToyModel::predict(object, rest, context);
    const Eigen::VectorXd x = measurements().front().place.col(0);
    return y.col(0) += 1.2 * share * share * (3 - 2 * share) * x.array().pow(2.6).matrix(), y;
  }
};

TEST_CASE("Diagnosis.NamesWhatTheCalibrationHasSwallowed") {
  SwallowingModel model(500);
  Eigen::VectorXd truth = model.nominal();
  truth[4] = 1.2;
  model.measure(truth, 0.05, 3);
  const Diagnosis d = diagnosed(model);
  REQUIRE(d.base.u[1] > 1.5);  // else the model does not do what it is for
  REQUIRE(d.verdict == std::vector<int>{2});
  CHECK_THAT(d.extended.u[4], WithinAbs(1.2, 0.05));
  CHECK_THAT(d.extended.u[1], WithinAbs(0, 0.05));
}

/// In one corner it does now this, now that, at the least change of any parameter: a sheet that snaps into a corner of
/// the mould, or does not.
class LeapingModel : public ToyModel {
 public:
  using ToyModel::ToyModel;
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    Eigen::MatrixXd y = ToyModel::predict(object, u, context);
    const double leap = std::sin(1e4 * u.sum()) > 0 ? 2 : -2;
    for (Eigen::Index i = 0; i < y.rows(); ++i) {
      const auto place = measurements().front().place.row(i);
      if (place[0] > 0.7 && place[1] > 0.7) y(i, 0) += leap * (place[0] - 0.7) * (place[1] - 0.7) / 0.09;
    }
    return y;
  }
};

TEST_CASE("Diagnosis.DoesNotRelyOnWhatTheModelDoesByLeaps") {
  for (const unsigned seed : {3u, 4u, 5u}) {
    LeapingModel model(500);
    Eigen::VectorXd truth = model.nominal();
    truth[0] = 0.23;
    truth[2] = -0.25;
    model.measure(truth, 0.05, seed);
    const Diagnosis d = diagnosed(model);
    {
      INFO(seed);
      REQUIRE(d.verdict == std::vector<int>{0});
      CHECK_THAT(d.extended.u[2], WithinAbs(-0.25, 0.05));
    }
    model.measure(model.nominal(), 0.05, seed);
    INFO(seed);
    CHECK(diagnosed(model).reading == Reading::none);
  }
}

/// Its fourth cause moves a narrow ring alone, by far: as a turned mould moves its walls, between plate and top that
/// stay.
class WalledModel : public ToyModel {
 public:
  WalledModel() : ToyModel(800, 1, true) {}
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    Eigen::VectorXd rest = u;
    rest[6] = 0;
    Eigen::MatrixXd y = ToyModel::predict(object, rest, context);
    for (Eigen::Index i = 0; i < y.rows(); ++i) {
      const Eigen::Vector2d from_middle = measurements().front().place.row(i).transpose() - Eigen::Vector2d(0.5, 0.5);
      const double size = from_middle.cwiseAbs().maxCoeff();
      if (size > 0.3 && size < 0.32) y.row(i) += 4 * u[6] * Eigen::RowVector2d(-from_middle.y(), from_middle.x());
    }
    return y;
  }
};

TEST_CASE("Diagnosis.TakesWhatACauseExplainsForNoOutliers") {
  WalledModel model;
  Eigen::VectorXd truth = model.nominal();
  truth[0] = 0.15;
  truth[6] = -0.5;
  model.measure(truth, 0.05, 6, 0.02);
  const Diagnosis d = diagnosed(model);
  REQUIRE(d.verdict == std::vector<int>{3});
  CHECK_THAT(d.extended.u[6], WithinAbs(-0.5, 0.03));
  CHECK_THAT(d.noise.front().outliers, WithinAbs(16, 8));  // of 800; of the ring's points there are 35
  CHECK_THAT(d.noise.front().sigma, WithinAbs(0.05, 0.005));
}

TEST_CASE("Diagnosis.FindsPairs") {
  ToyModel model(500);
  diagnosed_pair(model);
}

/// What a coarse mesh does: everything a little off, everywhere alike, effects a tenth too strong.
class CoarseToy : public ToyModel {
 public:
  using ToyModel::ToyModel;
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    ++asked;
    Eigen::VectorXd stronger = u;
    stronger.tail(u.size() - 2) *= 1.1;
    return ToyModel::predict(object, stronger, context).array() + 0.7;
  }
  mutable std::atomic<int> asked{0};
};

class ToyWithCoarseSelf : public ToyModel {
 public:
  using ToyModel::ToyModel;
  const ForwardModel* cheaper() const override { return &coarse; }
  CoarseToy coarse;
};

TEST_CASE("PairSearch.ACheaperModelAgreesWhereItIsAnchored") {
  const ToyModel full(200);
  const CoarseToy coarse(200);
  const Context context;
  Eigen::VectorXd at = full.nominal();
  at[2] = 0.5;
  const AnchoredModel anchored(coarse, {full.predict(0, at, context) - coarse.predict(0, at, context)});
  CHECK((anchored.predict(0, at, context) - full.predict(0, at, context)).cwiseAbs().maxCoeff() < 1e-12);
  // Away from there only the effect's strength differs, by its tenth.
  Eigen::VectorXd beyond = at;
  beyond[2] += 0.2;
  const Eigen::MatrixXd step = full.predict(0, beyond, context) - full.predict(0, at, context);
  CHECK((anchored.predict(0, beyond, context) - anchored.predict(0, at, context) - 1.1 * step).cwiseAbs().maxCoeff() <
        1e-12);
}

TEST_CASE("PairSearch.FindsBothCausesThroughACoarserModel") {
  ToyWithCoarseSelf model(500);
  const Diagnosis d = diagnosed_pair(model);
  CHECK(model.coarse.asked > 20);
  CHECK(d.simulations >= model.coarse.asked);
  // What is decided is decided on the model itself: strengths are not a tenth off.
  CHECK_THAT(std::abs(d.extended.u[2]), WithinAbs(0.6, 0.04));
  CHECK_THAT(std::abs(d.extended.u[3]), WithinAbs(0.4, 0.03));
}

/// What a coarse mesh does to what slides: it slides elsewhere. Its finer self is right, or has no answer at all.
class SlidingToy : public ToyModel {
 public:
  explicit SlidingToy(bool finer_fails = false) : ToyModel(500), fine(finer_fails) {}
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    Eigen::VectorXd without = u;
    without[3] = 0;
    Eigen::MatrixXd y = ToyModel::predict(object, without, context);
    const Eigen::ArrayXd z = measurements().front().place.col(1);
    y.col(1).array() += u[3] * (3 * std::numbers::pi * z + 1.2).cos();
    return y;
  }
  const ForwardModel* finer() const override { return &fine; }
  void measure(const Eigen::VectorXd& u) {
    fine.measure(u, 0.05, 4);
    measurement() = fine.measurement();
  }

  class Fine : public ToyModel {
   public:
    explicit Fine(bool fails) : ToyModel(500), fails_(fails) {}
    Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
      ++asked;
      if (fails_ && u.isZero()) throw Error(ErrorCode::could_not_solve, "", "no answer");
      return ToyModel::predict(object, u, context);
    }
    mutable std::atomic<int> asked{0};

   private:
    bool fails_;
  };
  Fine fine;
};

TEST_CASE("Diagnosis.LooksAgainMoreFinelyAtWhatItCannotDecide") {
  SlidingToy model;
  Eigen::VectorXd truth = model.nominal();
  truth[3] = 0.4;
  model.measure(truth);
  const Diagnosis d = diagnosed(model);
  CHECK(d.looked_again);
  REQUIRE(d.verdict == std::vector<int>{1});
  CHECK_THAT(d.extended.u[3], WithinAbs(0.4, 0.02));
  CHECK(d.reading == Reading::cause);
  CHECK(d.doubts == std::vector<std::string>{});
  CHECK((residuals(model, d.extended.predictions).front()).cwiseAbs().mean() < 0.06);
  // As fine are the predictions of what was not seen: coarsely they would be off by the ripple.
  SlidingToy other;
  other.measure(truth);
  Context context;
  CHECK(predict_unseen(other, model, d, context).gain.after.mean < 0.08);
}

TEST_CASE("Diagnosis.WhatIsDecidedIsNotLookedAtAgain") {
  SlidingToy model;
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 0.5;
  model.measure(truth);
  model.fine.asked = 0;
  const Diagnosis d = diagnosed(model);
  CHECK_FALSE(d.looked_again);
  CHECK(model.fine.asked == 0);
  CHECK(d.verdict == std::vector<int>{0});
}

TEST_CASE("Diagnosis.DoesWithoutAFinerSimulationThatHasNoAnswer") {
  SlidingToy model(true);
  Eigen::VectorXd truth = model.nominal();
  truth[3] = 0.4;
  model.measure(truth);
  const Diagnosis d = diagnosed(model);
  CHECK_FALSE(d.looked_again);
  CHECK((d.reading == Reading::unknown || d.doubtful()));
}

TEST_CASE("Diagnosis.SaysUnknownToWhatIsNotInTheList") {
  ToyModel model(500);
  model.measure(model.nominal(), 0.04, 3);
  Measurement& m = model.measurement();
  for (Eigen::Index i = 0; i < m.measured.rows(); ++i)
    m.measured(i, 1) += 0.4 * std::sin(5 * m.place(i, 0)) * std::cos(4 * m.place(i, 1) + 1);
  const Diagnosis d = diagnosed(model);
  CHECK((d.reading == Reading::unknown || d.doubtful()));
}

TEST_CASE("Diagnosis.OwnsUpToTwins") {
  ToyModel model(400, 1, true);
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 0.5;
  model.measure(truth, 0.08, 5);
  const Diagnosis d = diagnosed(model);
  REQUIRE_FALSE(d.not_separable.empty());
  const NotSeparable& pair = d.not_separable.front();
  CHECK(std::min(pair.cause_a, pair.cause_b) == 0);
  CHECK(std::max(pair.cause_a, pair.cause_b) == 3);
  CHECK(pair.similarity > 0.95);
}

TEST_CASE("Diagnosis.ReportsAreWholeAndHoldNoStrangeNumbers") {
  ToyModel model(300);
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 0.5;
  model.measure(truth, 0.05, 8);
  const Diagnosis d = diagnosed(model);
  const DiagnosisReport report{model, d, {}, std::nullopt, {}, {"A note with <angle> brackets"}};
  const Json json = diagnosis_json(report);
  CHECK(json["verdict"][0] == "bump");
  double sum = 0, sum_of_answers = 0;
  for (const Json& h : json["hypotheses"]) sum += h["probability"].get<double>();
  CHECK(sum <= 1 + 1e-9);
  for (const Json& answer : json["answers"]) sum_of_answers += answer["probability"].get<double>();
  CHECK_THAT(sum_of_answers + json["other_answers"].get<double>(), WithinAbs(1, 1e-9));
  CHECK(json.dump().find("null") == std::string::npos);
  const std::string page = diagnosis_page(report);
  CHECK(page.find("A note with &lt;angle&gt; brackets") != std::string::npos);
  CHECK(page.find("nan") == std::string::npos);
  CHECK(page.find("http") == std::string::npos);
}

}  // namespace
}  // namespace formwright
