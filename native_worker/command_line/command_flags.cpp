// SPDX-License-Identifier: GPL-3.0-or-later
#include "command_line/command_flags.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "job/catalog.h"

namespace formwright {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string joined(const std::vector<std::string>& words, const std::string& separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

std::string default_text(const ParameterInfo& info) {
  if (info.default_value.is_null()) return "auto";
  if (info.default_value.is_boolean()) return info.default_value.get<bool>() ? "on" : "off";
  if (info.default_value.is_string()) return info.default_value.get<std::string>();
  if (info.default_value.is_number()) return number(info.default_value.get<double>());
  std::string list;
  for (const Json& item : info.default_value) list += (list.empty() ? "" : ",") + number(item.get<double>());
  return list;
}

FlagInfo parameter_flag(const ParameterInfo& info) {
  FlagInfo flag{flag_name(info), "N", "", info.group.empty() ? "Parameters" : info.group};
  if (info.kind == ParameterKind::choice) flag.choices = info.choices;
  if (info.kind == ParameterKind::boolean) flag.choices = {"on", "off"};
  if (!flag.choices.empty()) {
    flag.value = FlagValue::choice;
    flag.placeholder = joined(flag.choices, "|");
  } else if (info.kind == ParameterKind::vector3) flag.placeholder = "X,Y,Z";
  else if (info.kind == ParameterKind::text) flag.placeholder = "TEXT";
  std::string range;
  if (info.kind == ParameterKind::number || info.kind == ParameterKind::integer ||
      info.kind == ParameterKind::optional_number)
    range = number(info.minimum) + " to " + number(info.maximum) + (info.unit.empty() ? "" : " " + info.unit) + ", ";
  const std::string only_with = info.only_with.empty() ? ""
                                                       : " Only with " + dashed(info.only_with) + " " +
                                                             joined(info.only_with_choices, " or ") + ".";
  flag.help = info.help + only_with + " [" + range + "default " + default_text(info) + "]";
  return flag;
}

FlagInfo preset_flag(const PresetList& list) {
  std::vector<std::string> names;
  for (const Preset& preset : list.presets) names.push_back(preset.name);
  const std::string help = list.help + " Other flags count more. [" + joined(names, ", ") + "]";
  return {dashed(list.name), "NAME", help, list.group, FlagValue::choice, names};
}

FlagInfo input_flag(const InputInfo& input) {
  const bool folder = !input.folder_files.empty();
  return {dashed(input.name), folder ? "DIR" : "FILE",
          input.help + (input.extensions.empty() ? "" : " (" + joined(input.extensions, ", ") + ")") +
              (input.repeatable ? " May be given several times." : ""),
          "Input", folder ? FlagValue::folder : FlagValue::file};
}

std::vector<std::string> sample_names() {
  std::vector<std::string> names;
  const Json catalog = catalog_json();
  for (const Json& sample : catalog["samples"]) names.push_back(sample["name"].get<std::string>());
  return names;
}

std::vector<std::string> operation_names() {
  std::vector<std::string> names;
  for (const Operation& operation : operations()) names.push_back(operation.name);
  return names;
}

std::vector<CommandInfo> make_other_commands() {
  const FlagInfo data{"--data", "DIR", "Where jobs, results and added machines are kept.", "", FlagValue::folder};
  const FlagInfo json{"--json", "", "As JSON.", "", FlagValue::no_value};
  return {
      {"serve",
       "Serves the page and the native worker on this computer only.",
       {},
       {{"--port", "N", "Port of 127.0.0.1; 0 takes any free one. [0 to 65535, default 8731]", ""},
        {"--web", "DIR", "The built page, if it is not beside the program.", "", FlagValue::folder},
        data,
        {"--upload-limit-mb", "N", "Largest file that the page may send. [1 to 65536, default 1024]", ""},
        {"--solver-memory-mb", "N", "Memory that jobs may take. [default three quarters of the computer's]", ""},
        {"--max-job-minutes", "N", "Time that a job may take. [0.01 to 1e+06, default 1440]", ""},
        {"--no-solver-sandbox", "", "Run jobs without Landlock and seccomp.", "", FlagValue::no_value}}},
      {"machine",
       "Printers and machines: list, add, remove, print, send, origin, frame, stop.",
       {"list", "add", "remove", "print", "send", "origin", "frame", "stop"},
       {{"--machine", "NAME", "Name or id of a machine.", ""},
        {"--job", "FILE", "The job to send; several, one after the other.", "", FlagValue::file},
        {"--file", "FILE", "The document to print.", "", FlagValue::file},
        {"--media", "NAME", "Paper to print on, such as A4.", ""},
        {"--copies", "N", "Number of copies. [default 1]", ""},
        {"--quality",
         "draft|normal|high",
         "Quality of the print. [default normal]",
         "",
         FlagValue::choice,
         {"draft", "normal", "high"}},
        {"--mirrored", "", "Print left and right exchanged, for transfers.", "", FlagValue::no_value},
        {"--yes", "", "Do not ask: somebody stands at the machine.", "", FlagValue::no_value},
        {"--z",
         "here|kept",
         "Mills: z 0 is where the tip is now, or stays as set before.",
         "",
         FlagValue::choice,
         {"here", "kept"}},
        {"--axes", "xyz", "Axes whose origin is set.", ""},
        {"--at", "head|corner", "Where the origin is set.", "", FlagValue::choice, {"head", "corner"}},
        {"--name", "NAME", "Name of a machine to add.", ""},
        {"--url", "URL", "Address of a machine to add, such as ipp://HOST/ipp/print or serial:/dev/NAME.", ""},
        {"--kind",
         "octoprint|moonraker",
         "Program that a web address belongs to.",
         "",
         FlagValue::choice,
         {"octoprint", "moonraker"}},
        {"--controller",
         "KIND",
         "Controller of a machine at a port.",
         "",
         FlagValue::choice,
         {"grbl", "grbl_mill", "marlin", "marlin_printer"}},
        {"--baud", "N", "Speed of a serial port.", ""},
        {"--api-key-file", "FILE", "File that holds the key of a printer's server.", "", FlagValue::file},
        {"--bed-x-mm", "N", "Width of the bed in mm.", ""},
        {"--bed-y-mm", "N", "Depth of the bed in mm.", ""},
        data,
        json}},
      {"list", "Lists all operations, one per line.", {}, {json}},
      {"describe", "Describes one operation as JSON: inputs, parameters, outputs and report. All without OP.",
       operation_names()},
      {"completions", "Completions for a shell.", {"bash", "zsh", "fish"}},
      {"manual", "The manual page, for man.", {}},
  };
}

}  // namespace

std::string dashed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

bool takes_object(const Operation& operation) {
  return std::any_of(operation.inputs.begin(), operation.inputs.end(),
                     [](const InputInfo& input) { return input.name == "setup"; });
}

std::vector<FlagInfo> operation_flags(const Operation& operation) {
  std::vector<FlagInfo> flags;
  std::vector<std::string> object_files;
  for (const InputInfo& input : operation.inputs) {
    flags.push_back(input_flag(input));
    if (!input.object_file.empty()) object_files.push_back(input.object_file);
    if (!input.accepts_sample) continue;
    const std::vector<std::string> names = sample_names();
    flags.push_back({"--sample", "NAME", "Uses a built-in sample instead of a file: " + joined(names, ", ") + ".",
                     "Input", FlagValue::choice, names});
    flags.push_back({"--sample-vertices", "N", "Number of vertices of the sample.", "Input"});
  }
  if (takes_object(operation))
    flags.push_back({"--object", "DIR",
                     "The folder of a measured object instead of single files: " + joined(object_files, ", ") + ".",
                     "Input", FlagValue::folder});
  std::string outputs;
  for (const OutputInfo& output : operation.outputs)
    outputs += (outputs.empty() ? "" : ", ") + output.name + (output.made_by_default ? "*" : "");
  flags.push_back({"--out", "DIR", "Folder for the outputs and report.json.", "Files", FlagValue::folder});
  flags.push_back({"--outputs", "A,B", "Outputs to make: " + outputs + " (* without being asked).", "Files"});
  if (operation.keeps_results) {
    flags.push_back(
        {"--results", "DIR",
         "Folder in which simulations are kept and found again. Default: OUT/simulations. Several runs and computers may share it.",
         "Files", FlagValue::folder});
    flags.push_back(
        {"--engine",
         "local|slurm",
         "Where simulations run: on this computer, or in a Slurm cluster whose nodes share the folder of --results. [default local]",
         "Cluster",
         FlagValue::choice,
         {"local", "slurm"}});
    flags.push_back(
        {"--slurm-option", "OPTION",
         "An option for sbatch with its dashes, for memory, constraints and the like. May be given several times. The variables SBATCH_PARTITION, SBATCH_ACCOUNT and SBATCH_TIMELIMIT work without it.",
         "Cluster"});
    flags.push_back(
        {"--local-seconds", "N",
         "Simulations that this computer makes within this time stay here; 0 sends all to Slurm. [0 to 86400 s, default 5]",
         "Cluster"});
  }
  flags.push_back({"--quiet", "", "Prints no progress.", "Files", FlagValue::no_value});
  // Presets stand before the first parameter of their group.
  std::set<std::string> begun;
  for (const ParameterInfo& info : operation.parameters) {
    if (begun.insert(info.group).second)
      for (const PresetList& list : operation.presets)
        if (list.group == info.group) flags.push_back(preset_flag(list));
    flags.push_back(parameter_flag(info));
  }
  return flags;
}

const std::vector<CommandInfo>& other_commands() {
  static const std::vector<CommandInfo> commands = make_other_commands();
  return commands;
}

}  // namespace formwright
