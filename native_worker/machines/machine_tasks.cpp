// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_tasks.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>
#include <iostream>
#include <thread>

#include "base/error.h"
#include "system/files.h"
#include "system/host.h"
#include "system/secret.h"

namespace formwright {
namespace {

constexpr std::size_t max_unfinished = 16, max_kept = 100;
constexpr std::uintmax_t max_kept_bytes = 64 * 1024;

bool is_end(const std::string& state) { return state == "done" || state == "failed" || state == "cancelled"; }

}  // namespace

MachineTask::MachineTask(const Machine& m, std::string k)
    : id(random_hex(16)),
      kind(std::move(k)),
      machine(m),
      submitted_unix_s_(std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count()) {}

MachineTask::MachineTask(const Machine& m, const Json& kept)
    : id(kept.at("id").get<std::string>()),
      kind(kept.at("kind").get<std::string>()),
      machine(m),
      state_(kept.at("state").get<std::string>()),
      sentence_(kept.at("sentence").get<std::string>()),
      fraction_(kept.at("fraction").get<double>()),
      submitted_unix_s_(kept.at("submitted_unix_s").get<double>()),
      result_(kept.value("result", Json())),
      error_(kept.value("error", Json())),
      there_(kept.value("there", Json())) {}

void MachineTask::hand_over(Json there) {
  {
    const std::scoped_lock lock(mutex_);
    there_ = std::move(there);
  }
  if (keep_) keep_();
}

Json MachineTask::handed_over() const {
  const std::scoped_lock lock(mutex_);
  return there_;
}

void MachineTask::say(const std::string& state, const std::string& sentence, double fraction) {
  const std::scoped_lock lock(mutex_);
  state_ = state;
  sentence_ = sentence;
  fraction_ = fraction;
}

void MachineTask::end(const std::string& state, Json result, Json error) {
  const std::scoped_lock lock(mutex_);
  state_ = state;
  result_ = std::move(result);
  error_ = std::move(error);
  sentence_ = error_.is_object() ? error_["message"].get<std::string>() : "Done.";
  if (state == "done") fraction_ = 1;
}

bool MachineTask::finished() const {
  const std::scoped_lock lock(mutex_);
  return is_end(state_);
}

Json MachineTask::json() const {
  const std::scoped_lock lock(mutex_);
  Json json = {{"id", id},
               {"machine", machine.id},
               {"kind", kind},
               {"state", state_},
               {"sentence", sentence_},
               {"fraction", fraction_},
               {"submitted_unix_s", submitted_unix_s_}};
  if (!result_.is_null()) json["result"] = result_;
  if (!error_.is_null()) json["error"] = error_;
  return json;
}

void MachineTasks::keep(const MachineTask& task) const {
  Json kept = task.json();
  kept["there"] = task.handed_over();
  kept["machine_name"] = task.machine.name;
  try {
    std::filesystem::create_directories(folder_);
    write_file(folder_ / (task.id + ".json"), as_bytes(json_text(kept)));
  } catch (const std::exception& error) {
    // The print goes on all the same.
    std::cerr << "formwright: a print is not remembered after a restart: " << error.what() << std::endl;
  }
}

void MachineTasks::add(const Task& task) {
  tasks_.push_front(task);
  for (std::size_t i = tasks_.size(); i-- > max_kept;)
    if (tasks_[i]->finished()) {
      std::error_code ignored;
      std::filesystem::remove(folder_ / (tasks_[i]->id + ".json"), ignored);
      tasks_.erase(tasks_.begin() + static_cast<std::ptrdiff_t>(i));
    }
}

std::vector<MachineTasks::Task> MachineTasks::restore() {
  std::vector<Task> found, going_on;
  std::error_code status;
  for (std::filesystem::directory_iterator it(folder_, status), end; !status && it != end; it.increment(status)) {
    try {
      const Json kept = Json::parse(as_text(*read_file(it->path(), "data", max_kept_bytes)));
      Machine machine;
      machine.id = kept.at("machine").get<std::string>();
      machine.name = kept.at("machine_name").get<std::string>();
      Task task(new MachineTask(machine, kept));
      if (it->path().filename().string() != task->id + ".json") continue;
      task->keep_ = [this, t = task.get()] { keep(*t); };
      found.push_back(std::move(task));
    } catch (const std::exception&) {
      // Half a file of a crash, or no print: left where it is.
    }
  }
  std::sort(found.begin(), found.end(),
            [](const Task& a, const Task& b) { return a->submitted_unix_s_ < b->submitted_unix_s_; });
  const std::scoped_lock lock(mutex_);
  for (const Task& task : found) {
    add(task);
    if (task->finished()) continue;
    if (task->there_.is_object()) {
      going_on.push_back(task);
      continue;
    }
    task->end("failed", nullptr,
              {{"code", to_string(ErrorCode::could_not_solve)},
               {"where", "machine"},
               {"message", "The worker ended before " + task->machine.name +
                               " had confirmed it: see whether it came through before sending it again."}});
    keep(*task);
  }
  return going_on;
}

std::shared_ptr<MachineTask> MachineTasks::start(const Machine& machine, const std::string& kind, Work work,
                                                 std::function<void()> ended) {
  auto task = std::make_shared<MachineTask>(machine, kind);
  if (kind != "slice") task->keep_ = [this, t = task.get()] { keep(*t); };
  {
    const std::scoped_lock lock(mutex_);
    if (std::count_if(tasks_.begin(), tasks_.end(), [](const auto& t) { return !t->finished(); }) >=
        static_cast<std::ptrdiff_t>(max_unfinished))
      return nullptr;
    add(task);
  }
  log_.append(machine, {{"event", "task"}, {"kind", kind}, {"task", task->id}, {"state", "queued"}}, true);
  run(task, std::move(work), std::move(ended));
  return task;
}

void MachineTasks::run(const Task& task, Work work, std::function<void()> ended) {
  boost::asio::post(threads_, [this, task, work = std::move(work), ended = std::move(ended)] {
    const auto fail = [&](ErrorCode code, const std::string& where, const std::string& message) {
      const bool cancelled = code == ErrorCode::cancelled;
      task->end(cancelled ? "cancelled" : "failed", nullptr,
                {{"code", to_string(code)}, {"where", where}, {"message", message}});
    };
    try {
      if (task->cancelled && task->handed_over().is_null()) throw Error(ErrorCode::cancelled, "", "Cancelled.");
      if (task->keep_ && task->handed_over().is_null()) task->keep_();
      Json result = work(*task);
      task->end("done", std::move(result), nullptr);
    } catch (const Error& error) {
      fail(error.code(), error.where(), error.what());
    } catch (const std::bad_alloc&) {
      fail(ErrorCode::out_of_memory, "sha256", "There is not enough memory for this file: make it smaller.");
    } catch (const std::exception& error) {
      fail(ErrorCode::internal, "", std::string("Internal error: ") + error.what());
    }
    if (task->keep_) task->keep_();
    const Json now = task->json();
    log_.append(task->machine,
                {{"event", "task"},
                 {"kind", task->kind},
                 {"task", task->id},
                 {"state", now["state"]},
                 {"text", now["sentence"]}},
                true);
    if (ended) ended();
  });
}

std::shared_ptr<MachineTask> MachineTasks::find(const std::string& machine_id, const std::string& id) const {
  const std::scoped_lock lock(mutex_);
  const auto it = std::find_if(tasks_.begin(), tasks_.end(),
                               [&](const auto& t) { return t->id == id && t->machine.id == machine_id; });
  return it == tasks_.end() ? nullptr : *it;
}

Json MachineTasks::list(const std::string& machine_id) const {
  const std::scoped_lock lock(mutex_);
  Json list = Json::array();
  for (const auto& task : tasks_)
    if (task->machine.id == machine_id) list.push_back(task->json());
  return list;
}

void MachineTasks::stop() {
  std::vector<Task> cancelled;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& task : tasks_) {
      if (task->handed_over().is_object()) continue;
      task->cancelled = true;
      cancelled.push_back(task);
    }
  }
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (std::any_of(cancelled.begin(), cancelled.end(), [](const auto& t) { return !t->finished(); }) &&
         std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

}  // namespace formwright
