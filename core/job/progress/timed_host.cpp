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
/// Runs of a session that are remembered.
constexpr std::size_t max_learned = 4;

std::string session_key(const std::string& alike) { return "time_shares/" + alike; }

}  // namespace

struct TimedHost::Run {
  Run(Host outer, std::string kept_as, Session& kept, std::vector<TimeShares> runs)
      : host(std::move(outer)), key(std::move(kept_as)), session(kept), clock(std::move(runs)) {}

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

TimedHost::TimedHost(const Host& host, const std::string& alike, Session& session) : timed_(host) {
  if (!host.on_progress) return;
  std::vector<TimeShares> runs = usual_time_shares(alike);
  if (const auto learned = learned_time_shares(alike, session))
    runs.insert(runs.end(), learned->begin(), learned->end());
  run_ = std::make_shared<Run>(host, session_key(alike), session, std::move(runs));
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
  std::vector<TimeShares> runs;
  if (const auto before = run_->session.find<std::vector<TimeShares>>(run_->key)) runs = *before;
  if (runs.size() == max_learned) runs.erase(runs.begin());
  runs.push_back(run_->clock.measured(seconds));
  constexpr double memory_mb = 0.005;
  run_->session.keep(run_->key, std::make_shared<std::vector<TimeShares>>(std::move(runs)), memory_mb);
}

std::shared_ptr<const std::vector<TimeShares>> learned_time_shares(const std::string& alike, Session& session) {
  return session.find<std::vector<TimeShares>>(session_key(alike));
}

}  // namespace formwright
