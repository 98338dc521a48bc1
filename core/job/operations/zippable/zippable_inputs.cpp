// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/zippable/zippable_inputs.h"

namespace formwright {

InputInfo flat_design_info() {
  InputInfo info;
  info.name = "design";
  info.label = "Design";
  info.help = "The design.json that zippable-design wrote: the flat ribbon, its zipper and the intended shape.";
  info.extensions = {"json"};
  return info;
}

InputInfo making_profile_info() {
  InputInfo info;
  info.name = "profile";
  info.label = "Making profile";
  info.help =
      "The profile.json that evidence-diagnose-zippable wrote: what goes wrong when a plan is cut and sewn. What is given by name counts more.";
  info.extensions = {"json"};
  info.required = false;
  return info;
}

InputInfo plan_record_info() {
  InputInfo info;
  info.name = "plan";
  info.label = "Plan";
  info.help =
      "The plan.json that zippable-plan wrote: how each piece was turned on its sheet. Without it the grain runs along x of the flat ribbon.";
  info.extensions = {"json"};
  info.required = false;
  return info;
}

Json with_making_profile(const OperationCall& call, const Json& given) {
  const auto profile = call.inputs.find("profile");
  return profile == call.inputs.end() ? given : with_making_profile(given, read_making_profile(*profile->second.bytes));
}

}  // namespace formwright
