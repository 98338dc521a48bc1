// SPDX-License-Identifier: GPL-3.0-or-later
// What a page, or whatever has the token, may say at a machine's socket.
#include "base/error.h"
#include "fuzz/fuzz_check.h"
#include "machines/machine_page.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  try {
    const MachineRequest request = read_machine_request({reinterpret_cast<const char*>(data), size});
    if (request.kind == MachineRequest::Kind::load)
      fuzz::check(request.sha256.size() == 64 && !request.name.empty() && request.name.size() <= 200);
    else fuzz::check(request.kind == MachineRequest::Kind::close || request.content.is_object());
  } catch (const Error& error) {
    fuzz::check_invalid_input(error);
  }
  return 0;
}
