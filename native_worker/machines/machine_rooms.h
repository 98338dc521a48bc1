// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Machines that are driven over sockets: one page steers, others watch. When the one that steers vanishes, the machine
// is held.
#include <boost/asio/awaitable.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/thread_pool.hpp>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "job_store.h"
#include "machines/machine_page.h"
#include "machines/machine_session.h"

namespace formwright {

class MachineRooms {
 public:
  /// `opening`: threads on which ports are opened, which blocks.
  MachineRooms(boost::asio::io_context& io, boost::asio::thread_pool& opening, std::filesystem::path data,
               JobStore& store, MachineLog& log)
      : io_(io), opening_(opening), data_(std::move(data)), store_(store), log_(log) {}

  /// Accepts the page and serves it until it is gone. The request has passed the server's checks.
  boost::asio::awaitable<void> serve(std::shared_ptr<MachinePage> page, Head head, Machine machine);
  bool full(const std::string& machine_id) const;
  /// "" or what the machine does now: its phase.
  std::string state_of(const std::string& machine_id) const;
  void look_for_stops();
  /// Stops every machine, with up to 2 s for it to come to rest, and closes the ports. Runs the io_context meanwhile.
  void stop();

 private:
  struct Room {
    Machine machine;
    std::shared_ptr<MachineSession> session;
    std::shared_ptr<MachinePage> steering;
    std::set<std::shared_ptr<MachinePage>> pages;
    std::deque<Json> recent;   // events, for a page that comes later
    std::string held_because;  // for the next page that steers
    bool opening = false;
  };
  boost::asio::awaitable<void> handle(std::shared_ptr<Room> room, std::shared_ptr<MachinePage> page,
                                      MachineRequest request);
  boost::asio::awaitable<void> open(std::shared_ptr<Room> room, std::shared_ptr<MachinePage> page, Json options);
  void begin(const std::shared_ptr<Room>& room, std::shared_ptr<MachineSession> session);
  void leave(const std::shared_ptr<Room>& room, const std::shared_ptr<MachinePage>& page);
  static void tell_events(Room& room, const Json& events);

  boost::asio::io_context& io_;
  boost::asio::thread_pool& opening_;
  const std::filesystem::path data_;
  JobStore& store_;
  MachineLog& log_;
  std::map<std::string, std::shared_ptr<Room>> rooms_;
};

}  // namespace formwright
