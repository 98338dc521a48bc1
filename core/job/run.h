// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The one door: browser, command line and worker all come in here.
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "job/contract/operation.h"

namespace formwright {

struct JobError {
  ErrorCode code = ErrorCode::internal;
  std::string where, message;
};

struct JobResult {
  std::optional<JobError> error;  // set: nothing else is
  Json report;
  std::vector<OutputBlob> outputs;
};

/// Bytes of a blob by its SHA-256, or null when the host does not have it.
using BlobSource = std::function<std::shared_ptr<const Bytes>(const std::string& sha256)>;

/// Checks a job message without running it: operation, parameters, inputs named, outputs known.
std::optional<JobError> check_job(const Json& message);

/// Runs a job message (docs/job_contract.md) to its one result or one error. Never throws.
JobResult run_job(const Json& message, const BlobSource& blobs, Session& session, const Host& host);

/// The result message: {"report", "outputs"} or {"error"}.
Json result_json(const JobResult& result);
Json error_json(const JobError& error);

}  // namespace formwright
