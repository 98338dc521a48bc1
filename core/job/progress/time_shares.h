// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How an operation's time is spread over the fractions that it reports.
#include <array>
#include <string>
#include <vector>

namespace formwright {

/// Entry k: the share of an operation's time that passes while the fraction it reports is from k to k + 1 hundredths.
/// Entries are not negative and add up to 1.
using TimeShares = std::array<double, 100>;

/// The entry that belongs to a reported fraction; those outside 0 to 1 belong to the first and the last.
int time_share_index(double fraction);

/// Of runs that were measured (usual_time_shares.cpp), on models, sizes and parameters that differ. `alike` is an
/// operation of the catalog with its unusual switches (alike_runs.h); where none was measured with those, the
/// operation's own; empty for an operation that was not measured.
std::vector<TimeShares> usual_time_shares(const std::string& alike);

}  // namespace formwright
