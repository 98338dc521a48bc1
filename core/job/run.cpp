// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/run.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <mutex>
#include <new>

#include "geometry/samples/samples.h"
#include "job/catalog.h"
#include "job/made_by.h"
#include "job/progress/alike_runs.h"
#include "job/progress/timed_host.h"

namespace formwright {
namespace {

/// Eigen cuts matrix products into blocks by the caches it finds, and with them the order of sums: the same job would
/// differ in its last bits from one processor to the next, and where a border is a tie, visibly. These are the sizes
/// that Eigen takes where it cannot ask, as in WebAssembly.
void sum_alike_on_every_processor() {
  static std::once_flag once;
  std::call_once(once, [] { Eigen::setCpuCacheSizes(32 << 10, 256 << 10, 2 << 20); });
}

Error invalid(const std::string& where, const std::string& sentence) {
  return {ErrorCode::invalid_input, where, sentence};
}

const Operation& operation_of(const Json& message) {
  if (!message.is_object()) throw invalid("", "A job must be a JSON object.");
  for (const auto& [name, value] : message.items())
    if (name != "operation" && name != "parameters" && name != "inputs" && name != "outputs")
      throw invalid(name, "A job has operation, parameters, inputs and outputs; there is no \"" + name + "\".");
  const auto name = message.find("operation");
  if (name == message.end() || !name->is_string()) throw invalid("operation", "The job names no operation.");
  if (const Operation* operation = find_operation(name->get<std::string>())) return *operation;
  std::string list;
  for (const Operation& known : operations()) list += (list.empty() ? "" : ", ") + known.name;
  throw invalid("operation", "There is no operation called " + name->get<std::string>() + "; there are: " + list + ".");
}

InputBlob read_input(const std::string& name, const Json& value) {
  InputBlob input;
  if (!value.is_object()) throw invalid(name, "The input " + name + " must be an object with sha256 or sample.");
  const auto text = [&](const char* key) {
    const auto it = value.find(key);
    if (it == value.end()) return std::string();
    if (!it->is_string()) throw invalid(name, std::string(key) + " of the input " + name + " must be text.");
    return it->get<std::string>();
  };
  input.sha256 = text("sha256");
  input.file_name = text("file_name");
  input.sample = text("sample");
  if (const auto it = value.find("vertices"); it != value.end()) {
    if (!it->is_number_integer() || it->get<long long>() < 0 || it->get<long long>() > 5'000'000)
      throw invalid(name, "The number of vertices of a sample must be a whole number up to 5 million.");
    input.sample_vertices = it->get<int>();
  }
  if (input.sha256.empty() == input.sample.empty())
    throw invalid(name, "The input " + name + " must have either sha256 or sample.");
  if (!input.sha256.empty() &&
      (input.sha256.size() != 64 || input.sha256.find_first_not_of("0123456789abcdef") != std::string::npos))
    throw invalid(name, "sha256 of the input " + name + " must be 64 lower-case hexadecimal digits.");
  return input;
}

void check_sample(const std::string& input_name, const InputBlob& input) {
  std::string list;
  for (const SampleInfo& sample : sample_catalog()) {
    if (sample.name == input.sample) {
      if (input.sample_vertices != 0 &&
          (input.sample_vertices < min_sample_vertices || input.sample_vertices > max_sample_vertices))
        throw invalid(input_name, "A sample has from " + std::to_string(min_sample_vertices) + " to " +
                                      std::to_string(max_sample_vertices) + " vertices.");
      return;
    }
    list += (list.empty() ? "" : ", ") + sample.name;
  }
  throw invalid(input_name, "There is no sample called " + input.sample + "; there are: " + list + ".");
}

/// "object_2" of "object", up to "object_64".
bool is_repeat_of(const std::string& name, const std::string& candidate) {
  if (!candidate.starts_with(name + "_")) return false;
  const std::string number = candidate.substr(name.size() + 1);
  return !number.empty() && number.size() <= 2 && number.find_first_not_of("0123456789") == std::string::npos &&
         number[0] != '0' && std::stoi(number) >= 2 && std::stoi(number) <= 64;
}

std::map<std::string, InputBlob> read_inputs(const Operation& operation, const Json& message) {
  std::map<std::string, InputBlob> inputs;
  const Json empty = Json::object();
  const auto it = message.find("inputs");
  const Json& given = it == message.end() ? empty : *it;
  if (!given.is_object()) throw invalid("inputs", "The inputs must be a JSON object.");
  for (const auto& [name, value] : given.items()) {
    const auto info = std::find_if(operation.inputs.begin(), operation.inputs.end(), [&n = name](const InputInfo& i) {
      return i.name == n || (i.repeatable && is_repeat_of(i.name, n));
    });
    if (info == operation.inputs.end())
      throw invalid(name, "The operation " + operation.name + " has no input called " + name + ".");
    InputBlob input = read_input(name, value);
    if (!input.sample.empty()) {
      if (!info->accepts_sample) throw invalid(name, "The input " + name + " must be a file, not a sample.");
      check_sample(name, input);
    }
    inputs.emplace(name, std::move(input));
  }
  for (const InputInfo& info : operation.inputs)
    if (info.required && !inputs.contains(info.name))
      throw invalid(info.name, "The operation " + operation.name + " needs an input called " + info.name +
                                   (info.accepts_sample ? ": a file or a sample." : "."));
  return inputs;
}

std::vector<std::string> read_wanted(const Operation& operation, const Json& message) {
  std::vector<std::string> wanted;
  const auto it = message.find("outputs");
  if (it == message.end()) {
    for (const OutputInfo& output : operation.outputs)
      if (output.made_by_default) wanted.push_back(output.name);
    return wanted;
  }
  if (!it->is_array()) throw invalid("outputs", "The outputs must be a list of names.");
  for (const Json& name : *it) {
    if (!name.is_string() || !operation.output(name.get<std::string>())) {
      std::string list;
      for (const OutputInfo& output : operation.outputs) list += (list.empty() ? "" : ", ") + output.name;
      throw invalid("outputs", "The operation " + operation.name + " makes: " + list + "; not " + name.dump() + ".");
    }
    wanted.push_back(name.get<std::string>());
  }
  return wanted;
}

Json parameters_of(const Json& message) {
  const auto it = message.find("parameters");
  return it == message.end() ? Json::object() : *it;
}

/// NaN and infinity have no JSON: a report that holds one is a bug of ours, not an output.
void require_finite(const Json& value, const std::string& path) {
  if (value.is_number_float() && !std::isfinite(value.get<double>()))
    throw Error(ErrorCode::internal, path,
                "The figure " + path + " of the report is not finite: this is a bug in Formwright.");
  if (value.is_structured())
    for (const auto& [name, item] : value.items()) require_finite(item, path + (path.empty() ? "" : ".") + name);
}

template <class Body>
std::optional<JobError> caught(const Body& body) {
  try {
    body();
    return std::nullopt;
  } catch (const Error& error) {
    return JobError{error.code(), error.where(), error.what()};
  } catch (const std::bad_alloc&) {
    return JobError{ErrorCode::out_of_memory, "",
                    "There is not enough memory for this: use a smaller model, or the native worker."};
  } catch (const std::exception& error) {
    return JobError{ErrorCode::internal, "", std::string("Formwright made a mistake: ") + error.what()};
  }
}

}  // namespace

std::optional<JobError> check_job(const Json& message) {
  return caught([&] {
    const Operation& operation = operation_of(message);
    read_inputs(operation, message);
    read_wanted(operation, message);
    operation.prepare(parameters_of(message));
  });
}

JobResult run_job(const Json& message, const BlobSource& blobs, Session& session, const Host& host) {
  sum_alike_on_every_processor();
  JobResult result;
  result.error = caught([&] {
    const Operation& operation = operation_of(message);
    TimedHost timed(host, alike_runs(operation, parameters_of(message)), session);
    Context context(timed.host());
    std::map<std::string, InputBlob> inputs = read_inputs(operation, message);
    const std::vector<std::string> wanted = read_wanted(operation, message);
    const PreparedOperation prepared = operation.prepare(parameters_of(message));
    for (auto& [name, input] : inputs) {
      if (!input.sample.empty()) continue;
      input.bytes = blobs(input.sha256);
      if (!input.bytes)
        throw Error(ErrorCode::invalid_input, name,
                    "The file for the input " + name + " has not arrived: send it again.");
    }
    const auto wants = [&](const std::string& name) {
      return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
    };
    OperationResult made = prepared({inputs, wants, session, context});
    if (const double memory = context.peak_memory_mb(); memory > 0) made.report["peak_memory_mb"] = memory;
    const Json record = made_by(operation, parameters_of(message), inputs);
    for (OutputBlob& output : made.outputs) note_made_by(output, record);
    made.report["made_by"] = record;
    require_finite(made.report, "");
    for (const ReportField& field : operation.report)
      if (!field.old_name.empty() && made.report.contains(field.name))
        made.report[field.old_name] = made.report[field.name];
    result.report = std::move(made.report);
    result.outputs = std::move(made.outputs);
    timed.succeeded();
  });
  if (result.error) result.report = Json(), result.outputs.clear();
  return result;
}

Json error_json(const JobError& error) {
  return {{"error", {{"code", to_string(error.code)}, {"where", error.where}, {"message", error.message}}}};
}

Json result_json(const JobResult& result) {
  if (result.error) return error_json(*result.error);
  Json outputs = Json::object();
  for (const OutputBlob& output : result.outputs)
    outputs[output.name] = {{"media_type", output.media_type}, {"bytes", output.bytes->size()}};
  return {{"report", result.report}, {"outputs", outputs}};
}

}  // namespace formwright
