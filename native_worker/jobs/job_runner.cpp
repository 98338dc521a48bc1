// SPDX-License-Identifier: GPL-3.0-or-later
// The child process of the worker: one JSON message a line in, one a line out.
//   in:  {"run": id, "job": message, "blobs": {sha256: path}, "outputs": folder, "results": folder, "time_shares"?:
//   bool}
//        | {"cancel": id}
//   out: {"progress": id, ...}
//        | {"finished": id, "result": message, "altered_blobs": [sha256, ...], "stuck"?: true, "time_shares"?:
//        {"alike", "shares"}} | {"finished": id, "not_kept": sentence}: the disk did not take the outputs, the job is
//        to run again
// `stuck`: the solver did not hear that its time was up, and this process takes no further job.
// `time_shares`: how this process's runs of the operation spent their time, for tests/bench/progress.mjs.
// Paths come from the server, which makes them from hashes and identifiers only.
#include <sys/prctl.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <iostream>
#include <mutex>
#include <thread>

#include "base/sha256.h"
#include "system/files.h"
#include "system/host.h"
#include "job/catalog.h"
#include "job/progress/alike_runs.h"
#include "job/progress/timed_host.h"
#include "job/run.h"
#include "jobs/job_runner.h"
#include "jobs/solver_limits.h"
#include "system/work_places.h"

namespace formwright {
namespace {

class Inbox {
 public:
  void read_all() {
    std::string line;
    while (std::getline(std::cin, line)) {
      const Json message = Json::parse(line, nullptr, false);
      const std::scoped_lock lock(mutex_);
      if (message.contains("cancel")) {
        // It may overtake the job it is about, which is still in the line.
        cancelled_id_ = message["cancel"].get<std::string>();
        if (cancelled_id_ == running_) cancel_ = true;
      } else if (message.contains("run")) {
        waiting_.push_back(message);
        arrived_.notify_one();
      }
    }
    // The server is gone: nobody waits for an answer.
    std::_Exit(0);
  }
  Json next() {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return !waiting_.empty(); });
    Json message = std::move(waiting_.front());
    waiting_.pop_front();
    running_ = message["run"].get<std::string>();
    cancel_ = running_ == cancelled_id_;
    return message;
  }
  bool cancelled() const { return cancel_; }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<Json> waiting_;
  std::string running_, cancelled_id_;
  std::atomic<bool> cancel_{false};
};

void send(const Json& message) {
  static std::mutex one_line;
  const std::string text = json_text(message);
  const std::scoped_lock lock(one_line);
  std::cout << text << std::endl;
}

Json places_json(const std::vector<WorkPlace>& places) {
  Json list = Json::array();
  for (const WorkPlace& place : places)
    list.push_back({{"name", place.name}, {"running", place.running}, {"done", place.done}});
  return list;
}

Json error_message(ErrorCode code, const std::string& sentence) { return error_json({code, "", sentence}); }

Json time_is_up(const SolverOptions& options) {
  return error_message(ErrorCode::could_not_solve,
                       "The job was stopped after " + job_time_text(options) +
                           ": use a smaller model, or start the worker with a larger --max-job-minutes.");
}

/// Watches one job's time. A solver that does not hear of its end is given up, and the process with it.
class TimeLimit {
 public:
  TimeLimit(const SolverOptions& options, const std::string& id)
      : end_(Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                std::chrono::duration<double, std::ratio<60>>(options.max_job_minutes))),
        watch_([this, options, id] { watch(options, id); }) {}
  ~TimeLimit() {
    {
      const std::scoped_lock lock(mutex_);
      over_ = true;
    }
    ended_.notify_one();
    watch_.join();
  }
  bool passed() const { return Clock::now() > end_; }

 private:
  using Clock = std::chrono::steady_clock;
  void watch(const SolverOptions& options, const std::string& id) {
    std::unique_lock lock(mutex_);
    if (ended_.wait_until(lock, end_ + patience, [&] { return over_; })) return;
    send({{"finished", id}, {"result", time_is_up(options)}, {"stuck", true}});
    ::pause();  // until the server ends this process
  }

  static constexpr auto patience = std::chrono::seconds(5);
  const Clock::time_point end_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread watch_;
};

std::string input_of(const Json& job, const std::string& sha256) {
  for (const auto& [name, input] : job["inputs"].items())
    if (input.value("sha256", "") == sha256) return name;
  return "";
}

Json run_one(const Json& request, Session& session, const Host& host, const SolverOptions& options) {
  const Json& blobs = request["blobs"];
  Json altered = Json::array();
  const auto find = [&](const std::string& hash) -> std::shared_ptr<const Bytes> {
    if (!blobs.contains(hash)) return nullptr;
    const std::string name = input_of(request["job"], hash);
    auto bytes = read_file(blobs[hash].get<std::string>(), name);
    if (sha256_hex(*bytes) == hash) return bytes;
    altered.push_back(hash);
    throw Error(ErrorCode::invalid_input, name,
                "The file for the input " + name + " was altered on the disk: send it again.");
  };
  const auto finished = [&](Json result) {
    return Json{{"finished", request["run"]}, {"result", std::move(result)}, {"altered_blobs", altered}};
  };
  try {
    JobResult result = run_job(request["job"], find, session, host);
    if (result.error && result.error->code == ErrorCode::out_of_memory)
      result.error->message = "The job needs more memory than a solver may have (" +
                              std::to_string(solver_memory_mb(options)) +
                              " MB): use a smaller model, or start the worker with a larger --solver-memory-mb.";
    Json answer = result_json(result);
    const std::filesystem::path folder = request["outputs"].get<std::string>();
    for (const OutputBlob& output : result.outputs) {
      write_file(folder / output.name, *output.bytes);
      answer["outputs"][output.name]["sha256"] = sha256_hex(*output.bytes);
    }
    return finished(std::move(answer));
  } catch (const StorageError& error) {
    return {{"finished", request["run"]}, {"not_kept", error.what()}};
  } catch (const Error& error) {
    return finished(error_json({error.code(), error.where(), error.what()}));
  } catch (const std::exception& error) {
    return finished(
        error_json({ErrorCode::internal, "", std::string("The results could not be kept: ") + error.what()}));
  }
}

}  // namespace

int run_jobs_for_server(const std::vector<std::string>& words) {
  const SolverOptions options = read_solver_words(words);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // Ctrl+C in the terminal is the server's to handle
  std::signal(SIGHUP, SIG_IGN);  // and so is its end: the job would count as failed
  std::signal(SIGTERM, SIG_DFL);
  limit_solver(options);
  Inbox inbox;
  std::thread([&] { inbox.read_all(); }).detach();
  Session session;
  for (;;) {
    const Json request = inbox.next();
    const std::string id = request["run"].get<std::string>();
    const std::string results = request.value("results", "");
    Json answer;
    {
      const TimeLimit time(options, id);
      Host host{[&](const Progress& p) {
                  send({{"progress", id},
                        {"fraction", p.fraction},
                        {"stage", p.stage},
                        {"seconds_left", p.seconds_left ? Json(*p.seconds_left) : Json(nullptr)},
                        {"places", places_json(p.places)}});
                },
                [&] { return inbox.cancelled() || time.passed(); }, peak_memory_mb};
      if (!results.empty()) share_results(ResultFolder(results), host);
      // A thread of its own, since what is forbidden to a thread cannot be allowed again for the next job.
      std::thread([&] {
        limit_job(options, request["outputs"].get<std::string>(), results);
        answer = run_one(request, session, host, options);
      }).join();
    }
    if (answer.contains("result")) {
      Json& result = answer["result"];
      const bool cancelled = result.contains("error") && result["error"]["code"] == to_string(ErrorCode::cancelled);
      if (cancelled && !inbox.cancelled()) result = time_is_up(options);
    }
    if (request.value("time_shares", false)) {
      const Operation* operation = find_operation(request["job"]["operation"].get<std::string>());
      const std::string alike =
          operation ? alike_runs(*operation, request["job"].value("parameters", Json::object())) : "";
      const auto shares = learned_time_shares(alike, session);
      answer["time_shares"] = shares ? Json({{"alike", alike}, {"shares", shares->back()}}) : Json(nullptr);
    }
    send(answer);
  }
}

}  // namespace formwright
