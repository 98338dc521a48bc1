// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How an operation declares its parameters: once, as the structs that its `run` is called with.
#include <algorithm>
#include <array>
#include <iterator>
#include <tuple>

#include "base/error.h"
#include "job/contract/operation.h"

namespace formwright {

/// The operation's parameters are those of `Options`; a job's are read before it begins, and `run(call, options)` gets
/// them. `check` tests what no range of a single parameter says; it throws Error{invalid_input}.
template <class Options, class Run>
void take_options(Operation& operation, Run run, void (*check)(const Options&) = nullptr) {
  operation.parameters = describe_parameters<Options>();
  operation.prepare = [run, check](const Json& parameters) -> PreparedOperation {
    const auto options = read_parameters<Options>(parameters);
    if (check) check(options);
    return [run, options](const OperationCall& call) { return run(call, options); };
  };
}

/// The operation's parameters are those of `Options`, in a program that has not its code: parameters are checked, and
/// running it is refused.
template <class Options>
void declare_options(Operation& operation) {
  take_options<Options>(
      operation,
      [name = operation.name, module = operation.module](const OperationCall&, const Options&) -> OperationResult {
        throw Error(ErrorCode::internal, "operation",
                    name + " runs in the module " + module + ", which was not loaded: this is a bug in Formwright.");
      });
}

namespace job_detail {
/// The values that `Options` declares, taken out of `parameters`.
template <class Options>
Json taken_from(Json& parameters) {
  Json taken = Json::object();
  for (const ParameterInfo& info : describe_parameters<Options>())
    for (const std::string& name : {info.name, info.old_name})
      if (!name.empty() && parameters.contains(name)) {
        taken[name] = parameters[name];
        parameters.erase(name);
      }
  return taken;
}
}  // namespace job_detail

/// The same where an input file may hold more of the values: `run(call, given...)` gets, for every struct, those of the
/// job as they were given, to merge them. A name that none declares is refused as one of `Options`.
template <class Options, class... More, class Run>
void take_mergeable_options(Operation& operation, Run run) {
  operation.parameters.clear();
  const auto append = [&](std::vector<ParameterInfo> infos) {
    std::move(infos.begin(), infos.end(), std::back_inserter(operation.parameters));
  };
  append(describe_parameters<Options>());
  (append(describe_parameters<More>()), ...);
  operation.prepare = [run](const Json& parameters) -> PreparedOperation {
    Json given = parameters;
    const std::array<Json, sizeof...(More)> more{job_detail::taken_from<More>(given)...};
    read_parameters<Options>(given);
    [[maybe_unused]] std::size_t index = 0;
    (read_parameters<More>(more[index++]), ...);
    return [run, given, more](const OperationCall& call) {
      return std::apply([&](const auto&... of_more) { return run(call, given, of_more...); }, more);
    };
  };
}

}  // namespace formwright
