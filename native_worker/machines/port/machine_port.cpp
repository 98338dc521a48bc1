// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/port/machine_port.h"

#include <cups/http.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/write.hpp>

#include "base/error.h"

namespace formwright {
namespace {

using boost::system::error_code;
constexpr std::size_t read_bytes = 4096;
constexpr int flush_patience_ms = 300;

/// A serial port or a TCP connection.
class StreamPort final : public MachinePort, public std::enable_shared_from_this<StreamPort> {
 public:
  StreamPort(boost::asio::io_context& io, int descriptor, std::string name)
      : stream_(io, descriptor), name_(std::move(name)) {}

  void start(Received received, Closed closed) override {
    received_ = std::move(received);
    closed_ = std::move(closed);
    read();
  }
  void write(std::vector<Bytes> packets, bool first) override {
    if (!open_) return;
    if (first) {
      // What is being written stays: its buffer belongs to the system until it is done.
      while (outgoing_.size() > (writing_ ? 1u : 0u)) outgoing_.pop_back();
    }
    for (Bytes& packet : packets)
      if (!packet.empty()) outgoing_.push_back(std::move(packet));
    if (!writing_) write_next();
  }
  void flush() override {
    if (!open_) return;
    // Not over the io_context, which may not run again. Its write may have got through in part: reals repeat nothing,
    // so that part is skipped.
    stream_.native_non_blocking(true);
    for (std::size_t i = writing_ ? 1 : 0; i < outgoing_.size(); ++i) {
      std::size_t done = 0;
      while (done < outgoing_[i].size()) {
        pollfd wait{stream_.native_handle(), POLLOUT, 0};
        if (::poll(&wait, 1, flush_patience_ms) <= 0) return;
        const ssize_t count = ::write(stream_.native_handle(), outgoing_[i].data() + done, outgoing_[i].size() - done);
        if (count <= 0) return;
        done += static_cast<std::size_t>(count);
      }
    }
    outgoing_.resize(writing_ ? 1 : 0);
  }
  void close() override {
    open_ = false;
    closed_ = nullptr;
    received_ = nullptr;
    error_code ignored;
    stream_.close(ignored);
  }
  std::size_t waiting_bytes() const override {
    std::size_t total = 0;
    for (const Bytes& packet : outgoing_) total += packet.size();
    return total;
  }

 private:
  void read() {
    stream_.async_read_some(boost::asio::buffer(incoming_),
                            [this, self = shared_from_this()](const error_code& error, std::size_t count) {
                              if (!open_) return;
                              if (error) return end();
                              const auto received = received_;  // it may close the port, and with it itself
                              received(ByteView(incoming_.data(), count));
                              if (open_) read();
                            });
  }
  void write_next() {
    if (outgoing_.empty()) return;
    writing_ = true;
    boost::asio::async_write(stream_, boost::asio::buffer(outgoing_.front()),
                             [this, self = shared_from_this()](const error_code& error, std::size_t) {
                               writing_ = false;
                               if (!open_) return;
                               if (error) return end();
                               outgoing_.pop_front();
                               write_next();
                             });
  }
  void end() {
    const auto closed = closed_;
    close();
    if (closed) closed(name_ + " is no longer connected: check that its cable is plugged in and it is switched on.");
  }

  boost::asio::posix::stream_descriptor stream_;
  const std::string name_;
  Received received_;
  Closed closed_;
  std::array<std::byte, read_bytes> incoming_{};
  std::deque<Bytes> outgoing_;
  bool open_ = true, writing_ = false;
};

/// Ruida: requests go to one port, answers come to another of ours.
class UdpPort final : public MachinePort, public std::enable_shared_from_this<UdpPort> {
 public:
  static constexpr unsigned short machine_port = 50200, answer_port = 40200;
  using udp = boost::asio::ip::udp;

  UdpPort(boost::asio::io_context& io, const std::string& host, int port, const std::string& name) : socket_(io) {
    error_code error;
    udp::resolver resolver(io);
    const auto found = resolver.resolve(udp::v4(), host, std::to_string(port > 0 ? port : machine_port), error);
    if (error || found.empty())
      throw Error(ErrorCode::could_not_solve, "machine",
                  "The name " + host + " of " + name +
                      " is not known on this network: register the machine with its address in numbers.");
    machine_ = found.begin()->endpoint();
    socket_.open(udp::v4(), error);
    // Answers of a machine on this computer need not be heard from elsewhere.
    const auto from = machine_.address().is_loopback()
                          ? boost::asio::ip::address(boost::asio::ip::address_v4::loopback())
                          : boost::asio::ip::address(boost::asio::ip::address_v4::any());
    if (!error) socket_.bind({from, answer_port}, error);
    if (error)
      throw Error(ErrorCode::could_not_solve, "machine",
                  "Port 40200, to which " + name + " answers, is used by another program (" + error.message() +
                      "): close that one first.");
    socket_.non_blocking(true, error);
  }
  void start(Received received, Closed) override {
    received_ = std::move(received);
    read();
  }
  void write(std::vector<Bytes> packets, bool) override {
    // A datagram is taken whole or not at all, and the driver sends a lost one again: nothing waits here.
    for (const Bytes& packet : packets) {
      error_code ignored;
      if (!packet.empty() && open_) socket_.send_to(boost::asio::buffer(packet), machine_, 0, ignored);
    }
  }
  void flush() override {}
  void close() override {
    open_ = false;
    received_ = nullptr;
    error_code ignored;
    socket_.close(ignored);
  }
  std::size_t waiting_bytes() const override { return 0; }

 private:
  void read() {
    socket_.async_receive_from(boost::asio::buffer(incoming_), from_,
                               [this, self = shared_from_this()](const error_code& error, std::size_t count) {
                                 if (!open_ || error == boost::asio::error::operation_aborted) return;
                                 // "Connection refused" is an answer of the network to what was sent: a machine that is
                                 // off. The driver waits and says so.
                                 if (!error && from_.address() == machine_.address()) {
                                   const auto received = received_;
                                   received(ByteView(incoming_.data(), count));
                                 }
                                 if (open_) read();
                               });
  }

  udp::socket socket_;
  udp::endpoint machine_, from_;
  Received received_;
  std::array<std::byte, read_bytes> incoming_{};
  bool open_ = true;
};

}  // namespace

std::shared_ptr<MachinePort> open_machine_port(boost::asio::io_context& io, const Machine& machine, int baud) {
  using namespace machine_port_detail;
  if (machine.url.starts_with("serial:"))
    return std::make_shared<StreamPort>(io, open_serial(machine.url.substr(7), baud, machine.name), machine.name);
  char scheme[32] = "", user[256] = "", host[256] = "", resource[1024] = "";
  int port = 0;
  if (httpSeparateURI(HTTP_URI_CODING_ALL, machine.url.c_str(), scheme, sizeof scheme, user, sizeof user, host,
                      sizeof host, &port, resource, sizeof resource) < HTTP_URI_STATUS_OK)
    throw Error(ErrorCode::could_not_solve, "machine",
                "The address of " + machine.name + " cannot be read: register it anew.");
  if (machine.kind == MachineKind::ruida) return std::make_shared<UdpPort>(io, host, port, machine.name);
  if (std::string(scheme) == "tcp")
    return std::make_shared<StreamPort>(io, connect_tcp(host, port, machine.name), machine.name);
  throw Error(ErrorCode::invalid_input, "machine",
              machine.name + " is a " + std::string(to_string(machine.kind)) + ": it is not driven line by line.");
}

}  // namespace formwright
