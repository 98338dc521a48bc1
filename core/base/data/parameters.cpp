// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/data/parameters.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "base/format.h"

namespace formwright {
namespace {

int edit_distance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

const char* type_name(ParameterKind kind) {
  switch (kind) {
    case ParameterKind::boolean: return "boolean";
    case ParameterKind::integer: return "integer";
    case ParameterKind::number:
    case ParameterKind::optional_number: return "number";
    case ParameterKind::text:
    case ParameterKind::choice: return "string";
    case ParameterKind::vector3: return "array";
  }
  return "string";
}

}  // namespace

namespace parameters_detail {

std::string range_sentence(const ParameterInfo& info) {
  const std::string unit = info.unit.empty() ? "" : " " + info.unit;
  return "from " + with_digits(info.minimum, 6) + " to " + with_digits(info.maximum, 6) + unit;
}

void reject(const ParameterInfo& info, const std::string& what) {
  throw Error(ErrorCode::invalid_input, info.name, info.label + " (" + info.name + ") " + what + ".");
}

double checked_number(const ParameterInfo& info, const Json& value) {
  if (!value.is_number()) reject(info, "must be a number " + range_sentence(info));
  const double number = value.get<double>();
  if (!std::isfinite(number) || number < info.minimum || number > info.maximum)
    reject(info, "is " + with_digits(number, 6) + ", and must be " + range_sentence(info));
  return number;
}

void reject_unknown(const std::string& name, const std::vector<ParameterInfo>& known) {
  const ParameterInfo* nearest = nullptr;
  int best = 4;  // further apart than this is not a typing slip
  for (const auto& info : known)
    if (const int distance = edit_distance(name, info.name); distance < best) {
      best = distance;
      nearest = &info;
    }
  throw Error(ErrorCode::invalid_input, name,
              "There is no parameter called " + name + (nearest ? "; did you mean " + nearest->name + "?" : "."));
}

}  // namespace parameters_detail

Json parameter_schema(const ParameterInfo& info) {
  Json schema;
  if (info.kind == ParameterKind::optional_number) schema["type"] = {"number", "null"};
  else schema["type"] = type_name(info.kind);
  if (info.kind == ParameterKind::vector3) {
    schema["items"] = {{"type", "number"}};
    schema["minItems"] = schema["maxItems"] = 3;
  }
  if (info.kind == ParameterKind::number || info.kind == ParameterKind::integer ||
      info.kind == ParameterKind::optional_number) {
    schema["minimum"] = info.minimum;
    schema["maximum"] = info.maximum;
    schema["x-slider"] = {info.slider_minimum, info.slider_maximum};
  }
  if (info.kind == ParameterKind::choice) {
    schema["enum"] = info.choices;
    schema["x-choice-labels"] = info.choice_labels;
  }
  schema["default"] = info.default_value;
  schema["title"] = info.label;
  schema["description"] = info.help;
  if (!info.unit.empty()) schema["x-unit"] = info.unit;
  if (!info.group.empty()) schema["x-group"] = info.group;
  if (info.advanced) schema["x-advanced"] = true;
  if (!info.only_with.empty())
    schema["x-only-with"] = {{"parameter", info.only_with}, {"values", info.only_with_choices}};
  return schema;
}

Json parse_flag(const ParameterInfo& info, const std::string& word) {
  const auto number = [&](const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0') parameters_detail::reject(info, "is \"" + word + "\", which is not a number");
    return value;
  };
  switch (info.kind) {
    case ParameterKind::boolean:
      if (word == "on" || word == "true" || word == "yes" || word == "1") return true;
      if (word == "off" || word == "false" || word == "no" || word == "0") return false;
      parameters_detail::reject(info, "must be on or off");
    case ParameterKind::optional_number:
      if (word == "auto") return nullptr;
      return number(word);
    case ParameterKind::integer:
    case ParameterKind::number: return number(word);
    case ParameterKind::vector3: {
      Json result = Json::array();
      std::size_t start = 0;
      while (start <= word.size()) {
        const std::size_t comma = std::min(word.find(',', start), word.size());
        result.push_back(number(word.substr(start, comma - start)));
        start = comma + 1;
      }
      return result;
    }
    case ParameterKind::text:
    case ParameterKind::choice: return word;
  }
  return nullptr;
}

std::string flag_name(const ParameterInfo& info) {
  std::string flag = "--" + info.name;
  std::replace(flag.begin() + 2, flag.end(), '_', '-');
  return flag;
}

}  // namespace formwright
