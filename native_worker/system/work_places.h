// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Counts where the simulations of one run are made: here, in other runs that share the kept results, and where an
// engine has them made.
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "base/context.h"
#include "system/files.h"

namespace formwright {

/// From any thread.
class WorkPlaces {
 public:
  void began(const std::string& key);
  /// Kept by this run; seconds since it began are handed to `on_made_here`.
  void made(const std::string& key);
  void gave_up(const std::string& key);
  /// Another run of `machine` is at it, unless this one has begun it.
  void is_made_by(const std::string& machine, const std::string& key);
  /// It is there; where another run was at it, that one has made it.
  void found(const std::string& key);
  /// What an engine has made elsewhere, in its order.
  void set_engine_places(std::vector<WorkPlace> places);
  /// First this computer, then others by name, then the engine's.
  std::vector<WorkPlace> now() const;

  /// May be empty. Set before the run.
  std::function<void(const std::string& key, double seconds)> on_made_here = {};

 private:
  using Clock = std::chrono::steady_clock;
  mutable std::mutex mutex_;
  std::map<std::string, Clock::time_point> running_here_;
  int made_here_ = 0;
  std::map<std::string, std::string> running_elsewhere_;  // key, machine
  std::map<std::string, int> made_elsewhere_;             // machine
  std::vector<WorkPlace> engine_;
};

/// Lends the folder to a job and counts: the progress that the host hears of says where simulations run.
std::shared_ptr<WorkPlaces> share_results(const ResultFolder& folder, Host& host);

/// "this computer 2 running, 31 done; n1 4 running, 20 done; 7 waiting in Slurm's queue"; empty where nothing runs or
/// ran.
std::string places_text(const std::vector<WorkPlace>& places);

}  // namespace formwright
