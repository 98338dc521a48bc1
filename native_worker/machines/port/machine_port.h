// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where a machine is reached: a serial port, a TCP connection that stands for one, or UDP (Ruida).
#include <boost/asio/io_context.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "machines/port/machine_registry.h"

namespace formwright {

/// All calls and callbacks on the thread that runs the io_context.
class MachinePort {
 public:
  virtual ~MachinePort() = default;
  using Received = std::function<void(ByteView)>;
  using Closed =
      std::function<void(const std::string& sentence)>;  // the cable was pulled, the other side is gone; at most once

  virtual void start(Received received, Closed closed) = 0;
  /// In this order. Serial lines join the packets, UDP sends each as one datagram. `first`: what still waits is thrown
  /// away.
  virtual void write(std::vector<Bytes> packets, bool first) = 0;
  /// Writes what waits for up to 300 ms, for a program that is about to end.
  virtual void flush() = 0;
  virtual void close() = 0;
  virtual std::size_t waiting_bytes() const = 0;
};

/// Opens the machine's port for this program alone, 8N1 without flow control; nothing is sent. Blocks for up to 5 s
/// (TCP). Throws Error{could_not_solve, "machine"} with what to do: no such port, no permission, used by another
/// program, nobody there.
std::shared_ptr<MachinePort> open_machine_port(boost::asio::io_context& io, const Machine& machine, int baud);

namespace machine_port_detail {
/// A serial port's descriptor, set up. Leaves DTR as it is where the system lets us, since a change resets many boards.
int open_serial(const std::string& path, int baud, const std::string& name);
int connect_tcp(const std::string& host, int port, const std::string& name);
/// Any speed, also those without a name in POSIX. False when the port cannot have it.
bool set_speed(int descriptor, int baud);
}  // namespace machine_port_detail

}  // namespace formwright
