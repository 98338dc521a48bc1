// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Progress and cancel, handed through every long computation.
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

/// Where simulations of a job run, and how many.
struct WorkPlace {
  std::string name;  // of a computer, or of a queue; empty for this computer
  int running = 0, done = 0, waiting = 0;
};

struct Progress {
  double fraction = 0;                 // of the whole job, 0 to 1, never falling
  std::string stage;                   // what is being done, for a person: "Factorising"
  std::optional<double> seconds_left;  // an estimate, once there is ground for one
  std::vector<WorkPlace> places = {};  // from hosts that keep results; empty elsewhere
};

/// A result that another computer can make: everything it depends on.
struct ResultTask {
  std::string key;                          // under which the result is kept
  std::string recipe;                       // for make_result() (job/make_result.h)
  std::shared_ptr<const Bytes> input = {};  // large data that many recipes share
  double work = 1;                          // expected time to make it, relative to others of this job
};

/// What the host (command line, worker, WASM) lends to a computation.
struct Host {
  std::function<void(const Progress&)> on_progress = {};  // may be empty; called from the job's thread
  std::function<bool()> cancel_requested = {};            // may be empty; cheap, callable from any thread
  std::function<double()> peak_memory_mb = {};            // may be empty
  /// Results that outlive the job, by the hash of what they were made from. May be empty; called from any thread, must
  /// not throw.
  std::function<std::optional<Bytes>(const std::string& key)> find_result = {};
  std::function<void(const std::string& key, const Bytes& result)> keep_result = {};
  /// Several processes may share kept results: true when this one is to make what is missing, false while another is at
  /// it. Whoever claims keeps or releases.
  std::function<bool(const std::string& key)> claim_result = {};
  std::function<void(const std::string& key)> release_result = {};
  /// Has other computers make results, tells of the share made so far, and returns when each is kept or is left to the
  /// caller. May be empty. Called from the job's thread. Throws Error{cancelled}, and Error{invalid_input} where
  /// nothing can be made there.
  std::function<void(const std::vector<ResultTask>& tasks, const std::function<void(double fraction)>& made_share)>
      make_results = {};
};

/// Carries the host through nested stages. `span` narrows the fraction that `progress` speaks of, so
/// that a solver reports 0 to 1 of its own work wherever it is called from.
/// `check_cancelled` may be called from any thread; the rest belongs to the job's thread.
class Context {
 public:
  Context();  // silent, never cancelled
  explicit Context(Host host);

  /// Throws Error{cancelled} once the host asks for it. Call at least every 100 ms of work.
  void check_cancelled() const;
  bool cancelled() const;

  /// Reports `fraction` of the current span; throttled to 20 messages a second, but a new stage
  /// always goes out. Also checks for cancel.
  void progress(double fraction, const std::string& stage);
  void progress(double fraction);

  /// While the returned object lives, fractions run from `from` to `to` of the enclosing span.
  class Span {
   public:
    Span(const Span&) = delete;
    Span& operator=(const Span&) = delete;
    ~Span();

   private:
    friend class Context;
    Span(Context& context, double from, double to);
    Context& context_;
    double outer_from_, outer_to_;
  };
  [[nodiscard]] Span span(double from, double to, const std::string& stage);

  double peak_memory_mb() const;  // 0 when the host does not tell

  /// What an earlier run kept under `key`, if anything. From any thread.
  std::optional<Bytes> find_result(const std::string& key) const;
  /// Keeps an expensive intermediate result at once, so that a run that is killed goes on from there. From any thread.
  void keep_result(const std::string& key, const Bytes& result) const;
  /// See Host. True where nothing is shared. From any thread.
  bool claim_result(const std::string& key) const;
  void release_result(const std::string& key) const;

  /// Whether other computers make results for this job: see Host.
  bool has_helpers() const { return static_cast<bool>(host_.make_results); }
  void make_results(const std::vector<ResultTask>& tasks, const std::string& stage);

 private:
  using Clock = std::chrono::steady_clock;
  Host host_;
  double from_ = 0, to_ = 1, reported_ = 0;
  std::string stage_;
  Clock::time_point start_, last_message_;
};

/// Wall-clock seconds since construction or the last `lap`.
class Stopwatch {
 public:
  Stopwatch() : start_(std::chrono::steady_clock::now()) {}
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  double lap() {
    const double elapsed = seconds();
    start_ = std::chrono::steady_clock::now();
    return elapsed;
  }

 private:
  std::chrono::steady_clock::time_point start_;
};

}  // namespace formwright
