// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/progress/alike_runs.h"

namespace formwright {

std::string alike_runs(const Operation& operation, const Json& parameters) {
  std::string name = operation.name;
  if (!parameters.is_object()) return name;
  for (const ParameterInfo& info : operation.parameters) {
    const auto given = parameters.find(info.name);
    if (given == parameters.end() || *given == info.default_value) continue;
    if (info.kind == ParameterKind::boolean && given->is_boolean())
      name += " " + info.name + (given->get<bool>() ? "=true" : "=false");
    if (info.kind == ParameterKind::choice && given->is_string())
      name += " " + info.name + "=" + given->get<std::string>();
  }
  return name;
}

}  // namespace formwright
