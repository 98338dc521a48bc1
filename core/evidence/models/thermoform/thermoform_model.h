// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Thermoforming as a forward model: from material, machine and measurement to the places of measured points.
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "evidence/fit/forward_model.h"
#include "thermoform/forming.h"
#include "thermoform/machine_profile.h"
#include "thermoform/measured/measured_object.h"

namespace formwright {

/// One measured object, read and checked.
struct FormedObject {
  std::string name;
  std::string key;  // names the mould's content
  std::shared_ptr<const MouldShape> mould;
  ObjectSetup setup;
  std::vector<MeasuredPoint> points;
};

/// Throws Error{invalid_input, "object"}: too few points, or points that are not in mm or not where the machine is,
/// with the likely reason.
void check_measured_object(const FormedObject& object);

/// Throws Error{invalid_input, "object"} where the mould is in another unit than the measured points.
void check_mould_of(const FormedObject& object);

/// A sentence where the clamped rim was not measured where the set-up has it; else empty.
std::string rim_note(const FormedObject& object);

struct ThermoformModelOptions {
  int triangles = 5000;
  bool fit_mould_place = false;      // as calibration does: the mould's place is a base parameter, no cause
  MachineProfile profile;            // what is known of the machine; empty where nothing is
  std::vector<std::string> without;  // causes that are not considered
};

class ThermoformModel : public ForwardModel {
 public:
  /// `objects`: at least one, each checked.
  ThermoformModel(std::vector<FormedObject> objects, ThermoformModelOptions options);

  const std::vector<ModelParameter>& parameters() const override { return parameters_; }
  const std::vector<Cause>& causes() const override { return causes_; }
  const std::vector<Measurement>& measurements() const override { return measurements_; }
  Eigen::MatrixXd predict(int object, const Eigen::VectorXd& u, const Context& context) const override;
  bool claim(int object, const Eigen::VectorXd& u, const Context& context) const override;
  double known_misfit() const override { return 0.08; }
  std::string in_words(int cause, const std::vector<double>& values) const override;
  /// On a quarter of the triangles, where that leaves enough of them.
  const ForwardModel* cheaper() const override { return cheaper_.get(); }
  /// On twice the triangles, where these are no more than most are content with.
  const ForwardModel* finer() const override;

  const std::vector<FormedObject>& objects() const { return objects_; }
  /// The simulation's parameters for an object at u, and the measurement's.
  ThermoformOptions simulation_options(int object, const Eigen::VectorXd& u) const;
  MeasurementEffects measurement_effects(const Eigen::VectorXd& u) const;
  /// The sheet as it is simulated at u (mould coordinates, plate at 0). From several threads; kept.
  std::shared_ptr<const FormedSheet> formed(int object, const Eigen::VectorXd& u, const Context& context) const;
  /// What is fitted at u, as a profile that later simulations can use: base parameters, and effects that are not zero.
  MachineProfile profile_at(const Eigen::VectorXd& u) const;

 private:
  /// Names a simulation: everything it depends on.
  std::string key_of(const FormedObject& object, const ThermoformOptions& options) const;

  std::vector<FormedObject> objects_;
  ThermoformModelOptions options_;
  std::vector<ModelParameter> parameters_;
  std::vector<Cause> causes_;
  std::vector<Measurement> measurements_;
  std::unique_ptr<const ThermoformModel> cheaper_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<const ThermoformModel> finer_;
  mutable std::map<std::string, std::shared_ptr<const FormedSheet>> sheets_;
};

/// The parameters that a diagnosis varies, base first, and the causes they belong to.
void declare_thermoform_parameters(const Json& nominal, bool fit_mould_place, const std::vector<std::string>& without,
                                   std::vector<ModelParameter>& parameters, std::vector<Cause>& causes);

/// Makes the simulation the other one that the discrepancy of this name stands for.
void apply_discrepancy(const std::string& name, ThermoformOptions& options);

}  // namespace formwright
