// SPDX-License-Identifier: GPL-3.0-or-later
#include "command_line/flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "base/error.h"

namespace formwright {
namespace {

/// `--flag=value` of a rule's flag as two words: CLI11 would take the next word for an empty value.
std::vector<std::string> separated(const std::vector<std::string>& words, const std::vector<FlagRule>& rules) {
  std::vector<std::string> result;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const bool known =
        equals != std::string::npos && std::any_of(rules.begin(), rules.end(), [&](const FlagRule& rule) {
          return rule.value != FlagRule::Value::none && word.compare(0, equals, rule.name) == 0;
        });
    result.push_back(word.substr(0, known ? equals : std::string::npos));
    if (known) result.push_back(word.substr(equals + 1));
  }
  return result;
}

}  // namespace

FlagValues read_flags(const std::vector<std::string>& words, const std::vector<FlagRule>& rules,
                      const std::function<std::string(const std::string& word)>& unknown) {
  CLI::App app;
  app.set_help_flag();
  app.allow_extras();
  std::vector<CLI::Option*> options;  // one a rule
  for (const FlagRule& rule : rules) {
    CLI::Option* option = rule.value == FlagRule::Value::none ? app.add_flag(rule.name) : app.add_option(rule.name);
    if (rule.value == FlagRule::Value::optional) option->expected(0, 1);
    options.push_back(option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll));
  }
  std::vector<std::string> backwards = separated(words, rules);
  std::reverse(backwards.begin(), backwards.end());
  try {
    app.parse(std::move(backwards));
  } catch (const CLI::ParseError&) {
    // Extra words are allowed and nothing is converted: what is left is a last flag without its value.
    const std::string flag = words.empty() ? std::string() : words.back();
    throw Error(ErrorCode::invalid_input, flag, flag + " needs a value.");
  }
  if (const auto extra = app.remaining(); !extra.empty()) {
    std::string word = extra.front();
    if (word.starts_with("--")) word = word.substr(0, word.find('='));
    throw Error(ErrorCode::invalid_input, word, unknown(word));
  }
  FlagValues values;
  for (std::size_t i = 0; i < rules.size(); ++i) {
    if (options[i]->count() == 0) continue;
    std::vector<std::string> given = options[i]->results();
    for (std::string& value : given)
      if (rules[i].value == FlagRule::Value::none || (rules[i].value == FlagRule::Value::optional && value.empty()))
        value = "on";
    values[rules[i].name] = std::move(given);
  }
  return values;
}

}  // namespace formwright
