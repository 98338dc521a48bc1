// SPDX-License-Identifier: GPL-3.0-or-later
// After groff_man(7).
#include "command_line/manual_page.h"

#include "command_line/command_flags.h"
#include "command_line/command_line.h"
#include "job/catalog.h"

namespace formwright {
namespace {

/// Text that roff reads as it stands: a line may not begin with its control characters.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\') result += "\\e";
    else if (c == '-') result += "\\-";
    else if (c == '\n') result += ' ';
    else result += c;
  }
  return (result.starts_with('.') || result.starts_with('\'') ? "\\&" : "") + result;
}

std::string tagged(const std::string& tag, const std::string& value, const std::string& text) {
  return ".TP\n\\fB" + roff(tag) + "\\fR" + (value.empty() ? "" : " \\fI" + roff(value) + "\\fR") + "\n" + roff(text) +
         "\n";
}

std::string flag_entries(const std::vector<FlagInfo>& flags) {
  std::string text, group;
  for (const FlagInfo& flag : flags) {
    if (flag.group != group) text += ".PP\n" + roff(flag.group) + ":\n";
    group = flag.group;
    text += tagged(flag.name, flag.placeholder, flag.help);
  }
  return text;
}

}  // namespace

std::string manual_page() {
  std::string text = ".\\\" Made by `formwright manual`.\n.TH FORMWRIGHT 1 \"\" \"formwright " +
                     std::string(version()) +
                     "\" \"User Commands\"\n"
                     ".SH NAME\nformwright \\- from a 3D model to something that can be made\n"
                     ".SH SYNOPSIS\n"
                     "\\fBformwright\\fR \\fIOPERATION\\fR \\fB\\-\\-out\\fR \\fIDIR\\fR [\\fIflags\\fR]\n.br\n"
                     "\\fBformwright\\fR \\fICOMMAND\\fR [\\fIflags\\fR]\n"
                     ".SH DESCRIPTION\n"
                     "Each operation reads files, computes and writes its outputs and report.json into a folder.\n"
                     "Operations are the same as in the page that \\fBformwright serve\\fR shows in a browser.\n"
                     ".SH COMMANDS\n";
  for (const CommandInfo& command : other_commands()) {
    text += ".SS " + command.name + "\n" + roff(command.summary) + "\n";
    text += flag_entries(command.flags);
  }
  text += ".SH OPERATIONS\n";
  for (const Operation& operation : operations()) {
    text +=
        ".SS " + operation.name + "\n" + roff(operation.summary) + "\n.PP\n" + roff(operation_usage(operation)) + "\n";
    text += flag_entries(operation_flags(operation));
  }
  text += ".SH EXIT STATUS\n" + tagged("0", "", "Done.") +
          tagged("2", "", "Bad input, or a job that does not fit the machine.") +
          tagged("3", "", "It could not be solved.") + tagged("130", "", "Cancelled.") + ".SH FILES\n" +
          tagged("$XDG_DATA_HOME/formwright", "", "Jobs and results of the worker and the added machines (--data).");
  return text;
}

}  // namespace formwright
