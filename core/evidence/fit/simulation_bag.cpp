// SPDX-License-Identifier: GPL-3.0-or-later
#include "evidence/fit/simulation_bag.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "base/error.h"
#include "base/parallel.h"

namespace formwright {

namespace {

std::vector<double> key_of(const Eigen::VectorXd& u) { return {u.data(), u.data() + u.size()}; }

/// Indices of measurements by object. Other quantities of an object are predicted right after its places, by the same
/// thread: the simulation is there then.
std::vector<std::vector<std::size_t>> by_object(const std::vector<Measurement>& measurements) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<std::size_t> group_of;
  for (std::size_t m = 0; m < measurements.size(); ++m) {
    group_of.push_back(measurements[m].is_place() ? groups.size()
                                                  : group_of[static_cast<std::size_t>(measurements[m].places_index)]);
    if (measurements[m].is_place()) groups.emplace_back();
    groups[group_of[m]].push_back(m);
  }
  return groups;
}

}  // namespace

/// A point that a bag has not been asked for before.
struct SimulationBag::Missing {
  Missing(SimulationBag& b, const Eigen::VectorXd& point)
      : bag(b), u(point), groups(by_object(b.model_.measurements())), made(b.model_.measurements().size()) {}

  bool claimed(std::size_t object, const Context& context) const {
    return bag.model_.claim(static_cast<int>(groups[object].front()), u, context);
  }
  void make(std::size_t object, const Context& context) {
    try {
      for (const std::size_t m : groups[object]) made[m] = bag.model_.predict(static_cast<int>(m), u, context);
      ++simulations;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::could_not_solve) throw;
      failed = true;
    }
  }

  SimulationBag& bag;
  const Eigen::VectorXd& u;
  std::vector<std::vector<std::size_t>> groups;
  Predictions made;
  std::atomic<bool> failed{false};
  std::atomic<int> simulations{0};
};

std::vector<std::vector<std::optional<Predictions>>> SimulationBag::run_together(
    const std::vector<SimulationBag*>& bags, const std::vector<std::vector<Eigen::VectorXd>>& points, Context& context,
    const std::string& stage, const std::vector<std::vector<Eigen::VectorXd>>& ahead) {
  std::vector<std::unique_ptr<Missing>> missing;
  const auto ask = [&](SimulationBag& bag, const Eigen::VectorXd& u) {
    if (bag.known_.emplace(key_of(u), std::nullopt).second) missing.push_back(std::make_unique<Missing>(bag, u));
  };
  for (std::size_t b = 0; b < bags.size(); ++b)
    for (const Eigen::VectorXd& u : points[b]) {
      ask(*bags[b], u);
      if (const auto early = bags[b]->made_ahead_.extract(key_of(u))) bags[b]->simulations_ += early.mapped();
    }
  const std::size_t asked_for = missing.size();
  for (std::size_t b = 0; b < ahead.size(); ++b)
    for (const Eigen::VectorXd& u : ahead[b])
      if (missing.size() < static_cast<std::size_t>(thread_count())) ask(*bags[b], u);
  // One chunk for each object at each point: threads take the next as they get free.
  struct Job {
    Missing* point;
    std::size_t object;
  };
  std::vector<Job> jobs;
  for (const auto& point : missing)
    for (std::size_t object = 0; object < point->groups.size(); ++object) jobs.push_back({point.get(), object});
  const auto job_thread = std::this_thread::get_id();
  std::atomic<std::size_t> done{0};
  std::mutex later_mutex;
  std::vector<std::size_t> later;  // what other processes are at
  const auto make = [&](const Job& job) {
    job.point->make(job.object, context);
    const double fraction = static_cast<double>(++done) / static_cast<double>(jobs.size());
    if (std::this_thread::get_id() == job_thread) context.progress(fraction, stage);
  };
  try {
    context.progress(0, stage);
    if (context.has_helpers()) {
      std::vector<ResultTask> tasks;
      for (const Job& job : jobs)
        if (auto task = job.point->bag.model_.task(static_cast<int>(job.point->groups[job.object].front()),
                                                   job.point->u, context))
          tasks.push_back(std::move(*task));
      context.make_results(tasks, stage);
    }
    // What helpers have made is found here; what they could not make is made.
    parallel_for(jobs.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t j = begin; j < end; ++j) {
        context.check_cancelled();
        if (jobs[j].point->failed) continue;
        if (jobs[j].point->claimed(jobs[j].object, context)) {
          make(jobs[j]);
        } else {
          const std::scoped_lock lock(later_mutex);
          later.push_back(j);
        }
      }
    });
    std::sort(later.begin(), later.end());
    parallel_for(later.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const Job& job = jobs[later[k]];
        while (!job.point->claimed(job.object, context)) {
          context.check_cancelled();
          std::this_thread::sleep_for(std::chrono::milliseconds(30));
        }
        make(job);
      }
    });
  } catch (...) {
    // What was not made must be asked for again.
    for (const auto& point : missing) point->bag.known_.erase(key_of(point->u));
    throw;
  }
  for (std::size_t i = 0; i < missing.size(); ++i) {
    Missing& point = *missing[i];
    if (!point.failed) point.bag.known_[key_of(point.u)] = std::move(point.made);
    if (i < asked_for) point.bag.simulations_ += point.simulations;
    else point.bag.made_ahead_[key_of(point.u)] = point.simulations;
  }
  std::vector<std::vector<std::optional<Predictions>>> result(bags.size());
  for (std::size_t b = 0; b < bags.size(); ++b)
    for (const Eigen::VectorXd& u : points[b]) result[b].push_back(bags[b]->known_[key_of(u)]);
  return result;
}

std::vector<std::optional<Predictions>> SimulationBag::run(const std::vector<Eigen::VectorXd>& points, Context& context,
                                                           const std::string& stage) {
  return std::move(run_together({this}, {points}, context, stage).front());
}

std::optional<Predictions> SimulationBag::run(const Eigen::VectorXd& point, Context& context,
                                              const std::string& stage) {
  return run(std::vector<Eigen::VectorXd>{point}, context, stage).front();
}

}  // namespace formwright
