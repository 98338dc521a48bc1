// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/simulation_bag.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"

namespace formwright {

std::vector<std::optional<Predictions>> SimulationBag::run(const std::vector<Eigen::VectorXd>& points, Context& context,
                                                           const std::string& stage) {
  // Other quantities of an object are predicted right after its places, by the same thread: the simulation is there
  // then.
  const std::vector<Measurement>& measurements = model_.measurements();
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> group_of;
  for (std::size_t m = 0; m < measurements.size(); ++m) {
    group_of.push_back(measurements[m].is_place() ? groups.size()
                                                  : group_of[static_cast<std::size_t>(measurements[m].places_index)]);
    if (measurements[m].is_place()) groups.emplace_back();
    groups[group_of[m]].push_back(m);
  }
  const std::size_t objects = groups.size();
  const auto key = [](const Eigen::VectorXd& u) { return std::vector<double>(u.data(), u.data() + u.size()); };
  std::vector<const Eigen::VectorXd*> missing;
  for (const Eigen::VectorXd& u : points)
    if (known_.emplace(key(u), std::nullopt).second) missing.push_back(&u);

  // One chunk for each object at each point: threads take the next as they get free.
  std::vector<Predictions> made(missing.size(), Predictions(measurements.size()));
  std::vector<std::atomic<bool>> failed(missing.size());
  const auto job_thread = std::this_thread::get_id();
  std::atomic<std::size_t> done{0};
  const std::size_t jobs = missing.size() * objects;
  std::mutex later_mutex;
  std::vector<std::size_t> later;  // what other processes are at
  const auto make = [&](std::size_t job) {
    const std::size_t point = job / objects, object = job % objects;
    try {
      for (const std::size_t m : groups[object])
        made[point][m] = model_.predict(static_cast<int>(m), *missing[point], context);
      ++simulations_;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      failed[point] = true;
    }
    const double fraction = static_cast<double>(++done) / static_cast<double>(jobs);
    if (std::this_thread::get_id() == job_thread) context.progress(fraction, stage);
  };
  const auto claimed = [&](std::size_t job) {
    return model_.claim(static_cast<int>(groups[job % objects].front()), *missing[job / objects], context);
  };
  try {
    context.progress(0, stage);
    if (context.has_helpers()) {
      std::vector<ResultTask> tasks;
      for (std::size_t job = 0; job < jobs; ++job)
        if (auto task = model_.task(static_cast<int>(groups[job % objects].front()), *missing[job / objects], context))
          tasks.push_back(std::move(*task));
      context.make_results(tasks, stage);
    }
    // What helpers have made is found here; what they could not make is made.
    parallel_for(jobs, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t job = begin; job < end; ++job) {
        context.check_cancelled();
        if (failed[job / objects]) continue;
        if (claimed(job)) {
          make(job);
        } else {
          const std::scoped_lock lock(later_mutex);
          later.push_back(job);
        }
      }
    });
    std::sort(later.begin(), later.end());
    parallel_for(later.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        while (!claimed(later[k])) {
          context.check_cancelled();
          std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
        make(later[k]);
      }
    });
  } catch (...) {
    // What was not made must be asked for again.
    for (const Eigen::VectorXd* u : missing) known_.erase(key(*u));
    throw;
  }
  for (std::size_t i = 0; i < missing.size(); ++i)
    if (!failed[i]) known_[key(*missing[i])] = std::move(made[i]);
  std::vector<std::optional<Predictions>> result;
  for (const Eigen::VectorXd& u : points) result.push_back(known_[key(u)]);
  return result;
}

std::optional<Predictions> SimulationBag::run(const Eigen::VectorXd& point, Context& context,
                                              const std::string& stage) {
  return run(std::vector<Eigen::VectorXd>{point}, context, stage).front();
}

}  // namespace formwright
