// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What OctoPrint and Moonraker answer. Whatever they say, each of these gives a result or throws Error{could_not_solve,
// "machine"}.
#include <string>

#include "base/data/json.h"
#include "machines/port/machine_registry.h"

namespace formwright {

struct UploadReply {
  long status = 0;  // HTTP
  Json json;        // discarded when it is not JSON
};

/// Throws for a redirect and a key that is not known.
UploadReply read_reply(const Machine& machine, long status, const std::string& answer);
/// To a file that was sent: {"file_name", "printing"}. `print`: it was to be started.
Json read_uploaded(const Machine& machine, bool print, const UploadReply& reply);
/// To /api/version: "OctoPrint 1.11".
std::string read_octoprint_version(const Machine& machine, const UploadReply& version);
/// To /api/printer: {"state", "software", "state_message"?}.
Json read_octoprint_state(const std::string& software, const UploadReply& printer);
/// To /server/info: {"state", "software"}; true where the printer should be asked whether it prints.
bool read_moonraker_state(const Machine& machine, const UploadReply& info, Json& state);
void read_moonraker_printing(const UploadReply& printing, Json& state);
/// To the request to end a print.
void read_cancelled(const Machine& machine, const UploadReply& reply);

}  // namespace formwright
