// SPDX-License-Identifier: GPL-3.0-or-later
// What OctoPrint, Moonraker, or whatever listens at their address may answer. The first three bytes: what was asked,
// and the HTTP status.
#include "base/error.h"
#include "fuzz/fuzz_check.h"
#include "system/host.h"
#include "machines/print/upload_answers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  if (size < 3) return 0;
  static constexpr long statuses[] = {200, 201, 400, 401, 404, 409, 413, 415, 422, 500, 302};
  const unsigned what = data[0] % 8;
  const long status = data[1] < 200 ? statuses[data[1] % std::size(statuses)] : data[2] * 4;
  const std::string answer(reinterpret_cast<const char*>(data) + 3, size - 3);
  Machine machine;
  machine.name = "Mould";
  machine.url = "http://mould";
  machine.kind = what % 2 ? MachineKind::octoprint : MachineKind::moonraker;
  try {
    const UploadReply reply = read_reply(machine, status, answer);
    Json read = Json::object();
    switch (what) {
      case 0:
      case 1: read = read_uploaded(machine, data[2] % 2, reply); break;
      case 2:
        if (read_moonraker_state(machine, reply, read)) read_moonraker_printing(reply, read);
        break;
      case 3: read = read_octoprint_state(read_octoprint_version(machine, reply), reply); break;
      case 4: read_moonraker_printing(reply, read); break;
      case 5: read = read_octoprint_state("OctoPrint", reply); break;
      default: read_cancelled(machine, reply);
    }
    fuzz::check(Json::parse(json_text(read)).is_object());
  } catch (const Error& error) {
    fuzz::check(error.code() == ErrorCode::could_not_solve && std::string_view(error.what()).ends_with('.'));
    fuzz::check(Json::parse(json_text({{"message", error.what()}})).is_object());
  }
  return 0;
}
