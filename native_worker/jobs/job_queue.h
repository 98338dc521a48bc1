// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One job after the other in a child process. All calls from the thread that runs `io`.
// A job is done when its result is on the disk. Until then the disk has it as queued, and a worker that starts takes it
// up again, however the earlier one ended.
#include <sys/types.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "jobs/job_store.h"

namespace formwright {

class JobQueue {
 public:
  /// `tell` receives the messages for the pages (docs/job_contract.md, socket).
  /// `solver`: the command line of the solver process, behind the program's name.
  JobQueue(boost::asio::io_context& io, JobStore& store, std::function<void(const Json&)> tell,
           std::vector<std::string> solver);
  ~JobQueue() { stop(); }

  /// Takes up what an earlier worker left. Not before the port is ours: a start that fails runs nothing.
  void start();
  /// Ends the child; the job in it is queued again for the next start. Nothing happens after this.
  void stop();
  void enqueue(const std::string& id);
  void cancel(const std::string& id);
  std::size_t waiting() const { return waiting_.size(); }
  bool running() const { return !running_.empty(); }
  pid_t process() const { return process_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Waiting {
    std::string id;
    Clock::time_point from = {};  // not before
  };
  void start_process();
  void end_process();
  void start_next();
  void run(StoredJob& job);
  void read_line();
  void handle(const Json& message);
  void process_ended();
  void finish(StoredJob& job, Json result);
  bool save_finished();
  void put_back(StoredJob& job, const std::string& sentence, Clock::time_point from = {});
  void rest(const std::string& sentence);
  void wake_at(Clock::time_point time);
  void send(const Json& message);
  void flush();

  boost::asio::io_context& io_;
  JobStore& store_;
  std::function<void(const Json&)> tell_;
  const std::vector<std::string> solver_;
  std::deque<Waiting> waiting_;
  std::string running_;
  pid_t process_ = -1;
  std::unique_ptr<boost::asio::posix::stream_descriptor> input_, output_;  // of the child
  std::string incoming_;
  std::deque<std::string> outgoing_;
  boost::asio::steady_timer patience_;       // after a cancel
  std::string cancelling_;                   // the job that was asked to stop
  bool stopping_ = false;                    // we killed the child ourselves
  std::map<std::string, JobState> unsaved_;  // how jobs ended that the disk did not take yet
  Clock::time_point resting_until_ = {};     // the disk has no room, or the system none for another process
  std::chrono::milliseconds next_rest_;      // doubles until something works again
  boost::asio::steady_timer alarm_;          // for the above, and for jobs that wait for their time
  std::uint64_t oom_kills_before_ = 0;       // before the job that runs
  unsigned generation_ = 0;                  // of the child, so that late answers of a dead one are ignored
};

}  // namespace formwright
