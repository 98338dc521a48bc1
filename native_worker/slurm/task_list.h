// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The simulations of one job array as a file in the shared folder: each task of the array makes those of one share.
#include <filesystem>
#include <string>
#include <vector>

#include "base/context.h"

namespace formwright {

struct ListedTask {
  std::string key, recipe, input_key;  // of ResultTask; input_key: under which its input is kept
};

/// Splits tasks into shares of about `share_seconds` each by their work, in their order; one task a share where
/// `seconds_per_work` is not known (0). At most `max_shares`, then larger ones.
std::vector<std::vector<ListedTask>> shares_of(const std::vector<ListedTask>& tasks, const std::vector<double>& work,
                                               double seconds_per_work, double share_seconds, std::size_t max_shares);

/// Throws StorageError where the file cannot be written.
void write_task_list(const std::filesystem::path& file, const std::vector<std::vector<ListedTask>>& shares);

/// The tasks of share `index`. Throws Error{invalid_input, "tasks"}: no such file, altered or cut short, of another
/// version, or an index that it does not have.
std::vector<ListedTask> read_share(const std::filesystem::path& file, std::size_t index);

}  // namespace formwright
