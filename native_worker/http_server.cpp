// SPDX-License-Identifier: GPL-3.0-or-later
#include "http_server.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <fstream>

#include "base/error.h"
#include "base/sha256.h"
#include "files.h"
#include "secret.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;
using namespace std::chrono_literals;

constexpr int most_connections = 64;
constexpr std::uint64_t most_json_bytes = 1 << 20;
constexpr double requests_per_second = 400, request_burst = 1200;
constexpr std::uint32_t header_limit = 16 * 1024;

std::string text_of(boost::core::string_view view) { return {view.data(), view.size()}; }

/// "/api/blobs/<hash>" -> the hash, or "" for anything else.
std::string blob_hash(const Head& head) {
  const std::string target = text_of(head.target());
  constexpr std::string_view prefix = "/api/blobs/";
  if (!target.starts_with(prefix)) return "";
  const std::string hash = target.substr(prefix.size());
  return is_hex_name(hash, 64) ? hash : "";
}

bool wants_api(const Head& head) { return text_of(head.target()).starts_with("/api/"); }

}  // namespace

HttpServer::HttpServer(boost::asio::io_context& io, const ServerOptions& options)
    : io_(io), options_(options), acceptor_(io), token_(random_hex(24)), store_(options.data), queue_(io, store_, [this](const Json& m) { tell_pages(m); }),
      rate_budget_(request_burst), rate_time_(std::chrono::steady_clock::now()) {
  const boost::asio::ip::tcp::endpoint endpoint(boost::asio::ip::address_v4::loopback(), options.port);
  boost::system::error_code error;
  acceptor_.open(endpoint.protocol(), error);
  if (!error) acceptor_.set_option(boost::asio::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(boost::asio::socket_base::max_listen_connections, error);
  if (error)
    throw Error(ErrorCode::invalid_input, "--port", "Port " + std::to_string(options.port) + " cannot be used (" + error.message() + "): choose another with --port, or 0 for any.");
  port_ = acceptor_.local_endpoint().port();
}

void HttpServer::start() { boost::asio::co_spawn(io_, accept_loop(), boost::asio::detached); }

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
    if (connections_ >= most_connections) continue;  // closes it
    ++connections_;
    boost::asio::co_spawn(io_, serve_connection(std::move(socket)), [this](std::exception_ptr) { --connections_; });
  }
}

bool HttpServer::host_allowed(const Head& head) const {
  // Exact names against DNS rebinding: a page elsewhere can make its own name point here, but not change Host.
  const std::string host = text_of(head[http::field::host]), port = ":" + std::to_string(port_);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

bool HttpServer::origin_allowed(const Head& head) const {
  if (head.count(http::field::origin) == 0) return true;
  const std::string origin = text_of(head[http::field::origin]), port = ":" + std::to_string(port_);
  return origin == "http://127.0.0.1" + port || origin == "http://localhost" + port;
}

bool HttpServer::token_given(const Head& head) const {
  const std::string value = text_of(head[http::field::authorization]);
  return equal_in_constant_time(value, "Bearer " + token_);
}

bool HttpServer::token_in_subprotocol(const Head& head) const {
  const std::string list = text_of(head[http::field::sec_websocket_protocol]);
  bool version = false, token = false;
  std::size_t start = 0;
  while (start < list.size()) {
    const std::size_t comma = std::min(list.find(',', start), list.size());
    std::string item = list.substr(start, comma - start);
    item.erase(0, item.find_first_not_of(' '));
    version = version || item == "formwright.v1";
    token = equal_in_constant_time(item, "token." + token_) || token;
    start = comma + 1;
  }
  return version && token;
}

bool HttpServer::within_rate() {
  const auto now = std::chrono::steady_clock::now();
  rate_budget_ = std::min(request_burst, rate_budget_ + requests_per_second * std::chrono::duration<double>(now - rate_time_).count());
  rate_time_ = now;
  if (rate_budget_ < 1) return false;
  rate_budget_ -= 1;
  return true;
}

boost::asio::awaitable<void> HttpServer::serve_connection(Socket socket) {
  beast::tcp_stream stream(std::move(socket));
  beast::flat_buffer buffer;
  for (;;) {
    http::request_parser<http::empty_body> head;
    head.header_limit(header_limit);
    head.body_limit(options_.upload_limit_bytes);
    stream.expires_after(60s);
    boost::system::error_code error;
    co_await http::async_read_header(stream, buffer, head, boost::asio::redirect_error(use_awaitable, error));
    if (error) break;
    const Head& request = head.get();

    std::optional<TextResponse> refusal;
    if (!host_allowed(request)) refusal = error_response(request, http::status::misdirected_request, "invalid_input", "Host", "This server answers to its own address only.");
    else if (!origin_allowed(request)) refusal = error_response(request, http::status::forbidden, "invalid_input", "Origin", "Another page may not use this worker.");
    else if (!within_rate()) refusal = error_response(request, http::status::too_many_requests, "invalid_input", "", "Too many requests: wait a second.");
    else if (beast::websocket::is_upgrade(request)) {
      if (text_of(request.target()) == "/api/socket" && token_in_subprotocol(request)) {
        auto page = std::make_shared<PageSocket>(beast::websocket::stream<beast::tcp_stream>(std::move(stream)));
        co_await serve_page_socket(page, request);
        co_return;
      }
      refusal = error_response(request, http::status::unauthorized, "invalid_input", "token", "The token is missing or wrong: open the page from the address that the worker printed.");
    } else if (wants_api(request) && !token_given(request)) {
      refusal = error_response(request, http::status::unauthorized, "invalid_input", "token", "The token is missing or wrong: open the page from the address that the worker printed.");
    }

    Response response;
    bool close = false;
    if (refusal) {
      refusal->keep_alive(false);  // its body, if any, stays unread
      response = std::move(*refusal);
    } else {
      response = co_await receive_and_answer(stream, buffer, head);
    }
    stream.expires_after(10min);
    if (auto* text = std::get_if<TextResponse>(&response)) {
      close = text->need_eof();
      co_await http::async_write(stream, *text, boost::asio::redirect_error(use_awaitable, error));
    } else {
      auto& file = std::get<FileResponse>(response);
      close = file.need_eof();
      co_await http::async_write(stream, file, boost::asio::redirect_error(use_awaitable, error));
    }
    if (error || close) break;
  }
  boost::system::error_code ignored;
  stream.socket().shutdown(Socket::shutdown_send, ignored);
}

boost::asio::awaitable<Response> HttpServer::receive_and_answer(beast::tcp_stream& stream, beast::flat_buffer& buffer, http::request_parser<http::empty_body>& head) {
  const Head request = head.get();
  boost::system::error_code error;
  const std::string hash = blob_hash(request);
  if (request.method() == http::verb::put && !hash.empty()) {
    const std::filesystem::path received = store_.temporary_path();
    http::request_parser<http::file_body> parser(std::move(head));
    parser.body_limit(options_.upload_limit_bytes);
    parser.get().body().open(received.c_str(), beast::file_mode::write, error);
    stream.expires_after(10min);
    if (!error) co_await http::async_read(stream, buffer, parser, boost::asio::redirect_error(use_awaitable, error));
    parser.get().body().close();
    const auto give_up = [&](http::status status, const std::string& code, const std::string& message) {
      std::error_code ignored;
      std::filesystem::remove(received, ignored);
      TextResponse refused = error_response(request, status, code, "mesh", message);
      refused.keep_alive(false);
      return refused;
    };
    if (error == http::error::body_limit)
      co_return give_up(http::status::payload_too_large, "invalid_input", "The file is larger than " + std::to_string(options_.upload_limit_bytes >> 20) + " MB: simplify it first.");
    if (error == boost::system::errc::no_space_on_device) co_return give_up(http::status::insufficient_storage, "internal", "The disk is full: make room and try again.");
    if (error) co_return give_up(http::status::bad_request, "invalid_input", "The upload was cut off: try again.");
    // Hashing a large file takes a moment, and others are waiting: not on this thread.
    const std::string found = co_await boost::asio::co_spawn(
        hashing_,
        [](std::filesystem::path path) -> boost::asio::awaitable<std::string> {
          co_return sha256_hex(*read_file(path, "mesh"));
        }(received),
        use_awaitable);
    co_return accept_upload(request, hash, received, found);
  }
  http::request_parser<http::string_body> parser(std::move(head));
  parser.body_limit(most_json_bytes);
  stream.expires_after(30s);
  co_await http::async_read(stream, buffer, parser, boost::asio::redirect_error(use_awaitable, error));
  if (error) {
    TextResponse refused = error == http::error::body_limit
                               ? error_response(request, http::status::payload_too_large, "invalid_input", "", "The message is too large: send meshes as blobs.")
                               : error_response(request, http::status::bad_request, "invalid_input", "", "The request was cut off or is not HTTP.");
    refused.keep_alive(false);
    co_return refused;
  }
  co_return answer(request, parser.get().body());
}

boost::asio::awaitable<void> HttpServer::serve_page_socket(std::shared_ptr<PageSocket> page, Head head) {
  boost::system::error_code error;
  beast::get_lowest_layer(page->stream).expires_never();
  page->stream.set_option(beast::websocket::stream_base::timeout::suggested(beast::role_type::server));
  page->stream.set_option(beast::websocket::stream_base::decorator([](beast::websocket::response_type& r) { r.set(http::field::sec_websocket_protocol, "formwright.v1"); }));
  page->stream.read_message_max(64 * 1024);
  co_await page->stream.async_accept(head, boost::asio::redirect_error(use_awaitable, error));
  if (error) co_return;
  pages_.insert(page);
  for (;;) {
    beast::flat_buffer buffer;
    co_await page->stream.async_read(buffer, boost::asio::redirect_error(use_awaitable, error));
    if (error) break;
    hear_page(beast::buffers_to_string(buffer.data()));
  }
  pages_.erase(page);
}

void HttpServer::tell_pages(const Json& message) {
  const auto text = std::make_shared<const std::string>(message.dump());
  const auto listeners = pages_;
  for (const auto& page : listeners) {
    if (page->outgoing.size() > 500) {  // it does not read: progress piles up
      beast::get_lowest_layer(page->stream).close();
      continue;
    }
    page->outgoing.push_back(text);
    if (page->outgoing.size() == 1) write_next(page);
  }
}

void HttpServer::write_next(const std::shared_ptr<PageSocket>& page) {
  page->stream.text(true);
  page->stream.async_write(boost::asio::buffer(*page->outgoing.front()), [this, page](const boost::system::error_code& error, std::size_t) {
    page->outgoing.pop_front();
    if (!error && !page->outgoing.empty()) write_next(page);
  });
}

void HttpServer::hear_page(const std::string& text) {
  const Json message = Json::parse(text, nullptr, false);
  if (!message.is_object() || message.value("type", Json()) != "cancel") return;
  const Json id = message.value("id", Json());
  if (id.is_string()) queue_.cancel(id.get<std::string>());
}

}  // namespace formwright
