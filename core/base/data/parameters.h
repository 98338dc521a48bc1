// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A parameter is declared once, beside the member it sets; command-line flags, JSON validation, the
// schema, help and the page's controls derive from that declaration.
//
//   struct SliceOptions {
//     double layer_height_mm = 0.2;
//     Pattern pattern = Pattern::grid;
//     static constexpr auto parameters = std::tuple{
//         parameter("layer_height_mm", &SliceOptions::layer_height_mm, "Layer height", unit::mm, 0.05, 1,
//                   "Thickness of one layer."),
//         parameter("pattern", &SliceOptions::pattern, "Infill", "How the inside is filled.").advanced()};
//   };
// An enumeration needs a specialisation of EnumNames. Defaults are the member initialisers.
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "base/data/json.h"

namespace formwright {

struct Unit {
  std::string_view symbol;  // as shown to a person; the name of the parameter carries its own suffix
};
namespace unit {
inline constexpr Unit none{""}, mm{"mm"}, degrees{"°"}, seconds{"s"}, percent{"%"}, pascal{"Pa"}, kilopascal{"kPa"},
    kg_per_m3{"kg/m³"}, mm_per_s{"mm/s"}, per_second{"1/s"}, dots_per_inch{"dpi"};
}

/// Specialise with `static constexpr std::array<std::string_view, N> names` (JSON and flag values, in
/// the order of the enumerators, which count from 0) and `labels` (for a person). `old_names`, pairs of a name of the
/// release before this one and its enumerator, may be added: these are still understood.
template <class E>
struct EnumNames;

enum class ParameterKind { boolean, integer, number, optional_number, text, choice, vector3 };

/// One parameter with its type erased: what schema, help and controls are made from.
struct ParameterInfo {
  std::string name, label, unit, help, group;
  std::string old_name;  // still understood, in JSON and as a flag; "" where there is none
  ParameterKind kind = ParameterKind::number;
  bool advanced = false;
  std::string only_with;                          // the choice that it belongs to; "" where it always counts
  std::vector<std::string> only_with_choices;     // and the values of that choice with which it counts
  double minimum = 0, maximum = 0;                // number, optional_number, integer; inclusive
  double slider_minimum = 0, slider_maximum = 0;  // the useful part of the range
  std::vector<std::string> choices, choice_labels;
  Json default_value;
};

template <class Options, class T>
struct Parameter {
  std::string_view name;
  T Options::*member;
  std::string_view label;
  Unit unit_;
  double minimum, maximum;
  std::string_view help;
  std::string_view group_ = "";
  bool advanced_ = false;
  double slider_minimum = 0, slider_maximum = 0;
  std::string_view old_name_ = "";
  std::string_view only_with_ = "";
  std::array<std::string_view, 5> only_with_choices_{};

  constexpr Parameter advanced() const {
    Parameter copy = *this;
    copy.advanced_ = true;
    return copy;
  }
  constexpr Parameter group(std::string_view title) const {
    Parameter copy = *this;
    copy.group_ = title;
    return copy;
  }
  /// The name in the release before this one, which is still understood.
  constexpr Parameter formerly(std::string_view old_name) const {
    Parameter copy = *this;
    copy.old_name_ = old_name;
    return copy;
  }
  /// It counts only while another parameter, a choice, has one of these values, at most five; else controls hide it. It
  /// is valid all the same.
  template <class... Choices>
  constexpr Parameter only_with(std::string_view choice, Choices... values) const {
    Parameter copy = *this;
    copy.only_with_ = choice;
    copy.only_with_choices_ = {std::string_view(values)...};
    return copy;
  }
  /// The part of the range a slider shows; the whole range stays valid when typed.
  constexpr Parameter slider(double from, double to) const {
    Parameter copy = *this;
    copy.slider_minimum = from;
    copy.slider_maximum = to;
    return copy;
  }
};

template <class Options, class T>
constexpr auto parameter(std::string_view name, T Options::*member, std::string_view label, Unit unit, double minimum,
                         double maximum, std::string_view help) {
  return Parameter<Options, T>{name, member, label, unit, minimum, maximum, help, "", false, minimum, maximum};
}
template <class Options, class T>
constexpr auto parameter(std::string_view name, T Options::*member, std::string_view label, std::string_view help) {
  return Parameter<Options, T>{name, member, label, unit::none, 0, 0, help};
}

/// The parameters of a base class as parameters of `Derived`, to be joined with std::tuple_cat. The base must be the
/// first one: g++ 12 forgets the offset when it converts other members at compile time.
template <class Derived, class... Parameters>
constexpr auto inherit_parameters(const std::tuple<Parameters...>& base) {
  const auto lift = []<class Base, class T>(const Parameter<Base, T>& p) {
    return Parameter<Derived, T>{p.name,           static_cast<T Derived::*>(p.member),
                                 p.label,          p.unit_,
                                 p.minimum,        p.maximum,
                                 p.help,           p.group_,
                                 p.advanced_,      p.slider_minimum,
                                 p.slider_maximum, p.old_name_,
                                 p.only_with_,     p.only_with_choices_};
  };
  return std::apply([&](const auto&... p) { return std::tuple{lift(p)...}; }, base);
}

// ---- values to and from JSON, with the parameter's name in every error ----
namespace parameters_detail {

std::string range_sentence(const ParameterInfo& info);
double checked_number(const ParameterInfo& info, const Json& value);
[[noreturn]] void reject(const ParameterInfo& info, const std::string& what);
[[noreturn]] void reject_unknown(const std::string& name, const std::vector<ParameterInfo>& known);

template <class T>
constexpr ParameterKind kind_of() {
  if constexpr (std::is_same_v<T, bool>) return ParameterKind::boolean;
  else if constexpr (std::is_same_v<T, int>) return ParameterKind::integer;
  else if constexpr (std::is_same_v<T, double>) return ParameterKind::number;
  else if constexpr (std::is_same_v<T, std::optional<double>>) return ParameterKind::optional_number;
  else if constexpr (std::is_same_v<T, std::string>) return ParameterKind::text;
  else if constexpr (std::is_same_v<T, std::array<double, 3>>) return ParameterKind::vector3;
  else {
    static_assert(std::is_enum_v<T>, "a parameter is a bool, int, double, optional<double>, string, 3-vector or enum");
    return ParameterKind::choice;
  }
}

template <class T>
Json to_json_value(const T& value) {
  if constexpr (std::is_enum_v<T>) return Json(std::string(EnumNames<T>::names.at(static_cast<std::size_t>(value))));
  else if constexpr (std::is_same_v<T, std::optional<double>>) return value ? Json(*value) : Json(nullptr);
  else return Json(value);
}

template <class T>
T from_json_value(const ParameterInfo& info, const Json& value) {
  if constexpr (std::is_same_v<T, bool>) {
    if (!value.is_boolean()) reject(info, "must be true or false");
    return value.template get<bool>();
  } else if constexpr (std::is_same_v<T, int>) {
    const double number = checked_number(info, value);
    if (number != std::floor(number)) reject(info, "must be a whole number");
    return static_cast<int>(number);
  } else if constexpr (std::is_same_v<T, double>) {
    return checked_number(info, value);
  } else if constexpr (std::is_same_v<T, std::optional<double>>) {
    return value.is_null() ? std::nullopt : std::optional<double>(checked_number(info, value));
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (!value.is_string()) reject(info, "must be text");
    return value.template get<std::string>();
  } else if constexpr (std::is_same_v<T, std::array<double, 3>>) {
    std::array<double, 3> result{};
    if (!value.is_array() || value.size() != 3) reject(info, "must be three numbers, such as [0, 0, 1]");
    for (std::size_t i = 0; i < 3; ++i) {
      if (!value[i].is_number() || !std::isfinite(value[i].template get<double>()))
        reject(info, "must be three finite numbers");
      result[i] = value[i].template get<double>();
    }
    return result;
  } else {
    if (value.is_string()) {
      const auto text = value.template get<std::string>();
      for (std::size_t i = 0; i < EnumNames<T>::names.size(); ++i)
        if (EnumNames<T>::names[i] == text) return static_cast<T>(i);
      if constexpr (requires { EnumNames<T>::old_names; })
        for (const auto& [old_name, choice] : EnumNames<T>::old_names)
          if (old_name == text) return choice;
    }
    std::string list;
    for (const auto& name : info.choices) list += (list.empty() ? "" : ", ") + name;
    reject(info, "must be one of: " + list);
  }
}
}  // namespace parameters_detail

/// The declared parameters of `Options`, in order, defaults taken from a default-constructed object.
template <class Options>
std::vector<ParameterInfo> describe_parameters() {
  const Options defaults{};
  std::vector<ParameterInfo> result;
  const auto add = [&]<class T>(const Parameter<Options, T>& p) {
    ParameterInfo info;
    info.name = p.name;
    info.label = p.label;
    info.unit = p.unit_.symbol;
    info.help = p.help;
    info.group = p.group_;
    info.old_name = p.old_name_;
    info.only_with = p.only_with_;
    for (const std::string_view choice : p.only_with_choices_)
      if (!choice.empty()) info.only_with_choices.emplace_back(choice);
    info.kind = parameters_detail::kind_of<T>();
    info.advanced = p.advanced_;
    info.minimum = p.minimum;
    info.maximum = p.maximum;
    info.slider_minimum = p.slider_minimum;
    info.slider_maximum = p.slider_maximum;
    if constexpr (std::is_enum_v<T>) {
      info.choices.assign(EnumNames<T>::names.begin(), EnumNames<T>::names.end());
      info.choice_labels.assign(EnumNames<T>::labels.begin(), EnumNames<T>::labels.end());
    }
    info.default_value = parameters_detail::to_json_value(defaults.*p.member);
    result.push_back(std::move(info));
  };
  std::apply([&](const auto&... p) { (add(p), ...); }, Options::parameters);
  return result;
}

/// Reads `Options` from a JSON object; names that are absent keep their defaults.
/// Throws Error{invalid_input} with `where` = the name for an unknown name, a wrong type, a value out of range.
template <class Options>
Options read_parameters(const Json& object) {
  const auto infos = describe_parameters<Options>();
  if (!object.is_object() && !object.is_null())
    throw Error(ErrorCode::invalid_input, "parameters", "The parameters must be a JSON object.");
  Options options{};
  for (const auto& [name, value] : object.items()) {
    bool known = false;
    std::size_t index = 0;
    const auto set = [&]<class T>(const Parameter<Options, T>& p) {
      if (p.name == name || (!p.old_name_.empty() && p.old_name_ == name)) {
        options.*p.member = parameters_detail::from_json_value<T>(infos[index], value);
        known = true;
      }
      ++index;
    };
    std::apply([&](const auto&... p) { (set(p), ...); }, Options::parameters);
    if (!known) parameters_detail::reject_unknown(name, infos);
  }
  return options;
}

template <class Options>
Json write_parameters(const Options& options) {
  Json object = Json::object();
  const auto add = [&]<class T>(const Parameter<Options, T>& p) {
    object[std::string(p.name)] = parameters_detail::to_json_value(options.*p.member);
  };
  std::apply([&](const auto&... p) { (add(p), ...); }, Options::parameters);
  return object;
}

/// JSON schema (draft 2020-12) of one parameter, with `x-` keys for label, unit, group and slider.
Json parameter_schema(const ParameterInfo& info);

/// Parses a command-line word as this parameter's JSON value ("on"/"off" for booleans, "0,0,1" for
/// vectors, "auto" for an absent optional number). Throws Error{invalid_input}.
Json parse_flag(const ParameterInfo& info, const std::string& word);

/// "thickness_mm" as a flag: "--thickness-mm".
std::string flag_name(const ParameterInfo& info);

}  // namespace formwright
