// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a solver may do to the rest of the computer, enforced by the kernel where it can: Landlock
// (Documentation/userspace-api/landlock.rst) for files and the network, a seccomp filter for system calls.
#include <filesystem>
#include <vector>

namespace formwright {

/// The version of the kernel's Landlock, 0 where there is none or it is switched off.
int landlock_version();

struct FileAccess {
  std::vector<std::filesystem::path> read, write;  // files, or folders with all that is in them; write includes read
};

/// Restricts this thread, and the threads that it starts from now on, to these files and to no TCP (version 4). What
/// was forbidden before stays forbidden. False where the kernel refuses: nothing has changed then.
bool restrict_files(const FileAccess& access);

/// Folders and files that programs read while they run: libraries, the time zone, this process's own /proc.
std::vector<std::filesystem::path> system_files();

/// Does the kernel take filters of system calls? Changes nothing.
bool system_call_filter_available();

/// From now on this thread, and those it starts, can start threads but no program, and have no network, no signals to
/// others and no debugging of others: such calls fail with EPERM. False where the kernel refuses.
bool filter_system_calls();

}  // namespace formwright
