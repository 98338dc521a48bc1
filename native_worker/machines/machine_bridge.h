// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Machines behind the worker's HTTP interface (docs/machine_bridge.md). Lives on the server's thread; what blocks runs
// beside it, and machines that are driven have a thread of their own.
#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "system/http_types.h"
#include "jobs/job_store.h"
#include "machines/port/machine_log.h"
#include "machines/port/machine_registry.h"
#include "machines/machine_rooms.h"
#include "machines/machine_tasks.h"

namespace formwright {

class MachineBridge {
 public:
  MachineBridge(boost::asio::io_context& io, std::filesystem::path data, JobStore& store);
  /// `path`: behind /api/machines, without the query. The request has passed the server's checks of Host, Origin and
  /// token.
  boost::asio::awaitable<Response> answer(Head head, std::string path, std::string query, std::string body);
  /// The WebSocket of one machine. Returns when the page is gone; answers with an HTTP error when there is no such
  /// machine.
  boost::asio::awaitable<void> serve_socket(beast::tcp_stream stream, Head head, std::string id);
  /// Takes up the prints that an earlier worker left with printers.
  void start();
  /// Cancels what no machine has yet, and stops every machine that is driven from here.
  void stop();

 private:
  template <class Result>
  static boost::asio::awaitable<Result> aside(boost::asio::thread_pool& threads, std::function<Result()> work);
  boost::asio::awaitable<std::vector<Machine>> machines(bool search_again);
  boost::asio::awaitable<Machine> machine(std::string id);
  boost::asio::awaitable<Response> answer_machine(Head head, std::string id, std::string rest, std::string body);
  boost::asio::awaitable<Response> slice(Head head, Machine machine, Json order);
  void follow_again(const std::shared_ptr<MachineTask>& task);
  boost::asio::awaitable<Response> print(Head head, Machine machine, Json order);
  boost::asio::awaitable<Response> upload(Head head, Machine machine, Json order);
  Response answer_tasks(const Head& head, const Machine& machine, const std::string& rest);
  boost::asio::awaitable<std::shared_ptr<const Bytes>> blob(Json order);

  boost::asio::io_context& io_;
  JobStore& store_;
  MachineRegistry registry_;
  MachineLog log_;
  MachineTasks tasks_;
  // Threads apart: a machine that is switched off keeps the one that asks it for half a minute, and neither a stop nor
  // a port that is to be opened may wait behind that; nor the search, which finds the port.
  boost::asio::thread_pool asking_{4};   // machines elsewhere: what they are and do
  boost::asio::thread_pool acting_{4};   // stops, and ports that are opened
  boost::asio::thread_pool looking_{2};  // what this computer knows: the search, the log
  MachineRooms rooms_;
  std::vector<Machine> found_;
  std::chrono::steady_clock::time_point found_when_{};
};

}  // namespace formwright
