// SPDX-License-Identifier: GPL-3.0-or-later
#include "slurm/slurm_engine.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "base/sha256.h"
#include "slurm/finished_tasks.h"
#include "slurm/task_list.h"
#include "system/host.h"

namespace formwright {
namespace {

using Clock = std::chrono::steady_clock;

/// Of the time that a batch must be worth to be sent: how much one task makes of it. A batch of that time keeps twice
/// as many tasks as this computer has cores busy.
constexpr double share_of_local_seconds = 0.5;
/// Slurm's own default allows indices up to 1000 (slurm.conf(5), MaxArraySize).
constexpr std::size_t max_shares = 1000;
/// How often the folder and the queue are looked at.
constexpr auto look_period = std::chrono::milliseconds(100);
constexpr double queue_period_s = 1, max_queue_period_s = 10;
/// How long a network folder may take to show what another computer has written.
constexpr double folder_delay_s = 5;
/// A controller may be restarted meanwhile; the tasks go on without it.
constexpr double max_silence_s = 600;
/// How long a task may take from keeping its last result to its end.
constexpr double noting_s = 0.5;
/// How long Slurm may take to end cancelled tasks; then it does so without us.
constexpr double max_ending_s = 60;

constexpr std::string_view script = "#!/bin/sh\nexec \"$@\"\n";

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

std::filesystem::path own_program() {
  std::error_code status;
  const auto path = std::filesystem::read_symlink("/proc/self/exe", status);
  if (status)
    throw Error(ErrorCode::invalid_input, "--engine", "--engine slurm: /proc is needed to find this program.");
  return path;
}

std::string run_name() {
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  return sha256_hex(as_bytes(machine_name() + " " + std::to_string(::getpid()) + " " + std::to_string(now)))
      .substr(0, 12);
}

}  // namespace

struct SlurmEngine::Batch {
  std::filesystem::path folder;
  SlurmArray array;
  std::vector<std::vector<ListedTask>> shares;
  std::map<std::string, double> work;  // of every simulation, by key
  std::set<std::string> missing;
  std::map<std::string, FinishedTask> finished;
  std::vector<QueuedTask> queue;
  bool over = false;  // nothing of it is in Slurm's queue any more
};

SlurmEngine::SlurmEngine(SlurmOptions options, const std::filesystem::path& results)
    : options_(std::move(options)),
      results_path_(std::filesystem::absolute(results).lexically_normal()),
      folder_(results_path_ / ("slurm-" + run_name())),
      results_(results_path_),
      program_(own_program().string()) {
  try {
    make_folder(folder_);
    write_file(folder_ / "task.sh", as_bytes(script));
  } catch (const Error& error) {
    throw Error(ErrorCode::invalid_input, "--results",
                "--engine slurm needs a folder that every node can write to, and --results " + results_path_.string() +
                    " is none: " + error.what());
  }
  try {
    for (const char* name : {"sbatch", "squeue", "scancel"}) run_program({name, "--version"}, max_ending_s);
    check_slurm(options_.options, folder_ / "task.sh");
  } catch (const Error&) {
    remove_for_good(folder_);
    throw;
  }
}

SlurmEngine::~SlurmEngine() {
  try {
    // A task that was started again although its first start had kept everything.
    cancel_arrays(unseen_ends_);
  } catch (const Error&) {
    // Without scancel there is nothing more to do: such a task finds its work done, and ends.
  }
  remove_for_good(folder_);
}

void SlurmEngine::lend_to(Host& host, const std::shared_ptr<WorkPlaces>& places) {
  places_ = places;
  cancel_requested_ = host.cancel_requested;
  places_->on_made_here = [this](const std::string& key, double seconds) {
    const std::scoped_lock lock(measured_mutex_);
    const auto known = work_here_.find(key);
    if (known == work_here_.end()) return;
    measured_seconds_ += seconds;
    measured_work_ += known->second;
    work_here_.erase(known);
  };
  host.make_results = [this](const std::vector<ResultTask>& tasks, const std::function<void(double)>& made_share) {
    make(tasks, made_share);
  };
}

/// What is not known yet stays here where that costs no more than one simulation: its time is measured then.
bool SlurmEngine::stays_here(const std::vector<ResultTask>& tasks) {
  const std::scoped_lock lock(measured_mutex_);
  const double threads = thread_count();
  double work = 0;
  for (const ResultTask& task : tasks) work += task.work;
  const bool few = static_cast<double>(tasks.size()) <= threads;
  const double rounds = std::ceil(static_cast<double>(tasks.size()) / threads);
  const double expected_s = rounds * work / static_cast<double>(tasks.size()) * seconds_per_work();
  const bool here = options_.local_seconds > 0 && (measured_work_ > 0 ? expected_s <= options_.local_seconds : few);
  if (here)
    for (const ResultTask& task : tasks) work_here_[task.key] = task.work;
  return here;
}

void SlurmEngine::make(const std::vector<ResultTask>& tasks, const std::function<void(double fraction)>& made_share) {
  // A batch may name a simulation twice.
  std::vector<ResultTask> once;
  std::set<std::string> keys;
  for (const ResultTask& task : tasks)
    if (keys.insert(task.key).second) once.push_back(task);
  if (stays_here(once)) return;
  Batch batch = submit(once);
  try {
    wait_for(batch, made_share);
  } catch (...) {
    end(batch);
    throw;
  }
  end(batch);
  if (batch.missing.size() < batch.work.size()) slurm_works_ = true;
  else if (!slurm_works_) refuse_silent(batch);
  left_by_slurm_ += static_cast<int>(batch.missing.size());
  remove_for_good(batch.folder);
}

SlurmEngine::Batch SlurmEngine::submit(const std::vector<ResultTask>& tasks) {
  Batch batch;
  batch.folder = folder_ / std::to_string(batches_);
  std::vector<ListedTask> list;
  std::vector<double> work;
  for (const ResultTask& task : tasks) {
    const std::string input_key = sha256_hex(*task.input);
    if (kept_inputs_.insert(input_key).second) results_.keep(input_key, *task.input);
    list.push_back({task.key, task.recipe, input_key});
    work.push_back(task.work);
    batch.work[task.key] = task.work;
    batch.missing.insert(task.key);
  }
  const double rate = [this] {
    const std::scoped_lock lock(measured_mutex_);
    return seconds_per_work();
  }();
  batch.shares = shares_of(list, work, rate, share_of_local_seconds * options_.local_seconds, max_shares);
  make_folder(batch.folder);
  write_task_list(batch.folder / "tasks", batch.shares);
  batch.array = submit_array(folder_.filename().string() + "-" + std::to_string(batches_), batch.shares.size(),
                             options_.options, batch.folder,
                             {(folder_ / "task.sh").string(), program_, "run-simulations", "--results",
                              results_path_.string(), "--tasks", (batch.folder / "tasks").string()});
  ++batches_;
  return batch;
}

void SlurmEngine::wait_for(Batch& batch, const std::function<void(double fraction)>& made_share) {
  const auto start = Clock::now();
  auto asked = start, answered = start;
  std::optional<Clock::time_point> over;
  double period_s = queue_period_s;
  while (!batch.missing.empty()) {
    if (cancelled()) throw Error(ErrorCode::cancelled, "", "Cancelled.");
    const std::size_t before = batch.missing.size();
    std::error_code status;
    std::erase_if(batch.missing, [&](const std::string& key) {
      return std::filesystem::is_regular_file(results_path_ / key, status);
    });
    if (batch.missing.size() != before) learn_from(batch);
    if (!over && seconds_since(asked) >= period_s) {
      asked = Clock::now();
      // Long waits are asked after less often.
      period_s = std::min(max_queue_period_s, std::max(queue_period_s, 0.02 * seconds_since(start)));
      if (auto queue = queued_tasks(batch.array)) {
        batch.queue = std::move(*queue);
        answered = Clock::now();
        if (batch.queue.empty()) over = answered;
      } else if (seconds_since(answered) > max_silence_s) {
        throw Error(ErrorCode::invalid_input, "--engine",
                    "--engine slurm: squeue has not answered for ten minutes: start the command again when it does.");
      }
    }
    show(batch);
    made_share(1 - static_cast<double>(batch.missing.size()) / static_cast<double>(batch.work.size()));
    if (over && seconds_since(*over) > folder_delay_s) break;
    std::this_thread::sleep_for(look_period);
  }
  batch.over = over.has_value();
}

void SlurmEngine::learn_from(Batch& batch) {
  const std::scoped_lock lock(measured_mutex_);
  for (std::size_t task = 0; task < batch.shares.size(); ++task) {
    const auto& share = batch.shares[task];
    const bool has_news = std::any_of(share.begin(), share.end(), [&](const ListedTask& one) {
      return !batch.missing.contains(one.key) && !batch.finished.contains(one.key);
    });
    if (!has_news) continue;
    for (const auto& [key, one] : read_finished(batch.folder / ("finished-" + std::to_string(task)))) {
      if (!batch.work.contains(key) || !batch.finished.emplace(key, one).second) continue;
      ++done_by_node_[one.node];
      measured_seconds_ += one.seconds;
      measured_work_ += batch.work.at(key);
    }
  }
}

void SlurmEngine::show(const Batch& batch) {
  std::map<std::string, WorkPlace> nodes;
  WorkPlace queue;
  for (const auto& [node, done] : done_by_node_) nodes[node].done = done;
  for (const QueuedTask& task : batch.missing.empty() ? std::vector<QueuedTask>{} : batch.queue) {
    if (task.state == "RUNNING") ++nodes[task.node].running;
    if (task.state != "PENDING") continue;
    ++queue.waiting;
    queue.name = "Slurm's queue" + (task.reason.empty() || task.reason == "None" ? "" : " (" + task.reason + ")");
  }
  std::vector<WorkPlace> places;
  for (auto& [name, place] : nodes) {
    place.name = name;
    places.push_back(place);
  }
  if (queue.waiting > 0) places.push_back(queue);
  places_->set_engine_places(std::move(places));
}

/// Nothing of it may wait or run on where the run ends; a task that has kept its last result ends by itself.
void SlurmEngine::end(Batch& batch) {
  const auto start = Clock::now();
  if (batch.missing.empty()) {
    while (batch.finished.size() < batch.work.size() && seconds_since(start) < noting_s) {
      std::this_thread::sleep_for(look_period / 5);
      learn_from(batch);
    }
    unseen_ends_.push_back(batch.array);
  }
  while (!batch.missing.empty() && !batch.over && seconds_since(start) < max_ending_s) {
    cancel_arrays({batch.array});
    std::this_thread::sleep_for(look_period);
    const auto queue = queued_tasks(batch.array);
    batch.over = queue && queue->empty();
  }
  learn_from(batch);
  batch.queue.clear();
  show(batch);
}

void SlurmEngine::refuse_silent(const Batch& batch) const {
  std::string words;
  for (std::size_t task = 0; task < batch.shares.size() && words.empty(); ++task) {
    std::ifstream log(batch.folder / ("log-" + std::to_string(task)));
    words = last_words({std::istreambuf_iterator<char>(log), std::istreambuf_iterator<char>()});
  }
  throw Error(ErrorCode::invalid_input, "--engine",
              "--engine slurm: none of the " + std::to_string(batch.work.size()) + " simulations of job " +
                  batch.array.job + " came back" +
                  (words.empty() ? ": " + results_path_.string() + " (--results) and " + program_ +
                                       " must have these names on every node."
                                 : ", and a task says \"" + words + "\"."));
}

}  // namespace formwright
