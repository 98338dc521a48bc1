// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/explanations/distorted_measurement.h"

#include <algorithm>
#include <limits>

namespace formwright {
namespace {

// As those of the scan that are in the list.
constexpr double usual_stretch = 0.012, usual_shift_mm = 1;

bool is_in_space(const Measurement& m) { return m.is_place() && m.measured.cols() == 3; }

/// The same with one cause more, the map.
class WithDistortion : public ForwardModel {
 public:
  explicit WithDistortion(const ForwardModel& model)
      : model_(model), parameters_(model.parameters()), causes_(model.causes()) {
    Cause distortion;
    distortion.name = "distortion";
    for (int k = 0; k < 12; ++k) {
      distortion.parameters.push_back(static_cast<int>(parameters_.size()));
      ModelParameter p;
      p.role = ParameterRole::effect;
      p.prior_sd = k < 9 ? usual_stretch : usual_shift_mm;
      p.low = -1e3;
      p.high = 1e3;
      parameters_.push_back(p);
    }
    causes_.push_back(distortion);
  }
  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return model_.measurements(); }
  double known_misfit() const override { return model_.known_misfit(); }
  Eigen::MatrixXd predict(int measurement, const Eigen::VectorXd& u, const Context& context) const override {
    return model_.predict(measurement, u.head(static_cast<Eigen::Index>(model_.parameters().size())), context);
  }
  int distortion() const { return static_cast<int>(causes_.size()) - 1; }

  /// What the twelve numbers do.
  std::vector<Sensitivities> fields() const {
    std::vector<Sensitivities> all;
    for (const Measurement& m : measurements()) {
      Sensitivities own(12, Eigen::MatrixXd::Zero(m.measured.rows(), m.measured.cols()));
      if (is_in_space(m)) {
        const Eigen::MatrixXd from_centre = m.measured.rowwise() - m.measured.colwise().mean();
        for (Eigen::Index to = 0; to < 3; ++to) {
          for (Eigen::Index of = 0; of < 3; ++of)
            own[static_cast<std::size_t>(3 * to + of)].col(to) = from_centre.col(of);
          own[static_cast<std::size_t>(9 + to)].col(to).setOnes();
        }
      }
      all.push_back(std::move(own));
    }
    return all;
  }

 private:
  const ForwardModel& model_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
};

}  // namespace

std::optional<DistortedMeasurement> distorted_measurement(const ForwardModel& model, const MisfitOfAll& misfit,
                                                          const std::vector<LinearModel>& models,
                                                          std::size_t structure) {
  if (!std::any_of(model.measurements().begin(), model.measurements().end(), is_in_space)) return std::nullopt;
  const WithDistortion distorted(model);
  std::vector<int> columns(distorted.parameters().size());
  for (std::size_t p = 0; p < columns.size(); ++p) columns[p] = static_cast<int>(p);
  DistortedMeasurement result;
  result.log_evidence = -std::numeric_limits<double>::infinity();
  for (const LinearModel& linear : models) {
    const GramByStructure gram =
        misfit.gram(residuals(model, linear.predictions), side_by_side(linear.sensitivities, distorted.fields()));
    Eigen::VectorXd u = distorted.nominal();
    u.head(linear.u.size()) = linear.u;
    for (const bool unknown : {false, true}) {
      Hypothesis h;
      h.causes = {distorted.distortion()};
      h.unknown_structure = unknown;
      weigh(distorted, gram, columns, u, h);
      result.log_evidence = std::max(result.log_evidence, h.log_evidence);
    }
    if (!result.similarity.empty()) continue;
    for (int cause = 0; cause < distorted.distortion(); ++cause)
      result.similarity.push_back(similarity(distorted, gram, structure, columns, cause, distorted.distortion()));
  }
  return result;
}

}  // namespace formwright
