// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a result was made: enough to make it again, and to find the report that belongs to a file.
#include <map>
#include <string>

#include "job/contract/operation.h"

namespace formwright {

/// {"program", "version", "operation", "parameters", "inputs", "job"}: the parameters that were given; for every input
/// its SHA-256 and file name, or its sample; and as "job" 16 digits that only the same job of the same version has.
/// @param parameters  as the job gives them, checked
Json made_by(const Operation& operation, const Json& parameters, const std::map<std::string, InputBlob>& inputs);

/// How every operation's report declares it.
ReportField made_by_field();

/// Notes the record in the output's file, where its format has a place for it; only program, version, operation and job
/// where it is above 2 kB, and only the job in an STL.
void note_made_by(OutputBlob& output, const Json& record);

}  // namespace formwright
