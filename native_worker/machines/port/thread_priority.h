// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
namespace formwright {

/// For the thread that stops machines: ahead of all ordinary work on this computer, where the system allows it.
void run_this_thread_first();

/// For work that may wait.
void run_this_thread_last();

}  // namespace formwright
