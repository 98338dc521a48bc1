// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_rooms.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <iostream>

#include "base/error.h"
#include "files.h"
#include "host.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;
using namespace std::chrono_literals;

constexpr std::size_t most_pages = 16, most_pages_a_machine = 4, most_recent = 200;
constexpr std::uintmax_t most_job_bytes = std::uintmax_t{128} << 20;

Json error_of(const std::string& code, const std::string& where, const std::string& message, int number) {
  return {{"error", {{"code", code}, {"where", where}, {"message", message}}}, {"n", number}};
}

/// Who watches may still stop or hold a machine that goes wrong.
bool anyone_may(const MachineRequest& request) {
  if (request.kind != MachineRequest::Kind::command || !request.content.contains("do")) return false;
  return request.content["do"] == "stop" || request.content["do"] == "pause";
}

struct Busy {
  std::string sentence;
};

}  // namespace

bool MachineRooms::full(const std::string& machine_id) const {
  std::size_t total = 0;
  for (const auto& [id, room] : rooms_) total += room->pages.size();
  const auto found = rooms_.find(machine_id);
  return total >= most_pages || (found != rooms_.end() && found->second->pages.size() >= most_pages_a_machine);
}

std::string MachineRooms::state_of(const std::string& machine_id) const {
  const auto found = rooms_.find(machine_id);
  return found == rooms_.end() || !found->second->session ? ""
                                                          : found->second->session->state()["phase"].get<std::string>();
}

boost::asio::awaitable<void> MachineRooms::serve(std::shared_ptr<MachinePage> page, Head head, Machine machine) {
  auto& room_here = rooms_[machine.id];
  if (!room_here) room_here = std::make_shared<Room>(Room{machine, nullptr, nullptr, {}, {}, "", false});
  const auto room = room_here;
  room->pages.insert(page);  // counted before the handshake, so that many at once are too many
  auto& stream = page->stream();
  beast::get_lowest_layer(stream).expires_never();
  // A page whose computer sleeps or whose network is gone is noticed within 20 s, one that is closed at once.
  stream.set_option(beast::websocket::stream_base::timeout{10s, 20s, true});
  stream.set_option(beast::websocket::stream_base::decorator(
      [](beast::websocket::response_type& r) { r.set(http::field::sec_websocket_protocol, "formwright.machine.v1"); }));
  stream.read_message_max(MachinePage::most_message_bytes);
  boost::system::error_code error;
  co_await stream.async_accept(head, boost::asio::redirect_error(use_awaitable, error));
  if (!error) page->accepted();
  try {
    if (!error && room->session) page->send({{"state", room->session->state()}});
    if (!error && !room->recent.empty())
      page->send({{"events", Json(std::vector<Json>(room->recent.begin(), room->recent.end()))}});
    while (!error) {
      beast::flat_buffer buffer;
      co_await stream.async_read(buffer, boost::asio::redirect_error(use_awaitable, error));
      if (error) break;
      const int counted = page->next_number();
      std::optional<MachineRequest> request;
      std::optional<Json> answer;
      try {
        if (!page->within_rate())
          throw Error(ErrorCode::invalid_input, "", "Too many requests at once: wait a second.");
        request = read_machine_request(beast::buffers_to_string(buffer.data()));
      } catch (const Error& refused) {
        answer = error_of(to_string(refused.code()), refused.where(), refused.what(), counted);
      }
      if (!request) {
        page->send(*answer);
        if (!page->bears_malformed()) break;  // whatever it is, it is no page of ours
        continue;
      }
      const int number = request->number.value_or(counted);
      try {
        co_await handle(room, page, std::move(*request));
        answer = Json{{"done", number}};
      } catch (const Busy& busy) {
        answer = error_of("busy", "", busy.sentence, number);
      } catch (const Error& refused) {
        answer = error_of(to_string(refused.code()), refused.where(), refused.what(), number);
      }
      page->send(*answer);
    }
  } catch (const std::exception& mistake) {
    std::cerr << "formwright: machine socket: " << mistake.what() << std::endl;
  }
  leave(room, page);
  // Said before the line goes dead, so that what it was told last still arrives.
  if (!error)
    co_await stream.async_close(beast::websocket::close_code::policy_error,
                                boost::asio::redirect_error(use_awaitable, error));
  page->hang_up();
}

boost::asio::awaitable<void> MachineRooms::handle(std::shared_ptr<Room> room, std::shared_ptr<MachinePage> page,
                                                  MachineRequest request) {
  const bool steers = room->steering == page;
  if (request.kind == MachineRequest::Kind::open) {
    if (room->steering && !steers)
      throw Busy{"Another page steers " + room->machine.name +
                 ": you see what it does. Close that page to steer here."};
    co_await open(room, page, std::move(request.content));
    co_return;
  }
  if (!room->session) throw Error(ErrorCode::invalid_input, "do", "The machine is not connected: connect it first.");
  if (!steers && !anyone_may(request))
    throw Busy{room->steering ? "Another page steers " + room->machine.name + ": only pause and stop work here."
                              : "Take the machine over first: connect it here."};
  switch (request.kind) {
    case MachineRequest::Kind::command: room->session->command(request.content); break;
    case MachineRequest::Kind::load: {
      std::error_code status;
      const auto path = store_.blob_path(request.sha256);
      if (!std::filesystem::exists(path, status))
        throw Error(ErrorCode::invalid_input, "sha256", "The job has not arrived: send it again.");
      const auto job = read_checked_file(path, request.sha256, "sha256", most_job_bytes);
      room->session->load(request.name, *job);
      break;
    }
    default:  // close
      room->session->end("The page closed the connection.");
      room->session = nullptr;
      room->steering = nullptr;
      for (const auto& other : room->pages) other->send({{"closed", true}});
  }
}

boost::asio::awaitable<void> MachineRooms::open(std::shared_ptr<Room> room, std::shared_ptr<MachinePage> page,
                                                Json options) {
  if (room->session) {  // held for it
    room->steering = page;
    if (!room->held_because.empty())
      page->send({{"events", {{{"event", "note"}, {"text", room->held_because}, {"now_s", 0}}}}});
    room->held_because.clear();
    page->send({{"state", room->session->state()}});
    co_return;
  }
  if (room->opening) throw Busy{"Another page connects " + room->machine.name + " at this moment: wait for it."};
  options = driver_options(room->machine, std::move(options));
  make_machine_driver(options);  // says what is wrong with them before a port is touched
  const int baud =
      options.contains("baud") && options["baud"].is_number_integer() ? options["baud"].get<int>() : room->machine.baud;
  room->opening = true;
  room->steering = page;
  std::shared_ptr<MachineSession> session;
  std::exception_ptr failed;
  try {
    auto lock = std::make_unique<MachineLock>(data_, room->machine);
    const auto port = co_await boost::asio::co_spawn(
        opening_,
        [](boost::asio::io_context& io, Machine machine,
           int speed) -> boost::asio::awaitable<std::shared_ptr<MachinePort>> {
          co_return open_machine_port(io, machine, speed);
        }(io_, room->machine, baud),
        use_awaitable);
    session = std::make_shared<MachineSession>(io_, room->machine, options, port, std::move(lock), log_);
  } catch (...) {
    failed = std::current_exception();
  }
  room->opening = false;
  if (failed) {
    if (room->steering == page) room->steering = nullptr;
    std::rethrow_exception(failed);
  }
  if (room->steering != page) {  // it went away meanwhile: nothing was sent yet
    session->end("The page went away.");
    co_return;
  }
  begin(room, session);
}

void MachineRooms::begin(const std::shared_ptr<Room>& room, std::shared_ptr<MachineSession> session) {
  room->session = session;
  room->recent.clear();
  room->held_because.clear();
  const std::weak_ptr<Room> weak = room;
  session->begin({[weak](const Json& state) {
                    const auto here = weak.lock();
                    if (!here) return;
                    const auto text = std::make_shared<const std::string>(json_text({{"state", state}}));
                    for (const auto& page : here->pages) page->send_state(text);
                  },
                  [weak](const Json& events) {
                    if (const auto here = weak.lock()) tell_events(*here, events);
                  },
                  [weak](const std::string& sentence) {
                    const auto here = weak.lock();
                    if (!here) return;
                    here->session = nullptr;
                    here->steering = nullptr;
                    for (const auto& page : here->pages)
                      page->send({{"error", {{"code", "could_not_solve"}, {"where", "machine"}, {"message", sentence}}},
                                  {"closed", true}});
                  }});
}

void MachineRooms::tell_events(Room& room, const Json& events) {
  for (const Json& event : events) {
    room.recent.push_back(event);
    if (room.recent.size() > most_recent) room.recent.pop_front();
  }
  const auto pages = room.pages;
  for (const auto& page : pages) page->send({{"events", events}});
}

void MachineRooms::leave(const std::shared_ptr<Room>& room, const std::shared_ptr<MachinePage>& page) {
  room->pages.erase(page);
  if (room->steering == page) {
    room->steering = nullptr;
    if (room->session) {
      const Json before = room->session->state();
      const bool job = room->session->job_active();
      const bool moved = before["phase"] != "idle" && before["phase"] != "alarm" && before["phase"] != "paused";
      room->session->hold("The page that steered the machine is gone.");
      if (job) {
        // The port stays open: closing it may reset the board, and with it what the held job needs to go on.
        room->held_because = "The page that steered " + room->machine.name + " vanished in the middle of the job " +
                             before["job"]["name"].get<std::string>() + ": the machine was held, laser off.";
        tell_events(*room, Json::array({{{"event", "note"}, {"text", room->held_because}, {"now_s", 0}}}));
      } else {
        room->session->end(moved ? "The page that steered is gone; what moved was stopped."
                                 : "The page that steered is gone.");
        room->session = nullptr;
        for (const auto& other : room->pages) other->send({{"closed", true}});
      }
    }
  }
  if (room->pages.empty() && !room->session && !room->opening) rooms_.erase(room->machine.id);
}

void MachineRooms::look_for_stops() {
  for (const auto& [id, room] : rooms_)
    if (room->session) room->session->look_for_stop();
}

void MachineRooms::stop() {
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
  while (stopping() && std::chrono::steady_clock::now() < end) {
    io_.restart();
    io_.run_for(50ms);
  }
  for (const auto& session : sessions) session->end("The worker ended.");
  for (const auto& [id, room] : rooms_) room->session = nullptr;
}

}  // namespace formwright
