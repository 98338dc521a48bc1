// SPDX-License-Identifier: GPL-3.0-or-later
// Apart from the rest: the kernel's own termios2 and the C library's termios cannot be included together.
#include <asm/termbits.h>
#include <sys/ioctl.h>

namespace formwright::machine_port_detail {

bool set_speed(int descriptor, int baud) {
  termios2 settings{};
  if (::ioctl(descriptor, TCGETS2, &settings) != 0) return false;
  settings.c_cflag &= ~static_cast<tcflag_t>(CBAUD | (CBAUD << IBSHIFT));
  settings.c_cflag |= BOTHER | (BOTHER << IBSHIFT);
  settings.c_ispeed = settings.c_ospeed = static_cast<speed_t>(baud);
  return ::ioctl(descriptor, TCSETS2, &settings) == 0;
}

}  // namespace formwright::machine_port_detail
