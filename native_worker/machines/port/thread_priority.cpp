// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/port/thread_priority.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace formwright {
namespace {
constexpr int ahead = -10, behind = 10;

// Niceness belongs to a thread on Linux, where POSIX has it for the process (setpriority(2), "C library/kernel
// differences").
void set_niceness(int niceness) { ::setpriority(PRIO_PROCESS, static_cast<id_t>(::syscall(SYS_gettid)), niceness); }
}  // namespace

void run_this_thread_first() {
  // The lowest real-time priority is enough: the machines' thread works for microseconds and sleeps, and the kernel
  // leaves 5 % to others whatever happens (sched(7)). Threads that it starts are ordinary ones.
  const sched_param lowest{::sched_get_priority_min(SCHED_RR)};
  if (::sched_setscheduler(0, SCHED_RR | SCHED_RESET_ON_FORK, &lowest) != 0) set_niceness(ahead);
}

void run_this_thread_last() { set_niceness(behind); }

}  // namespace formwright
