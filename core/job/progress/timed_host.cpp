// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/progress/timed_host.h"

#include <thread>
#include <utility>

#include "job/progress/progress_clock.h"

namespace formwright {

namespace {

/// Shorter runs are previews with most of the work kept from before.
constexpr double min_learned_s = 1;
constexpr double quiet_s = 0.25;

std::string session_key(const std::string& operation) { return "time_shares/" + operation; }

}  // namespace

struct TimedHost::Run {
  Run(Host outer, std::string operation_key, Session& kept, const TimeShares& shares)
      : host(std::move(outer)), key(std::move(operation_key)), session(kept), clock(shares) {}

  void report(const Progress& progress) {
    const double now_s = watch.seconds();
    clock.report(progress.fraction, now_s);
    stage = progress.stage;
    say(now_s);
  }

  void say(double now_s) {
    const ProgressClock::Estimate estimate = clock.at(now_s);
    said_s = now_s;
    host.on_progress({estimate.passed, stage, estimate.seconds_left});
  }

  /// Of the job's own thread: it is in the middle of something long.
  void tick() {
    const double now_s = watch.seconds();
    if (!stage.empty() && now_s - said_s > quiet_s) say(now_s);
  }

  Host host;
  std::string key;
  Session& session;
  ProgressClock clock;
  Stopwatch watch;
  double said_s = 0;
  std::string stage;
  std::thread::id thread = std::this_thread::get_id();
};

TimedHost::TimedHost(const Host& host, const std::string& operation, Session& session) : timed_(host) {
  if (!host.on_progress) return;
  const auto learned = learned_time_shares(operation, session);
  run_ =
      std::make_shared<Run>(host, session_key(operation), session, learned ? *learned : usual_time_shares(operation));
  timed_.on_progress = [run = run_](const Progress& progress) { run->report(progress); };
  timed_.cancel_requested = [run = run_] {
    if (std::this_thread::get_id() == run->thread) run->tick();
    return run->host.cancel_requested && run->host.cancel_requested();
  };
}

TimedHost::~TimedHost() = default;

void TimedHost::succeeded() {
  if (!run_) return;
  const double seconds = run_->watch.seconds();
  if (seconds < min_learned_s) return;
  const TimeShares measured = run_->clock.measured(seconds);
  const auto before = run_->session.find<TimeShares>(run_->key);
  constexpr double memory_mb = 0.001;
  run_->session.keep(run_->key, std::make_shared<TimeShares>(before ? mean_of(*before, measured) : measured),
                     memory_mb);
}

std::shared_ptr<const TimeShares> learned_time_shares(const std::string& operation, Session& session) {
  return session.find<TimeShares>(session_key(operation));
}

}  // namespace formwright
