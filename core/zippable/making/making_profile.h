// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is known to go wrong in one workshop when a ribbon is cut and sewn, as a small JSON file: the next plan makes up
// for it.
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/data/json.h"
#include "zippable/making/making_errors.h"

namespace formwright {

struct MakingProfile {
  std::string name;
  Json parameters = Json::object();  // of MakingErrors, as far as they are known
  std::vector<std::string> from;     // the objects it was learnt from
  std::vector<std::string> notes;
};

/// Throws Error{invalid_input, "profile"}: no such file, an unknown name, a value out of range.
MakingProfile read_making_profile(ByteView json);
std::string write_making_profile(const MakingProfile& profile);

/// `given`, parameters by name, and the profile's where they are not given.
Json with_making_profile(const Json& given, const MakingProfile& profile);

}  // namespace formwright
