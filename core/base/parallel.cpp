// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>

#include "base/library_threads.h"

#ifdef __linux__
#include <sched.h>
#endif

namespace formwright {

#if defined(__wasm__) && !defined(__wasm_atomics__)
#define FORMWRIGHT_ONE_THREAD 1
#endif

namespace {

thread_local int thread_limit = std::numeric_limits<int>::max();

void run_alone(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  for (std::size_t begin = 0; begin < count; begin += std::min(grain, count - begin))
    body(begin, begin + std::min(grain, count - begin));
}

}  // namespace

ThreadLimit::ThreadLimit(int threads) : before_(thread_limit) { thread_limit = std::max(threads, 1); }
ThreadLimit::~ThreadLimit() { thread_limit = before_; }

#ifdef FORMWRIGHT_ONE_THREAD

int available_processors() { return 1; }
int thread_count() { return 1; }
int allowed_threads() { return 1; }

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  run_alone(count, std::max<std::size_t>(grain, 1), body);
}

#else

namespace {

using Clock = std::chrono::steady_clock;

thread_local bool inside_loop = false;

/// One loop in progress.
class Loop {
 public:
  Loop(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body)
      : count_(count), grain_(grain), chunks_((count - 1) / grain + 1), body_(body) {}

  void work() {
    inside_loop = true;
    for (std::size_t chunk = next_++; chunk < chunks_; chunk = next_++) {
      try {
        body_(chunk * grain_, std::min(count_, (chunk + 1) * grain_));
      } catch (...) {
        const std::scoped_lock lock(failure_mutex_);
        if (!failure_) failure_ = std::current_exception();
        next_ = chunks_;
      }
    }
    inside_loop = false;
  }
  std::exception_ptr failure() const { return failure_; }

 private:
  std::size_t count_, grain_, chunks_;
  const std::function<void(std::size_t, std::size_t)>& body_;
  std::atomic<std::size_t> next_{0};
  std::exception_ptr failure_;
  std::mutex failure_mutex_;
};

/// Waits until `value` is no longer `old`: awake for as long as a pause between two loops of one algorithm takes, then
/// asleep.
std::uint32_t changed(const std::atomic<std::uint32_t>& value, std::uint32_t old) {
  const auto enough = Clock::now() + std::chrono::microseconds(100);
  do {
    for (int i = 0; i < 32; ++i) {
      if (const std::uint32_t now = value.load(std::memory_order_acquire); now != old) return now;
#if defined(__x86_64__) || defined(__i386__)
      __builtin_ia32_pause();
#endif
    }
  } while (Clock::now() < enough);
  value.wait(old, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

/// The helping threads. They are never joined: asleep, they end with the process, which so cannot hang on them.
class Pool {
 public:
  static Pool& instance() {
    static Pool* const pool = new Pool(thread_count() - 1);
    return *pool;
  }

  /// Runs the loop with up to `helpers` helpers; alone, and returns the same, where another loop has them.
  void run(Loop& loop, int helpers) {
    const std::unique_lock lock(in_use_, std::try_to_lock);
    const auto start = Clock::now();
    if (!lock.owns_lock() || start < alone_until_) return loop.work();
    loop_ = &loop;
    seats_.store(helpers, std::memory_order_relaxed);
    gate_.store((gate_.load(std::memory_order_relaxed) & ~low_bits) + one_loop + open, std::memory_order_release);
    gate_.notify_all();
    loop.work();
    const auto done = Clock::now();
    // Only helpers that came in are waited for: one that is still asleep is not needed any more.
    std::uint32_t gate = gate_.fetch_and(~open, std::memory_order_acq_rel) & ~open;
    while ((gate & (low_bits & ~open)) != 0) gate = changed(gate_, gate);
    // A helper that kept this thread waiting for longer than all of a short loop took has been put aside for another
    // program: short loops go better without it for a while, the longer the more often it happens.
    if (done - start > long_loop) return;
    if (const auto waited = Clock::now() - done; waited > std::chrono::microseconds(300) && waited > done - start) {
      alone_until_ = done + waited + pause_;
      pause_ = std::min<Clock::duration>(2 * pause_, std::chrono::seconds(1));
    } else {
      pause_ = std::max<Clock::duration>(pause_ - pause_ / 256, min_pause);
    }
  }

 private:
  static constexpr std::chrono::milliseconds min_pause{5}, long_loop{5};
  // The gate: whether a loop is open, how many helpers are inside, and the loop's number.
  static constexpr std::uint32_t open = 1, one_helper = 2, one_loop = 256, low_bits = one_loop - 1;

  explicit Pool(int helpers) {
    try {
      for (int i = 0; i < helpers; ++i) std::thread([this] { help(); }).detach();
    } catch (const std::system_error&) {  // no more threads to be had: those that came will do
    }
  }

  [[noreturn]] void help() {
    std::uint32_t gate = gate_.load(std::memory_order_acquire), helped = 0;
    for (;;) {
      const bool wanted = (gate & open) != 0 && (gate & ~low_bits) != helped;
      if (!wanted) {
        gate = changed(gate_, gate);
        continue;
      }
      if (!gate_.compare_exchange_weak(gate, gate + one_helper, std::memory_order_acq_rel, std::memory_order_acquire))
        continue;
      helped = gate & ~low_bits;
      if (seats_.fetch_sub(1, std::memory_order_relaxed) > 0) loop_->work();
      gate = gate_.fetch_sub(one_helper, std::memory_order_acq_rel) - one_helper;
      gate_.notify_all();
    }
  }

  std::mutex in_use_;
  Clock::time_point alone_until_{};  // guarded by in_use_, as is the next
  Clock::duration pause_ = min_pause;
  Loop* loop_ = nullptr;  // written while no helper is inside
  std::atomic<int> seats_{0};
  std::atomic<std::uint32_t> gate_{0};
};

}  // namespace

int available_processors() {
#ifdef __linux__
  // Of a machine shared by many tasks each is given some: threads that take turns on one wait for each other.
  cpu_set_t own;
  if (sched_getaffinity(0, sizeof own, &own) == 0) return std::max(CPU_COUNT(&own), 1);
#endif
  return std::max(static_cast<int>(std::thread::hardware_concurrency()), 1);
}

int thread_count() {
  static const int count = std::min(available_processors(), 16);
  return count;
}

int allowed_threads() { return inside_loop ? 1 : std::min(thread_count(), thread_limit); }

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t threads =
      std::min<std::size_t>(static_cast<std::size_t>(allowed_threads()), (count - 1) / grain + 1);
  if (threads <= 1) return run_alone(count, grain, body);
  Loop loop(count, grain, body);
  Pool::instance().run(loop, static_cast<int>(threads) - 1);
  if (loop.failure()) std::rethrow_exception(loop.failure());
}

#endif

}  // namespace formwright
