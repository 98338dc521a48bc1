// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// DATA holds keys of printers, models and jobs: for its owner alone.
#include <filesystem>

namespace formwright {

/// New files and folders of this process are for its owner alone.
void make_new_files_private();

/// Makes an existing DATA folder 0700, and what is in it 0700 and 0600. A folder of others (/tmp, a home folder) keeps
/// its own mode; what we put there does not.
void make_private(const std::filesystem::path& data);

}  // namespace formwright
