// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/progress/progress_clock.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace formwright {

namespace {

/// Before this, what has passed says too little.
constexpr double min_elapsed_s = 1, min_counted = 0.03;
/// Of the logarithms of what remains: where the forecasts are further apart, their mean is no figure.
constexpr double max_deviation = 0.36;
/// The largest difference between the shares of the time that two runs had spent where they reported the same: at this
/// one the earlier run counts for 0.6.
constexpr double usual_distance = 0.12;
/// Where no earlier run counts for more than this, none is like this one.
constexpr double min_weight = 0.1;
/// Nor is one that would have left this hundredth longer ago than this share of its time.
constexpr double max_overdue = 0.1;
/// How much less it counts, by the share of the time since when it would have left.
constexpr double overdue_weight = 4;
/// A part that takes longer than it did goes on for half as long again.
constexpr double overdue_rest = 0.5;
constexpr double not_done = 0.2;
/// Half a second more or less matters to nobody who waits; and the logarithm of nothing is none.
constexpr double min_left_s = 0.5, nothing_s = 0.02;

double sum_of(const TimeShares& shares, int begin, int end) {
  return std::accumulate(shares.begin() + begin, shares.begin() + end, 0.0);
}

}  // namespace

ProgressClock::ProgressClock(std::vector<TimeShares> runs) : runs_(std::move(runs)), nothing_known_(runs_.empty()) {
  if (!nothing_known_) return;
  runs_.emplace_back();
  runs_.back().fill(1.0 / static_cast<double>(runs_.back().size()));
}

void ProgressClock::report(double fraction, double now_s) {
  const int index = time_share_index(fraction);
  if (index > entered_.back().hundredth) entered_.push_back({index, now_s});
}

ProgressClock::Forecast ProgressClock::forecast(const TimeShares& run, double now_s) const {
  double share = 0, seconds = 0;  // of what both runs have done
  std::vector<std::pair<double, double>> reached;
  for (std::size_t k = 0; k + 1 < entered_.size(); ++k) {
    const double its_share = sum_of(run, entered_[k].hundredth, entered_[k + 1].hundredth);
    const double its_seconds = entered_[k + 1].at_s - entered_[k].at_s;
    if (share > 0 && its_share > 0.01 && its_seconds < not_done * its_share * seconds / share) continue;
    share += its_share;
    seconds += its_seconds;
    reached.emplace_back(share, seconds);
  }
  if (!(share > 0) || !(seconds > 0)) return {};
  double distance = 0;
  for (const auto& [at_share, at_seconds] : reached)
    distance = std::max(distance, std::abs(at_share / share - at_seconds / seconds));
  const auto [here, since_s] = entered_.back();
  const double seconds_of_all = seconds / share, expected_s = run[static_cast<std::size_t>(here)] * seconds_of_all,
               overdue_s = std::max(0.0, now_s - since_s - expected_s);
  Forecast forecast;
  forecast.seconds_left = std::max(0.0, expected_s - (now_s - since_s)) +
                          sum_of(run, here + 1, static_cast<int>(run.size())) * seconds_of_all +
                          overdue_rest * overdue_s;
  const double apart = distance / usual_distance;
  forecast.weight = std::exp(-0.5 * apart * apart) / (1 + overdue_weight * overdue_s / now_s);
  forecast.known = share > min_counted && overdue_s <= max_overdue * seconds_of_all;
  return forecast;
}

ProgressClock::Estimate ProgressClock::at(double now_s) {
  std::vector<Forecast> forecasts;
  for (const TimeShares& run : runs_) forecasts.push_back(forecast(run, now_s));
  double weight = 0, sum = 0, squares = 0, sum_of_all = 0, largest = 0;
  for (const Forecast& one : forecasts) {
    if (one.known) largest = std::max(largest, one.weight);
    const double left = std::log(std::max(one.seconds_left, min_left_s));
    weight += one.weight;
    sum += one.weight * left;
    squares += one.weight * left * left;
    sum_of_all += one.weight * std::log(std::max(one.seconds_left, nothing_s));
  }
  if (!(weight > 1e-9)) return {passed_, std::nullopt};
  const double mean = sum / weight, variance = std::max(0.0, squares / weight - mean * mean), left_s = std::exp(mean);
  passed_ = std::clamp(now_s / (now_s + std::exp(sum_of_all / weight)), passed_, 1.0);
  const bool agreed = !nothing_known_ && std::sqrt(variance) <= max_deviation && largest > min_weight;
  return {passed_, agreed && now_s >= min_elapsed_s ? std::optional(left_s) : std::nullopt};
}

TimeShares ProgressClock::measured(double end_s) const {
  TimeShares shares{};
  for (std::size_t k = 0; k < entered_.size(); ++k) {
    const double until_s = k + 1 < entered_.size() ? entered_[k + 1].at_s : end_s;
    shares[static_cast<std::size_t>(entered_[k].hundredth)] += std::max(0.0, until_s - entered_[k].at_s);
  }
  for (double& share : shares) share = end_s > 0 ? share / end_s : 1.0 / static_cast<double>(shares.size());
  return shares;
}

}  // namespace formwright
