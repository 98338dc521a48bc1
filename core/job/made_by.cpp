// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/made_by.h"

#include "base/sha256.h"
#include "formats/shared/file_note.h"
#include "job/catalog.h"

namespace formwright {
namespace {

/// In one line of ASCII.
std::string line_of(const Json& value) { return value.dump(-1, ' ', true, Json::error_handler_t::replace); }

/// 5 and 5.0 are the same value of a parameter that is no whole number.
Json as_declared(const ParameterInfo& info, const Json& value) {
  if (value.is_array()) {
    Json numbers = Json::array();
    for (const Json& number : value) numbers.push_back(as_declared(info, number));
    return numbers;
  }
  const bool whole = info.kind == ParameterKind::integer;
  return value.is_number_integer() && !whole ? Json(value.get<double>()) : value;
}

/// A given value stays even where it is the default: it goes before that of a machine profile among the inputs.
Json given_values(const Operation& operation, const Json& parameters) {
  Json given = Json::object();
  for (const ParameterInfo& info : operation.parameters)
    for (const std::string& name : {info.name, info.old_name})
      if (!name.empty() && parameters.contains(name)) given[info.name] = as_declared(info, parameters[name]);
  return given;
}

}  // namespace

Json made_by(const Operation& operation, const Json& parameters, const std::map<std::string, InputBlob>& inputs) {
  Json used = Json::object();
  for (const auto& [name, input] : inputs) {
    if (input.sample.empty()) used[name] = {{"sha256", input.sha256}, {"file_name", input.file_name}};
    else used[name] = {{"sample", input.sample}, {"vertices", input.sample_vertices}};
  }
  Json record = {{"program", "Formwright"},
                 {"version", version()},
                 {"operation", operation.name},
                 {"parameters", given_values(operation, parameters)},
                 {"inputs", used}};
  record["job"] = sha256_hex(as_bytes(line_of(record))).substr(0, 16);
  return record;
}

ReportField made_by_field() {
  return {
      "made_by", "Made by", "",
      "Program, version, operation, the parameters that were given, and the inputs. \"job\" names all that in 16 digits, which stand in the files, too."};
}

void note_made_by(OutputBlob& output, const Json& record) {
  if (!takes_note(output.media_type)) return;
  std::string note = line_of(record);
  if (note.size() > 2048) {
    Json brief = record;
    brief.erase("parameters"), brief.erase("inputs");
    note = line_of(brief);
  }
  const auto file = std::make_shared<Bytes>(*output.bytes);
  add_note(*file, output.media_type, note, ", job " + record["job"].get<std::string>());
  output.bytes = file;
}

}  // namespace formwright
