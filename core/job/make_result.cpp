// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/make_result.h"

#include "base/data/json.h"
#include "base/error.h"
#include "base/parallel.h"
#include "evidence/models/thermoform/sheet_simulation.h"

namespace formwright {

Bytes make_result(const std::string& key, const std::string& recipe, ByteView input, const Host& host) {
  const Json read = Json::parse(recipe, nullptr, false);
  const std::string kind = read.is_object() && read.contains("kind") && read["kind"].is_string()
                               ? read["kind"].get<std::string>()
                               : std::string();
  if (kind != "thermoform")
    throw Error(ErrorCode::invalid_input, "tasks",
                "There is no simulation of the kind \"" + kind + "\": run the same version of formwright everywhere.");
  const ThreadLimit one_thread(1);
  return simulated_by_recipe(key, read, input, Context(host));
}

}  // namespace formwright
