// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What every machine was told and did, in DATA/machine_log/DAY-ID.jsonl: one JSON object a line, handed to the system
// line by line, so that a crash of this program loses nothing; entries that say what began or ended are on the disk
// when the call returns.
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "base/json.h"
#include "machines/machine_registry.h"

namespace formwright {

class MachineLog {
 public:
  /// `day`: today as in a file's name, 2026-11-23; UTC unless a test says otherwise.
  explicit MachineLog(std::filesystem::path data, std::function<std::string()> day = utc_day)
      : folder_(std::move(data) / "machine_log"), day_(std::move(day)) {}
  MachineLog(const MachineLog&) = delete;
  MachineLog& operator=(const MachineLog&) = delete;
  ~MachineLog();

  /// Adds the time (unix_s), the machine's id and name. From any thread. `lasting`: wait until the disk has it. A disk
  /// that cannot be written stops no machine: that is said once on standard error.
  void append(const Machine& machine, Json entry, bool lasting = false);

  /// The newest entries first. `lines`: also each line sent and received.
  Json newest(std::size_t limit, bool lines) const;

  static std::string utc_day();

 private:
  int descriptor_for(const Machine& machine);
  void close_all();
  void tidy() const;

  std::filesystem::path folder_;
  std::function<std::string()> day_;
  mutable std::mutex mutex_;
  std::string open_day_;             // the day of all that is open
  std::map<std::string, int> open_;  // machine's id -> descriptor: two that run at once do not wait for each other's
  bool complained_ = false;
};

}  // namespace formwright
