// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/thermoform_model.h"

#include <algorithm>
#include <cmath>

#include "evidence/models/thermoform/cause_words.h"
#include "evidence/models/thermoform/rim_thickness.h"
#include "evidence/models/thermoform/thermoform_extensions.h"

namespace formwright {
namespace {

constexpr int fewest_triangles = 1000;  // of the cheaper model
constexpr int max_triangles = 5000;     // of a model that has a finer one
/// To choose among extensions: they differ by more than what a finer mesh changes.
constexpr int choosing_triangles = 2500;
constexpr std::size_t max_sheets = 200;  // kept at a time; about 0.2 MB each
/// The simulation's own error of thickness, RMS, as a share of the sheet's: what a finer mesh or the other elastic law
/// changes (docs/evidence.md, "Thickness").
constexpr double known_thickness_misfit = 0.03;
/// The same of the rim. It is not simulated: an assumption of how much sheets vary from place to place.
constexpr double known_rim_misfit = 0.01;

/// Not of the material, which all objects share.
bool is_set_by_hand(const ModelParameter& p) {
  return p.role == ParameterRole::effect || (p.role == ParameterRole::base && p.name.starts_with("mould_"));
}

/// Places on the flat sheet in the clamp's directions.
template <class Reading>
TextureCoordinates in_clamp(const std::vector<Reading>& readings, bool sheet_turned) {
  TextureCoordinates places(static_cast<Eigen::Index>(readings.size()), 2);
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    places.row(i) = (sheet_turned ? -1 : 1) * readings[static_cast<std::size_t>(i)].sheet_mm.transpose();
  return places;
}

/// Measurement::place of readings on the sheet.
template <class Reading>
Eigen::MatrixX2d in_opening(const std::vector<Reading>& readings, const ThermoformOptions& o) {
  Eigen::MatrixX2d place(static_cast<Eigen::Index>(readings.size()), 2);
  for (Eigen::Index i = 0; i < place.rows(); ++i) {
    const Vec2& on_sheet = readings[static_cast<std::size_t>(i)].sheet_mm;
    place(i, 0) = on_sheet.x() / o.clamp_opening_x_mm + 0.5;
    place(i, 1) = on_sheet.y() / o.clamp_opening_y_mm + 0.5;
  }
  return place;
}

/// Of a material's prior_sd: how far it may be from a profile's; and from that of a good part, which is the same
/// plastic: 9 % of its stiffness and a quarter of its creep rate. Assumed (docs/evidence.md, "Beside a good part").
constexpr double known_share = 0.3, same_material_share = 0.15;
constexpr double max_deviations = 4;  // from a good part's material

void keep_near_nominal(ModelParameter& p) {
  p.was_measured = true;
  p.low = std::max(p.low, p.value(-max_deviations * p.prior_sd));
  p.high = std::min(p.high, p.value(max_deviations * p.prior_sd));
}

}  // namespace

ThermoformModel::ThermoformModel(std::vector<FormedObject> objects, ThermoformModelOptions options)
    : objects_(std::move(objects)), options_(std::move(options)) {
  Json nominal = settings_of(objects_.front());
  const Json measurement = write_parameters(options_.profile.measurement);
  for (const auto& [name, value] : measurement.items()) nominal[name] = value;
  declare_thermoform_parameters(nominal, options_, parameters_, causes_);
  // What a profile says of the material was measured, on a machine that was well: far more than a guess, and the only
  // thing that tells a weak vacuum from a stiff sheet.
  for (ModelParameter& p : parameters_)
    if (p.role == ParameterRole::base && options_.profile.parameters.contains(p.name)) {
      p.prior_sd *= options_.good_parts ? same_material_share : known_share;
      if (options_.good_parts) keep_near_nominal(p);
    }
  for (const FormedObject& object : objects_) add_places(object);
  for (int object = 0; object < static_cast<int>(objects_.size()); ++object) {
    std::vector<MeasuredThickness> rim = objects_[static_cast<std::size_t>(object)].thickness;
    const auto own = read_parameters<ThermoformOptions>(objects_[static_cast<std::size_t>(object)].setup.parameters);
    const auto within = std::stable_partition(
        rim.begin(), rim.end(), [&](const MeasuredThickness& reading) { return is_on_rim(reading.sheet_mm, own); });
    std::vector<MeasuredThickness> formed(within, rim.end());
    rim.erase(within, rim.end());
    add_thickness(object, std::move(formed), ", thickness", known_thickness_misfit);
    add_thickness(object, std::move(rim), ", thickness of the rim", known_rim_misfit);
  }
  if (options_.good_parts) {
    ThermoformModelOptions without = options_;
    without.good_parts.reset();
    in_order_ = std::make_unique<const ThermoformModel>(*options_.good_parts, std::move(without));
  }
  if (options_.triangles / 4 < fewest_triangles) return;
  ThermoformModelOptions coarse = options_;
  coarse.triangles /= 4;
  cheaper_ = std::make_unique<ThermoformModel>(objects_, std::move(coarse));
}

double ThermoformModel::thickness_scale(const FormedObject& object, double misfit_share) const {
  return misfit_mm / (misfit_share * read_parameters<ThermoformOptions>(object.setup.parameters).sheet_thickness_mm);
}

void ThermoformModel::add_places(const FormedObject& object) {
  const auto own = read_parameters<ThermoformOptions>(object.setup.parameters);
  Measurement m;
  m.name = object.name;
  m.place = in_opening(object.points, own);
  m.extent_mm = std::max(own.clamp_opening_x_mm, own.clamp_opening_y_mm);
  m.measured.resize(m.place.rows(), 3);
  m.sigma.resize(m.place.rows());
  for (Eigen::Index i = 0; i < m.place.rows(); ++i) {
    const MeasuredPoint& p = object.points[static_cast<std::size_t>(i)];
    m.measured.row(i) = p.place_mm.transpose();
    m.sigma[i] = p.sigma_mm;
  }
  measurements_.push_back(std::move(m));
}

void ThermoformModel::add_thickness(int object, std::vector<MeasuredThickness> readings, const char* what,
                                    double misfit_share) {
  if (readings.empty()) return;
  const FormedObject& own_object = objects_[static_cast<std::size_t>(object)];
  const auto own = read_parameters<ThermoformOptions>(own_object.setup.parameters);
  Measurement m;
  m.name = own_object.name + what;
  m.places_index = object;
  m.scale = thickness_scale(own_object, misfit_share);
  m.place = in_opening(readings, own);
  m.extent_mm = std::max(own.clamp_opening_x_mm, own.clamp_opening_y_mm);
  m.measured.resize(m.place.rows(), 1);
  m.sigma.resize(m.place.rows());
  for (Eigen::Index i = 0; i < m.place.rows(); ++i) {
    m.measured(i, 0) = m.scale * readings[static_cast<std::size_t>(i)].thickness_mm;
    m.sigma[i] = m.scale * readings[static_cast<std::size_t>(i)].sigma_mm;
  }
  measurements_.push_back(std::move(m));
  thickness_.push_back(std::move(readings));
}

const ForwardModel* ThermoformModel::finer() const {
  if (options_.triangles > max_triangles) return nullptr;
  const std::scoped_lock lock(mutex_);
  if (!finer_) {
    ThermoformModelOptions fine = options_;
    fine.triangles *= 2;
    finer_ = std::make_unique<ThermoformModel>(objects_, std::move(fine));
  }
  return finer_.get();
}

const ThermoformModel& ThermoformModel::for_choosing() const {
  if (options_.triangles <= choosing_triangles) return *this;
  const std::scoped_lock lock(mutex_);
  if (!for_choosing_) {
    ThermoformModelOptions fewer = options_;
    fewer.triangles = choosing_triangles;
    for_choosing_ = std::make_unique<ThermoformModel>(objects_, std::move(fewer));
  }
  return *for_choosing_;
}

std::vector<SimulationExtension> ThermoformModel::extensions() const {
  std::vector<SimulationExtension> list;
  const Json nominal = settings_of(objects_.front());
  for (const ThermoformExtension& extension : thermoform_extensions()) {
    if (has_extension(extension, nominal, options_)) continue;
    const std::scoped_lock lock(mutex_);
    auto& model = extended_[extension.name];
    if (!model) {
      ThermoformModelOptions more = options_;
      apply_extension(extension, more);
      model = std::make_unique<ThermoformModel>(objects_, std::move(more));
    }
    list.push_back(
        {extension.name, extension.label, extension.explanation, extension.remedy, model.get(), extension.trial});
  }
  return list;
}

const ThermoformModel& ThermoformModel::extended_by(const std::vector<std::string>& names) const {
  const ThermoformModel* model = this;
  for (const std::string& name : names) {
    for (const SimulationExtension& extension : model->extensions())
      if (extension.name == name) model = model->extended_.at(name).get();
  }
  return *model;
}

Json ThermoformModel::settings_of(const FormedObject& object) const {
  Json settings = with_profile(object.setup.parameters, options_.profile);
  for (const ThermoformExtension& extension : thermoform_extensions())
    if (std::find(options_.extensions.begin(), options_.extensions.end(), extension.name) != options_.extensions.end())
      settings.update(extension.settings);
  return settings;
}

ThermoformOptions ThermoformModel::simulation_options(int object, const Eigen::VectorXd& u) const {
  const FormedObject& formed_object = objects_[static_cast<std::size_t>(object)];
  Json values = settings_of(formed_object);
  const MeasurementEffects none;
  const Json measurement = write_parameters(none);
  values["triangles"] = options_.triangles;
  values["frames"] = 2;
  values["step_mm"] = options_.step_mm;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const ModelParameter& p = parameters_[i];
    const double at = u[static_cast<Eigen::Index>(i)];
    if (p.role == ParameterRole::discrepancy || measurement.contains(p.name)) continue;
    // What does not vary keeps its value to the last bit, which is what stored results are known by.
    const double value = at == 0 ? p.nominal : p.value(at);
    // A mould that was set beside its mark on purpose, or anything else set by hand, is of this object alone:
    // what is found comes on top. The material is shared.
    const bool of_this_object = object > 0 && is_set_by_hand(p) && values.contains(p.name);
    values[p.name] =
        of_this_object ? std::clamp(values[p.name].get<double>() + value - p.nominal, p.low, p.high) : value;
  }
  auto o = read_parameters<ThermoformOptions>(values);
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (parameters_[i].role == ParameterRole::discrepancy && u[static_cast<Eigen::Index>(i)] >= 0.5)
      apply_discrepancy(parameters_[i].name, o);
  if (formed_object.setup.sheet_turned) {
    o.thickness_wedge_x = -o.thickness_wedge_x;
    o.thickness_wedge_y = -o.thickness_wedge_y;
  }
  return o;
}

MeasurementEffects ThermoformModel::measurement_effects(const Eigen::VectorXd& u) const {
  Json values = write_parameters(options_.profile.measurement);
  for (std::size_t i = 0; i < parameters_.size(); ++i)
    if (values.contains(parameters_[i].name))
      values[parameters_[i].name] = parameters_[i].value(u[static_cast<Eigen::Index>(i)]);
  return read_parameters<MeasurementEffects>(values);
}

SheetSimulation ThermoformModel::simulation_of(int object, const Eigen::VectorXd& u) const {
  const FormedObject& own = objects_[static_cast<std::size_t>(object)];
  return {own.key, own.setup.base_plate_end_z_mm, simulation_options(object, u)};
}

bool ThermoformModel::claim(int object, const Eigen::VectorXd& u, const Context& context) const {
  const std::string key = simulation_of(object, u).key();
  {
    const std::scoped_lock lock(mutex_);
    if (sheets_.contains(key)) return true;
  }
  return context.find_result(key).has_value() || context.claim_result(key);
}

std::optional<ResultTask> ThermoformModel::task(int object, const Eigen::VectorXd& u, const Context& context) const {
  const SheetSimulation simulation = simulation_of(object, u);
  ResultTask task{simulation.key(), "", {}, static_cast<double>(simulation.options.triangles)};
  const std::scoped_lock lock(mutex_);
  if (sheets_.contains(task.key) || context.find_result(task.key)) return std::nullopt;
  packed_moulds_.resize(objects_.size());
  auto& mould = packed_moulds_[static_cast<std::size_t>(object)];
  if (!mould)
    mould = std::make_shared<const Bytes>(packed_mould(objects_[static_cast<std::size_t>(object)].mould->mesh));
  task.recipe = simulation_recipe(simulation).dump();
  task.input = mould;
  return task;
}

std::shared_ptr<const FormedSheet> ThermoformModel::formed(int object, const Eigen::VectorXd& u,
                                                           const Context& context) const {
  const FormedObject& own = objects_[static_cast<std::size_t>(object)];
  const SheetSimulation simulation = simulation_of(object, u);
  const std::string key = simulation.key();
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = sheets_.find(key); known != sheets_.end()) return known->second;
  }
  std::shared_ptr<const FormedSheet> sheet;
  try {
    if (const auto stored = context.find_result(key)) {
      sheet = kept_sheet(*stored, simulation.options);
      if (sheet) context.release_result(key);
    }
    if (!sheet) {
      const Bytes bytes = simulated(simulation, own.mould, context);
      context.keep_result(key, bytes);
      sheet = kept_sheet(bytes, simulation.options);
    }
  } catch (const Error& error) {
    context.release_result(key);
    // A mould pushed out of the opening is no fault of the maker's here, but a place where there is no answer.
    if (error.code() == ErrorCode::invalid_input && u.cwiseAbs().maxCoeff() > 0)
      throw Error(ErrorCode::could_not_solve, error.where(), error.what());
    if (error.code() == ErrorCode::invalid_input)
      throw Error(error.code(), error.where(), own.name + ": " + error.what());
    throw;
  } catch (...) {
    context.release_result(key);
    throw;
  }
  const std::scoped_lock lock(mutex_);
  if (sheets_.size() >= max_sheets) sheets_.clear();
  return sheets_.emplace(key, std::move(sheet)).first->second;
}

Eigen::MatrixXd ThermoformModel::predict(int measurement, const Eigen::VectorXd& u, const Context& context) const {
  const Measurement& measured = measurements_[static_cast<std::size_t>(measurement)];
  const int object = measured.is_place() ? measurement : measured.places_index;
  const FormedObject& own = objects_[static_cast<std::size_t>(object)];
  const auto sheet = formed(object, u, context);
  const ThermoformOptions o = simulation_options(object, u);
  if (!measured.is_place()) {
    Eigen::MatrixXd thickness =
        measured.scale * predict_thickness(*sheet, places_in_clamp(measurement), o, measurement_effects(u));
    if (in_order_) thickness += beside_simulation(measurement, u, context);
    return thickness;
  }
  const double plate_z = own.setup.base_plate_end_z_mm;
  FormedSheet raised = *sheet;
  raised.mesh.V.col(2).array() += plate_z;
  Eigen::MatrixXd places =
      predict_measured(raised, places_in_clamp(measurement), own.setup.measured_surface, o.clamp_height_mm + plate_z,
                       o.sheet_thickness_mm, measurement_effects(u), plate_z);
  if (in_order_) places += beside_simulation(measurement, u, context);
  return places;
}

TextureCoordinates ThermoformModel::places_in_clamp(int measurement) const {
  const Measurement& measured = measurements_[static_cast<std::size_t>(measurement)];
  const FormedObject& own =
      objects_[static_cast<std::size_t>(measured.is_place() ? measurement : measured.places_index)];
  return measured.is_place()
             ? in_clamp(own.points, own.setup.sheet_turned)
             : in_clamp(thickness_readings(static_cast<std::size_t>(measurement)), own.setup.sheet_turned);
}

bool ThermoformModel::is_of_the_rim(int measurement) const {
  const Measurement& measured = measurements_[static_cast<std::size_t>(measurement)];
  return !measured.is_place() &&
         measured.scale == thickness_scale(objects_[static_cast<std::size_t>(measured.places_index)], known_rim_misfit);
}

std::string ThermoformModel::in_words(int cause, const std::vector<double>& values) const {
  return thermoform_cause_in_words(causes_[static_cast<std::size_t>(cause)].name, values);
}

MachineProfile ThermoformModel::profile_at(const Eigen::VectorXd& u) const {
  MachineProfile profile = options_.profile;
  // The law and the ramp that the numbers were fitted with: with others they mean another sheet.
  const Json first = settings_of(objects_.front());
  for (const std::string& name : names_of_material())
    if (first.contains(name)) {
      profile.parameters[name] = first[name];
      for (const FormedObject& object : objects_)
        if (const Json own = settings_of(object); !own.contains(name) || own[name] != first[name])
          profile.notes.push_back("The objects' set-ups differ in " + name + ": the value of " + objects_.front().name +
                                  " was taken for all.");
    }
  Json measurement = write_parameters(profile.measurement);
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    const ModelParameter& p = parameters_[i];
    if (p.role == ParameterRole::discrepancy) continue;
    const double value = p.value(u[static_cast<Eigen::Index>(i)]);
    if (measurement.contains(p.name)) measurement[p.name] = value;
    else if (p.role == ParameterRole::base || value != 0) profile.parameters[p.name] = value;
  }
  profile.measurement = read_parameters<MeasurementEffects>(measurement);
  for (const FormedObject& object : objects_) profile.from.push_back(object.name);
  return profile;
}

}  // namespace formwright
