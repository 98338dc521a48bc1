// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_page.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>

#include "system/host.h"

namespace formwright {
namespace {
constexpr std::size_t max_waiting = 400;
}  // namespace

void MachinePage::send(const Json& message) { push(std::make_shared<const std::string>(json_text(message))); }

void MachinePage::send_state(std::shared_ptr<const std::string> text) {
  if (outgoing_.size() < 4) push(std::move(text));
  else latest_state_ = std::move(text);
}

void MachinePage::push(std::shared_ptr<const std::string> text) {
  if (!accepted_) return;
  if (outgoing_.size() > max_waiting) return hang_up();  // it does not read
  outgoing_.push_back(std::move(text));
  if (outgoing_.size() == 1) write_next();
}

void MachinePage::write_next() {
  stream_.text(true);
  stream_.async_write(boost::asio::buffer(*outgoing_.front()),
                      [this, self = shared_from_this()](const boost::system::error_code& error, std::size_t) {
                        outgoing_.pop_front();
                        if (error) return outgoing_.clear();
                        if (outgoing_.empty() && latest_state_)
                          outgoing_.push_back(std::exchange(latest_state_, nullptr));
                        if (!outgoing_.empty()) write_next();
                      });
}

void MachinePage::hang_up() { beast::get_lowest_layer(stream_).close(); }

boost::asio::awaitable<void> refuse_page(beast::tcp_stream stream, TextResponse refusal) {
  boost::system::error_code ignored;
  refusal.keep_alive(false);
  stream.expires_after(std::chrono::seconds(10));
  co_await http::async_write(stream, refusal, boost::asio::redirect_error(boost::asio::use_awaitable, ignored));
  stream.socket().shutdown(boost::asio::ip::tcp::socket::shutdown_both, ignored);
}

}  // namespace formwright
