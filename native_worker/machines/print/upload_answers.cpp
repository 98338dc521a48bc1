// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/upload_answers.h"

#include <algorithm>

#include "base/error.h"
#include "base/data/json_text.h"
#include "system/machine_errors.h"

namespace formwright {
namespace {

/// The machine's own words: OctoPrint says {"error": "..."}, Moonraker {"error": {"message": "..."}}.
std::string words_of(const Json& json) {
  if (!json.is_object() || !json.contains("error")) return "";
  const Json& error = json["error"];
  std::string words = error.is_string() ? error.get<std::string>()
                      : error.is_object() && error.contains("message") && error["message"].is_string()
                          ? error["message"].get<std::string>()
                          : "";
  std::replace_if(
      words.begin(), words.end(), [](unsigned char c) { return c < 32; }, ' ');
  return words.substr(0, 300);
}

std::string quoted(const std::string& words) { return words.empty() ? "" : " (\"" + words + "\")"; }

const Json& at_path(const Json& json, std::initializer_list<const char*> path) {
  static const Json nothing;
  const Json* here = &json;
  for (const char* name : path) {
    if (!here->is_object() || !here->contains(name)) return nothing;
    here = &(*here)[name];
  }
  return *here;
}

std::string text_at(const Json& json, std::initializer_list<const char*> path) {
  const Json& value = at_path(json, path);
  return value.is_string() ? value.get<std::string>() : "";
}

bool flag_at(const Json& json, std::initializer_list<const char*> path) {
  const Json& value = at_path(json, path);
  return value.is_boolean() && value.get<bool>();
}

}  // namespace

UploadReply read_reply(const Machine& machine, long status, const std::string& answer) {
  if (status >= 300 && status < 400)
    fail_at_machine(machine.name + " redirects to another address: register it with that address.");
  // OctoPrint takes a request with a key it does not know for one of a browser.
  if (status == 401 || status == 403 || (status == 400 && answer.find("CSRF") != std::string::npos))
    fail_at_machine(
        machine.name +
        " does not accept the key: remove it and add it again with --api-key-file and a key from its settings.");
  return {status, parse_json_text(answer)};
}

Json read_uploaded(const Machine& machine, bool print, const UploadReply& reply) {
  const bool octoprint = machine.kind == MachineKind::octoprint;
  const std::string words = words_of(reply.json);
  if (reply.status == 409)
    fail_at_machine(machine.name + " cannot take the file now" + quoted(words) +
                    ": it prints that file, or is not connected to its printer. Wait or connect it.");
  if (reply.status == 413 || reply.status == 507)
    fail_at_machine(machine.name + " has no room for the file" + quoted(words) + ": delete old ones there.");
  if (reply.status == 415)
    fail_at_machine(machine.name + " does not take such a file" + quoted(words) + ": send G-code.");
  if (reply.status == 404)
    fail_at_machine("What answers at " + machine.url + " is no " + (octoprint ? "OctoPrint" : "Moonraker") +
                    ": see whether the address and --kind are right.");
  if (reply.status == 422)
    fail_at_machine("The file arrived damaged at " + machine.name + quoted(words) + ": send it again.");
  if (reply.status < 200 || reply.status >= 300)
    fail_at_machine(machine.name + " refused the file (" + std::to_string(reply.status) + ")" + quoted(words) +
                    ": see its own page for the reason.");
  std::string kept =
      octoprint ? text_at(reply.json, {"files", "local", "name"}) : text_at(reply.json, {"item", "path"});
  if (kept.empty())
    kept =
        octoprint ? text_at(reply.json, {"files", "local", "path"}) : text_at(reply.json, {"result", "item", "path"});
  if (kept.empty())
    fail_at_machine("What answers at " + machine.url + " is no " + (octoprint ? "OctoPrint" : "Moonraker") +
                    ": see whether the address and --kind are right.");
  bool printing = print;
  if (octoprint && at_path(reply.json, {"effectivePrint"}).is_boolean())
    printing = flag_at(reply.json, {"effectivePrint"});
  else if (!octoprint)
    printing = flag_at(reply.json, {"print_started"}) || flag_at(reply.json, {"result", "print_started"});
  else if (print) printing = !at_path(reply.json, {"files", "local"}).is_null();
  if (print && !printing)
    fail_at_machine(machine.name + " has the file " + kept +
                    " and did not start it: its printer is not ready. Start it there once it is.");
  return {{"file_name", kept}, {"printing", printing}};
}

std::string read_octoprint_version(const Machine& machine, const UploadReply& version) {
  const std::string server = text_at(version.json, {"server"});
  if (version.status != 200 || server.empty())
    fail_at_machine("What answers at " + machine.url +
                    " is no OctoPrint: see whether the address and --kind are right.");
  return "OctoPrint " + server;
}

Json read_octoprint_state(const std::string& software, const UploadReply& printer) {
  if (printer.status == 409) return {{"state", "disconnected"}, {"software", software}};
  const auto flag = [&](const char* name) { return flag_at(printer.json, {"state", "flags", name}); };
  const std::string state = flag("error") || flag("closedOrError")   ? "error"
                            : flag("paused") || flag("pausing")      ? "paused"
                            : flag("printing") || flag("cancelling") ? "printing"
                            : flag("operational")                    ? "ready"
                                                                     : "disconnected";
  return {{"state", state}, {"software", software}, {"state_message", text_at(printer.json, {"state", "text"})}};
}

bool read_moonraker_state(const Machine& machine, const UploadReply& info, Json& state) {
  const std::string klippy = text_at(info.json, {"result", "klippy_state"});
  if (info.status != 200 || klippy.empty())
    fail_at_machine("What answers at " + machine.url +
                    " is no Moonraker: see whether the address and --kind are right.");
  state = {{"state", klippy == "ready"                           ? "ready"
                     : klippy == "error" || klippy == "shutdown" ? "error"
                                                                 : "disconnected"},
           {"software", "Moonraker " + text_at(info.json, {"result", "moonraker_version"})}};
  return klippy == "ready";
}

void read_moonraker_printing(const UploadReply& printing, Json& state) {
  const std::string now = text_at(printing.json, {"result", "status", "print_stats", "state"});
  if (now == "printing" || now == "paused" || now == "error") state["state"] = now;
}

void read_cancelled(const Machine& machine, const UploadReply& reply) {
  if (reply.status < 200 || reply.status >= 300)
    fail_at_machine(machine.name + " did not stop (" + std::to_string(reply.status) + ")" +
                    quoted(words_of(reply.json)) + ": if it prints, stop it at the machine.");
}

}  // namespace formwright
