// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Results of a job that another computer makes for it (ResultTask).
#include <string>

#include "base/bytes.h"
#include "base/context.h"

namespace formwright {

/// The bytes that the job would have made itself and kept under the task's key, to the bit. Runs on one thread. Throws
/// Error{invalid_input, "tasks"} where recipe or input are damaged or of another version of the program,
/// Error{cancelled}, and what made the attempt fail without being an answer.
Bytes make_result(const std::string& key, const std::string& recipe, ByteView input, const Host& host);

}  // namespace formwright
