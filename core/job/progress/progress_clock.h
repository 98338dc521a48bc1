// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From the fractions that an operation reports to the share of its time that has passed, and what remains.
#include <deque>
#include <optional>
#include <utility>

#include "job/progress/time_shares.h"

namespace formwright {

/// Follows one run. Times are seconds since its begin and never fall. Not for several threads.
///
/// Where the run is, is known by the fractions; how quick it is, by the time that the finished hundredths took against
/// their shares. Hundredths that took less than a fifth of what was expected were not done (a factorisation that was
/// kept, simulations that were found again) and say nothing of the speed.
class ProgressClock {
 public:
  /// `shares`: how the operation usually spends its time.
  explicit ProgressClock(const TimeShares& shares);

  /// The operation reports `fraction` (0 to 1) of its work; smaller ones than before are ignored.
  void report(double fraction, double now_s);

  struct Estimate {
    double passed = 0;                   // share of the time, 0 to 1, never falling
    std::optional<double> seconds_left;  // only while recent estimates of the end agree
  };
  Estimate at(double now_s);

  /// How this run spent its time, until `end_s`; even if that is 0.
  TimeShares measured(double end_s) const;

 private:
  double expected_s(double share) const { return share * *seconds_of_all_; }
  void finish_until(int index, double now_s);

  TimeShares shares_, spent_{};         // spent_: seconds
  int index_ = 0;                       // the hundredth that the run is in
  double finished_ = 0;                 // shares before it
  double entered_s_ = 0;                // when it was entered
  double counted_ = 0, counted_s_ = 0;  // shares that were done, and the seconds they took
  std::optional<double> seconds_of_all_;
  double passed_ = 0;
  std::deque<std::pair<double, double>> ends_;  // when the run was expected to end: time of the estimate, seconds
};

}  // namespace formwright
