// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a diagnosis knows of a craft: a model that predicts measurable quantities from parameters, effects that extend
// it, and data. Nothing here knows about sheets, reliefs or zippers.
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"

namespace formwright {

enum class ParameterRole {
  base,         // of the model itself: always fitted
  effect,       // of an extension: zero means absent
  discrepancy,  // known variants of the simulation (another law, a finer mesh): never fitted, but what they move is
                // not evidence
};

/// A parameter the engine may turn. It is searched in a coordinate u that is 0 at the nominal value: ln(value /
/// nominal) if logarithmic, else value - nominal.
struct ModelParameter {
  std::string name, label, unit;
  ParameterRole role = ParameterRole::base;
  double nominal = 0, low = 0, high = 0;  // values
  bool logarithmic = false;
  double prior_sd = 1;        // of u: how far from the nominal value it may well be
  double usual_sd = 0;        // of an effect: how much of it there may be where nothing is wrong; 0: none
  bool was_measured = false;  // nominal value and prior_sd are what was found before: far from them is a surprise
  double probe = 0.1;         // a step in u that moves predictions visibly, and still about linearly

  double value(double u) const;
  double coordinate(double value) const;
  double low_u() const { return coordinate(low); }
  double high_u() const { return coordinate(high); }
  /// Standard deviation where no cause that it belongs to is at work: 0 where it has no say then.
  double sd_without_cause() const { return role == ParameterRole::effect ? usual_sd : prior_sd; }
  bool one_sided() const { return role != ParameterRole::base && low >= nominal; }
};

/// Whose a cause is: what the maker does or has; how it was measured; what the simulation leaves out.
enum class FaultOf { machine, measurement, simulation };

/// "machine", "measurement", "simulation": in reports.
constexpr const char* fault_name(FaultOf fault_of) {
  switch (fault_of) {
    case FaultOf::measurement: return "measurement";
    case FaultOf::simulation: return "simulation";
    case FaultOf::machine: break;
  }
  return "machine";
}

/// An effect as a maker names it; one or more parameters (a gradient has two).
struct Cause {
  std::string name, label;      // "heating_gradient", "Uneven heating from side to side"
  std::string explanation;      // what it is, in a sentence
  std::string remedy;           // what to do at the machine, in a sentence
  std::vector<int> parameters;  // indices into ForwardModel::parameters()
  std::string unit;             // of its strength: the Euclidean norm of its parameters' values
  double gain_error = 0;  // standard deviation, as a share of its strength: how differently equally good simulations
                          // turn it into movement
  FaultOf fault_of = FaultOf::machine;
  double min_strength = 0;  // of what is there or not: an explanation with less of it counts no more than none
};

/// What was measured of one object. `place` are coordinates on the object, in [0, 1] x [0, 1] about, by which
/// neighbours are known.
struct Measurement {
  std::string name;
  Eigen::MatrixX2d place;    // n x 2
  double extent_mm = 1;      // length that a unit of place stands for
  Eigen::MatrixXd measured;  // n x d
  Eigen::VectorXd sigma;     // n: standard deviation of each of the d numbers; all 0 where nothing is known
  /// -1 where places are measured. Else another quantity of the same object, predicted by the same simulation: index of
  /// the measurement of that object's places, which comes before it. It is evidence, but no distance: reported mean
  /// errors are without it.
  int places_index = -1;
  /// `measured` and `sigma` are as many times what was measured, so that ForwardModel::known_misfit() holds for this
  /// quantity, too.
  double scale = 1;

  bool is_place() const { return places_index < 0; }
};

class ForwardModel;

/// How much work it takes to see whether an extension is needed. One look: a single simulation where the calibrated one
/// is, the rest by linear models.
enum class ExtensionTrial { fit, fit_if_one_look_promises, one_look };

/// Something that the simulation leaves out unless a setting turns it on. It is a fault of ours, not of a machine:
/// where data show it, causes are looked for with it. What gets one look alone costs too much to be taken, and is
/// advised.
struct SimulationExtension {
  std::string name, label;
  std::string explanation;  // what the simulation leaves out, in a sentence
  std::string remedy;       // which setting does it, and what it costs, in a sentence
  /// With it: the same objects, and the same parameters and causes in the same places; what it brings to fit is a base
  /// parameter of this one and of no cause in the other.
  const ForwardModel* model = nullptr;
  ExtensionTrial trial = ExtensionTrial::fit;
};

class ForwardModel {
 public:
  static constexpr double max_share_left = 0.6;  // of the misfit that a model is known to have by itself

  virtual ~ForwardModel() = default;
  virtual const std::vector<ModelParameter>& parameters() const = 0;
  virtual const std::vector<Cause>& causes() const = 0;
  virtual const std::vector<Measurement>& measurements() const = 0;
  /// n x d: what would be measured of `object` at `u` (all parameters' coordinates). Called from several threads at
  /// once; the same bits for the same u. Throws Error{could_not_solve} where the model has no answer there,
  /// Error{cancelled}.
  virtual Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const = 0;
  /// False while another process makes this very prediction: ask for others first. From several threads at once. Asked
  /// of places only.
  virtual bool claim(int /*object*/, const Eigen::VectorXd& /*u*/, const Context& /*context*/) const { return true; }
  /// What another computer needs to simulate `object` at `u`; nothing where that is made already, or where only this
  /// one can. Asked of places only.
  virtual std::optional<ResultTask> task(int /*object*/, const Eigen::VectorXd& /*u*/,
                                         const Context& /*context*/) const {
    return std::nullopt;
  }
  /// The same objects and parameters, simulated more coarsely and several times as fast, for searching; null where
  /// there is no such model.
  virtual const ForwardModel* cheaper() const { return nullptr; }
  /// The same, simulated more finely, for the answer; null where there is no such model.
  virtual const ForwardModel* finer() const { return nullptr; }
  /// What it leaves out and could do. The models live as long as this one.
  virtual std::vector<SimulationExtension> extensions() const { return {}; }
  /// What happened, in a sentence, where `cause` has these values of its parameters; empty where the model has no words
  /// for it.
  virtual std::string in_words(int /*cause*/, const std::vector<double>& /*values*/) const { return {}; }
  /// Size of structured misfit (in the measurement's unit) that the model is known to have without any fault of the
  /// machine.
  virtual double known_misfit() const = 0;
  /// Structured misfit (in the measurement's unit) beyond which part of it counts as unexplained. Right causes leave
  /// none, or the next smaller size of those that are considered.
  virtual double max_misfit_left() const { return max_share_left * known_misfit(); }
  /// Log evidence that another mesh moves; 0 where the model has none.
  virtual double mesh_error() const { return 0; }

  std::vector<int> parameters_with(ParameterRole role) const;
  /// `parameter` belongs to one of `causes`.
  bool is_of(int parameter, const std::vector<int>& causes) const;
  /// One of the parameters of `causes` is never negative.
  bool has_one_sign(const std::vector<int>& causes) const;
  /// How strong `cause` is at u: the length of its parameters' values.
  double strength(int cause, const Eigen::VectorXd& u) const;
  std::vector<int> base_parameters() const { return parameters_with(ParameterRole::base); }
  /// Base parameters, then those of `causes` in their order: what is fitted together.
  std::vector<int> base_and(const std::vector<int>& causes) const;
  Eigen::VectorXd nominal() const { return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters().size())); }
};

/// Keeps `u` within the parameters' ranges.
Eigen::VectorXd within_ranges(const ForwardModel& model, Eigen::VectorXd u);

}  // namespace formwright
