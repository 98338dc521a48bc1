// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Simulations of a job as job arrays of a Slurm cluster: one array for each batch that a fit asks for. Slurm alone says
// when and where a task runs and starts it again when its node fails; results come back through the shared folder.
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "base/context.h"
#include "slurm/slurm_commands.h"
#include "system/files.h"
#include "system/work_places.h"

namespace formwright {

struct SlurmOptions {
  std::vector<std::string> options;  // words for sbatch
  double local_seconds = 5;          // a batch that this computer makes in this time stays here
};

class SlurmEngine {
 public:
  /// `results`: the folder that all nodes share. Throws Error{invalid_input}: "--results" where it cannot be written,
  /// "--engine" where there is no Slurm, or it refuses the options.
  SlurmEngine(SlurmOptions options, const std::filesystem::path& results);
  ~SlurmEngine();
  SlurmEngine(const SlurmEngine&) = delete;
  SlurmEngine& operator=(const SlurmEngine&) = delete;

  /// Makes the engine the host's, and tells `places` what runs where. To be called once; the engine outlives the run.
  void lend_to(Host& host, const std::shared_ptr<WorkPlaces>& places);

  /// What Slurm was given and did not make, so that this computer made it.
  int left_by_slurm() const { return left_by_slurm_; }

 private:
  struct Batch;
  void make(const std::vector<ResultTask>& tasks, const std::function<void(double fraction)>& made_share);
  bool stays_here(const std::vector<ResultTask>& tasks);
  Batch submit(const std::vector<ResultTask>& tasks);
  void wait_for(Batch& batch, const std::function<void(double fraction)>& made_share);
  void learn_from(Batch& batch);
  void show(const Batch& batch);
  void end(Batch& batch);
  [[noreturn]] void refuse_silent(const Batch& batch) const;
  bool cancelled() const { return cancel_requested_ && cancel_requested_(); }
  double seconds_per_work() const { return measured_work_ > 0 ? measured_seconds_ / measured_work_ : 0; }

  const SlurmOptions options_;
  const std::filesystem::path results_path_, folder_;  // folder_: of this run's arrays, within the results
  const ResultFolder results_;
  std::string program_;
  std::function<bool()> cancel_requested_;
  std::shared_ptr<WorkPlaces> places_;
  int batches_ = 0, left_by_slurm_ = 0;
  bool slurm_works_ = false;             // it has made something
  std::vector<SlurmArray> unseen_ends_;  // made whole; their last tasks may still be ending
  std::set<std::string> kept_inputs_;
  std::map<std::string, int> done_by_node_;
  std::mutex measured_mutex_;
  std::map<std::string, double> work_here_;  // of tasks that stay here, by key
  double measured_seconds_ = 0, measured_work_ = 0;
};

}  // namespace formwright
