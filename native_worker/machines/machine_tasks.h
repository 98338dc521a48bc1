// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Prints, uploads and slicings that run beside the server's thread, each in a state that can be asked for and with a
// cancel. Prints and uploads are kept in DATA/prints/ID.json: what a machine has taken goes on without the worker, and
// the next worker shows it again.
#include <atomic>
#include <boost/asio/thread_pool.hpp>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/data/json.h"
#include "machines/port/machine_log.h"
#include "machines/port/machine_registry.h"

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
  /// The machine has it now, as its own job: `there` is what it takes to ask for it again.
  void hand_over(Json there);
  /// Null before.
  Json handed_over() const;
  Json json() const;
  bool finished() const;

 private:
  friend class MachineTasks;
  /// One that another worker kept. Throws where `kept` is none.
  MachineTask(const Machine& machine, const Json& kept);
  void end(const std::string& state, Json result, Json error);
  mutable std::mutex mutex_;
  std::string state_ = "queued", sentence_;
  double fraction_ = 0, submitted_unix_s_ = 0;
  Json result_, error_, there_;
  std::function<void()> keep_;  // writes it down
};

class MachineTasks {
 public:
  using Work = std::function<Json(MachineTask&)>;  // returns the result; throws Error
  MachineTasks(MachineLog& log, const std::filesystem::path& data) : log_(log), folder_(data / "prints") {}
  ~MachineTasks() { stop(); }

  /// Reads what earlier workers kept. Returns those that the machines have and that had not ended: they are to be
  /// followed with `resume`.
  std::vector<std::shared_ptr<MachineTask>> restore();
  void resume(const std::shared_ptr<MachineTask>& task, Work work) { run(task, std::move(work), {}); }

  /// Null when too many are under way. `ended` is called from another thread once the task has finished.
  std::shared_ptr<MachineTask> start(const Machine& machine, const std::string& kind, Work work,
                                     std::function<void()> ended = {});
  std::shared_ptr<MachineTask> find(const std::string& machine_id, const std::string& id) const;
  Json list(const std::string& machine_id) const;  // newest first
  /// Cancels all but what the machines have already, and waits for the cancelled, but no longer than 3 s: a printer
  /// that is being connected to may take more.
  void stop();

 private:
  using Task = std::shared_ptr<MachineTask>;
  void add(const Task& task);
  void keep(const MachineTask& task) const;
  void run(const Task& task, Work work, std::function<void()> ended);
  MachineLog& log_;
  const std::filesystem::path folder_;
  mutable std::mutex mutex_;
  std::deque<Task> tasks_;  // newest first
  boost::asio::thread_pool threads_{4};
};

}  // namespace formwright
