// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What a maker can change about a note or a warning.
#include <string>
#include <vector>

#include "base/data/json.h"

namespace formwright {

struct Fix {
  std::string sentence;  // as it stands among the notes or warnings
  std::string label;     // an order of a few words, for a button
  Json parameters;       // new values by name, of the same operation or of one that made its input
};

inline constexpr char fixes_help[] =
    "For some notes and warnings, what helps: the sentence, a label and new values of parameters.";

/// The report's field `fixes`.
inline Json fixes_json(const std::vector<Fix>& fixes) {
  Json list = Json::array();
  for (const Fix& fix : fixes)
    list.push_back({{"sentence", fix.sentence}, {"label", fix.label}, {"parameters", fix.parameters}});
  return list;
}

}  // namespace formwright
