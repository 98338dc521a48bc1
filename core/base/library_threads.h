// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// For libraries that bring threads of their own.

namespace formwright {

/// Number of threads that a parallel_for begun here would use at most: 1 inside a chunk, fewer under a ThreadLimit.
int allowed_threads();

}  // namespace formwright
