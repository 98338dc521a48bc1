// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which causes a plan of measurements would show, as words and as JSON.
#include <string>

#include "base/data/json.h"
#include "evidence/planning/measuring_plan.h"

namespace formwright {

/// "These marks would show ... at usual strength. They would not show ...". `what`: what is measured, a plural.
std::string outlook_sentence(const ForwardModel& model, const MeasuringPlan& plan, const std::string& what);

/// A list: name, label, unit, shows, usual_strength, min_visible_strength, best_visible_strength (null: infinite),
/// closest_cause (null: none), similarity.
Json outlook_json(const ForwardModel& model, const MeasuringPlan& plan);

}  // namespace formwright
