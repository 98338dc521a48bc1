// SPDX-License-Identifier: GPL-3.0-or-later
#include "command_line/command_line.h"

#include <algorithm>

#include "command_line/command_flags.h"
#include "command_line/flags.h"
#include "job/catalog.h"

namespace formwright {
namespace {

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::size_t start = 0;
  while (start <= text.size()) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    if (comma > start) parts.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return parts;
}

int sample_vertices(const std::string& text) {
  char* end = nullptr;
  const long count = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || count < 0 || count > 5'000'000)
    throw Error(ErrorCode::invalid_input, "sample-vertices",
                "--sample-vertices must be a whole number up to 5000000, and is \"" + text + "\".");
  return static_cast<int>(count);
}

std::size_t shown_width(const std::string& text) {
  // Bytes of UTF-8 that continue a character take no room of their own.
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

/// "  left        right", with `right` broken between words so that no line is longer than 100 columns.
std::string entry(const std::string& left, std::size_t left_width, const std::string& right) {
  constexpr std::size_t columns = 100;
  const std::string indent(left_width + 2, ' ');
  std::string text = "  " + left, line;
  text += shown_width(left) < left_width ? std::string(left_width - shown_width(left), ' ') : "\n" + indent;
  std::size_t start = 0;
  while (start < right.size()) {
    const std::size_t end = std::min(right.find(' ', start), right.size());
    const std::string word = right.substr(start, end - start);
    if (!line.empty() && indent.size() + shown_width(line) + 1 + shown_width(word) > columns) {
      text += line + "\n" + indent;
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
    start = end + 1;
  }
  return text + line + "\n";
}

/// Broken between words so that no line is longer than 100 columns.
std::string paragraph(const std::string& text) {
  std::string plain = entry("", 0, text);
  plain.erase(0, plain.find_first_not_of("\n "));
  for (std::size_t at = plain.find("\n  "); at != std::string::npos; at = plain.find("\n  ", at + 1))
    plain.erase(at + 1, 2);
  return plain;
}

/// A file, or one more of the same; folders are for inputs that are packed from one.
void add_file(const InputInfo& input, const std::string& value, ParsedCommand& command) {
  std::string name = input.name;
  for (int number = 2; command.files.contains(name); ++number) {
    if (!input.repeatable)
      throw Error(ErrorCode::invalid_input, dashed(input.name), dashed(input.name) + " is given twice.");
    name = input.name + "_" + std::to_string(number);
  }
  if (!input.folder_files.empty() && std::filesystem::is_directory(value))
    command.folders[name] = {input.folder_files, input.optional_folder_files};
  command.files[name] = value;
}

constexpr const char* help_flag = "-h,--help";  // as CLI11 names two spellings of one flag

/// The flag of a parameter, and the one that it had in the release before this one.
std::vector<std::string> names_of(const ParameterInfo& info) {
  std::vector<std::string> flags{flag_name(info)};
  if (!info.old_name.empty()) flags.push_back(dashed(info.old_name));
  return flags;
}

std::vector<FlagRule> rules_of(const Operation& operation) {
  using Value = FlagRule::Value;
  std::vector<FlagRule> rules{
      {help_flag, Value::none}, {"--quiet", Value::none}, {"--out"}, {"--outputs"}, {"--sample"},
      {"--sample-vertices"}};
  for (const ParameterInfo& info : operation.parameters)  // a boolean may stand alone: --depth-order means on
    for (const std::string& flag : names_of(info))
      rules.push_back({flag, info.kind == ParameterKind::boolean ? Value::optional : Value::one});
  for (const InputInfo& input : operation.inputs) rules.push_back({dashed(input.name)});
  for (const PresetList& list : operation.presets) rules.push_back({dashed(list.name)});
  if (operation.keeps_results)
    for (const char* flag : {"--results", "--engine", "--slurm-option", "--local-seconds"}) rules.push_back({flag});
  if (takes_object(operation)) rules.push_back({"--object"});
  return rules;
}

/// The values of a preset chosen by name. Throws Error{invalid_input} naming the choices.
const Json& values_of(const PresetList& list, const std::string& name) {
  std::string names;
  for (const Preset& preset : list.presets) {
    if (preset.name == name) return preset.parameters;
    names += (names.empty() ? "" : ", ") + preset.name;
  }
  throw Error(ErrorCode::invalid_input, dashed(list.name),
              dashed(list.name) + " must be one of " + names + ", and is \"" + name + "\".");
}

/// Reads --engine and what belongs to it. Throws Error{invalid_input} naming the flag.
void read_engine(const FlagValues& flags, ParsedCommand& command) {
  const auto values_of_flag = [&](const char* flag) {
    const auto found = flags.find(flag);
    return found == flags.end() ? std::vector<std::string>() : found->second;
  };
  const std::vector<std::string> engine = values_of_flag("--engine"), seconds = values_of_flag("--local-seconds");
  const std::string name = engine.empty() ? "local" : engine.back();
  if (name != "local" && name != "slurm")
    throw Error(ErrorCode::invalid_input, "--engine", "--engine must be local or slurm, and is \"" + name + "\".");
  command.slurm = name == "slurm";
  for (const char* flag : {"--slurm-option", "--local-seconds"})
    if (!command.slurm && flags.contains(flag))
      throw Error(ErrorCode::invalid_input, flag, std::string(flag) + " belongs to --engine slurm: add that.");
  command.slurm_options.options = values_of_flag("--slurm-option");
  for (const std::string& option : command.slurm_options.options)
    if (!option.starts_with("-"))
      throw Error(ErrorCode::invalid_input, "--slurm-option",
                  "--slurm-option takes one option of sbatch, such as --mem=4G, and is \"" + option + "\".");
  if (seconds.empty()) return;
  char* end = nullptr;
  const double value = std::strtod(seconds.back().c_str(), &end);
  constexpr double longest_s = 86400;
  if (seconds.back().empty() || *end != '\0' || !(value >= 0 && value <= longest_s))
    throw Error(ErrorCode::invalid_input, "--local-seconds",
                "--local-seconds must be a number from 0 to 86400, and is \"" + seconds.back() + "\".");
  command.slurm_options.local_seconds = value;
}

/// The sentence for a word that is no flag of the operation.
std::string unknown_word(const std::string& word, const Operation& operation) {
  if (!word.starts_with("--")) return "\"" + word + "\" is not a flag: every value needs one, such as --mesh FILE.";
  std::string name = word.substr(2);
  std::replace(name.begin(), name.end(), '-', '_');
  std::string hint;
  try {
    parameters_detail::reject_unknown(name, operation.parameters);
  } catch (const Error& error) {
    const std::string text = error.what();
    if (const auto at = text.find("did you mean "); at != std::string::npos) {
      hint = dashed(text.substr(at + 13));
      hint = "; did you mean " + hint.substr(0, hint.size() - 1) + "?";
    }
  }
  return "There is no flag " + word + (hint.empty() ? ": see formwright " + operation.name + " --help." : hint);
}

}  // namespace

ParsedCommand parse_command(const Operation& operation, const std::vector<std::string>& words) {
  ParsedCommand command;
  const FlagValues flags =
      read_flags(words, rules_of(operation), [&](const std::string& word) { return unknown_word(word, operation); });
  const auto last_of = [&](const std::string& flag) {
    const auto found = flags.find(flag);
    return found == flags.end() ? std::string() : found->second.back();
  };
  command.help = flags.contains(help_flag);
  if (command.help) return command;
  command.quiet = flags.contains("--quiet");
  command.out = last_of("--out");
  command.results = last_of("--results");
  if (operation.keeps_results) read_engine(flags, command);
  if (flags.contains("--outputs")) command.message["outputs"] = split(last_of("--outputs"));
  Json parameters = Json::object(), inputs = Json::object();
  for (const ParameterInfo& info : operation.parameters)
    for (const std::string& flag : names_of(info))
      if (flags.contains(flag) && !parameters.contains(info.name))
        parameters[info.name] = parse_flag(info, last_of(flag));
  for (const PresetList& list : operation.presets)
    if (flags.contains(dashed(list.name)))
      for (const auto& [name, value] : values_of(list, last_of(dashed(list.name))).items())
        if (!parameters.contains(name)) parameters[name] = value;
  for (const InputInfo& input : operation.inputs)
    if (const auto given = flags.find(dashed(input.name)); given != flags.end())
      for (const std::string& value : given->second) add_file(input, value, command);
  const std::string sample = last_of("--sample");
  const std::string object = takes_object(operation) ? last_of("--object") : "";  // else an input of that name
  const int vertices = flags.contains("--sample-vertices") ? sample_vertices(last_of("--sample-vertices")) : 0;
  if (!object.empty()) {
    if (!std::filesystem::is_directory(object))
      throw Error(ErrorCode::invalid_input, "--object",
                  "There is no folder " + object + ": --object names one with mould.obj, setup.json and measured.csv.");
    for (const InputInfo& input : operation.inputs)
      if (!input.object_file.empty() && !command.files.contains(input.name))
        command.files[input.name] = std::filesystem::path(object) / input.object_file;
  }
  if (!sample.empty()) {
    const auto input = std::find_if(operation.inputs.begin(), operation.inputs.end(),
                                    [](const InputInfo& in) { return in.accepts_sample; });
    if (input == operation.inputs.end())
      throw Error(ErrorCode::invalid_input, "--sample", operation.name + " takes no sample.");
    if (command.files.contains(input->name))
      throw Error(ErrorCode::invalid_input, "--sample",
                  "Give either --sample or " + dashed(input->name) + ", not both.");
    inputs[input->name] = {{"sample", sample}, {"vertices", vertices}};
  }
  for (const InputInfo& input : operation.inputs)
    if (input.required && !inputs.contains(input.name) && !command.files.contains(input.name))
      throw Error(ErrorCode::invalid_input, dashed(input.name),
                  "No input file was given: use " + dashed(input.name) + " FILE" +
                      (input.accepts_sample ? ", or --sample NAME" : "") +
                      (input.object_file.empty() ? "." : ", or --object DIR."));
  if (command.out.empty())
    throw Error(ErrorCode::invalid_input, "--out", "No folder for the results was given: use --out DIR.");
  command.message["operation"] = operation.name;
  command.message["parameters"] = parameters;
  command.message["inputs"] = inputs;
  return command;
}

std::string overview_text() {
  constexpr std::size_t width = 23;
  std::string text = std::string("formwright ") + version() + ": from a 3D model to something that can be made\n\n";
  for (const Operation& operation : operations())
    text += entry("formwright " + operation.name, width, operation.summary);
  text += "\n";
  for (const CommandInfo& command : other_commands())
    text += entry("formwright " + command.name, width, command.summary);
  text += entry("formwright --version", width, "The version.");
  text += "\nformwright OP --help shows the flags of an operation.\n";
  return text;
}

std::string operation_usage(const Operation& operation) {
  std::string text = "formwright " + operation.name;
  for (const InputInfo& input : operation.inputs)
    if (input.required) text += " " + dashed(input.name) + (input.folder_files.empty() ? " FILE" : " DIR");
  return text + " --out DIR [flags]";
}

std::string operation_help(const Operation& operation) {
  constexpr std::size_t width = 30;
  std::string text = paragraph(operation.summary) + "\n  " + operation_usage(operation) + "\n", group;
  for (const FlagInfo& flag : operation_flags(operation)) {
    if (flag.group != group) text += "\n" + flag.group + "\n";
    group = flag.group;
    text += entry(flag.name + (flag.placeholder.empty() ? "" : " " + flag.placeholder), width, flag.help);
  }
  return text;
}

}  // namespace formwright
