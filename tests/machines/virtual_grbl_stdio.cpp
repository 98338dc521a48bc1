// SPDX-License-Identifier: GPL-3.0-or-later
// The virtual GRBL on standard input and output, in real time, for socat to put behind a serial port:
//   socat PTY,link=/tmp/laser,raw,echo=0 EXEC:virtual_grbl_stdio
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <string>

#include "machines/virtual_grbl/virtual_grbl.h"

int main() {
  using namespace formwright;
  const auto start = std::chrono::steady_clock::now();
  const auto now_s = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  VirtualGrbl machine;
  machine.open(now_s());
  for (char buffer[4096];;) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (::poll(&input, 1, 5) > 0) {
      const ssize_t count = ::read(STDIN_FILENO, buffer, sizeof buffer);
      if (count <= 0) return 0;
      machine.receive({buffer, static_cast<std::size_t>(count)}, now_s());
    }
    machine.advance(now_s());
    const std::string said = machine.take_output();
    for (std::size_t at = 0; at < said.size();) {
      const ssize_t count = ::write(STDOUT_FILENO, said.data() + at, said.size() - at);
      if (count <= 0) return 0;
      at += static_cast<std::size_t>(count);
    }
  }
}
