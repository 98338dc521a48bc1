// SPDX-License-Identifier: GPL-3.0-or-later
// Models that have a coarser self, for the search of pairs, or a finer one, for what cannot be decided.
#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <atomic>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "base/error.h"
#include "evidence/diagnosed.h"
#include "evidence/diagnosis/diagnosis.h"
#include "evidence/explanations/pair_search.h"
#include "evidence/diagnosis/unseen.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using evidence_test::check_one_answer;
using evidence_test::diagnosed;
using evidence_test::diagnosed_pair;
using evidence_test::ToyModel;

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
  double mesh_error() const override { return 40; }
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

/// What a coarse mesh does to a sheet that slides: at some strength it leaps, by about the right movement and, from
/// point to point, by more than half of it. Its finer self is right.
class CoarselyLeapingToy : public SlidingToy {
 public:
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override {
    const double leap = u[3] > 0.1 ? 0.8 : 0.0;
    Eigen::VectorXd leapt = u;
    leapt[3] = leap;
    Eigen::MatrixXd y = ToyModel::predict(object, leapt, context);
    const Eigen::MatrixX2d& place = measurements().front().place;
    y.col(1).array() += 0.6 * leap * (211 * place.col(0).array() + 307 * place.col(1).array()).sin();
    return y;
  }
};

TEST_CASE("Diagnosis.LooksAgainAtWhatTheDataLookLikeThoughItFitsWorseThanNone") {
  CoarselyLeapingToy model;
  Eigen::VectorXd truth = model.nominal();
  truth[3] = 0.9;
  model.measure(truth);
  SimulationBag bag(model);
  Context context;
  DiagnosisOptions options;
  options.pairs = false;  // pairs are searched from starts that know the ripple
  const Diagnosis d = diagnose(bag, options, context);
  check_one_answer(d);
  CHECK(d.looked_again);
  REQUIRE(d.verdict == std::vector<int>{1});
  CHECK_THAT(d.extended.u[3], WithinAbs(0.9, 0.02));
  CHECK(d.doubts == std::vector<std::string>{});
}

TEST_CASE("Diagnosis.OfWhatIsDecidedTheAnswerAloneIsFittedMoreFinely") {
  SlidingToy model;
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 0.5;
  model.measure(truth);
  const Diagnosis d = diagnosed(model);
  CHECK(d.looked_again);
  CHECK(d.verdict == std::vector<int>{0});
  CHECK(std::count_if(d.causes.begin(), d.causes.end(), [](const CauseFinding& f) { return f.fitted; }) == 1);
  CHECK_THAT(d.extended.u[2], WithinAbs(0.5, 0.02));
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

}  // namespace
}  // namespace formwright
