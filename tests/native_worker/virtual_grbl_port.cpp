// SPDX-License-Identifier: GPL-3.0-or-later
// The strict virtual GRBL of core/machines at a pseudo terminal, in real time. Prints the port's name; for every line
// on standard input it answers with what it saw, as JSON. Ends with its standard input, which is the cable being
// pulled.
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <iostream>

#include "base/data/json.h"
#include "machines/virtual_grbl/virtual_grbl.h"

int main(int argc, char** argv) {
  using namespace formwright;
  const int port = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (port < 0 || ::grantpt(port) != 0 || ::unlockpt(port) != 0) return 1;
  // Held open, so that the master does not see a hang-up before and between the programs that use it.
  const int held = ::open(::ptsname(port), O_RDWR | O_NOCTTY);
  termios raw{};
  ::tcgetattr(held, &raw);
  ::cfmakeraw(&raw);
  ::tcsetattr(held, TCSANOW, &raw);
  std::cout << ::ptsname(port) << std::endl;
  VirtualGrblOptions options;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "no-homing") options.homes = false;
    if (std::string_view(argv[i]) == "mill") options.laser_mode = false;
    if (std::string_view(argv[i]) == "grblhal") options.grblhal = true;
  }
  options.homing_s = 0.5;
  VirtualGrbl machine(options);
  const auto start = std::chrono::steady_clock::now();
  const auto now_s = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  for (int i = 1; i < argc; ++i)
    if (std::string_view(argv[i]).starts_with("refuses=")) machine.refuse_line(argv[i] + 8, 33);
  machine.open(0);
  std::string outgoing;
  double hold_monotonic_s = 0;  // when a feed hold came last, of the computer's monotonic clock
  for (;;) {
    pollfd waits[2] = {{port, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
    ::poll(waits, 2, 2);
    char buffer[4096];
    if (const ssize_t count = ::read(port, buffer, sizeof buffer); count > 0) {
      const std::string_view said(buffer, static_cast<std::size_t>(count));
      if (said.find_first_of("!\x82") != std::string_view::npos)
        hold_monotonic_s = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
      machine.receive(said, now_s());
    }
    machine.advance(now_s());
    outgoing += machine.take_output();
    if (!outgoing.empty())
      if (const ssize_t count = ::write(port, outgoing.data(), outgoing.size()); count > 0)
        outgoing.erase(0, static_cast<std::size_t>(count));
    if (waits[1].revents != 0) {
      const ssize_t count = ::read(STDIN_FILENO, buffer, sizeof buffer);
      if (count <= 0) return 0;
      double burnt_mm = 0;
      for (const auto& burn : machine.burns())
        burnt_mm += std::hypot(burn.to_mm[0] - burn.from_mm[0], burn.to_mm[1] - burn.from_mm[1]);
      std::cout << Json{{"state", machine.state()},
                        {"beam", machine.beam()},
                        {"burns", machine.burns().size()},
                        {"burnt_mm", burnt_mm},
                        {"bytes_lost", machine.bytes_lost()},
                        {"lines", machine.lines().size()},
                        {"hold_monotonic_s", hold_monotonic_s},
                        {"position_mm", machine.position_mm()}}
                       .dump()
                << std::endl;
    }
  }
}
