// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// From the fractions that an operation reports to the share of its time that has passed, and what remains.
#include <optional>
#include <vector>

#include "job/progress/time_shares.h"

namespace formwright {

/// Follows one run beside earlier runs of the same operation. Times are seconds since its begin and never fall. Not for
/// several threads.
///
/// Each earlier run foretells what remains: as many times the seconds that have passed as it was itself from there on.
/// It counts the more, the more alike the two spent their time so far, and the less, the longer this run is at a
/// hundredth than the earlier one was. A remaining time is given only while the runs that count agree.
/// Hundredths that took less than a fifth of what was expected were not done (a factorisation that was kept,
/// simulations that were found again); they are left out of both runs.
class ProgressClock {
 public:
  /// `runs`: how earlier runs spent their time. With none, the reported fraction is taken for the share of the time,
  /// and no remaining time is given.
  explicit ProgressClock(std::vector<TimeShares> runs);

  /// The operation reports `fraction` (0 to 1) of its work; smaller ones than before are ignored.
  void report(double fraction, double now_s);

  struct Estimate {
    double passed = 0;                   // share of the time, 0 to 1, never falling
    std::optional<double> seconds_left;  // only while the earlier runs that count agree
  };
  Estimate at(double now_s);

  /// How this run spent its time, until `end_s`; even if that is 0.
  TimeShares measured(double end_s) const;

 private:
  struct Forecast {
    double weight = 0, seconds_left = 0;
    bool known = false;  // from enough of the run, and of one that is not long past this place
  };
  Forecast forecast(const TimeShares& run, double now_s) const;

  struct Entry {
    int hundredth = 0;
    double at_s = 0;
  };
  std::vector<TimeShares> runs_;
  bool nothing_known_;
  std::vector<Entry> entered_{{}};  // hundredths that were reported, in order; the run is in the last one
  double passed_ = 0;
};

}  // namespace formwright
