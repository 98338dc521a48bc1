// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/progress/progress_clock.h"

#include <algorithm>

namespace formwright {

namespace {

/// Below two seconds a figure is read no sooner than the end comes.
constexpr double min_elapsed_s = 2, min_counted = 0.04;
/// Estimates of the end made during this last part of the elapsed time must agree to this factor.
constexpr double recent = 0.2, agreement = 1.3;
/// Beyond what was expected for the hundredth it is in, as a share of the whole.
constexpr double max_overdue = 0.1;
constexpr double not_done = 0.2;

}  // namespace

ProgressClock::ProgressClock(const TimeShares& shares) : shares_(shares) {}

void ProgressClock::finish_until(int index, double now_s) {
  const double took_s = now_s - entered_s_;
  spent_[static_cast<std::size_t>(index_)] += took_s;
  double share = 0;
  for (int k = index_; k < index; ++k) share += shares_[static_cast<std::size_t>(k)];
  finished_ += share;
  const bool skipped = seconds_of_all_ && share > 0.01 && took_s < not_done * expected_s(share);
  if (!skipped) counted_ += share;
  counted_s_ += took_s;
  if (counted_ > 0) seconds_of_all_ = counted_s_ / counted_;
  index_ = index;
  entered_s_ = now_s;
}

void ProgressClock::report(double fraction, double now_s) {
  const int index = time_share_index(fraction);
  if (index > index_) finish_until(index, now_s);
}

ProgressClock::Estimate ProgressClock::at(double now_s) {
  const double share = shares_[static_cast<std::size_t>(index_)];
  Estimate estimate;
  double overdue = 0;
  double here = 0;
  if (seconds_of_all_ && *seconds_of_all_ > 0) {
    const double by_time = (now_s - entered_s_) / *seconds_of_all_;
    here = std::min(by_time, share);
    overdue = by_time - here;
  }
  passed_ = std::clamp(finished_ + here, passed_, 1.0);
  estimate.passed = passed_;
  if (!seconds_of_all_ || counted_ < min_counted || now_s < min_elapsed_s) return estimate;

  const double left_s = std::max(0.0, 1 - finished_ - here) * *seconds_of_all_;
  ends_.emplace_back(now_s, now_s + left_s);
  const double since_s = (1 - recent) * now_s;
  while (ends_.size() > 1 && ends_[1].first <= since_s) ends_.pop_front();
  if (ends_.front().first > since_s || overdue > max_overdue) return estimate;
  const auto [first, last] =
      std::minmax_element(ends_.begin(), ends_.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  // What remains counts, not the end: near it a small change of the end is a large one of the rest.
  const double min_left_s = first->second - now_s, max_left_s = last->second - now_s;
  if (max_left_s <= agreement * std::max(min_left_s, 0.0) + 0.5) estimate.seconds_left = left_s;
  return estimate;
}

TimeShares ProgressClock::measured(double end_s) const {
  TimeShares shares = spent_;
  shares[static_cast<std::size_t>(index_)] += std::max(0.0, end_s - entered_s_);
  for (double& share : shares) share = end_s > 0 ? share / end_s : 1.0 / static_cast<double>(shares.size());
  return shares;
}

}  // namespace formwright
