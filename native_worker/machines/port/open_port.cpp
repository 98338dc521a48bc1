// SPDX-License-Identifier: GPL-3.0-or-later
#include <cups/http.h>
#include <fcntl.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "base/error.h"
#include "machines/port/machine_port.h"

namespace formwright::machine_port_detail {
namespace {

constexpr int port_connect_patience_ms = 5000;

[[noreturn]] void fail(int descriptor, const std::string& sentence) {
  if (descriptor >= 0) ::close(descriptor);
  throw Error(ErrorCode::could_not_solve, "machine", sentence);
}

}  // namespace

int open_serial(const std::string& path, int baud, const std::string& name) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0 && (errno == EACCES || errno == EPERM))
    fail(descriptor,
         name + " may not be opened by you: join the group of " + path + " (often dialout), and log in again.");
  if (descriptor < 0 && errno == EBUSY) fail(descriptor, name + " is used by another program: close that one first.");
  if (descriptor < 0)
    fail(descriptor, name + " is not there (" + std::string(std::strerror(errno)) + "): plug it in and switch it on.");
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISCHR(status.st_mode) || ::isatty(descriptor) != 1)
    fail(descriptor, path + " is no serial port: register the machine with the right one.");
  // Both: others of this program's kind look at the lock, programs of other makers at TIOCEXCL.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0)
    fail(descriptor, name + " is used by another program: close that one first.");
  ::ioctl(descriptor, TIOCEXCL);
  termios settings{};
  if (::tcgetattr(descriptor, &settings) != 0)
    fail(descriptor, name + " does not answer as a serial port does: plug it in again.");
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD | CS8;
  // Without HUPCL, DTR stays up when the port is closed: the next opening does not reset the board.
  settings.c_cflag &= ~static_cast<tcflag_t>(PARENB | CSTOPB | CRTSCTS | HUPCL);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  ::cfsetispeed(&settings, B115200);
  ::cfsetospeed(&settings, B115200);
  if (::tcsetattr(descriptor, TCSANOW, &settings) != 0 || (baud != 115200 && !set_speed(descriptor, baud)))
    fail(descriptor, name + " cannot do " + std::to_string(baud) + " baud: choose another speed.");
  ::tcflush(descriptor, TCIOFLUSH);
  return descriptor;
}

int connect_tcp(const std::string& host, int port, const std::string& name) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* list = nullptr;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list) != 0)
    fail(-1, "The name " + host + " of " + name +
                 " is not known on this network: register the machine with its address in numbers.");
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owned(list, ::freeaddrinfo);
  std::string reason = "nobody there";
  for (const addrinfo* a = list; a; a = a->ai_next) {
    const int descriptor = ::socket(a->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (descriptor < 0) continue;
    if (::connect(descriptor, a->ai_addr, a->ai_addrlen) != 0 && errno == EINPROGRESS) {
      pollfd wait{descriptor, POLLOUT, 0};
      const int ready = ::poll(&wait, 1, port_connect_patience_ms);
      errno = ready > 0 ? 0 : ETIMEDOUT;
    }
    int error = errno;
    socklen_t length = sizeof error;
    if (error == 0) ::getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &length);
    if (error == 0) {
      const int on = 1;
      ::setsockopt(descriptor, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      ::setsockopt(descriptor, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
      return descriptor;
    }
    reason = std::strerror(error);
    ::close(descriptor);
  }
  fail(-1, name + " does not answer at " + host + ":" + std::to_string(port) + " (" + reason +
               "): see whether it is switched on and its address is right.");
}

}  // namespace formwright::machine_port_detail
