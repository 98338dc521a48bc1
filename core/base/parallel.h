// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Loops over several threads natively; the same loops on one thread in single-threaded WASM.
#include <cstddef>
#include <functional>

namespace formwright {

/// Processors that the calling thread may run on, at least 1: fewer than there are where a cluster or `taskset` says
/// so.
int available_processors();

/// Number of threads that parallel_for uses, at least 1: the processors available at its first loop.
int thread_count();

/// Calls body(begin, end) on chunks that cover [0, count). Chunks are fixed by `count` and `grain`
/// alone, never by the number of threads, so that reductions per chunk are reproducible.
/// The first exception thrown by a chunk is rethrown after all threads have stopped.
/// The helping threads are started once and wait between loops, so that loops of 20 microseconds gain already. A loop
/// inside a chunk of another, or begun while another thread's loop has the helpers, runs on the calling thread alone.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& body);

/// While it lives, loops begun by the thread that made it use at most `threads` threads.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  int before_;
};

}  // namespace formwright
