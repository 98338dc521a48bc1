// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thermoforming as a forward model: from material, machine and measurement to the places of measured points, and to the
// thickness where it was measured.
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "evidence/fit/forward_model.h"
#include "evidence/models/thermoform/formed_object.h"
#include "evidence/models/thermoform/sheet_simulation.h"
#include "thermoform/forming.h"
#include "thermoform/machine_profile.h"

namespace formwright {

struct ThermoformModelOptions {
  int triangles = 2500;
  double step_mm = 0.6;                 // automatic steps are longer, and their noise drowns what small changes do
  bool fit_mould_place = false;         // as calibration does: the mould's place is a base parameter, no cause
  MachineProfile profile;               // what is known of the machine; empty where nothing is
  std::vector<std::string> without;     // causes that are not considered
  std::vector<std::string> extensions;  // by name: what the simulation does beside what set-up and profile say
  /// Parts from when the machine was in order, as `profile` describes it (good_part.h). What the simulation misses of
  /// one is added to what it predicts of objects over the same mould.
  std::shared_ptr<const std::vector<FormedObject>> good_parts;
};

/// A parameter that a fit varies, with the range, where narrower than its own, and the coordinate of ModelParameter.
struct VariedParameter {
  const char* name;
  bool logarithmic;
  double low, high;
  double prior_sd, probe;
};

/// Its measurements are the places of each object in their order; then, of each object that has any, the thickness
/// within the clamp opening and that of the rim.
class ThermoformModel : public ForwardModel {
 public:
  /// `objects`: at least one, each checked.
  ThermoformModel(std::vector<FormedObject> objects, ThermoformModelOptions options);

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  Eigen::MatrixXd predict(int measurement, const Eigen::VectorXd& u, const Context& context) const override;
  bool claim(int object, const Eigen::VectorXd& u, const Context& context) const override;
  std::optional<ResultTask> task(int object, const Eigen::VectorXd& u, const Context& context) const override;
  /// Beside a good part half: at most 0.04 mm were left of 18 sheets of the foreign laboratory that had no fault.
  double known_misfit() const override { return (options_.good_parts ? 0.5 : 1) * misfit_mm; }
  /// Beside a good part as much as without: what a fault changes, the simulation gets no better.
  double max_misfit_left() const override { return max_share_left * misfit_mm; }
  double mesh_error() const override { return 40; }
  std::string in_words(int cause, const std::vector<double>& values) const override;
  /// On a quarter of the triangles, where that leaves enough of them.
  const ForwardModel* cheaper() const override { return cheaper_.get(); }
  /// On twice the triangles, where these are no more than most are content with.
  const ForwardModel* finer() const override;
  std::vector<SimulationExtension> extensions() const override;
  /// The same on no more triangles than it takes to choose among extensions; this one where it has no more.
  const ThermoformModel& for_choosing() const;
  /// This, or what `names` make of it. What its set-up or profile has already is passed over.
  const ThermoformModel& extended_by(const std::vector<std::string>& names) const;
  const ThermoformModelOptions& options() const { return options_; }

  const std::vector<FormedObject>& objects() const { return objects_; }
  /// The readings of a measurement that is not of places, row by row.
  const std::vector<MeasuredThickness>& thickness_readings(std::size_t measurement) const {
    return thickness_[measurement - objects_.size()];
  }
  /// The simulation's parameters for an object at u, and the measurement's.
  ThermoformOptions simulation_options(int object, const Eigen::VectorXd& u) const;
  MeasurementEffects measurement_effects(const Eigen::VectorXd& u) const;
  /// The sheet as it is simulated at u (mould coordinates, plate at 0). From several threads; kept.
  std::shared_ptr<const FormedSheet> formed(int object, const Eigen::VectorXd& u, const Context& context) const;
  /// What is fitted at u, as a profile that later simulations can use: base parameters, and effects that are not zero.
  MachineProfile profile_at(const Eigen::VectorXd& u) const;

 private:
  static constexpr double misfit_mm = 0.08;

  void add_places(const FormedObject& object);
  /// What good parts over the same mould have beside the simulation with the discrepancies of u, where a measurement's
  /// readings are; n x d, all 0 where there is no such part, and of the rim.
  const Eigen::MatrixXd& beside_simulation(int measurement, const Eigen::VectorXd& u, const Context& context) const;
  /// Of an object's measurements the one of the same quantity, or -1.
  int measurement_like(const Measurement& other, int object) const;
  TextureCoordinates places_in_clamp(int measurement) const;
  bool is_of_the_rim(int measurement) const;
  /// Measurement::scale of thickness that is known to be off by a share of the sheet's.
  double thickness_scale(const FormedObject& object, double misfit_share) const;
  void add_thickness(int object, std::vector<MeasuredThickness> readings, const char* what, double misfit_share);
  SheetSimulation simulation_of(int object, const Eigen::VectorXd& u) const;
  /// Parameters by name, as the object's set-up, the profile and the extensions have them.
  Json settings_of(const FormedObject& object) const;

  std::vector<FormedObject> objects_;
  ThermoformModelOptions options_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
  std::vector<std::vector<MeasuredThickness>> thickness_;  // of the measurements after those of places
  std::unique_ptr<const ThermoformModel> cheaper_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const ThermoformModel> finer_, for_choosing_;
  mutable std::map<std::string, std::unique_ptr<const ThermoformModel>> extended_;
  mutable std::vector<std::shared_ptr<const Bytes>> packed_moulds_;  // of the objects; null until a task needs them
  mutable std::map<std::string, std::shared_ptr<const FormedSheet>> sheets_;
  std::unique_ptr<const ThermoformModel> in_order_;  // of the good parts
  mutable std::mutex beside_mutex_;
  mutable std::map<std::pair<int, std::vector<int>>, Eigen::MatrixXd> beside_;  // per measurement and discrepancies
};

/// The parameters that a diagnosis varies, base first, and the causes they belong to.
/// `nominal`: what set-up and profile say.
void declare_thermoform_parameters(const Json& nominal, const ThermoformModelOptions& options,
                                   std::vector<ModelParameter>& parameters, std::vector<Cause>& causes);

/// Names of all causes that a diagnosis considers.
std::vector<std::string> thermoform_cause_names();

/// Makes the simulation the other one that the discrepancy of this name stands for.
void apply_discrepancy(const std::string& name, ThermoformOptions& options);

}  // namespace formwright
