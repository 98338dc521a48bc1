// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A page at a machine's socket: what it says, bounded, and what is sent to it, never more than it reads.
#include <boost/asio/awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <string>

#include "base/data/json.h"
#include "system/http_types.h"
#include "system/rate_budget.h"

namespace formwright {

/// One request of a page: exactly one of open, command, load and close (docs/machine_bridge.md).
struct MachineRequest {
  enum class Kind { open, command, load, close } kind = Kind::command;
  Json content;               // of open and command: an object
  std::string name, sha256;   // of load
  std::optional<int> number;  // "n", if the page counts its requests itself
};

/// Throws Error{invalid_input} with a sentence for what is no such request. Never anything else, whatever the bytes.
MachineRequest read_machine_request(const std::string& text);

class MachinePage : public std::enable_shared_from_this<MachinePage> {
 public:
  static constexpr std::size_t max_message_bytes = 64 * 1024;
  static constexpr int max_malformed = 20;

  explicit MachinePage(beast::websocket::stream<beast::tcp_stream>&& stream) : stream_(std::move(stream)) {}
  beast::websocket::stream<beast::tcp_stream>& stream() { return stream_; }

  /// The handshake is done. What is sent before is dropped: Beast would take itself for the client, and mask it.
  void accepted() { accepted_ = true; }
  void send(const Json& message);
  /// A page that reads slowly gets the latest state, not each.
  void send_state(std::shared_ptr<const std::string> text);
  /// At most 100 requests a second, 200 at once.
  bool within_rate() { return rate_.take(); }
  int next_number() { return ++requests_; }
  /// True while it may go on after one more message that was no request.
  bool bears_malformed() { return ++malformed_ < max_malformed; }
  int malformed() const { return malformed_; }
  void hang_up();

 private:
  void push(std::shared_ptr<const std::string> text);
  void write_next();

  beast::websocket::stream<beast::tcp_stream> stream_;
  std::deque<std::shared_ptr<const std::string>> outgoing_;
  std::shared_ptr<const std::string> latest_state_;  // waits until the rest is written
  bool accepted_ = false;
  int requests_ = 0, malformed_ = 0;
  RateBudget rate_{100, 200};
};

/// Answers a request for a socket with an error of HTTP, and hangs up.
boost::asio::awaitable<void> refuse_page(beast::tcp_stream stream, TextResponse refusal);

}  // namespace formwright
