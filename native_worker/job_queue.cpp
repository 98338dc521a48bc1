// SPDX-License-Identifier: GPL-3.0-or-later
#include "job_queue.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <csignal>

#include "base/error.h"

namespace formwright {
namespace {

// A solver answers a cancel within a second; one that does not is stuck and goes with its process.
constexpr auto cancel_patience = std::chrono::milliseconds(1500);
constexpr int most_attempts = 2;

Json error_message(const char* code, const std::string& sentence) {
  return {{"error", {{"code", code}, {"where", ""}, {"message", sentence}}}};
}

}  // namespace

JobQueue::JobQueue(boost::asio::io_context& io, JobStore& store, std::function<void(const Json&)> tell,
                   std::vector<std::string> solver)
    : io_(io), store_(store), tell_(std::move(tell)), solver_(std::move(solver)), patience_(io) {}

void JobQueue::start() {
  for (const std::string& id : store_.unfinished_oldest_first()) waiting_.push_back(id);
  start_next();
}

void JobQueue::stop() {
  ++generation_;
  patience_.cancel();
  waiting_.clear();
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
  if (StoredJob* job = running_.empty() ? nullptr : store_.find(running_)) {
    job->state = JobState::queued;
    --job->attempts;  // it did not end the process; we did
    store_.save(*job);
  }
  running_.clear();
}

void JobQueue::enqueue(const std::string& id) {
  waiting_.push_back(id);
  start_next();
}

void JobQueue::cancel(const std::string& id) {
  StoredJob* job = store_.find(id);
  if (!job || job->finished()) return;
  if (id != running_) {
    std::erase(waiting_, id);
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
  process_ = ::fork();
  if (process_ < 0) {
    for (const int descriptor : {to_child[0], to_child[1], from_child[0], from_child[1]}) ::close(descriptor);
    throw Error(ErrorCode::internal, "",
                "The solver process could not be started: the system has no room for another.");
  }
  if (process_ == 0) {
    ::dup2(to_child[0], STDIN_FILENO);
    ::dup2(from_child[1], STDOUT_FILENO);
    // Sockets of pages are not its: one that it kept open would never end for the browser, however often we close it.
    ::close_range(STDERR_FILENO + 1, ~0U, CLOSE_RANGE_CLOEXEC);
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
  while (running_.empty() && !waiting_.empty()) {
    const std::string id = waiting_.front();
    waiting_.pop_front();
    StoredJob* job = store_.find(id);
    if (!job || job->finished()) continue;
    if (job->attempts >= most_attempts) {
      finish(*job, error_message(
                       "internal",
                       "This job stopped the solver twice and is not tried again: simplify the model, and report it."));
      continue;
    }
    try {
      if (process_ <= 0) start_process();
    } catch (const std::exception& error) {
      finish(*job, error_message("internal", error.what()));
      continue;
    }
    ++job->attempts;
    job->state = JobState::running;
    store_.save(*job);
    if (job->finished()) {  // the disk is full: said in the job already
      tell_({{"type", "finished"}, {"id", id}, {"state", to_string(job->state)}, {"error", job->result["error"]}});
      continue;
    }
    running_ = id;
    Json blobs = Json::object();
    const Json inputs = job->job.value("inputs", Json::object());
    for (const auto& [name, input] : inputs.items())
      if (input.contains("sha256") && std::filesystem::exists(store_.blob_path(input["sha256"].get<std::string>())))
        blobs[input["sha256"].get<std::string>()] = store_.blob_path(input["sha256"].get<std::string>()).string();
    send({{"run", id},
          {"job", job->job},
          {"blobs", blobs},
          {"outputs", store_.outputs_folder(id).string()},
          {"results", store_.results_folder().string()}});
  }
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
                     {"seconds_left", message["seconds_left"]}};
    if (StoredJob* job = store_.find(running_))
      job->progress = {
          {"fraction", message["fraction"]}, {"stage", message["stage"]}, {"seconds_left", message["seconds_left"]}};
    tell_(progress);
  } else if (message.contains("finished") && message["finished"] == running_) {
    StoredJob* job = store_.find(running_);
    running_.clear();
    cancelling_.clear();
    patience_.cancel();
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
  const bool stopped_by_us = stopping_;
  const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL;
  stopping_ = false;
  cancelling_.clear();
  patience_.cancel();
  StoredJob* job = running_.empty() ? nullptr : store_.find(running_);
  running_.clear();
  if (job && stopped_by_us)
    finish(*job, error_message("cancelled", "Cancelled; the solver process had to be stopped."));
  else if (job && killed)
    finish(
        *job,
        error_message(
            "out_of_memory",
            "The system stopped the solver process, most likely for lack of memory: use a smaller model. Nothing else is lost."));
  else if (job)
    finish(
        *job,
        error_message(
            "internal",
            "The solver process stopped unexpectedly. Nothing else is lost; try a smaller model, and report this one."));
  start_next();
}

void JobQueue::finish(StoredJob& job, Json result) {
  const Json error = result.value("error", Json());
  job.state = !error.is_object()                       ? JobState::done
              : error.value("code", "") == "cancelled" ? JobState::cancelled
                                                       : JobState::failed;
  job.result = std::move(result);
  job.progress = nullptr;
  store_.save(job);
  Json message = {{"type", "finished"}, {"id", job.id}, {"state", to_string(job.state)}};
  if (job.result.contains("error")) message["error"] = job.result["error"];
  else message["result"] = job.result;
  tell_(message);
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
