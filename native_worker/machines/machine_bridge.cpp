// SPDX-License-Identifier: GPL-3.0-or-later
// The routes of docs/machine_bridge.md.
#include "machines/machine_bridge.h"

#include <algorithm>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>

#include "base/error.h"
#include "base/data/json_text.h"
#include "base/sha256.h"
#include "system/files.h"
#include "system/host.h"
#include "machines/print/printer.h"
#include "machines/print/slicer.h"
#include "machines/print/upload.h"
#include "system/machine_errors.h"

namespace formwright {
namespace {

using boost::asio::use_awaitable;
constexpr auto search_lasts = std::chrono::seconds(5);
constexpr std::uintmax_t max_document_bytes = std::uintmax_t{512} << 20;
constexpr double slice_limit_s = 900;

http::status status_of(const Error& error) {
  if (error.where() == "machine" && error.code() == ErrorCode::invalid_input) return http::status::not_found;
  switch (error.code()) {
    case ErrorCode::invalid_input: return http::status::unprocessable_entity;
    case ErrorCode::could_not_solve: return http::status::bad_gateway;
    case ErrorCode::cancelled: return http::status::conflict;
    default: return http::status::internal_server_error;
  }
}

Response refused(const Head& head, const Error& error) {
  return error_response(head, status_of(error), to_string(error.code()), error.where(), error.what());
}
Response accepted(const Head& head, const std::string& id) {
  return text_response(head, http::status::accepted, Json{{"id", id}}.dump());
}
Response too_many(const Head& head) {
  return error_response(head, http::status::too_many_requests, "invalid_input", "",
                        "Too many prints and uploads are under way: let some finish.");
}
Response nothing_here(const Head& head) {
  return error_response(head, http::status::not_found, "invalid_input", "", "There is nothing at this address.");
}

std::string text_in(const Json& order, const char* name, const std::string& otherwise) {
  if (!order.contains(name)) return otherwise;
  if (!order[name].is_string() || order[name].get_ref<const std::string&>().size() > 200)
    refuse(name, std::string(name) + " must be text of up to 200 letters.");
  return order[name].get<std::string>();
}

bool flag_in(const Json& order, const char* name) {
  if (!order.contains(name)) return false;
  if (!order[name].is_boolean()) refuse(name, std::string(name) + " must be true or false.");
  return order[name].get<bool>();
}

void check_names(const Json& order, std::initializer_list<const char*> known) {
  if (!order.is_object()) refuse("", "The request must be a JSON object.");
  for (const auto& [name, value] : order.items())
    if (std::none_of(known.begin(), known.end(), [&](const char* k) { return name == k; }))
      refuse(name.substr(0, 80), "There is no field called " + name.substr(0, 80) + " in this request: leave it out.");
}

PrinterAddress address_of(const Machine& m) { return {m.name, m.url, m.destination}; }

}  // namespace

MachineBridge::MachineBridge(boost::asio::io_context& io, std::filesystem::path data, JobStore& store)
    : io_(io), store_(store), registry_(data), log_(data), tasks_(log_, data), rooms_(acting_, data, store, log_) {}

void MachineBridge::start() {
  for (const auto& task : tasks_.restore()) follow_again(task);
}

void MachineBridge::follow_again(const std::shared_ptr<MachineTask>& task) {
  tasks_.resume(task, [this](MachineTask& running) -> Json {
    const Json there = running.handed_over();
    const auto list = find_machines(registry_);
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const Machine& m) { return m.id == running.machine.id; });
    if (found == list.end())
      throw Error(
          ErrorCode::could_not_solve, "machine",
          running.machine.name + " is no longer connected: check whether its sheets came out before you print again.");
    const int sheets =
        follow_print(address_of(*found), there.at("job_id").get<int>(), running.cancelled,
                     [&](const std::string& state, const std::string& sentence) { running.say(state, sentence); });
    return {{"job_id", there["job_id"]}, {"sheets", sheets}, {"notes", there.value("notes", Json::array())}};
  });
}

void MachineBridge::stop() {
  rooms_.stop();  // first: they move
  tasks_.stop();
  log_.flush();
}

boost::asio::awaitable<void> MachineBridge::serve_socket(beast::tcp_stream stream, Head head, std::string id) {
  std::optional<Machine> found;
  std::optional<TextResponse> refusal;
  try {
    found = co_await machine(id);
    if (found->kind != MachineKind::serial && found->kind != MachineKind::ruida)
      refuse("machine",
             found->name + " cannot be controlled line by line: it is a " + std::string(to_string(found->kind)) + ".");
  } catch (const Error& error) {
    refusal = error_response(head, http::status::not_found, to_string(error.code()), error.where(), error.what());
  }
  if (refusal) co_await refuse_page(std::move(stream), std::move(*refusal));
  else co_await rooms_.serve(std::move(stream), std::move(head), std::move(*found));
}

template <class Result>
boost::asio::awaitable<Result> MachineBridge::aside(boost::asio::thread_pool& threads, std::function<Result()> work) {
  co_return co_await boost::asio::co_spawn(
      threads, [](std::function<Result()> w) -> boost::asio::awaitable<Result> { co_return w(); }(std::move(work)),
      use_awaitable);
}

boost::asio::awaitable<std::vector<Machine>> MachineBridge::machines(bool search_again) {
  if (search_again || std::chrono::steady_clock::now() - found_when_ > search_lasts) {
    const std::function<std::vector<Machine>()> search = [this] { return find_machines(registry_); };
    found_ = co_await aside(looking_, search);
    found_when_ = std::chrono::steady_clock::now();
  }
  co_return found_;
}

boost::asio::awaitable<Machine> MachineBridge::machine(std::string id) {
  if (!is_hex_name(id, 16)) refuse("machine", "There is no machine with this id: see the list of machines.");
  for (const Machine& m : registry_.read())
    if (m.id == id) co_return m;
  for (const bool again : {false, true})
    for (const Machine& m : co_await machines(again))
      if (m.id == id && !m.registered) co_return m;
  refuse("machine",
         "That machine is no longer connected: check that it is plugged in or registered, and look at the list again.");
}

boost::asio::awaitable<Response> MachineBridge::answer(Head head, std::string path, std::string query,
                                                       std::string body) {
  const bool reads = head.method() == http::verb::get || head.method() == http::verb::head;
  std::optional<Error> failed;
  try {
    if (path.empty() && reads) {
      Json list = Json::array();
      for (const Machine& m : co_await machines(query == "search=again")) {
        Json entry = machine_json(m);
        if (const std::string now = rooms_.state_of(m.id); !now.empty()) entry["state"] = now;
        list.push_back(std::move(entry));
      }
      co_return text_response(head, http::status::ok, json_text(list));
    }
    if (path == "/log" && reads) {
      const std::size_t limit = query.starts_with("limit=")
                                    ? static_cast<std::size_t>(std::clamp(std::atoi(query.c_str() + 6), 1, 5000))
                                    : 200;
      const bool lines = query.find("lines=1") != std::string::npos;
      const std::function<std::string()> read = [this, limit, lines] { return json_text(log_.newest(limit, lines)); };
      co_return text_response(head, http::status::ok, co_await aside(looking_, read));
    }
    if (path.size() > 1 && path[0] == '/') {
      const std::size_t end = std::min(path.find('/', 1), path.size());
      co_return co_await answer_machine(head, path.substr(1, end - 1), path.substr(end), body);
    }
  } catch (const Error& error) {
    failed = error;
  }
  co_return failed ? refused(head, *failed) : nothing_here(head);
}

boost::asio::awaitable<Response> MachineBridge::answer_machine(Head head, std::string id, std::string rest,
                                                               std::string body) {
  const Machine m = co_await machine(id);
  const bool reads = head.method() == http::verb::get || head.method() == http::verb::head,
             posts = head.method() == http::verb::post;
  const bool uploads = m.kind == MachineKind::octoprint || m.kind == MachineKind::moonraker,
             elsewhere = uploads || m.kind == MachineKind::printer;
  if (rest.empty() && reads) {
    const std::function<Json()> describe = [this, m] {
      const std::atomic<bool> go_on{false};
      Json json = machine_json(m);
      if (m.kind == MachineKind::printer) json.update(printer_json(describe_printer(address_of(m), go_on)));
      else if (m.kind == MachineKind::octoprint || m.kind == MachineKind::moonraker)
        json.update(upload_machine_state(m, go_on));
      else if (m.kind == MachineKind::slicer) json["profiles"] = slicer_profiles(registry_.data());
      return json;
    };
    boost::asio::thread_pool& threads = elsewhere ? asking_ : looking_;
    co_return text_response(head, http::status::ok, json_text(co_await aside(threads, describe)));
  }
  if (rest == "/jobs" || rest.starts_with("/jobs/")) co_return answer_tasks(head, m, rest.substr(5));
  if (!posts) co_return nothing_here(head);
  const Json order = body.empty() ? Json::object() : parse_json_text(body);
  if (order.is_discarded())
    co_return error_response(head, http::status::bad_request, "invalid_input", "", "The request is not JSON.");
  if (rest == "/print" && m.kind == MachineKind::printer) co_return co_await print(head, m, order);
  if (rest == "/upload" && uploads) co_return co_await upload(head, m, order);
  if (rest == "/stop" && uploads) {
    log_.append(m, {{"event", "command"}, {"command", {{"do", "stop"}}}}, true);
    const std::function<bool()> end = [m] {
      const std::atomic<bool> go_on{false};
      cancel_print(m, go_on);
      return true;
    };
    co_await aside(acting_, end);
    co_return text_response(head, http::status::ok, "{}");
  }
  if (rest == "/slice" && m.kind == MachineKind::slicer) co_return co_await slice(head, m, order);
  refuse("", m.name + " cannot do that: it is a " + std::string(to_string(m.kind)) + ".");
}

boost::asio::awaitable<std::shared_ptr<const Bytes>> MachineBridge::blob(Json order) {
  const std::string hash = text_in(order, "sha256", "");
  if (!is_hex_name(hash, 64)) refuse("sha256", "Give the file's SHA-256, and send the file first.");
  std::error_code status;
  if (!std::filesystem::exists(store_.blob_path(hash), status))
    refuse("sha256", "The file has not arrived: send it again.");
  const std::function<std::shared_ptr<const Bytes>()> read = [hash, path = store_.blob_path(hash)] {
    return read_checked_file(path, hash, "sha256", max_document_bytes);
  };
  co_return co_await aside(looking_, read);
}

boost::asio::awaitable<Response> MachineBridge::print(Head head, Machine m, Json order) {
  check_names(order, {"sha256", "media", "copies", "quality", "mirrored", "title"});
  PrintOrder print;
  print.media = text_in(order, "media", "");
  print.quality = text_in(order, "quality", "normal");
  print.title = text_in(order, "title", "Formwright");
  print.mirrored = flag_in(order, "mirrored");
  if (order.contains("copies")) {
    if (!order["copies"].is_number_integer() || order["copies"] < 1 || order["copies"] > 9999)
      refuse("copies", "copies must be a whole number from 1.");
    print.copies = order["copies"].get<int>();
  }
  const auto document = co_await blob(order);
  const auto task = tasks_.start(m, "print", [m, print, document](MachineTask& running) mutable -> Json {
    print.document = *document;
    const PrintResult result = print_document(
        address_of(m), print, running.cancelled,
        [&](const std::string& state, const std::string& sentence) { running.say(state, sentence); },
        [&](const PrintResult& taken) {
          running.hand_over({{"job_id", taken.job_id}, {"notes", taken.notes}});
        });
    return {{"job_id", result.job_id}, {"sheets", result.sheets}, {"notes", result.notes}};
  });
  co_return task ? accepted(head, task->id) : too_many(head);
}

boost::asio::awaitable<Response> MachineBridge::upload(Head head, Machine m, Json order) {
  check_names(order, {"sha256", "file_name", "print", "confirmed"});
  UploadOrder upload;
  upload.file_name = upload_file_name(text_in(order, "file_name", "job.gcode"));
  upload.print = flag_in(order, "print");
  if (upload.print && !flag_in(order, "confirmed"))
    refuse("confirmed", "The machine would start: somebody standing in front of it must confirm this first.");
  const auto gcode = co_await blob(order);
  const auto task = tasks_.start(m, "upload", [m, upload, gcode](MachineTask& running) mutable -> Json {
    upload.gcode = *gcode;
    running.say("sending", "Sending the file to " + m.name + ".");
    return upload_gcode(m, upload, running.cancelled,
                        [&](double share) { running.say("sending", "Sending the file to " + m.name + ".", share); });
  });
  co_return task ? accepted(head, task->id) : too_many(head);
}

boost::asio::awaitable<Response> MachineBridge::slice(Head head, Machine m, Json order) {
  check_names(order, {"sha256", "profile", "wait"});
  const std::string profile = text_in(order, "profile", "");
  const bool waits = !order.contains("wait") || flag_in(order, "wait");
  const auto model = co_await blob(order);
  auto over = std::make_shared<boost::asio::steady_timer>(io_, std::chrono::steady_clock::time_point::max());
  const auto task = tasks_.start(
      m, "slice",
      [this, model, profile](MachineTask& running) -> Json {
        running.say("slicing", "PrusaSlicer is slicing.");
        const Bytes gcode = slice_model(*model, profile, registry_.data(), slice_limit_s, running.cancelled);
        const std::string hash = sha256_hex(gcode);
        write_file(store_.blob_path(hash), gcode);
        return {{"sha256", hash}, {"bytes", gcode.size()}};
      },
      [over, &io = io_] { boost::asio::post(io, [over] { over->cancel(); }); });
  if (!task) co_return too_many(head);
  if (!waits) co_return accepted(head, task->id);
  boost::system::error_code ignored;
  while (!task->finished()) co_await over->async_wait(boost::asio::redirect_error(use_awaitable, ignored));
  const Json ended = task->json();
  if (ended["state"] != "done")
    co_return text_response(
        head,
        ended["error"]["code"] == "invalid_input" ? http::status::unprocessable_entity : http::status::bad_gateway,
        json_text({{"error", ended["error"]}}));
  Json result = ended["result"];
  result["id"] = task->id;
  co_return text_response(head, http::status::ok, json_text(result));
}

Response MachineBridge::answer_tasks(const Head& head, const Machine& m, const std::string& rest) {
  const bool reads = head.method() == http::verb::get || head.method() == http::verb::head;
  if (rest.empty() && reads) return text_response(head, http::status::ok, json_text(tasks_.list(m.id)));
  const std::size_t end = std::min(rest.find('/', 1), rest.size());
  const auto task = rest.size() > 1 ? tasks_.find(m.id, rest.substr(1, end - 1)) : nullptr;
  if (!task) return error_response(head, http::status::not_found, "invalid_input", "", "There is no such job.");
  if (end == rest.size() && reads) return text_response(head, http::status::ok, json_text(task->json()));
  if (rest.substr(end) == "/cancel" && head.method() == http::verb::post) {
    task->cancelled = true;
    return accepted(head, task->id);
  }
  return nothing_here(head);
}

}  // namespace formwright
