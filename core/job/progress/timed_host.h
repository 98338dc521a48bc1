// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Between a job and its host: what reaches the host is the share of the time that has passed, not of the code.
#include <memory>
#include <string>
#include <vector>

#include "base/context.h"
#include "job/contract/session.h"
#include "job/progress/time_shares.h"

namespace formwright {

/// A host like `host` for one run, which begins now; `alike` names the runs to compare it with (alike_runs.h). Its
/// `on_progress` hands on what a ProgressClock makes of the reported fractions, also while the job reports nothing but
/// asks whether it is to end. `session` keeps how the operation spent its time from run to run.
class TimedHost {
 public:
  TimedHost(const Host& host, const std::string& alike, Session& session);
  ~TimedHost();
  TimedHost(const TimedHost&) = delete;
  TimedHost& operator=(const TimedHost&) = delete;

  const Host& host() const { return timed_; }
  /// The run succeeded: the next one learns from it, if it was long enough.
  void succeeded();

 private:
  struct Run;
  std::shared_ptr<Run> run_;
  Host timed_;
};

/// Of the session's last runs that are alike, the newest at the end; null before the first.
std::shared_ptr<const std::vector<TimeShares>> learned_time_shares(const std::string& alike, Session& session);

}  // namespace formwright
