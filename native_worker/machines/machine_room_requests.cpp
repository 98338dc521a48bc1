// SPDX-License-Identifier: GPL-3.0-or-later
// What pages ask of a machine that is driven: to open it, to load a job, to command it, to close it.
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "machines/controllers.h"
#include "base/error.h"
#include "system/files.h"
#include "machines/machine_rooms.h"
#include "machines/port/thread_priority.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;

Json error_of(const std::string& code, const std::string& where, const std::string& message, int number) {
  return {{"error", {{"code", code}, {"where", where}, {"message", message}}}, {"n", number}};
}

/// Who watches may still stop or hold a machine that goes wrong.
bool anyone_may(const MachineRequest& request) {
  if (request.kind != MachineRequest::Kind::command || !request.content.contains("do")) return false;
  return request.content["do"] == "stop" || request.content["do"] == "pause";
}

}  // namespace

boost::asio::awaitable<void> MachineRooms::read_requests(RoomHere room, Page page) {
  if (room->session) page->send({{"state", room->session->state()}});
  if (!room->recent.empty())
    page->send({{"events", Json(std::vector<Json>(room->recent.begin(), room->recent.end()))}});
  for (;;) {
    beast::flat_buffer buffer;
    boost::system::error_code error;
    co_await page->stream().async_read(buffer, boost::asio::redirect_error(use_awaitable, error));
    if (error) co_return;
    const int counted = page->next_number();
    std::optional<MachineRequest> request;
    try {
      if (!page->within_rate()) throw Error(ErrorCode::invalid_input, "", "Too many requests at once: wait a second.");
      request = read_machine_request(beast::buffers_to_string(buffer.data()));
    } catch (const Error& refused) {
      page->send(error_of(to_string(refused.code()), refused.where(), refused.what(), counted));
    }
    if (!request) {
      if (!page->bears_malformed()) co_return;  // whatever it is, it is no page of ours
      continue;
    }
    const int number = request->number.value_or(counted);
    if (request->kind != MachineRequest::Kind::load) {
      page->send(co_await answer(room, page, std::move(*request), number));
      continue;
    }
    // A large job takes seconds to read: a stop that follows must not wait behind it.
    boost::asio::co_spawn(io_, answer(room, page, std::move(*request), number),
                          [page](const std::exception_ptr& failed, const Json& answer) {
                            if (!failed) page->send(answer);
                          });
  }
}

boost::asio::awaitable<Json> MachineRooms::answer(RoomHere room, Page page, MachineRequest request, int number) {
  try {
    co_await handle(room, page, std::move(request));
    co_return Json{{"done", number}};
  } catch (const Busy& busy) {
    co_return error_of("busy", "", busy.sentence, number);
  } catch (const Error& refused) {
    co_return error_of(to_string(refused.code()), refused.where(), refused.what(), number);
  } catch (const std::bad_alloc&) {
    co_return error_of(to_string(ErrorCode::out_of_memory), "sha256",
                       "There is not enough memory for this job: make it smaller.", number);
  }
}

boost::asio::awaitable<void> MachineRooms::handle(RoomHere room, Page page, MachineRequest request) {
  const bool steers = room->steering == page;
  if (request.kind == MachineRequest::Kind::open) {
    if (room->steering && !steers)
      throw Busy{"Another page controls " + room->machine.name +
                 ". You can watch it; close that page to control the machine here."};
    co_await open(room, page, std::move(request.content));
    co_return;
  }
  if (!room->session) throw Error(ErrorCode::invalid_input, "do", "The machine is not connected: connect it first.");
  if (!steers && !anyone_may(request))
    throw Busy{room->steering ? "Another page controls " + room->machine.name + ". Only pause and stop work here."
                              : "Take the machine over first: connect it here."};
  switch (request.kind) {
    case MachineRequest::Kind::command:
      if (room->loading > 0 && request.content.value("do", Json()) == "start")
        throw Busy{"The job is still being read: start it once it is loaded."};
      room->session->command(request.content);
      break;
    case MachineRequest::Kind::load:
      if (room->loading > 0) throw Busy{"Another job is still being read: wait until it is loaded."};
      co_await load(room, std::move(request));
      break;
    default:  // close
      room->session->end("The page closed the connection.");
      close(*room);
  }
}

boost::asio::awaitable<void> MachineRooms::load(RoomHere room, MachineRequest request) {
  const auto session = room->session;
  std::size_t bytes = 0;
  const auto read = [&bytes, path = store_.blob_path(request.sha256), sha256 = request.sha256,
                     options = session->options()]() -> boost::asio::awaitable<std::unique_ptr<PreparedJob>> {
    run_this_thread_last();
    std::error_code status;
    if (!std::filesystem::exists(path, status))
      throw Error(ErrorCode::invalid_input, "sha256", "The job has not arrived: send it again.");
    const auto job = read_checked_file(path, sha256, "sha256", max_machine_job_bytes);
    bytes = job->size();
    co_return prepare_job(options, *job);
  };
  ++room->loading;
  std::unique_ptr<PreparedJob> job;
  std::exception_ptr failed;
  try {
    job = co_await boost::asio::co_spawn(reading_, read, use_awaitable);
    if (room->session != session)
      throw Error(ErrorCode::invalid_input, "load", "The machine was disconnected while the job was read.");
    session->load_prepared(request.name, *job, bytes);
  } catch (...) {
    failed = std::current_exception();
  }
  --room->loading;
  // Freeing a hundred thousand lines takes its time, too.
  if (job) boost::asio::post(reading_, [held = std::move(job)] {});
  if (failed) std::rethrow_exception(failed);
}

boost::asio::awaitable<void> MachineRooms::open(RoomHere room, Page page, Json options) {
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
    struct Opened {
      std::unique_ptr<MachineLock> lock;
      std::shared_ptr<MachinePort> port;
    };
    const auto open_port = [&io = io_, data = data_, machine = room->machine,
                            baud]() -> boost::asio::awaitable<Opened> {
      auto lock = std::make_unique<MachineLock>(data, machine);
      co_return Opened{std::move(lock), open_machine_port(io, machine, baud)};
    };
    Opened opened = co_await boost::asio::co_spawn(opening_, open_port, use_awaitable);
    // Its driver holds the job, which is freed where that delays no machine.
    session = std::shared_ptr<MachineSession>(
        new MachineSession(io_, room->machine, options, opened.port, std::move(opened.lock), log_),
        [this](MachineSession* over) {
          auto driver = over->take_driver();
          delete over;
          if (driver) boost::asio::post(reading_, [held = std::move(driver)] {});
        });
  } catch (...) {
    failed = std::current_exception();
  }
  room->opening = false;
  if (failed) {
    if (room->steering == page) room->steering = nullptr;
    std::rethrow_exception(failed);
  }
  if (room->steering != page) {  // it went away meanwhile: nothing was sent yet
    session->end("The page was closed.");
    co_return;
  }
  begin(room, session);
}

}  // namespace formwright
