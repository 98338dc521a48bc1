// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// PrusaSlicer as a program of its own, when it is installed: a model in, G-code out. Blocks: never on the server's
// thread.
#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

#include "base/bytes.h"

namespace formwright {

/// Its path, or "" when it is not installed. Looked for once, in the places programs are installed to.
std::string slicer_program();

/// The names of the profiles a person put into DATA/slicer_profiles (NAME.ini, exported from PrusaSlicer).
std::vector<std::string> slicer_profiles(const std::filesystem::path& data);

/// Slices an STL or 3MF (as its first bytes say) in a temporary folder of ours under `data`, with a fixed list of
/// arguments, no shell, an environment of four names, at most `seconds_limit` s and 1 GB of output. Scripts that a
/// profile or a 3MF brings (post_process) are never run. Throws Error{invalid_input} with where "profile" or "sha256",
/// Error{could_not_solve, "sha256"} with the slicer's own words, Error{cancelled}; its processes are ended in every
/// case.
Bytes slice_model(ByteView model, const std::string& profile, const std::filesystem::path& data, double seconds_limit,
                  const std::atomic<bool>& cancelled);

}  // namespace formwright
