// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What was sent to every machine and what it did, in DATA/machine_log/DAY-ID.jsonl: one JSON object a line. A thread of
// the log hands them to the system line by line, at once and in order, and sees to it that the disk has those that say
// what began or ended: a full or slow disk never keeps the thread that stops machines waiting.
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "base/data/json.h"
#include "machines/port/machine_registry.h"

namespace formwright {

class MachineLog {
 public:
  /// `day`: today as in a file's name, 2026-11-23; UTC unless a test says otherwise.
  explicit MachineLog(std::filesystem::path data, std::function<std::string()> day = utc_day)
      : folder_(std::move(data) / "machine_log"), day_(std::move(day)) {}
  MachineLog(const MachineLog&) = delete;
  MachineLog& operator=(const MachineLog&) = delete;
  ~MachineLog();

  /// Adds the time (unix_s), the machine's id and name. From any thread; returns at once. `lasting`: written through to
  /// the disk. A disk that cannot be written stops no machine: that is said once on standard error.
  void append(const Machine& machine, Json entry, bool lasting = false);
  /// Waits until all that was appended is written.
  void flush() const;

  /// All that was appended, the newest entries first. `lines`: also each line sent and received.
  Json newest(std::size_t limit, bool lines) const;

  static std::string utc_day();

 private:
  struct Entry {
    std::string machine_id, line;
    bool lasting = false;
  };
  void write_all();
  void write(const Entry& entry);
  int descriptor_for(const std::string& machine_id);
  void sync();
  void close_all();
  void tidy() const;
  void complain();

  const std::filesystem::path folder_;
  mutable std::mutex mutex_;
  mutable std::condition_variable arrived_, written_;
  std::deque<Entry> waiting_;
  std::size_t waiting_bytes_ = 0;
  bool writing_ = false, ending_ = false;

  // Of the writing thread alone.
  std::function<std::string()> day_;
  std::string open_day_;             // the day of all that is open
  std::map<std::string, int> open_;  // machine's id -> descriptor: two that run at once do not wait for each other's
  std::set<int> unsynced_;
  bool complained_ = false;
  std::thread writer_;  // from the first entry on
};

}  // namespace formwright
