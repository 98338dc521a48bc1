// SPDX-License-Identifier: GPL-3.0-or-later
#include "job/operations/evidence/measuring_outlook.h"

#include <cmath>

namespace formwright {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i)
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  return text;
}

}  // namespace

std::string outlook_sentence(const ForwardModel& model, const MeasuringPlan& plan, const std::string& what) {
  std::vector<std::string> shown, hidden;
  for (const CauseOutlook& one : plan.causes)
    (one.shows() ? shown : hidden).push_back("“" + model.causes()[static_cast<std::size_t>(one.cause)].label + "”");
  if (shown.empty()) return what + " would show no cause at its usual strength: measure more, or more exactly.";
  if (hidden.empty()) return what + " would show every cause at its usual strength.";
  return what + " would show " + listed(shown) + " at usual strength. They would not show " + listed(hidden) + ".";
}

Json outlook_json(const ForwardModel& model, const MeasuringPlan& plan) {
  const auto finite = [](double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); };
  Json list = Json::array();
  for (const CauseOutlook& one : plan.causes) {
    const Cause& cause = model.causes()[static_cast<std::size_t>(one.cause)];
    list.push_back({{"name", cause.name},
                    {"label", cause.label},
                    {"unit", cause.unit},
                    {"shows", one.shows()},
                    {"usual_strength", one.usual_strength},
                    {"min_visible_strength", finite(one.min_visible_strength)},
                    {"best_visible_strength", finite(one.best_visible_strength)},
                    {"closest_cause", one.closest_cause < 0
                                          ? Json(nullptr)
                                          : Json(model.causes()[static_cast<std::size_t>(one.closest_cause)].name)},
                    {"similarity", one.similarity}});
  }
  return list;
}

}  // namespace formwright
