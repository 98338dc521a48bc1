// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/planning/measuring_plan.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "evidence/fit/hypotheses.h"
#include "evidence/fit/structured_objective.h"
#include "evidence/fit/usual_strengths.h"
#include "evidence/planning/point_information.h"

namespace formwright {
namespace {

constexpr const char* trying = "Trying each cause";
constexpr double tie = 0.01;  // of a gain: mirrored points tell the same, and the first of them is taken on any machine

/// The model about two materials, and how well each point would be known.
struct Surroundings {
  Predictions expected;
  std::vector<int> columns;  // all parameters
  std::vector<Sensitivities> about_stiffer, about_nominal;
  std::vector<Precisions> precisions;  // all zero for what is of another object
};

/// Of the object that is planned for.
bool is_counted(const ForwardModel& model, std::size_t measurement) {
  return measurement == 0 || model.measurements()[measurement].places_index == 0;
}

/// A material that a calibration may well end at.
Eigen::VectorXd stiffer(const ForwardModel& model) {
  Eigen::VectorXd u = model.nominal();
  const std::vector<int> base = model.base_parameters();
  if (!base.empty()) u[base.front()] = model.parameters()[static_cast<std::size_t>(base.front())].prior_sd;
  return within_ranges(model, u);
}

Surroundings look_around(SimulationBag& bag, Context& context) {
  const ForwardModel& model = bag.model();
  Surroundings around;
  around.columns.resize(model.parameters().size());
  std::iota(around.columns.begin(), around.columns.end(), 0);
  const auto at_nominal = bag.run(model.nominal(), context, trying);
  if (!at_nominal)
    throw Error(ErrorCode::could_not_solve, "",
                "The simulation fails with the set-up's own parameters: check mould and set-up.");
  around.expected = *at_nominal;
  Probing nominal, other;
  {
    const auto span = context.span(0, 0.45, trying);
    nominal = probe_around(bag, model.nominal(), *at_nominal, around.columns, context, trying);
  }
  {
    const auto span = context.span(0.45, 0.9, trying);
    const Eigen::VectorXd u = stiffer(model);
    const auto at_stiffer = bag.run(u, context, trying);
    other = at_stiffer ? probe_around(bag, u, *at_stiffer, around.columns, context, trying) : nominal;
  }
  const auto span = context.span(0.9, 1, trying);
  around.about_stiffer = other.sensitivities;
  const std::vector<int> discrepancies = model.parameters_with(ParameterRole::discrepancy);
  auto movements =
      movements_of(model, discrepancies, sensitivities_of(discrepancies, nominal.sensitivities, around.columns));
  // As in a diagnosis: where the simulation leaps, a point tells less.
  std::vector<Eigen::VectorXd> weights;
  for (std::size_t m = 0; m < model.measurements().size(); ++m) {
    const Measurement& own = model.measurements()[m];
    for (const Probing* probing : {&nominal, &other})
      for (const Eigen::MatrixXd& bend : probing->bends[m]) movements[m].push_back(std::sqrt(0.5) * bend);
    weights.push_back(is_counted(model, m) ? Eigen::VectorXd(own.sigma.array().square().inverse())
                                           : Eigen::VectorXd(Eigen::VectorXd::Zero(own.sigma.size())));
  }
  around.precisions = precisions_of(model, weights, movements);
  around.about_nominal = at_usual_strengths(bag, *at_nominal, std::move(nominal.sensitivities), context, trying);
  return around;
}

/// Of some rows of the first measurement, and of all its object's other quantities: what a diagnosis would have to go
/// by.
class Outlook {
 public:
  Outlook(const ForwardModel& model, const Surroundings& around, const std::vector<Eigen::Index>& rows)
      : model_(model), around_(around) {
    add(0, rows);
    for (std::size_t m = 1; m < model.measurements().size(); ++m) {
      if (!is_counted(model, m)) continue;
      std::vector<Eigen::Index> all(static_cast<std::size_t>(model.measurements()[m].place.rows()));
      std::iota(all.begin(), all.end(), 0);
      add(m, all);
    }
  }

  /// Mean of both materials, nats.
  double information() const {
    const auto k = static_cast<Eigen::Index>(around_.columns.size());
    const Eigen::MatrixXd& G = both_.gram.front();
    return 0.5 * (information_about_causes(model_, G.block(1, 1, k, k)) +
                  information_about_causes(model_, G.block(1 + k, 1 + k, k, k)));
  }
  double visible(int cause) const { return min_visible_strength(model_, both_, 0, around_.columns, cause); }
  double alike(int a, int b) const { return similarity(model_, nominal_, 0, around_.columns, a, b); }

 private:
  void add(std::size_t measurement, const std::vector<Eigen::Index>& rows) {
    const Measurement& all = model_.measurements()[measurement];
    Measurement part;
    part.place = all.place(rows, Eigen::all);
    part.extent_mm = all.extent_mm;
    const StructuredMisfit misfit(part, around_.precisions[measurement](rows, Eigen::all), {model_.known_misfit()});
    const auto count = static_cast<Eigen::Index>(rows.size());
    std::vector<Eigen::MatrixXd> columns;
    for (const std::vector<Sensitivities>* s : {&around_.about_stiffer, &around_.about_nominal})
      for (const Eigen::MatrixXd& column : (*s)[measurement]) columns.emplace_back(column(rows, Eigen::all));
    const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(count, all.measured.cols());
    both_ += misfit.gram(zero, columns);
    nominal_ += misfit.gram(zero, std::span(columns).subspan(around_.columns.size()));
  }

  const ForwardModel& model_;
  const Surroundings& around_;
  GramByStructure both_, nominal_;
};

std::vector<CauseOutlook> outlooks(const ForwardModel& model, const Outlook& with_rows, const Outlook& with_all) {
  const auto count = static_cast<int>(model.causes().size());
  std::vector<CauseOutlook> list;
  for (int cause = 0; cause < count; ++cause) {
    CauseOutlook one;
    one.cause = cause;
    const int first = model.causes()[static_cast<std::size_t>(cause)].parameters.front();
    one.usual_strength = model.parameters()[static_cast<std::size_t>(first)].prior_sd;
    one.min_visible_strength = with_rows.visible(cause);
    one.best_visible_strength = with_all.visible(cause);
    for (int other = 0; other < count; ++other) {
      if (other == cause) continue;
      const double alike = with_rows.alike(cause, other);
      if (one.closest_cause < 0 || alike > one.similarity) one.closest_cause = other, one.similarity = alike;
    }
    list.push_back(one);
  }
  return list;
}

}  // namespace

MeasuringPlan plan_measuring(SimulationBag& bag, const MeasuringPlanOptions& options, Context& context) {
  const ForwardModel& model = bag.model();
  const Measurement& m = model.measurements().front();
  const Eigen::Index n = m.place.rows();
  Surroundings around;
  {
    const auto span = context.span(0, 0.9, trying);
    around = look_around(bag, context);
  }
  const auto span = context.span(0.9, 1, "Choosing points");
  MeasuringPlan plan;
  plan.expected = around.expected;
  std::array<PointInformation, 2> information{
      PointInformation(model, around.about_stiffer, around.precisions, model.known_misfit()),
      PointInformation(model, around.about_nominal, around.precisions, model.known_misfit())};
  const auto total = [&] { return 0.5 * (information[0].total() + information[1].total()); };
  const auto measure = [&](Eigen::Index row) {
    for (PointInformation& one : information) one.measure(row);
  };
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < options.measured; ++i) {
    measure(i);
    rows.push_back(i);
  }
  Eigen::Index others = 0;
  for (std::size_t k = 1; k < model.measurements().size(); ++k)
    if (is_counted(model, k)) others += model.measurements()[k].place.rows();
  // Rows of other quantities follow those of places.
  for (Eigen::Index i = 0; i < options.measured_others; ++i) measure(n + i);
  plan.information_of_measured = total();
  for (Eigen::Index i = options.measured_others; i < others; ++i) measure(n + i);
  while (static_cast<int>(plan.chosen.size()) < options.points) {
    context.check_cancelled();
    std::vector<double> gains(static_cast<std::size_t>(n), 0);
    for (Eigen::Index i = options.measured; i < n; ++i) {
      const bool near = std::any_of(rows.begin(), rows.end(), [&](Eigen::Index row) {
        return row == i || (m.place.row(row) - m.place.row(i)).norm() < options.min_distance;
      });
      if (!near) gains[static_cast<std::size_t>(i)] = 0.5 * (information[0].gain(i) + information[1].gain(i));
    }
    const double largest = *std::max_element(gains.begin(), gains.end());
    if (!(largest > 0)) break;
    const Eigen::Index best =
        std::find_if(gains.begin(), gains.end(), [&](double gain) { return gain >= (1 - tie) * largest; }) -
        gains.begin();
    measure(best);
    rows.push_back(best);
    plan.chosen.push_back(best);
    plan.information.push_back(total());
    context.progress(static_cast<double>(plan.chosen.size()) / options.points);
  }
  std::vector<Eigen::Index> all(static_cast<std::size_t>(n));
  std::iota(all.begin(), all.end(), 0);
  const Outlook with_all(model, around, all);
  plan.information_of_all = with_all.information();
  if (others > 0 || !rows.empty()) plan.causes = outlooks(model, Outlook(model, around, rows), with_all);
  return plan;
}

}  // namespace formwright
