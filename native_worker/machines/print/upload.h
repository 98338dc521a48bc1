// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// G-code to a printer's own server: OctoPrint (POST /api/files/local, X-Api-Key) and Moonraker (POST
// /server/files/upload with a SHA-256 checksum). Blocks: never on the server's thread.
#include <atomic>
#include <functional>
#include <string>

#include "base/bytes.h"
#include "base/data/json.h"
#include "machines/port/machine_registry.h"

namespace formwright {

struct UploadOrder {
  ByteView gcode;
  std::string file_name;
  bool print = false;  // starts it: the person has confirmed that
};

/// `file_name` as the machine may have it: the last part, of letters, digits, . _ and -, ending in .gcode.
/// Throws Error{invalid_input, "file_name"} when nothing is left.
std::string upload_file_name(const std::string& file_name);

/// {"file_name", "printing": bool}. Throws Error{could_not_solve, "machine"} when nobody answers, the key is wrong, the
/// machine refuses (busy, no room, another kind of server); Error{invalid_input}; Error{cancelled}. `progress`: share
/// sent, 0 to 1.
Json upload_gcode(const Machine& machine, const UploadOrder& order, const std::atomic<bool>& cancelled,
                  const std::function<void(double)>& progress);

/// {"state": "ready"|"printing"|"paused"|"error"|"disconnected", "software": "OctoPrint 1.11", ...}. Throws like
/// upload_gcode.
Json upload_machine_state(const Machine& machine, const std::atomic<bool>& cancelled);

/// Stops the print that runs there. Throws like upload_gcode.
void cancel_print(const Machine& machine, const std::atomic<bool>& cancelled);

}  // namespace formwright
