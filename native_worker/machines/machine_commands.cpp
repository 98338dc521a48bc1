// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_commands.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <iostream>

#include "base/error.h"
#include "command_line/flags.h"
#include "system/files.h"
#include "system/host.h"
#include "machines/port/machine_log.h"
#include "machines/port/machine_registry.h"
#include "machines/machine_terminal.h"
#include "machines/print/printer.h"

namespace formwright {
namespace {

constexpr const char* help_text =
    "Printers and machines of this computer and its network.\n\n"
    "  formwright machine list [--json]\n"
    "  formwright machine add --name N --url URL [--kind octoprint|moonraker] [--api-key-file F]\n"
    "                         [--controller grbl|grbl_mill|marlin|marlin_printer] [--baud N]\n"
    "  formwright machine remove N\n"
    "  formwright machine print --machine M --file F --media A4 [--copies N] [--mirrored]\n"
    "                           [--quality draft|normal|high]\n"
    "  formwright machine frame --machine M --job F [--yes]   once around the job, laser off\n"
    "  formwright machine send  --machine M --job F [--yes]   runs it; Ctrl-C stops the machine\n"
    "                           [--z here|kept]  for mills: is z 0 where the tip is now, or as set before?\n"
    "                           --job F --job G: one after the other; mills ask for z with each tool\n"
    "  formwright machine origin --machine M [--axes xyz] [--at head|corner] [--yes]   where 0 is\n"
    "  formwright machine stop  --machine M                   also one that another program drives\n\n"
    "frame, send and origin ask before anything moves or changes; --yes says that somebody stands at the machine.\n"
    "They take --controller, --bed-x-mm and --bed-y-mm too.\n\n"
    "URL: ipp://HOST/ipp/print, http://HOST, ruida://HOST, tcp://HOST:PORT or serial:/dev/NAME.\n"
    "Serial ports, the system's printers and those on the network are found without being added.\n"
    "--data DIR names the folder in which they are kept, the same as for formwright serve.\n";

int list(const std::vector<std::string>& words) {
  const MachineFlags flags = read_machine_flags(words, {"--data"}, {"--json"});
  const auto machines = find_machines(registry_of(flags));
  if (flags.given("--json")) {
    Json all = Json::array();
    for (const Machine& m : machines) all.push_back(machine_json(m));
    std::cout << json_text(all, 2) << "\n";
    return 0;
  }
  for (const Machine& m : machines)
    std::printf("%s  %-10s %-24s %s%s\n", m.id.c_str(), to_string(m.kind), m.name.c_str(), m.detail().c_str(),
                m.state.empty() ? "" : (" (" + m.state + ")").c_str());
  if (machines.empty())
    std::cout << "No machine was found. Plug one in, or add one: formwright machine add --name N --url URL\n";
  return 0;
}

int add(const std::vector<std::string>& words) {
  const MachineFlags flags = read_machine_flags(
      words, {"--data", "--name", "--url", "--kind", "--api-key-file", "--controller", "--baud"}, {});
  std::string key;
  if (flags.given("--api-key-file")) {
    key = std::string(as_text(*read_file(flags.values.at("--api-key-file"), "--api-key-file", 4096)));
    while (!key.empty() && std::isspace(static_cast<unsigned char>(key.back()))) key.pop_back();
    if (key.empty())
      throw Error(ErrorCode::invalid_input, "--api-key-file",
                  "The file with the key is empty: copy the key from the machine's settings into it.");
  }
  const Machine machine =
      machine_from_words({flags.value_or("--name", ""), flags.value_or("--url", ""), flags.value_or("--kind", ""),
                          flags.value_or("--controller", ""), key, flags.value_or("--baud", "")});
  registry_of(flags).add(machine);
  std::printf("%s  %-10s %s\n", machine.id.c_str(), to_string(machine.kind), machine.name.c_str());
  return 0;
}

int remove(const std::vector<std::string>& words) {
  const MachineFlags flags = read_machine_flags(words, {"--data", "--name", "machine"}, {});
  const std::string name = flags.value_or("machine", "");
  registry_of(flags).remove(name.empty() ? flags.needed("--name", "--name Studio") : name);
  return 0;
}

int print(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags =
      read_machine_flags(words, {"--data", "--machine", "--file", "--media", "--copies", "--quality"}, {"--mirrored"});
  const MachineRegistry registry = registry_of(flags);
  const std::string name = flags.needed("--machine", "--machine Studio"),
                    file = flags.needed("--file", "--file pages.pdf");
  PrintOrder order;
  order.media = flags.needed("--media", "--media A4");
  order.quality = flags.value_or("--quality", "normal");
  order.mirrored = flags.given("--mirrored");
  order.title = std::filesystem::path(file).filename().string().substr(0, 200);
  char* end = nullptr;
  const std::string copies = flags.value_or("--copies", "1");
  order.copies = static_cast<int>(std::clamp(std::strtol(copies.c_str(), &end, 10), 0L, 10000L));
  if (*end != '\0' || order.copies < 1)
    throw Error(ErrorCode::invalid_input, "--copies", "--copies must be a whole number from 1.");
  const auto document = read_file(file, "--file", std::uintmax_t{512} << 20);
  order.document = *document;
  const auto machines = find_machines(registry);
  const Machine& machine = choose_machine(machines, name);
  if (machine.kind != MachineKind::printer)
    throw Error(
        ErrorCode::invalid_input, "machine",
        machine.name + " is a " + to_string(machine.kind) + ", no printer: choose one from formwright machine list.");
  MachineLog log(registry.data());
  const auto note = [&](const std::string& state, const std::string& text) {
    log.append(machine, {{"event", "task"}, {"kind", "print"}, {"state", state}, {"text", text}}, true);
  };
  note("queued", order.title);
  try {
    std::string last;
    const PrintResult result = print_document({machine.name, machine.url, machine.destination}, order, interrupted,
                                              [&](const std::string&, const std::string& sentence) {
                                                if (sentence != last) std::fprintf(stderr, "%s\n", sentence.c_str());
                                                last = sentence;
                                              });
    for (const std::string& text : result.notes) std::fprintf(stderr, "%s\n", text.c_str());
    note("done", "Done.");
    std::printf("Printed on %s.\n", machine.name.c_str());
  } catch (const Error& error) {
    note(error.code() == ErrorCode::cancelled ? "cancelled" : "failed", error.what());
    throw;
  }
  return 0;
}

}  // namespace

const std::string& MachineFlags::needed(const std::string& flag, const std::string& example) const {
  const auto found = values.find(flag);
  if (found == values.end() || found->second.empty())
    throw Error(ErrorCode::invalid_input, flag, flag + " is missing: say " + example + ".");
  return found->second;
}

std::string MachineFlags::value_or(const std::string& flag, const std::string& otherwise) const {
  const auto found = values.find(flag);
  return found == values.end() ? otherwise : found->second;
}

MachineFlags read_machine_flags(const std::vector<std::string>& words, const std::vector<std::string>& flags,
                                const std::vector<std::string>& switches, const std::vector<std::string>& repeatable) {
  std::vector<FlagRule> rules;
  for (const std::string& flag : flags) rules.push_back({flag});
  for (const std::string& flag : switches) rules.push_back({flag, FlagRule::Value::none});
  MachineFlags result;
  for (auto& [flag, given] : read_flags(words, rules, [](const std::string& word) {
         return "There is no flag " + word + " here: see formwright machine --help.";
       })) {
    const bool repeats = std::find(repeatable.begin(), repeatable.end(), flag) != repeatable.end();
    if (given.size() > 1 && !repeats) throw Error(ErrorCode::invalid_input, flag, flag + " is given twice.");
    result.values[flag] = given.back();
    if (repeats) result.repeated[flag] = given;
  }
  return result;
}

int machine_command(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  if (words.empty() ||
      std::any_of(words.begin(), words.end(), [](const std::string& w) { return w == "--help" || w == "-h"; })) {
    std::cout << help_text;
    return words.empty() ? 2 : 0;
  }
  // Whoever reads our sentences may be gone first; the machine must still be stopped, the print be taken back.
  std::signal(SIGPIPE, SIG_IGN);
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  if (words[0] == "list") return list(rest);
  if (words[0] == "add") return add(rest);
  if (words[0] == "remove") return remove(rest);
  if (words[0] == "send") return machine_send(rest, interrupted);
  if (words[0] == "origin") return machine_origin(rest, interrupted);
  if (words[0] == "frame") return machine_frame(rest, interrupted);
  if (words[0] == "stop") return machine_stop(rest, interrupted);
  if (words[0] == "print") return print(rest, interrupted);
  throw Error(ErrorCode::invalid_input, words[0],
              "There is no command machine " + words[0] + ": see formwright machine --help.");
}

}  // namespace formwright
