// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/job_queue.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <csignal>
#include <iostream>
#include <utility>

#include "base/error.h"
#include "system/files.h"

namespace formwright {
namespace {

// A solver answers a cancel within a second; one that does not is stuck and goes with its process.
constexpr auto cancel_patience = std::chrono::milliseconds(1500);
constexpr std::chrono::milliseconds first_rest{1000}, max_rest{20000};

Json error_message(const char* code, const std::string& sentence) {
  return {{"error", {{"code", code}, {"where", ""}, {"message", sentence}}}};
}

}  // namespace

JobQueue::JobQueue(boost::asio::io_context& io, JobStore& store, std::function<void(const Json&)> tell,
                   std::vector<std::string> solver)
    : io_(io),
      store_(store),
      tell_(std::move(tell)),
      solver_(std::move(solver)),
      patience_(io),
      next_rest_(first_rest),
      alarm_(io) {}

void JobQueue::start() {
  for (const std::string& id : store_.unfinished_oldest_first()) waiting_.push_back({id});
  start_next();
}

void JobQueue::stop() {
  ++generation_;
  patience_.cancel();
  alarm_.cancel();
  waiting_.clear();
  end_process();
  save_finished();
  running_.clear();
}

void JobQueue::end_process() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
  process_ = -1;
  ++generation_;
  input_.reset();
  output_.reset();
}

void JobQueue::enqueue(const std::string& id) {
  waiting_.push_back({id});
  start_next();
}

void JobQueue::cancel(const std::string& id) {
  StoredJob* job = store_.find(id);
  if (!job || job->finished() || unsaved_.contains(id)) return;
  if (id != running_) {
    std::erase_if(waiting_, [&](const Waiting& waiting) { return waiting.id == id; });
    finish(*job, error_message("cancelled", "Cancelled."));
    return;
  }
  if (cancelling_ == id) return;  // asking again does not give it more time
  cancelling_ = id;
  send({{"cancel", id}});
  patience_.expires_after(cancel_patience);
  patience_.async_wait([this, id](const boost::system::error_code& error) {
    if (error || running_ != id) return;
    stopping_ = true;
    ::kill(process_, SIGKILL);
  });
}

void JobQueue::start_process() {
  int to_child[2], from_child[2];
  if (::pipe2(to_child, O_CLOEXEC) != 0)
    throw Error(ErrorCode::internal, "", "No pipe to the solver process could be made.");
  if (::pipe2(from_child, O_CLOEXEC) != 0) {
    ::close(to_child[0]);
    ::close(to_child[1]);
    throw Error(ErrorCode::internal, "", "No pipe to the solver process could be made.");
  }
  // Before the fork: between fork and exec, only what async-signal-safe functions do is safe (fork(2)).
  std::string program = "formwright";
  std::vector<std::string> words = solver_;
  std::vector<char*> arguments{program.data()};
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t worker = ::getpid();
  process_ = ::fork();
  if (process_ < 0) {
    for (const int descriptor : {to_child[0], to_child[1], from_child[0], from_child[1]}) ::close(descriptor);
    throw Error(ErrorCode::internal, "",
                "The solver process could not be started: the system has no room for another.");
  }
  if (process_ == 0) {
    // A solver without its worker would write where the next worker lets the job run again. It ends with the thread
    // that forked it (prctl(2)), which is the jobs'.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != worker) ::_exit(0);
    ::dup2(to_child[0], STDIN_FILENO);
    ::dup2(from_child[1], STDOUT_FILENO);
    // Sockets of pages are not its: one that it kept open would never end for the browser, however often we close it.
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
    ::fcntl(store_.solver_lock(), F_SETFD, 0);  // the next worker waits for it
    ::execv("/proc/self/exe", arguments.data());
    ::_exit(127);
  }
  ::close(to_child[0]);
  ::close(from_child[1]);
  input_ = std::make_unique<boost::asio::posix::stream_descriptor>(io_, to_child[1]);
  output_ = std::make_unique<boost::asio::posix::stream_descriptor>(io_, from_child[0]);
  incoming_.clear();
  outgoing_.clear();
  ++generation_;
  read_line();
}

void JobQueue::start_next() {
  if (Clock::now() < resting_until_) return wake_at(resting_until_);
  if (!save_finished()) return;
  while (running_.empty() && !waiting_.empty()) {
    const auto now = Clock::now();
    const auto due = std::find_if(waiting_.begin(), waiting_.end(), [&](const Waiting& w) { return w.from <= now; });
    if (due == waiting_.end())
      return wake_at(std::min_element(waiting_.begin(), waiting_.end(), [](const Waiting& a, const Waiting& b) {
                       return a.from < b.from;
                     })->from);
    StoredJob* job = store_.find(due->id);
    waiting_.erase(due);
    if (!job || job->finished()) continue;
    try {
      run(*job);
    } catch (const std::exception& error) {
      put_back(*job, error.what());
      return rest(error.what());
    }
  }
}

void JobQueue::run(StoredJob& job) {
  store_.clear_outputs(job.id);
  if (process_ <= 0) start_process();
  oom_kills_before_ = oom_kills();
  job.state = JobState::running;
  job.progress = nullptr;
  running_ = job.id;
  Json blobs = Json::object();
  const Json inputs = job.job.value("inputs", Json::object());
  for (const auto& [name, input] : inputs.items())
    if (input.contains("sha256") && std::filesystem::exists(store_.blob_path(input["sha256"].get<std::string>())))
      blobs[input["sha256"].get<std::string>()] = store_.blob_path(input["sha256"].get<std::string>()).string();
  send({{"run", job.id},
        {"job", job.job},
        {"blobs", blobs},
        {"outputs", store_.outputs_folder(job.id).string()},
        {"results", store_.results_folder().string()}});
}

void JobQueue::put_back(StoredJob& job, const std::string& sentence, Clock::time_point from) {
  job.state = JobState::queued;
  job.progress = {{"fraction", 0}, {"stage", sentence}, {"seconds_left", nullptr}};
  waiting_.push_back({job.id, from});
  tell_({{"type", "progress"}, {"id", job.id}, {"fraction", 0}, {"stage", sentence}, {"seconds_left", nullptr}});
}

void JobQueue::rest(const std::string& sentence) {
  std::cerr << "formwright: " << sentence << " Trying again in " << next_rest_.count() / 1000 << " s." << std::endl;
  resting_until_ = Clock::now() + next_rest_;
  next_rest_ = std::min(2 * next_rest_, max_rest);
  wake_at(resting_until_);
}

void JobQueue::wake_at(Clock::time_point time) {
  alarm_.expires_at(time);
  alarm_.async_wait([this](const boost::system::error_code& error) {
    if (!error) start_next();
  });
}

void JobQueue::read_line() {
  boost::asio::async_read_until(
      *output_, boost::asio::dynamic_buffer(incoming_), '\n',
      [this, generation = generation_](const boost::system::error_code& error, std::size_t length) {
        if (generation != generation_) return;
        if (error == boost::asio::error::operation_aborted) return;
        if (error) return process_ended();
        const Json message = Json::parse(incoming_.substr(0, length), nullptr, false);
        incoming_.erase(0, length);
        if (message.is_object()) handle(message);
        if (generation == generation_) read_line();
      });
}

void JobQueue::handle(const Json& message) {
  if (message.contains("progress") && message["progress"] == running_) {
    Json progress = {{"type", "progress"},
                     {"id", running_},
                     {"fraction", message["fraction"]},
                     {"stage", message["stage"]},
                     {"seconds_left", message["seconds_left"]},
                     {"places", message["places"]}};
    if (StoredJob* job = store_.find(running_))
      job->progress = {{"fraction", message["fraction"]},
                       {"stage", message["stage"]},
                       {"seconds_left", message["seconds_left"]},
                       {"places", message["places"]}};
    tell_(progress);
  } else if (message.contains("finished") && message["finished"] == running_) {
    StoredJob* job = store_.find(running_);
    running_.clear();
    cancelling_.clear();
    patience_.cancel();
    for (const Json& altered : message.value("altered_blobs", Json::array()))
      store_.remove_blob(altered.get<std::string>());
    if (job && message.contains("not_kept")) {
      end_process();  // a fresh one gives the outputs that an undisturbed run gives, to the last digit
      put_back(*job, message["not_kept"].get<std::string>());
      return rest(message["not_kept"].get<std::string>());
    }
    if (job) finish(*job, message["result"]);
    if (message.contains("stuck")) {  // it takes no further job
      ::kill(process_, SIGKILL);
      return process_ended();
    }
    start_next();
  }
}

void JobQueue::process_ended() {
  int status = 0;
  ::waitpid(process_, &status, 0);
  process_ = -1;
  ++generation_;
  input_.reset();
  output_.reset();
  const bool asked = stopping_ || (!running_.empty() && cancelling_ == running_);
  stopping_ = false;
  cancelling_.clear();
  patience_.cancel();
  ResultFolder(store_.results_folder()).remove_abandoned();
  StoredJob* job = running_.empty() ? nullptr : store_.find(running_);
  running_.clear();
  if (job && asked) {
    finish(*job, error_message("cancelled", "Cancelled; the solver process had to be stopped."));
  } else if (job) {
    const SolverDeath death = death_of(status, oom_kills() > oom_kills_before_);
    job->deaths.count(death);
    if (auto verdict = job->deaths.verdict()) {
      finish(*job, std::move(*verdict));
    } else {
      put_back(*job, "The solver process was ended. The job starts again.", Clock::now() + job->deaths.pause());
      if (death == SolverDeath::killed || death == SolverDeath::ended) return start_next();
      try {
        store_.save(*job);
      } catch (const StorageError&) {
        // A worker that starts counts one death less.
      }
    }
  }
  start_next();
}

void JobQueue::finish(StoredJob& job, Json result) {
  const Json error = result.value("error", Json());
  const JobState state = !error.is_object()                       ? JobState::done
                         : error.value("code", "") == "cancelled" ? JobState::cancelled
                                                                  : JobState::failed;
  job.result = std::move(result);
  job.progress = nullptr;
  unsaved_[job.id] = state;
  if (state != JobState::done) store_.discard_outputs(job.id);
  if (state != JobState::done) {  // true whether or not the disk takes it; without that the job runs again some day
    job.state = state;
    tell_({{"type", "finished"}, {"id", job.id}, {"state", to_string(state)}, {"error", error}});
  }
  save_finished();
}

bool JobQueue::save_finished() {
  while (!unsaved_.empty()) {
    const auto [id, state] = *unsaved_.begin();
    StoredJob* job = store_.find(id);
    if (job) {
      const JobState before = std::exchange(job->state, state);
      try {
        store_.save(*job);
      } catch (const StorageError& error) {
        job->state = before;
        if (state == JobState::done)
          job->progress = {{"fraction", 1}, {"stage", error.what()}, {"seconds_left", nullptr}};
        rest(error.what());
        return false;
      }
      job->progress = nullptr;
      if (state == JobState::done)
        tell_({{"type", "finished"}, {"id", id}, {"state", to_string(state)}, {"result", job->result}});
    }
    unsaved_.erase(id);
    next_rest_ = first_rest;
  }
  return true;
}

void JobQueue::send(const Json& message) {
  if (!input_) return;
  outgoing_.push_back(message.dump() + "\n");
  if (outgoing_.size() == 1) flush();
}

void JobQueue::flush() {
  boost::asio::async_write(*input_, boost::asio::buffer(outgoing_.front()),
                           [this, generation = generation_](const boost::system::error_code& error, std::size_t) {
                             if (generation != generation_ || error)
                               return;  // a broken pipe shows as the end of the child's output too
                             outgoing_.pop_front();
                             if (!outgoing_.empty()) flush();
                           });
}

}  // namespace formwright
