// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_rooms.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/use_future.hpp>
#include <csignal>
#include <iostream>

#include "base/error.h"
#include "system/host.h"
#include "machines/port/thread_priority.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;
using namespace std::chrono_literals;

constexpr std::size_t max_pages = 16, max_pages_per_machine = 4, max_recent = 200;
}  // namespace

MachineRooms::MachineRooms(boost::asio::thread_pool& opening, std::filesystem::path data, const JobStore& store,
                           MachineLog& log)
    : opening_(opening), data_(std::move(data)), store_(store), log_(log) {
  stops_.add(SIGUSR1);
  listen_for_stops();
  thread_ = std::thread([this] { run(); });
}

MachineRooms::~MachineRooms() {
  io_.stop();
  thread_.join();
}

void MachineRooms::run() {
  run_this_thread_first();
  for (;;) {
    try {
      io_.run();
      return;
    } catch (const std::exception& mistake) {  // of one handler; the others go on
      std::cerr << "formwright: machines: " << mistake.what() << std::endl;
    }
  }
}

bool MachineRooms::full(const std::string& machine_id) const {
  std::size_t total = 0;
  for (const auto& [id, room] : rooms_) total += room->pages.size();
  const auto found = rooms_.find(machine_id);
  return total >= max_pages || (found != rooms_.end() && found->second->pages.size() >= max_pages_per_machine);
}

std::string MachineRooms::state_of(const std::string& machine_id) const {
  const std::scoped_lock lock(phases_mutex_);
  const auto found = phases_.find(machine_id);
  return found == phases_.end() ? "" : found->second;
}

void MachineRooms::set_phase(const std::string& machine_id, const std::string& phase) {
  const std::scoped_lock lock(phases_mutex_);
  if (phase.empty()) phases_.erase(machine_id);
  else phases_[machine_id] = phase;
}

boost::asio::awaitable<void> MachineRooms::serve(beast::tcp_stream stream, Head head, Machine machine) {
  boost::system::error_code error;
  const int socket = stream.release_socket().release(error);
  if (error) co_return;
  co_await boost::asio::co_spawn(io_, serve_here(socket, std::move(head), std::move(machine)), use_awaitable);
}

boost::asio::awaitable<void> MachineRooms::serve_here(int descriptor, Head head, Machine machine) {
  beast::tcp_stream tcp(boost::asio::ip::tcp::socket(io_, boost::asio::ip::tcp::v4(), descriptor));
  if (full(machine.id)) {
    co_await refuse_page(std::move(tcp), error_response(head, http::status::too_many_requests, "invalid_input", "",
                                                        "Too many pages show this machine: close some."));
    co_return;
  }
  const auto page = std::make_shared<MachinePage>(beast::websocket::stream<beast::tcp_stream>(std::move(tcp)));
  auto& room_here = rooms_[machine.id];
  if (!room_here) {
    room_here = std::make_shared<Room>();
    room_here->machine = machine;
  }
  const auto room = room_here;
  room->pages.insert(page);  // counted before the handshake, so that many at once are too many
  auto& stream = page->stream();
  beast::get_lowest_layer(stream).expires_never();
  // A page whose computer sleeps or whose network is gone is noticed within 20 s, one that is closed at once.
  stream.set_option(beast::websocket::stream_base::timeout{10s, 20s, true});
  stream.set_option(beast::websocket::stream_base::decorator(
      [](beast::websocket::response_type& r) { r.set(http::field::sec_websocket_protocol, "formwright.machine.v1"); }));
  stream.read_message_max(MachinePage::max_message_bytes);
  boost::system::error_code error;
  co_await stream.async_accept(head, boost::asio::redirect_error(use_awaitable, error));
  if (!error) {
    page->accepted();
    try {
      co_await read_requests(room, page);
    } catch (const std::exception& mistake) {
      std::cerr << "formwright: machine socket: " << mistake.what() << std::endl;
    }
  }
  leave(room, page);
  // Said before the line goes dead, so that the last message still arrives.
  if (!error && stream.is_open())
    co_await stream.async_close(beast::websocket::close_code::policy_error,
                                boost::asio::redirect_error(use_awaitable, error));
  page->hang_up();
}

void MachineRooms::begin(const RoomHere& room, std::shared_ptr<MachineSession> session) {
  room->session = session;
  room->recent.clear();
  room->held_because.clear();
  const std::weak_ptr<Room> weak = room;
  session->begin({[this, weak](const Json& state) {
                    const auto here = weak.lock();
                    if (!here) return;
                    set_phase(here->machine.id, state["phase"].get<std::string>());
                    const auto text = std::make_shared<const std::string>(json_text({{"state", state}}));
                    for (const auto& page : here->pages) page->send_state(text);
                  },
                  [weak](const Json& events) {
                    if (const auto here = weak.lock()) tell_events(*here, events);
                  },
                  [this, weak](const std::string& sentence) {
                    const auto here = weak.lock();
                    if (!here) return;
                    here->session = nullptr;
                    here->steering = nullptr;
                    set_phase(here->machine.id, "");
                    for (const auto& page : here->pages)
                      page->send({{"error", {{"code", "could_not_solve"}, {"where", "machine"}, {"message", sentence}}},
                                  {"closed", true}});
                  }});
}

void MachineRooms::tell_events(Room& room, const Json& events) {
  for (const Json& event : events) {
    room.recent.push_back(event);
    if (room.recent.size() > max_recent) room.recent.pop_front();
  }
  const auto pages = room.pages;
  for (const auto& page : pages) page->send({{"events", events}});
}

void MachineRooms::close(Room& room) {
  room.session = nullptr;
  room.steering = nullptr;
  set_phase(room.machine.id, "");
  for (const auto& page : room.pages) page->send({{"closed", true}});
}

void MachineRooms::leave(const RoomHere& room, const Page& page) {
  room->pages.erase(page);
  if (room->steering == page) {
    room->steering = nullptr;
    if (room->session) {
      const Json before = room->session->state();
      const bool job = room->session->job_active();
      const bool moved = before["phase"] != "idle" && before["phase"] != "alarm" && before["phase"] != "paused";
      room->session->hold("The page that controlled the machine was closed.");
      if (job) {
        // The port stays open: closing it may reset the board, and with it what the held job needs to go on.
        room->held_because = "The page that controlled " + room->machine.name + " was closed during the job " +
                             before["job"]["name"].get<std::string>() + ": the machine was paused with its laser off.";
        tell_events(*room, Json::array({{{"event", "note"}, {"text", room->held_because}, {"now_s", 0}}}));
      } else {
        room->session->end(moved ? "The page that controlled the machine was closed, so the movement was stopped."
                                 : "The page that controlled the machine was closed.");
        close(*room);
      }
    }
  }
  if (room->pages.empty() && !room->session && !room->opening) rooms_.erase(room->machine.id);
}

void MachineRooms::listen_for_stops() {
  stops_.async_wait([this](const boost::system::error_code& error, int) {
    if (error) return;
    for (const auto& [id, room] : rooms_)
      if (room->session) room->session->look_for_stop();
    listen_for_stops();
  });
}

boost::asio::awaitable<void> MachineRooms::stop_all() {
  std::vector<std::shared_ptr<MachineSession>> sessions;
  for (const auto& [id, room] : rooms_)
    if (room->session) sessions.push_back(room->session);
  for (const auto& session : sessions) {
    try {
      const std::string phase = session->state()["phase"].get<std::string>();
      if (session->job_active() || (phase != "idle" && phase != "alarm")) session->command({{"do", "stop"}});
    } catch (const Error&) {
      // end() below stops what can be stopped.
    }
  }
  const auto end = std::chrono::steady_clock::now() + 2s;
  const auto stopping = [&] {
    return std::any_of(sessions.begin(), sessions.end(),
                       [](const auto& s) { return !s->over() && s->state()["phase"] == "stopping"; });
  };
  boost::asio::steady_timer look(io_);
  while (stopping() && std::chrono::steady_clock::now() < end) {
    look.expires_after(20ms);
    co_await look.async_wait(use_awaitable);
  }
  for (const auto& session : sessions) session->end("The worker ended.");
  for (const auto& [id, room] : rooms_) room->session = nullptr;
}

void MachineRooms::stop() {
  try {
    boost::asio::co_spawn(io_, stop_all(), boost::asio::use_future).wait_for(4s);
  } catch (const std::exception& mistake) {
    std::cerr << "formwright: machines: " << mistake.what() << std::endl;
  }
}

}  // namespace formwright
