// SPDX-License-Identifier: GPL-3.0-or-later
// One connection: read a request's head, decide, read its body, answer, again.
#include <algorithm>
#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <iostream>

#include "base/error.h"
#include "system/files.h"
#include "server/http_server.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;
using namespace std::chrono_literals;

constexpr std::uint32_t header_limit = 16 * 1024;
// Of bodies: what the longest that the page sends takes, and room.
constexpr std::uint64_t max_job_bytes = 1 << 20, max_order_bytes = 64 * 1024, max_other_bytes = 4 * 1024;
// A stranger says at once what it wants, and takes the answer: 30 s are enough for the page's largest file.
constexpr auto stranger_patience = 5s, stranger_answer_patience = 30s;
constexpr auto head_patience = 60s, body_patience = 15s, upload_patience = 600s, answer_patience = 600s;
constexpr std::size_t max_page_sockets = 32;
constexpr std::uint64_t max_drained_bytes = std::uint64_t{256} << 20;

/// "/api/blobs/<hash>" -> the hash, or "" for anything else.
std::string blob_hash(const Head& head) {
  const std::string target = text_of(head.target());
  constexpr std::string_view prefix = "/api/blobs/";
  if (!target.starts_with(prefix)) return "";
  const std::string hash = target.substr(prefix.size());
  return is_hex_name(hash, 64) ? hash : "";
}

/// "/api/machines/<id>/socket" -> the id, or "" for anything else.
std::string machine_of_socket(const Head& head) {
  const std::string target = text_of(head.target());
  constexpr std::string_view prefix = "/api/machines/", suffix = "/socket";
  if (!target.starts_with(prefix) || !target.ends_with(suffix) || target.size() <= prefix.size() + suffix.size())
    return "";
  const std::string id = target.substr(prefix.size(), target.size() - prefix.size() - suffix.size());
  return is_hex_name(id, 16) ? id : "";
}

std::string path_of(const Head& head) {
  const std::string target = text_of(head.target());
  return target.substr(0, target.find('?'));
}

std::uint64_t max_body_bytes(const Head& head) {
  const std::string path = path_of(head);
  if (path == "/api/jobs" && head.method() == http::verb::post) return max_job_bytes;
  return path.starts_with("/api/machines/") ? max_order_bytes : max_other_bytes;
}

bool is_upload(const Head& head) { return head.method() == http::verb::put && !blob_hash(head).empty(); }

/// The answer after which the connection ends, because a body may stand unread in it.
TextResponse last_answer(TextResponse response) {
  response.keep_alive(false);
  return response;
}

TextResponse token_refusal(const Head& head) {
  return error_response(head, http::status::unauthorized, "invalid_input", "token",
                        "The token is missing or wrong: open the page from the address that the worker printed.");
}

TextResponse too_large(const Head& head) {
  return error_response(head, http::status::payload_too_large, "invalid_input", "",
                        "The message is too large: send models as files first.");
}

TextResponse busy_refusal(const Head& head) {
  return error_response(head, http::status::service_unavailable, "invalid_input", "",
                        "Too many pages are open: close some.");
}

/// Its stream is about to go, whatever the reason.
struct StreamLent {
  StreamLent(std::shared_ptr<Connection> c, beast::tcp_stream& stream) : connection(std::move(c)) {
    connection->stream = &stream;
  }
  StreamLent(const StreamLent&) = delete;
  StreamLent& operator=(const StreamLent&) = delete;
  ~StreamLent() { connection->stream = nullptr; }
  const std::shared_ptr<Connection> connection;
};

}  // namespace

std::optional<TextResponse> HttpServer::refusal(const Head& head, std::optional<std::uint64_t> body_bytes,
                                                const std::shared_ptr<Connection>& connection) {
  if (!host_allowed(head))
    return error_response(head, http::status::misdirected_request, "invalid_input", "Host",
                          "This server answers to its own address only.");
  if (!origin_allowed(head))
    return error_response(head, http::status::forbidden, "invalid_input", "Origin",
                          "Another page may not use this worker.");
  const bool upgrade = beast::websocket::is_upgrade(head), page_file = !text_of(head.target()).starts_with("/api/");
  if (upgrade) {
    const bool page = text_of(head.target()) == "/api/socket" && token_in_subprotocol(head, "formwright.v1");
    if (!page && (machine_of_socket(head).empty() || !token_in_subprotocol(head, "formwright.machine.v1")))
      return token_refusal(head);
    if (page && pages_.size() >= max_page_sockets) return busy_refusal(head);
  } else if (!token_given(head)) {
    if (!page_file) return token_refusal(head);
    return body_bytes.value_or(0) > max_other_bytes ? std::optional(too_large(head)) : std::nullopt;
  }
  if (!connections_.recognise(connection)) return busy_refusal(head);
  if (!requests_.take())
    return error_response(head, http::status::too_many_requests, "invalid_input", "",
                          "Too many requests: wait a second.");
  const std::uint64_t bytes = body_bytes.value_or(0);
  if (is_upload(head) && bytes > options_.upload_limit_bytes) return upload_too_large(head);
  if (!is_upload(head) && bytes > max_body_bytes(head)) return too_large(head);
  return std::nullopt;
}

TextResponse HttpServer::upload_too_large(const Head& head) const {
  return error_response(
      head, http::status::payload_too_large, "invalid_input", "mesh",
      "The file is larger than " + std::to_string(options_.upload_limit_bytes >> 20) + " MB: simplify it first.");
}

boost::asio::awaitable<void> HttpServer::serve_connection(Socket socket, std::shared_ptr<Connection> connection) {
  beast::tcp_stream stream(std::move(socket));
  const StreamLent lent(connection, stream);
  beast::flat_buffer buffer;
  const auto rests = [&] {
    connection->answering = false;
    connection->since = std::chrono::steady_clock::now();
    // One limit for the whole head: single late bytes do not lengthen it.
    if (connection->known) stream.expires_after(head_patience);
    else stream.expires_after(stranger_patience);
  };
  rests();
  for (;;) {
    http::request_parser<http::empty_body> head;
    head.header_limit(header_limit);
    head.body_limit(boost::none);  // refusal() looks at the length, and says so instead of hanging up
    boost::system::error_code error;
    co_await http::async_read_header(stream, buffer, head, boost::asio::redirect_error(use_awaitable, error));
    if (error) break;
    const Head request = head.get();
    std::optional<std::uint64_t> body_bytes;
    if (const auto length = head.content_length()) body_bytes = *length;

    Response response;
    if (auto refused = refusal(request, body_bytes, connection)) {
      response = last_answer(std::move(*refused));
    } else if (const std::string machine = machine_of_socket(request);
               beast::websocket::is_upgrade(request) && !machine.empty()) {
      connection->stream = nullptr;
      co_await bridge_.serve_socket(std::move(stream), request, machine);
      co_return;
    } else if (beast::websocket::is_upgrade(request)) {
      connection->stream = nullptr;
      auto page = std::make_shared<PageSocket>(beast::websocket::stream<beast::tcp_stream>(std::move(stream)));
      co_await serve_page_socket(page, request);
      co_return;
    } else {
      if (!connection->known && !connection->pages.take()) {
        // Who asks faster than a page does is answered more slowly, not at the cost of others.
        boost::asio::steady_timer pause(io_, connection->pages.wait());
        co_await pause.async_wait(boost::asio::redirect_error(use_awaitable, error));
        connection->pages.take();
      }
      connection->answering = true;
      connection->since = std::chrono::steady_clock::now();
      try {
        response = co_await receive_and_answer(stream, buffer, head);
      } catch (const std::exception& mistake) {
        std::cerr << "formwright: " << text_of(request.target()) << ": " << mistake.what() << std::endl;
        response = last_answer(error_response(request, http::status::internal_server_error, "internal", "",
                                              "The worker failed; its terminal shows the reason. Try again."));
      }
    }
    if (connection->closed) break;
    if (connection->known) stream.expires_after(answer_patience);
    else stream.expires_after(stranger_answer_patience);
    bool close = false;
    if (auto* text = std::get_if<TextResponse>(&response)) {
      close = text->need_eof();
      co_await http::async_write(stream, *text, boost::asio::redirect_error(use_awaitable, error));
    } else {
      auto& file = std::get<FileResponse>(response);
      close = file.need_eof();
      co_await http::async_write(stream, file, boost::asio::redirect_error(use_awaitable, error));
    }
    if (error) break;
    rests();
    if (close) {
      co_await finish_sending(stream);
      break;
    }
  }
  boost::system::error_code ignored;
  stream.socket().shutdown(Socket::shutdown_both, ignored);
}

boost::asio::awaitable<void> HttpServer::finish_sending(beast::tcp_stream& stream) {
  // Closing with bytes unread resets the connection, and the client loses the answer it was sent (RFC 9112, 9.6).
  boost::system::error_code error;
  stream.socket().shutdown(Socket::shutdown_send, error);
  std::vector<char> unread(64 * 1024);
  std::uint64_t drained = 0;
  stream.expires_after(5s);
  while (!error && drained < max_drained_bytes)
    drained +=
        co_await stream.async_read_some(boost::asio::buffer(unread), boost::asio::redirect_error(use_awaitable, error));
}

boost::asio::awaitable<Response> HttpServer::receive_and_answer(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                                                http::request_parser<http::empty_body>& head) {
  const Head request = head.get();
  boost::system::error_code error;
  if (beast::iequals(request[http::field::expect], "100-continue")) {
    static constexpr std::string_view go_on = "HTTP/1.1 100 Continue\r\n\r\n";
    co_await boost::asio::async_write(stream, boost::asio::buffer(go_on.data(), go_on.size()),
                                      boost::asio::redirect_error(use_awaitable, error));
  }
  if (is_upload(request)) {
    Response answer = co_await receive_upload(stream, buffer, head);
    co_return answer;
  }
  http::request_parser<http::string_body> parser(std::move(head));
  parser.body_limit(max_body_bytes(request));  // also of a body that does not say its length
  stream.expires_after(body_patience);
  co_await http::async_read(stream, buffer, parser, boost::asio::redirect_error(use_awaitable, error));
  if (error == http::error::body_limit || error == http::error::buffer_overflow)
    co_return last_answer(too_large(request));
  if (error)
    co_return last_answer(error_response(request, http::status::bad_request, "invalid_input", "",
                                         "The request was cut off or is not HTTP."));
  constexpr std::string_view machines = "/api/machines";
  const std::string target = text_of(request.target()), path = path_of(request);
  if (path == machines || path.starts_with("/api/machines/")) {
    const std::string query = target.size() > path.size() ? target.substr(path.size() + 1) : "";
    Response answer = co_await bridge_.answer(request, path.substr(machines.size()), query, parser.get().body());
    co_return answer;
  }
  if (!path.starts_with("/api/")) co_return answer(request, parser.get().body());
  if (auto refused = co_await refuse_altered(request)) co_return std::move(*refused);
  const std::function<Response()> work = [this, request, body = parser.get().body()] { return answer(request, body); };
  Response answered = co_await on_jobs_thread(work);
  co_return answered;
}

boost::asio::awaitable<Response> HttpServer::receive_upload(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                                            http::request_parser<http::empty_body>& head) {
  const Head request = head.get();
  const UploadFile received(store_.temporary_path());
  boost::system::error_code error;
  const auto no_room = [&] {
    return last_answer(error_response(request, http::status::insufficient_storage, "internal", "",
                                      "The file could not be written to the disk: free some space and try again."));
  };
  http::request_parser<http::file_body> parser(std::move(head));
  parser.body_limit(options_.upload_limit_bytes);
  parser.get().body().open(received.path.c_str(), beast::file_mode::write, error);
  if (error) co_return no_room();
  buffer.reserve(64 * 1024);  // async_read fills what the buffer has room for, which after the head is a kilobyte
  stream.expires_after(upload_patience);
  co_await http::async_read(stream, buffer, parser, boost::asio::redirect_error(use_awaitable, error));
  parser.get().body().close();
  if (error == http::error::body_limit) co_return last_answer(upload_too_large(request));
  if (error == boost::system::errc::no_space_on_device || error == boost::system::errc::io_error ||
      error == boost::system::errc::file_too_large || error.value() == EDQUOT)
    co_return no_room();
  if (error)
    co_return last_answer(error_response(request, http::status::bad_request, "invalid_input", "mesh",
                                         "The upload was cut off: try again."));
  // Hashing a large file takes a moment, and others are waiting: not on this thread.
  std::string found;
  try {
    found = co_await boost::asio::co_spawn(
        hashing_,
        [](std::filesystem::path path) -> boost::asio::awaitable<std::string> {
          sync_file(path);
          co_return sha256_of_file(path);
        }(received.path),
        use_awaitable);
  } catch (const Error&) {
    co_return no_room();
  }
  const std::function<Response()> keep = [this, request, path = received.path, found] {
    return accept_upload(request, blob_hash(request), path, found);
  };
  Response answered = co_await on_jobs_thread(keep);
  co_return answered;
}

}  // namespace formwright
