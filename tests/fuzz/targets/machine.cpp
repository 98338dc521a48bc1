// SPDX-License-Identifier: GPL-3.0-or-later
// What a machine, or whoever sits on its cable, may say to a driver; and what a job file may hold.
#include "base/error.h"
#include "fuzz/fuzz_check.h"
#include "machines/controllers.h"
#include "machines/ruida/ruida_bounds.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace formwright;
  if (size < 2) return 0;
  static constexpr const char* controllers[] = {"grbl", "marlin", "k40", "ruida"};
  const auto driver = make_machine_driver({{"controller", controllers[data[0] % 4]}});
  const ByteView bytes(reinterpret_cast<const std::byte*>(data) + 2, size - 2);
  const std::size_t job_bytes = bytes.size() * data[1] / 512;
  const auto attempt = [](const auto& act) {
    try {
      act();
    } catch (const Error& error) {
      fuzz::check_invalid_input(error);
    }
  };
  double now_s = 0;
  driver->opened(now_s);
  attempt([&] { driver->load("job", bytes.first(job_bytes)); });
  attempt([&] { fuzz::check(!ruida_bounds(bytes.first(job_bytes)).empty); });
  const ByteView talk = bytes.subspan(job_bytes);
  static constexpr const char* commands[] = {"home", "start", "pause", "resume", "jog", "frame", "unlock", "stop"};
  for (std::size_t at = 0; at < talk.size(); at += 16) {
    driver->received(talk.subspan(at, std::min<std::size_t>(16, talk.size() - at)), now_s += 0.05);
    driver->tick(now_s += 0.05);
    const Json command = {{"do", commands[std::to_integer<std::size_t>(talk[at]) % 8]},
                          {"confirmed", true},
                          {"x_mm", 1},
                          {"speed_mm_per_s", 10},
                          {"bounds_mm", {0, 0, 1, 1}}};
    if (at % 64 == 0) attempt([&] { driver->command(command, now_s); });
    driver->take_output();
    driver->take_events().dump();
    driver->state(now_s).dump();
  }
  driver->closed(now_s);
  fuzz::check(driver->take_output().empty());
  return 0;
}
