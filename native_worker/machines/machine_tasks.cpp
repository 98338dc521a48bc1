// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_tasks.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "secret.h"

namespace formwright {
namespace {
constexpr std::size_t most_under_way = 16, most_kept = 100;
}

MachineTask::MachineTask(const Machine& m, std::string k)
    : id(random_hex(16)),
      kind(std::move(k)),
      machine(m),
      submitted_unix_s_(std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count()) {}

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
  return state_ == "done" || state_ == "failed" || state_ == "cancelled";
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

std::shared_ptr<MachineTask> MachineTasks::start(const Machine& machine, const std::string& kind, Work work,
                                                 std::function<void()> ended) {
  auto task = std::make_shared<MachineTask>(machine, kind);
  {
    const std::scoped_lock lock(mutex_);
    if (std::count_if(tasks_.begin(), tasks_.end(), [](const auto& t) { return !t->finished(); }) >=
        static_cast<std::ptrdiff_t>(most_under_way))
      return nullptr;
    tasks_.push_front(task);
    for (std::size_t i = tasks_.size(); i-- > most_kept;)
      if (tasks_[i]->finished()) tasks_.erase(tasks_.begin() + static_cast<std::ptrdiff_t>(i));
  }
  log_.append(machine, {{"event", "task"}, {"kind", kind}, {"task", task->id}, {"state", "queued"}}, true);
  boost::asio::post(threads_, [this, task, work = std::move(work), ended = std::move(ended)] {
    const auto fail = [&](ErrorCode code, const std::string& where, const std::string& message) {
      const bool cancelled = code == ErrorCode::cancelled;
      task->end(cancelled ? "cancelled" : "failed", nullptr,
                {{"code", to_string(code)}, {"where", where}, {"message", message}});
    };
    try {
      if (task->cancelled) throw Error(ErrorCode::cancelled, "", "Cancelled.");
      Json result = work(*task);
      task->end("done", std::move(result), nullptr);
    } catch (const Error& error) {
      fail(error.code(), error.where(), error.what());
    } catch (const std::bad_alloc&) {
      fail(ErrorCode::out_of_memory, "sha256", "There is not enough memory for this file: make it smaller.");
    } catch (const std::exception& error) {
      fail(ErrorCode::internal, "", std::string("Something went wrong that should not have: ") + error.what());
    }
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
  return task;
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
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& task : tasks_) task->cancelled = true;
  }
  const auto all_finished = [&] {
    const std::scoped_lock lock(mutex_);
    return std::all_of(tasks_.begin(), tasks_.end(), [](const auto& t) { return t->finished(); });
  };
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(3);
  while (!all_finished() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

}  // namespace formwright
