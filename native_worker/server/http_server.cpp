// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/http_server.h"

#include <algorithm>
#include <boost/asio/detached.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <iostream>

#include "base/error.h"
#include "system/secret.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;
using namespace std::chrono_literals;

}  // namespace

HttpServer::HttpServer(boost::asio::io_context& io, const ServerOptions& options)
    : io_(io),
      options_(options),
      acceptor_(io),
      token_(random_hex(24)),
      store_(options.data),
      queue_(
          jobs_io_, store_,
          [this](const Json& message) { boost::asio::post(io_, [this, message] { tell_pages(message); }); },
          solver_words(options.solver)),
      bridge_(io, options.data, store_) {
  const boost::asio::ip::tcp::endpoint endpoint(boost::asio::ip::address_v4::loopback(), options.port);
  boost::system::error_code error;
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(boost::asio::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(boost::asio::socket_base::max_listen_connections, error);
  if (error)
    throw Error(ErrorCode::invalid_input, "--port",
                "Port " + std::to_string(options.port) + " cannot be used (" + error.message() +
                    "): choose another with --port, or 0 for any.");
  port_ = acceptor_.local_endpoint().port();
}

void HttpServer::start() {
  jobs_thread_ = std::thread([this] { run_handlers(jobs_io_); });
  boost::asio::post(jobs_io_, [this] { queue_.start(); });
  bridge_.start();
  boost::asio::co_spawn(io_, accept_loop(), boost::asio::detached);
}

void HttpServer::stop() {
  bridge_.stop();  // first: machines run
  end_jobs_thread();
  queue_.stop();
}

void HttpServer::end_jobs_thread() {
  jobs_io_.stop();
  if (jobs_thread_.joinable()) jobs_thread_.join();
}

void run_handlers(boost::asio::io_context& io) {
  for (;;) {
    try {
      io.run();
      return;
    } catch (const std::exception& mistake) {
      std::cerr << "formwright: " << mistake.what() << std::endl;
    }
  }
}

boost::asio::awaitable<void> HttpServer::accept_loop() {
  for (;;) {
    boost::system::error_code error;
    Socket socket = co_await acceptor_.async_accept(boost::asio::redirect_error(use_awaitable, error));
    if (error == boost::asio::error::operation_aborted) co_return;
    if (error) {  // out of descriptors: wait for some to close
      boost::asio::steady_timer pause(io_, 100ms);
      co_await pause.async_wait(use_awaitable);
      continue;
    }
    const auto connection = connections_.admit();
    boost::asio::co_spawn(io_, serve_connection(std::move(socket), connection),
                          [this, connection](std::exception_ptr) { connections_.leave(connection); });
  }
}

bool HttpServer::host_allowed(const Head& head) const {
  // Exact names against DNS rebinding: a page elsewhere can make its own name point here, but not change Host.
  const std::string host = text_of(head[http::field::host]), port = ":" + std::to_string(port_);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

bool HttpServer::origin_allowed(const Head& head) const {
  // What the browser itself says of who asks (Fetch Metadata, sec. 2.3): pages of other sites cannot change it, and
  // most of their requests have no Origin. "none": typed into the address bar. Other programs send no such header.
  if (const auto site = head.find("Sec-Fetch-Site"); site != head.end())
    if (const std::string said = text_of(site->value()); said != "same-origin" && said != "none") return false;
  if (head.count(http::field::origin) == 0) return true;
  const std::string origin = text_of(head[http::field::origin]), port = ":" + std::to_string(port_);
  return origin == "http://127.0.0.1" + port || origin == "http://localhost" + port;
}

bool HttpServer::token_given(const Head& head) const {
  const std::string value = text_of(head[http::field::authorization]);
  return equal_in_constant_time(value, "Bearer " + token_);
}

bool HttpServer::token_in_subprotocol(const Head& head, std::string_view wanted) const {
  const std::string list = text_of(head[http::field::sec_websocket_protocol]);
  bool version = false, token = false;
  std::size_t start = 0;
  while (start < list.size()) {
    const std::size_t comma = std::min(list.find(',', start), list.size());
    std::string item = list.substr(start, comma - start);
    item.erase(0, item.find_first_not_of(' '));
    version = version || item == wanted;
    token = equal_in_constant_time(item, "token." + token_) || token;
    start = comma + 1;
  }
  return version && token;
}

}  // namespace formwright
