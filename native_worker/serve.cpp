// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve.h"

#include "base/error.h"

namespace formwright {
int serve(const std::vector<std::string>&) { throw Error(ErrorCode::internal, "serve", "The worker is not built yet."); }
int run_jobs_for_server() { throw Error(ErrorCode::internal, "run-jobs", "The worker is not built yet."); }
}  // namespace formwright
