// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Loopback HTTP and WebSocket: who may speak, and what the answers look like. Routes are in api.cpp.
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <variant>

#include "server/connections.h"
#include "system/http_types.h"
#include "jobs/job_queue.h"
#include "jobs/job_store.h"
#include "machines/machine_bridge.h"
#include "system/rate_budget.h"
#include "jobs/solver_limits.h"

namespace formwright {

struct ServerOptions {
  unsigned short port = 8731;  // 0: any free one
  std::filesystem::path web;   // folder of the built page
  std::filesystem::path data;
  std::uint64_t upload_limit_bytes = std::uint64_t{1} << 30;
  SolverOptions solver;
};

/// A page that listens. Messages queue up while one is being written; a page that does not read is dropped.
struct PageSocket {
  explicit PageSocket(beast::websocket::stream<beast::tcp_stream>&& s) : stream(std::move(s)) {}
  beast::websocket::stream<beast::tcp_stream> stream;
  std::deque<std::shared_ptr<const std::string>> outgoing;
};

/// Until it is stopped. What a handler throws is printed, and the others go on.
void run_handlers(boost::asio::io_context& io);

/// Connections are served on the thread of `io`, which never waits for a disk: a page that connects to stop a machine
/// is heard at once. Jobs, and the files that are kept for them, have a thread of their own.
class HttpServer {
 public:
  /// Binds 127.0.0.1. Throws Error{invalid_input, "--port"} when the port is taken.
  HttpServer(boost::asio::io_context& io, const ServerOptions& options);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer() { end_jobs_thread(); }

  unsigned short port() const { return port_; }
  const std::string& token() const { return token_; }
  void start();
  /// Ends the child process and puts its job back in the queue, for the next start.
  void stop();

 private:
  using Socket = boost::asio::ip::tcp::socket;
  boost::asio::awaitable<void> accept_loop();
  boost::asio::awaitable<void> serve_connection(Socket socket, std::shared_ptr<Connection> connection);
  boost::asio::awaitable<void> serve_page_socket(std::shared_ptr<PageSocket> page, Head head);
  boost::asio::awaitable<Response> receive_and_answer(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                                      http::request_parser<http::empty_body>& head);
  boost::asio::awaitable<Response> receive_upload(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                                  http::request_parser<http::empty_body>& head);
  /// What is read must be what was kept: the answer when a blob or an output was altered on the disk, or nothing.
  boost::asio::awaitable<std::optional<TextResponse>> refuse_altered(const Head& head);
  boost::asio::awaitable<void> finish_sending(beast::tcp_stream& stream);
  /// `work` done on the jobs' thread. All that touches store_ or queue_ runs there.
  template <class Result>
  boost::asio::awaitable<Result> on_jobs_thread(std::function<Result()> work) {
    co_return co_await boost::asio::co_spawn(
        jobs_io_, [](std::function<Result()> w) -> boost::asio::awaitable<Result> { co_return w(); }(std::move(work)),
        boost::asio::use_awaitable);
  }
  void end_jobs_thread();

  // Who may speak. What is refused is refused before its body is read.
  std::optional<TextResponse> refusal(const Head& head, std::optional<std::uint64_t> body_bytes,
                                      const std::shared_ptr<Connection>& connection);
  TextResponse upload_too_large(const Head& head) const;
  bool host_allowed(const Head& head) const;
  bool origin_allowed(const Head& head) const;
  bool token_given(const Head& head) const;
  bool token_in_subprotocol(const Head& head, std::string_view version) const;

  // api.cpp, all but page_file on the jobs' thread
  Response answer(const Head& head, const std::string& body);
  Response answer_jobs(const Head& head, const std::string& path, const std::string& body);
  Response answer_blob(const Head& head, const std::string& sha256);
  Response accept_upload(const Head& head, const std::string& sha256, const std::filesystem::path& received,
                         const std::string& found_hash);
  Response page_file(const Head& head, const std::string& path);
  void tell_pages(const Json& message);
  void write_next(const std::shared_ptr<PageSocket>& page);
  void hear_page(const std::string& text);

  boost::asio::io_context& io_;
  ServerOptions options_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::thread_pool hashing_{1};
  unsigned short port_ = 0;
  std::string token_;
  std::set<std::shared_ptr<PageSocket>> pages_;
  boost::asio::io_context jobs_io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> jobs_wait_{jobs_io_.get_executor()};
  std::thread jobs_thread_;
  JobStore store_;
  JobQueue queue_;
  MachineBridge bridge_;
  Connections connections_;
  RateBudget requests_{400, 1200};  // of all pages that have the token
};

}  // namespace formwright
