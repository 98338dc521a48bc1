// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// `formwright machine ...`: the same machines and the same code as in the worker, without it.
#include <atomic>
#include <map>
#include <string>
#include <vector>

namespace formwright {

/// `words`: what follows "machine". Returns the exit code; throws Error. `interrupted`: Ctrl-C was pressed, or the
/// terminal closed.
int machine_command(const std::vector<std::string>& words, const std::atomic<bool>& interrupted);

/// machine_run_commands.cpp
int machine_send(const std::vector<std::string>& words, const std::atomic<bool>& interrupted);
int machine_origin(const std::vector<std::string>& words, const std::atomic<bool>& interrupted);
int machine_frame(const std::vector<std::string>& words, const std::atomic<bool>& interrupted);
int machine_stop(const std::vector<std::string>& words, const std::atomic<bool>& interrupted);

/// Flags of one of the subcommands: every one takes a value, but those in `switches`.
struct MachineFlags {
  std::map<std::string, std::string> values;                 // "--machine" -> "Studio"; a switch that was given -> "on"
  std::map<std::string, std::vector<std::string>> repeated;  // of flags that may be given several times: all values
  const std::string& needed(const std::string& flag, const std::string& example) const;
  std::string value_or(const std::string& flag, const std::string& otherwise) const;
  bool given(const std::string& flag) const { return values.contains(flag); }
};
MachineFlags read_machine_flags(const std::vector<std::string>& words, const std::vector<std::string>& flags,
                                const std::vector<std::string>& switches,
                                const std::vector<std::string>& repeatable = {});

}  // namespace formwright
