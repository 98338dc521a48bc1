// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
namespace formwright {
/// Largest resident size of this process so far.
double peak_memory_mb();
}  // namespace formwright
