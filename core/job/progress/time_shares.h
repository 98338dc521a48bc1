// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How an operation's time is spread over the fractions that it reports.
#include <array>
#include <string>

namespace formwright {

/// Entry k: the share of an operation's time that passes while the fraction it reports is from k to k + 1 hundredths.
/// Entries are not negative and add up to 1.
using TimeShares = std::array<double, 100>;

/// The entry that belongs to a reported fraction; those outside 0 to 1 belong to the first and the last.
int time_share_index(double fraction);

/// As usually measured for an operation of the catalog (usual_time_shares.cpp); even for one that was not measured.
TimeShares usual_time_shares(const std::string& operation);

/// Half of each: one unusual run does not make all that follow look wrong.
TimeShares mean_of(const TimeShares& a, const TimeShares& b);

}  // namespace formwright
