// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One job's folder: job.json and result.json, each with its checksum.
#include <filesystem>
#include <optional>

#include "jobs/job_store.h"

namespace formwright {

/// Throws StorageError when the disk does not keep it.
void write_job(const std::filesystem::path& folder, const StoredJob& job);

/// The job of a folder in which there is a job.json. What cannot be believed becomes its error: an altered job.json
/// makes a failed job, a result that is altered or gone makes one that runs again.
StoredJob read_job(const std::filesystem::path& folder);

/// Whether the folder holds a job that was accepted.
bool holds_job(const std::filesystem::path& folder);

/// Removes the job for good, job.json first: what is left after a crash is no job.
bool remove_job(const std::filesystem::path& folder);

}  // namespace formwright
