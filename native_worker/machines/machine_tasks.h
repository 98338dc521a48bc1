// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Prints, uploads and slicings that run beside the server's thread, each in a state that can be asked for and with a
// cancel.
#include <atomic>
#include <boost/asio/thread_pool.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

#include "base/json.h"
#include "machines/machine_log.h"
#include "machines/machine_registry.h"

namespace formwright {

/// {"id", "machine", "kind", "state", "sentence", "fraction", "submitted_unix_s", "result"? | "error"?} as JSON.
/// state: queued, then what the work says (waiting, sending, printing, slicing), then done, failed or cancelled.
class MachineTask {
 public:
  MachineTask(const Machine& machine, std::string kind);
  const std::string id, kind;
  const Machine machine;
  std::atomic<bool> cancelled{false};

  void say(const std::string& state, const std::string& sentence, double fraction = 0);
  Json json() const;
  bool finished() const;

 private:
  friend class MachineTasks;
  void end(const std::string& state, Json result, Json error);
  mutable std::mutex mutex_;
  std::string state_ = "queued", sentence_;
  double fraction_ = 0, submitted_unix_s_ = 0;
  Json result_, error_;
};

class MachineTasks {
 public:
  using Work = std::function<Json(MachineTask&)>;  // returns the result; throws Error
  explicit MachineTasks(MachineLog& log) : log_(log) {}
  ~MachineTasks() { stop(); }

  /// Null when too many are under way. `ended` is called from another thread once the task has finished.
  std::shared_ptr<MachineTask> start(const Machine& machine, const std::string& kind, Work work,
                                     std::function<void()> ended = {});
  std::shared_ptr<MachineTask> find(const std::string& machine_id, const std::string& id) const;
  Json list(const std::string& machine_id) const;  // newest first
  /// Cancels all and waits for them, but no longer than 3 s: a printer that is being connected to may take more.
  void stop();

 private:
  MachineLog& log_;
  mutable std::mutex mutex_;
  std::deque<std::shared_ptr<MachineTask>> tasks_;  // newest first
  boost::asio::thread_pool threads_{4};
};

}  // namespace formwright
