// SPDX-License-Identifier: GPL-3.0-or-later
// What a page may say at a machine's socket. Apart from the socket, so that the fuzzer reaches it.
#include "base/error.h"
#include "base/data/json_text.h"
#include "system/hex_name.h"
#include "machines/machine_page.h"
#include "system/machine_errors.h"

namespace formwright {

MachineRequest read_machine_request(const std::string& text) {
  const Json message = parse_json_text(text);
  if (!message.is_object()) refuse("", "A request is a JSON object with open, command, load or close.");
  MachineRequest request;
  int count = 0;
  for (const auto& [name, value] : message.items()) {
    if (name == "n") {
      if (!value.is_number_integer() || value < 0 || value > 1'000'000'000)
        refuse("n", "n must be a whole number from 0.");
      request.number = value.get<int>();
      continue;
    }
    ++count;
    if (name == "open") request.kind = MachineRequest::Kind::open;
    else if (name == "command") request.kind = MachineRequest::Kind::command;
    else if (name == "load") request.kind = MachineRequest::Kind::load;
    else if (name == "close") request.kind = MachineRequest::Kind::close;
    else refuse("", "A request is one of open, command, load and close.");
    if (request.kind == MachineRequest::Kind::close) {
      if (value != true) refuse("close", "close must be true.");
      continue;
    }
    if (!value.is_object()) refuse(name, name + " must be an object.");
    if (request.kind != MachineRequest::Kind::load) {
      request.content = value;
      continue;
    }
    for (const auto& [field, content] : value.items()) {
      if ((field != "name" && field != "sha256") || !content.is_string())
        refuse("load", "load needs name and sha256, both text.");
      (field == "name" ? request.name : request.sha256) = content.get<std::string>();
    }
    if (request.name.empty() || request.name.size() > 200) refuse("name", "The job needs a name of up to 200 letters.");
    if (!is_hex_name(request.sha256, 64)) refuse("sha256", "Give the job's SHA-256, and send its file first.");
  }
  if (count != 1) refuse("", "A request is exactly one of open, command, load and close.");
  return request;
}

}  // namespace formwright
