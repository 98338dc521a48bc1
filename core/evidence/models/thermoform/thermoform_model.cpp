// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/models/thermoform/thermoform_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "base/statistics.h"
#include "base/format.h"
#include "base/sha256.h"
#include "evidence/fit/noise_model.h"
#include "evidence/models/thermoform/cause_words.h"
#include "thermoform/sheet/sheet_mesh.h"

namespace formwright {
namespace {

constexpr std::size_t min_sheet_points = 6;
constexpr int fewest_triangles = 1000;   // of the cheaper model
constexpr int max_triangles = 5000;      // of a model that has a finer one
constexpr std::size_t max_sheets = 200;  // kept at a time; about 0.2 MB each

/// What later readers of a stored simulation must find unchanged; raised when the simulation computes something else.
constexpr const char* simulation_version = "thermoform-2:";

/// Vertices and thicknesses in single precision, as they are kept between runs; what is computed afresh is rounded
/// alike.
Bytes packed(const FormedSheet& sheet) {
  const Eigen::Index n = sheet.mesh.V.rows();
  std::vector<float> numbers;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) numbers.push_back(static_cast<float>(sheet.mesh.V(i, k)));
    numbers.push_back(static_cast<float>(sheet.thickness_mm[i]));
  }
  Bytes bytes(numbers.size() * sizeof(float));
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

std::shared_ptr<const FormedSheet> unpacked(const Bytes& bytes, const ThermoformOptions& options) {
  const SheetMesh flat = make_sheet_mesh(clamp_opening_mm(options), options.triangles);
  const Eigen::Index n = flat.flat_mm.rows();
  if (bytes.size() != static_cast<std::size_t>(n) * 4 * sizeof(float)) return nullptr;
  std::vector<float> numbers(static_cast<std::size_t>(n) * 4);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  auto sheet = std::make_shared<FormedSheet>();
  sheet->mesh.V.resize(n, 3);
  sheet->mesh.F = flat.F;
  sheet->sheet_mm = flat.flat_mm;
  sheet->thickness_mm.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (int k = 0; k < 3; ++k) sheet->mesh.V(i, k) = numbers[static_cast<std::size_t>(4 * i + k)];
    sheet->thickness_mm[i] = numbers[static_cast<std::size_t>(4 * i + 3)];
  }
  if (!sheet->mesh.V.allFinite() || !sheet->thickness_mm.allFinite()) return nullptr;
  return sheet;
}

struct UnitName {
  double factor;
  const char* name;
};
constexpr std::array<UnitName, 4> other_units{
    {{1e-3, "metres"}, {1 / 25.4, "inches"}, {0.1, "centimetres"}, {1e3, "micrometres"}}};

double spread(const std::vector<MeasuredPoint>& points, bool on_sheet) {
  // The range between the 5th and the 95th of a hundred, so that outliers do not count.
  double widest = 0;
  for (int k = 0; k < 2; ++k) {
    std::vector<double> values;
    for (const MeasuredPoint& p : points) values.push_back(on_sheet ? p.sheet_mm[k] : p.place_mm[k]);
    const double low = value_of_rank(values, values.size() / 20);
    widest = std::max(widest, value_of_rank(values, values.size() * 19 / 20) - low);
  }
  return widest;
}

/// Not of the material, which all objects share.
bool is_set_by_hand(const ModelParameter& p) {
  return p.role == ParameterRole::effect || (p.role == ParameterRole::base && p.name.starts_with("mould_"));
}

}  // namespace

void check_measured_object(const FormedObject& object) {
  const auto refuse = [&](const std::string& sentence) {
    throw Error(ErrorCode::invalid_input, "object", object.name + ": " + sentence);
  };
  if (object.points.size() < min_sheet_points)
    refuse("measured.csv has " + std::to_string(object.points.size()) + " points; at least " +
           std::to_string(min_sheet_points) + ", spread over the sheet, are needed.");
  const bool stated =
      std::all_of(object.points.begin(), object.points.end(), [](const MeasuredPoint& p) { return p.sigma_mm > 0; });
  if (object.points.size() < static_cast<std::size_t>(min_points_to_find_noise) && !stated)
    refuse("with " + std::to_string(object.points.size()) + " points, fewer than " +
           std::to_string(min_points_to_find_noise) +
           ", the noise cannot be found in the data: give sigma_mm for each point (0.3 is usual for calipers).");
  const auto options = read_parameters<ThermoformOptions>(object.setup.parameters);
  const double on_sheet = spread(object.points, true), in_space = spread(object.points, false);
  if (!(on_sheet > 0) || !(in_space > 0))
    refuse("all measured points lie in one place; measure points all over the sheet.");
  // The rim stays where it is: over the sheet a spread in space cannot differ much from that on the sheet.
  for (const UnitName& unit : other_units)
    if (std::abs(std::log(in_space / on_sheet / unit.factor)) < 0.35)
      refuse(std::string("x_mm, y_mm, z_mm of measured.csv seem to be in ") + unit.name + " (they spread over " +
             with_digits(in_space, 3) + ", the sheet's over " + with_digits(on_sheet, 3) +
             " mm): convert them to millimetres.");
  const double sheet_side = std::max(options.sheet_x_mm, options.sheet_y_mm);
  for (const UnitName& unit : other_units)
    if (std::abs(std::log(on_sheet / sheet_side / unit.factor)) < 0.35 && on_sheet < 0.2 * sheet_side &&
        in_space < 0.2 * sheet_side)
      refuse(std::string("all coordinates of measured.csv seem to be in ") + unit.name +
             ": convert them to millimetres.");
  int outside = 0;
  double far = 0;
  const double turn = object.setup.sheet_turned ? -1 : 1;
  std::vector<double> offsets, alternative;
  for (const MeasuredPoint& p : object.points) {
    if (std::abs(p.sheet_mm.x()) > 0.5 * options.sheet_x_mm + 1 ||
        std::abs(p.sheet_mm.y()) > 0.5 * options.sheet_y_mm + 1)
      ++outside;
    offsets.push_back((p.place_mm.head<2>() - turn * p.sheet_mm).norm());
    alternative.push_back((p.place_mm.head<2>() + turn * p.sheet_mm).norm());
  }
  if (2 * outside > static_cast<int>(object.points.size()))
    refuse("most of the measured points lie beyond the sheet of " + with_digits(options.sheet_x_mm, 3) + " x " +
           with_digits(options.sheet_y_mm, 3) + " mm: sheet_x_mm and sheet_y_mm count from the sheet's centre, in mm.");
  far = median(std::move(offsets));
  if (far > 0.35 * sheet_side && median(std::move(alternative)) < 0.35 * sheet_side)
    refuse(object.setup.sheet_turned
               ? "the points lie as on a sheet that was not turned: take “sheet_turned” out of setup.json."
               : "the points lie as on a sheet turned by half a turn: add \"sheet_turned\": true to setup.json.");
  if (far > 0.35 * sheet_side)
    refuse(
        "the measured points lie " + with_digits(far, 3) +
        " mm beside their places on the sheet: bring the scan into the machine's coordinates, origin in the middle of the clamp "
        "opening, x and y as on the sheet.");
}

void check_mould_of(const FormedObject& object) {
  if (object.mould == nullptr || object.mould->mesh.V.rows() == 0) return;
  const double plate = object.setup.base_plate_end_z_mm, top = object.mould->mesh.V.col(2).maxCoeff() - plate;
  std::vector<double> heights;
  for (const MeasuredPoint& p : object.points) heights.push_back(p.place_mm.z() - plate);
  const double high = value_of_rank(heights, static_cast<std::size_t>(0.98 * static_cast<double>(heights.size() - 1)));
  constexpr double min_height_mm = 5;  // below that the sheet's thickness and the clamp's height count as well
  if (high < min_height_mm || top <= 0) return;
  for (const UnitName& unit : other_units)
    if (std::abs(std::log(top / high / unit.factor)) < 0.5)
      throw Error(ErrorCode::invalid_input, "object",
                  object.name + ": mould.obj seems to be in " + unit.name + " (its top is at " + with_digits(top, 3) +
                      ", measured points reach " + with_digits(high, 3) + " mm): convert it to millimetres.");
}

std::string rim_note(const FormedObject& object) {
  const auto o = read_parameters<ThermoformOptions>(object.setup.parameters);
  const bool outer = object.setup.measured_surface == MeasuredSurface::outer;
  const double held = o.clamp_height_mm + object.setup.base_plate_end_z_mm + (outer ? 0.5 * o.sheet_thickness_mm : 0.0);
  std::vector<double> heights;
  double sigma = 0;
  for (const MeasuredPoint& p : object.points)
    if (std::abs(p.sheet_mm.x()) > 0.5 * o.clamp_opening_x_mm + 1 ||
        std::abs(p.sheet_mm.y()) > 0.5 * o.clamp_opening_y_mm + 1) {
      heights.push_back(p.place_mm.z());
      sigma = std::max(sigma, p.sigma_mm);
    }
  constexpr std::size_t fewest_of_rim = 12;
  if (heights.size() < fewest_of_rim) return {};
  const double off = median(heights) - held;
  if (std::abs(off) < std::max(0.3, 3 * sigma / std::sqrt(static_cast<double>(heights.size())))) return {};
  return "The clamped rim was measured " + with_digits(std::abs(off), 3) + " mm " + (off > 0 ? "above" : "below") +
         " where setup.json has it (clamp_height_mm, sheet_thickness_mm, measured_surface): if the scan was aligned by "
         "its rim, register it again with the same values; else the whole scan may be off its place.";
}

ThermoformModel::ThermoformModel(std::vector<FormedObject> objects, ThermoformModelOptions options)
    : objects_(std::move(objects)), options_(std::move(options)) {
  Json nominal = with_profile(objects_.front().setup.parameters, options_.profile);
  const Json measurement = write_parameters(options_.profile.measurement);
  for (const auto& [name, value] : measurement.items()) nominal[name] = value;
  declare_thermoform_parameters(nominal, options_.fit_mould_place, options_.without, parameters_, causes_);
  // What a profile says of the material was measured, on a machine that was well: far more than a guess, and the only
  // thing that tells a weak vacuum from a stiff sheet.
  constexpr double known_share = 0.3;
  for (ModelParameter& p : parameters_)
    if (p.role == ParameterRole::base && options_.profile.parameters.contains(p.name)) p.prior_sd *= known_share;
  for (const FormedObject& object : objects_) {
    const auto own = read_parameters<ThermoformOptions>(object.setup.parameters);
    Measurement m;
    m.name = object.name;
    const auto n = static_cast<Eigen::Index>(object.points.size());
    m.place.resize(n, 2);
    m.measured.resize(n, 3);
    m.sigma.resize(n);
    m.extent_mm = std::max(own.clamp_opening_x_mm, own.clamp_opening_y_mm);
    for (Eigen::Index i = 0; i < n; ++i) {
      const MeasuredPoint& p = object.points[static_cast<std::size_t>(i)];
      m.place(i, 0) = p.sheet_mm.x() / own.clamp_opening_x_mm + 0.5;
      m.place(i, 1) = p.sheet_mm.y() / own.clamp_opening_y_mm + 0.5;
      m.measured.row(i) = p.place_mm.transpose();
      m.sigma[i] = p.sigma_mm;
    }
    measurements_.push_back(std::move(m));
  }
  if (options_.triangles / 4 < fewest_triangles) return;
  ThermoformModelOptions coarse = options_;
  coarse.triangles /= 4;
  cheaper_ = std::make_unique<ThermoformModel>(objects_, std::move(coarse));
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

ThermoformOptions ThermoformModel::simulation_options(int object, const Eigen::VectorXd& u) const {
  const FormedObject& formed_object = objects_[static_cast<std::size_t>(object)];
  Json values = with_profile(formed_object.setup.parameters, options_.profile);
  const MeasurementEffects none;
  const Json measurement = write_parameters(none);
  values["triangles"] = options_.triangles;
  values["frames"] = 2;
  values["step_mm"] = 0.6;  // automatic steps are longer, and their noise drowns what small changes do
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

std::string ThermoformModel::key_of(const FormedObject& object, const ThermoformOptions& o) const {
  const std::string text = simulation_version + object.key + ":" + std::to_string(object.setup.base_plate_end_z_mm) +
                           ":" + write_parameters(o).dump();
  return sha256_hex(as_bytes(text));
}

bool ThermoformModel::claim(int object, const Eigen::VectorXd& u, const Context& context) const {
  const std::string key = key_of(objects_[static_cast<std::size_t>(object)], simulation_options(object, u));
  {
    const std::scoped_lock lock(mutex_);
    if (sheets_.contains(key)) return true;
  }
  return context.find_result(key).has_value() || context.claim_result(key);
}

std::shared_ptr<const FormedSheet> ThermoformModel::formed(int object, const Eigen::VectorXd& u,
                                                           const Context& context) const {
  const FormedObject& own = objects_[static_cast<std::size_t>(object)];
  const ThermoformOptions o = simulation_options(object, u);
  const std::string key = key_of(own, o);
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = sheets_.find(key); known != sheets_.end()) return known->second;
  }
  std::shared_ptr<const FormedSheet> sheet;
  if (const auto stored = context.find_result(key)) {
    sheet = unpacked(*stored, o);
    if (sheet) context.release_result(key);
  }
  if (!sheet) {
    Context silent(Host{{}, [&context] { return context.cancelled(); }, {}});
    Placement as_it_is;
    as_it_is.translation.z() = -own.setup.base_plate_end_z_mm;
    FormedResult result;
    try {
      result = form_sheet(own.mould, as_it_is, o, silent);
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
    const Bytes bytes = packed(result.sheet);
    sheet = unpacked(bytes, o);
    if (sheet) context.keep_result(key, bytes);
    else context.release_result(key);
    if (!sheet) throw Error(ErrorCode::could_not_solve, "", "The simulation gave no finite sheet.");
  }
  const std::scoped_lock lock(mutex_);
  if (sheets_.size() >= max_sheets) sheets_.clear();
  return sheets_.emplace(key, std::move(sheet)).first->second;
}

Eigen::MatrixXd ThermoformModel::predict(int object, const Eigen::VectorXd& u, const Context& context) const {
  const FormedObject& own = objects_[static_cast<std::size_t>(object)];
  const auto sheet = formed(object, u, context);
  const ThermoformOptions o = simulation_options(object, u);
  TextureCoordinates places(static_cast<Eigen::Index>(own.points.size()), 2);
  const double sign = own.setup.sheet_turned ? -1 : 1;
  for (Eigen::Index i = 0; i < places.rows(); ++i)
    places.row(i) = sign * own.points[static_cast<std::size_t>(i)].sheet_mm.transpose();
  const double plate_z = own.setup.base_plate_end_z_mm;
  FormedSheet raised = *sheet;
  raised.mesh.V.col(2).array() += plate_z;
  return predict_measured(raised, places, own.setup.measured_surface, o.clamp_height_mm + plate_z, o.sheet_thickness_mm,
                          measurement_effects(u), plate_z);
}

std::string ThermoformModel::in_words(int cause, const std::vector<double>& values) const {
  return thermoform_cause_in_words(causes_[static_cast<std::size_t>(cause)].name, values);
}

MachineProfile ThermoformModel::profile_at(const Eigen::VectorXd& u) const {
  MachineProfile profile = options_.profile;
  // The law and the ramp that the numbers were fitted with: with others they mean another sheet.
  const Json first = with_profile(objects_.front().setup.parameters, options_.profile);
  for (const std::string& name : names_of_material())
    if (first.contains(name)) {
      profile.parameters[name] = first[name];
      for (const FormedObject& object : objects_)
        if (const Json own = with_profile(object.setup.parameters, options_.profile);
            !own.contains(name) || own[name] != first[name])
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
