// SPDX-License-Identifier: GPL-3.0-or-later
// A job as it is posted: operation, parameters, inputs and outputs.
#include "base/data/json_text.h"
#include "fuzz/fuzz_check.h"
#include "job/run.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  const Json message = parse_json_text({reinterpret_cast<const char*>(data), size});
  const std::optional<JobError> error = check_job(message);
  fuzz::check(!error || error->code == ErrorCode::invalid_input);
  return 0;
}
