// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/diagnosis/diagnosis.h"

#include <catch2/catch_test_macros.hpp>
#include <catch2/matchers/catch_matchers_floating_point.hpp>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "evidence/diagnosed.h"
#include "evidence/diagnosis/diagnosis_report.h"
#include "evidence/toy_model.h"

namespace formwright {
namespace {
using Catch::Matchers::WithinAbs;
using evidence_test::diagnosed;
using evidence_test::diagnosed_pair;
using evidence_test::ToyModel;

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

/// What linear models put far behind is not fitted, unless it may be part of a pair; the answer is the same.
TEST_CASE("Diagnosis.FitsOnlyWhatCanLead") {
  ToyModel model(2000, 3);
  Eigen::VectorXd truth = model.nominal();
  truth[2] = 2.5;
  model.measure(truth, 0.05, 33, 0.02);
  Context context;
  SimulationBag all_bag(model), bag(model);
  const Diagnosis all = diagnose(all_bag, {}, context);
  DiagnosisOptions alone;
  alone.pairs = false;
  const Diagnosis d = diagnose(bag, alone, context);
  for (const CauseFinding& f : all.causes) CHECK(f.fitted);
  CHECK(d.verdict == all.verdict);
  CHECK(d.verdict == std::vector<int>{0});
  CHECK(d.simulations < all.simulations);
  for (const CauseFinding& f : d.causes) {
    CHECK(f.fitted == (f.cause == 0));
    if (f.fitted) continue;
    CHECK(f.probability < 1e-9);
    CHECK(f.low == f.high);
  }
}

TEST_CASE("Diagnosis.FindsPairs") {
  ToyModel model(500);
  diagnosed_pair(model);
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

TEST_CASE("Diagnosis.AMaterialThatWasMeasuredAndIsAnotherNowIsNotNothing") {
  for (const double higher : {1.05, 1.3}) {
    ToyModel model;
    model.set_measured_height(0.05);
    Eigen::VectorXd u = model.nominal();
    u[0] = std::log(higher);
    model.measure(u, 0.05, 3);
    SimulationBag bag(model);
    Context context;
    const Diagnosis d = diagnose(bag, {}, context);
    CAPTURE(higher);
    CHECK(d.verdict.empty());
    CHECK(d.reading == (higher < 1.2 ? Reading::none : Reading::unknown));
    CHECK(d.answers.front().unknown_cause == (higher > 1.2));
    CHECK((!d.failed.empty() && d.failed.back().failure == Failure::other_material) == (higher > 1.2));
  }
}

/// What explains little is `unknown` where much is left without it, and nothing where hardly anything is.
TEST_CASE("Diagnosis.WhereHardlyAnythingIsLeftWhatExplainsLittleOfItIsNothing") {
  for (const double max_misfit_left : {0.018, 0.025}) {
    ToyModel model(1000, 4);
    model.set_max_misfit_left(max_misfit_left);
    Eigen::VectorXd u = model.nominal();
    u[2] = 0.12;
    model.measure(u, 0.05, 4);
    Measurement& m = model.measurement();
    for (Eigen::Index i = 0; i < m.measured.rows(); ++i)
      m.measured(i, 1) += 0.03 * std::sin(9 * m.place(i, 0)) * std::cos(8 * m.place(i, 1) + 1);
    const Diagnosis d = diagnosed(model);
    CAPTURE(max_misfit_left, d.unexplained_before);
    const bool much_is_left = max_misfit_left < 0.02;
    CHECK(d.reading == (much_is_left ? Reading::unknown : Reading::none));
    REQUIRE_FALSE(d.failed.empty());
    CHECK(d.failed.front().failure == (much_is_left ? Failure::explains_too_little : Failure::nothing_to_explain));
    CHECK(d.answers.front().causes.empty());
    CHECK(d.answers.front().unknown_cause == much_is_left);
    CHECK(d.verdict.empty() == !much_is_left);
    CHECK(d.doubtful() == much_is_left);
    if (!much_is_left) {
      CHECK(d.extended.u == d.base.u);
      CHECK(d.held_out.after.mean == d.held_out.before.mean);
      CHECK(d.unexplained_after == d.unexplained_before);
    }
  }
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

class ToyWithMesh : public ToyModel {
 public:
  explicit ToyWithMesh(double mesh_error) : ToyModel(2000, 1, true), mesh_error_(mesh_error) {}
  double mesh_error() const override { return mesh_error_; }

 private:
  double mesh_error_;
};

/// The data prefer the hidden one by 14; but what stays unexplained, or another mesh, could tip the scales between two
/// so alike.
TEST_CASE("Diagnosis.CausesThatAreAlikeAreSeparatedOnlyByFarAndWithoutDoubt") {
  struct Case {
    double unexplained, mesh_error;
    Reading reading;
  };
  for (const auto& [unexplained, mesh_error, reading] :
       {Case{0, 0, Reading::cause}, Case{0, 10, Reading::cause}, Case{0, 40, Reading::cannot_separate},
        Case{0.25, 0, Reading::cannot_separate}}) {
    ToyWithMesh model(mesh_error);
    Eigen::VectorXd truth = model.nominal();
    truth[2] = 2.5;
    model.measure(truth, 0.02, 5);
    Measurement& m = model.measurement();
    for (Eigen::Index i = 0; i < m.measured.rows(); ++i)
      m.measured(i, 1) += unexplained * std::sin(5 * m.place(i, 0)) * std::cos(4 * m.place(i, 1) + 1);
    const Diagnosis d = diagnosed(model);
    INFO(unexplained << " " << mesh_error << ": " << reading_name(d.reading));
    REQUIRE_FALSE(d.verdict.empty());
    CHECK(d.verdict.front() == 0);
    CHECK(d.doubtful() == (unexplained > 0));
    CHECK(d.reading == reading);
    CHECK(d.not_separable.size() == 1);
  }
}

TEST_CASE("Diagnosis.WhatIsUnknownIsComparedWithTheCauseThatIsMostLikeIt") {
  const ToyModel model(10);
  Diagnosis d;
  d.reading = Reading::unknown;
  for (int cause = 0; cause < 3; ++cause) {
    CauseFinding finding;
    finding.cause = cause;
    d.causes.push_back(finding);
  }
  const DiagnosisReport report{model, d, {}, std::nullopt, {}, {}};
  const std::string plain = "The object differs from the simulation, and none of the known causes explains it.";
  d.causes[1].likeness = 0.45;
  CHECK(verdict_sentence(report) == plain);
  d.causes[2].likeness = 0.8;
  CHECK(verdict_sentence(report) == plain + " Most like it, but not enough: Drift.");
  d.failed.push_back({{}, {}, Failure::other_material});
  CHECK(
      verdict_sentence(report) ==
      plain +
          " Most like it, but not enough: Drift. Another material would explain it: the sheet was stiffer or softer, of another "
          "plastic, or all of it hotter or colder.");
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
