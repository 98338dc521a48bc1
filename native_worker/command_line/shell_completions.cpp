// SPDX-License-Identifier: GPL-3.0-or-later
// After the manuals of the shells: bash (Programmable Completion), zsh (zshcompsys, _arguments), fish (complete).
#include "command_line/shell_completions.h"

#include "command_line/command_flags.h"
#include "job/catalog.h"

namespace formwright {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// In single quotes, which bash, zsh and fish read alike but for a quote within.
std::string quoted(const std::string& text, const std::string& quote) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? quote : std::string(1, c);
  return result + "'";
}

std::vector<CommandInfo> all_commands() {
  std::vector<CommandInfo> commands;
  for (const Operation& operation : operations())
    commands.push_back({operation.name, operation.summary, {}, operation_flags(operation)});
  for (const CommandInfo& command : other_commands()) commands.push_back(command);
  for (CommandInfo& command : commands)
    command.flags.push_back({"--help", "", "Show the help.", "", FlagValue::no_value});
  return commands;
}

std::string bash_script() {
  std::string script =
      "# Completions of formwright for bash; made by `formwright completions bash`.\n"
      "_formwright() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]} words=''\n"
      "  COMPREPLY=()\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    command=''\n"
      "    previous=''\n"
      "  fi\n"
      "  case \"$command $previous\" in\n";
  std::string words, names;
  for (const CommandInfo& command : all_commands()) {
    names += command.name + " ";
    std::string flags = joined(command.words);
    for (const FlagInfo& flag : command.flags) {
      flags += " " + flag.name;
      const std::string place = "    '" + command.name + " " + flag.name + "') ";
      const std::string compgen = "mapfile -t COMPREPLY < <(compgen ";
      if (flag.value == FlagValue::choice) script += place + "words='" + joined(flag.choices) + "' ;;\n";
      else if (flag.value == FlagValue::file)
        script += place + "compopt -o filenames; " + compgen + "-f -- \"$word\"); return ;;\n";
      else if (flag.value == FlagValue::folder)
        script += place + "compopt -o filenames; " + compgen + "-d -- \"$word\"); return ;;\n";
      else if (flag.value == FlagValue::none) script += place + "return ;;\n";
    }
    words += "      " + command.name + ") words='" + flags + "' ;;\n";
  }
  return script +
         "    *)\n"
         "      case \"$command\" in\n"
         "      '') words='" +
         names + "--help --version' ;;\n" + words +
         "      esac\n"
         "      ;;\n"
         "  esac\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
         "}\n"
         "complete -F _formwright formwright\n";
}

/// Of an _arguments specification: what may not stand bare in a description or a message.
std::string zsh_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_script() {
  const auto quote = [](const std::string& text) { return quoted(text, "'\\''"); };
  std::string script =
      "#compdef formwright\n"
      "# Completions of formwright for zsh; made by `formwright completions zsh`.\n"
      "_formwright() {\n"
      "  if (( CURRENT == 2 )); then\n"
      "    local -a commands=(\n";
  std::string cases;
  for (const CommandInfo& command : all_commands()) {
    script += "      " + quote(command.name + ":" + command.summary) + "\n";
    cases += "    " + command.name + ")\n      _arguments";
    if (!command.words.empty()) cases += " " + quote("1: :(" + joined(command.words) + ")");
    for (const FlagInfo& flag : command.flags) {
      std::string specification = "*" + flag.name + "[" + zsh_escaped(flag.help) + "]";
      if (flag.value != FlagValue::no_value) specification += ":" + zsh_escaped(flag.placeholder) + ":";
      if (flag.value == FlagValue::file) specification += "_files";
      if (flag.value == FlagValue::folder) specification += "_files -/";
      if (flag.value == FlagValue::choice) specification += "(" + joined(flag.choices) + ")";
      cases += " \\\n        " + quote(specification);
    }
    cases += " ;;\n";
  }
  return script +
         "    )\n"
         "    _describe command commands\n"
         "    return\n"
         "  fi\n"
         "  local command=$words[2]\n"
         "  shift words\n"
         "  (( CURRENT-- ))\n"
         "  case $command in\n" +
         cases +
         "  esac\n"
         "}\n"
         "if [ \"$funcstack[1]\" = _formwright ]; then _formwright \"$@\"; else compdef _formwright formwright; fi\n";
}

std::string fish_script() {
  const auto quote = [](std::string text) {
    std::string escaped;
    for (const char c : text) escaped += c == '\\' ? "\\\\" : std::string(1, c);
    return quoted(escaped, "\\'");
  };
  std::string script =
      "# Completions of formwright for fish; made by `formwright completions fish`.\n"
      "function __formwright_command\n"
      "  set -l words (commandline -opc)\n"
      "  test (count $words) -gt 1; and contains -- $words[2] $argv\n"
      "end\n"
      "complete -c formwright -f\n";
  for (const CommandInfo& command : all_commands()) {
    script += "complete -c formwright -n 'test (count (commandline -opc)) -eq 1' -a " + command.name + " -d " +
              quote(command.summary) + "\n";
    const std::string start = "complete -c formwright -n '__formwright_command " + command.name + "'";
    if (!command.words.empty()) script += start + " -a " + quote(joined(command.words)) + "\n";
    for (const FlagInfo& flag : command.flags) {
      script += start + " -l " + flag.name.substr(2);
      if (flag.value == FlagValue::file) script += " -r -F";
      if (flag.value == FlagValue::folder) script += " -x -a '(__fish_complete_directories)'";
      if (flag.value == FlagValue::choice) script += " -x -a " + quote(joined(flag.choices));
      if (flag.value == FlagValue::none) script += " -x";
      script += " -d " + quote(flag.help) + "\n";
    }
  }
  return script;
}

}  // namespace

std::string shell_completions(const std::string& shell) {
  if (shell == "bash") return bash_script();
  if (shell == "zsh") return zsh_script();
  if (shell == "fish") return fish_script();
  throw Error(ErrorCode::invalid_input, "completions",
              (shell.empty() ? "Name the shell" : "There are no completions for \"" + shell + "\": name one of these") +
                  ": formwright completions bash, zsh or fish.");
}

}  // namespace formwright
