// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Machines that are driven over sockets: one page steers, others watch. When the one that steers vanishes, the machine
// is held. All of this lives on a thread of its own, on which nothing blocks or computes for long, so that a stop takes
// milliseconds whatever else the worker does.
#include <boost/asio/awaitable.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/thread_pool.hpp>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "jobs/job_store.h"
#include "machines/machine_page.h"
#include "machines/machine_session.h"

namespace formwright {

/// All public calls from any other thread.
class MachineRooms {
 public:
  /// `opening`: threads on which ports are opened, which blocks. `store`: its paths are asked for, no more.
  MachineRooms(boost::asio::thread_pool& opening, std::filesystem::path data, const JobStore& store, MachineLog& log);
  MachineRooms(const MachineRooms&) = delete;
  MachineRooms& operator=(const MachineRooms&) = delete;
  ~MachineRooms();

  /// Takes the page over and serves it on the machines' thread; returns when it is gone. The request has passed the
  /// server's checks.
  boost::asio::awaitable<void> serve(beast::tcp_stream stream, Head head, Machine machine);
  /// "" or what the machine does now: its phase.
  std::string state_of(const std::string& machine_id) const;
  /// Stops every machine, with up to 2 s for it to come to rest, and closes the ports.
  void stop();

 private:
  using Page = std::shared_ptr<MachinePage>;
  /// Thrown: another page, or another job, is at it.
  struct Busy {
    std::string sentence;
  };
  struct Room {
    Machine machine;
    std::shared_ptr<MachineSession> session;
    Page steering;
    std::set<Page> pages;
    std::deque<Json> recent;   // events, for a page that comes later
    std::string held_because;  // for the next page that steers
    bool opening = false;
    int loading = 0;  // jobs that are being read
  };
  using RoomHere = std::shared_ptr<Room>;

  void run();
  bool full(const std::string& machine_id) const;
  boost::asio::awaitable<void> serve_here(int socket, Head head, Machine machine);
  boost::asio::awaitable<void> read_requests(RoomHere room, Page page);
  boost::asio::awaitable<Json> answer(RoomHere room, Page page, MachineRequest request, int number);
  boost::asio::awaitable<void> handle(RoomHere room, Page page, MachineRequest request);
  boost::asio::awaitable<void> open(RoomHere room, Page page, Json options);
  boost::asio::awaitable<void> load(RoomHere room, MachineRequest request);
  boost::asio::awaitable<void> stop_all();
  void begin(const RoomHere& room, std::shared_ptr<MachineSession> session);
  void leave(const RoomHere& room, const Page& page);
  void close(Room& room);
  void listen_for_stops();
  void set_phase(const std::string& machine_id, const std::string& phase);
  static void tell_events(Room& room, const Json& events);

  boost::asio::thread_pool& opening_;
  const std::filesystem::path data_;
  const JobStore& store_;
  MachineLog& log_;
  boost::asio::thread_pool reading_{1};  // jobs, one after the other: each takes several times its size
  std::map<std::string, RoomHere> rooms_;
  mutable std::mutex phases_mutex_;
  std::map<std::string, std::string> phases_;

  boost::asio::io_context io_{1};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_{io_.get_executor()};
  boost::asio::signal_set stops_{io_};  // formwright machine stop, from another process
  std::thread thread_;
};

}  // namespace formwright
