// SPDX-License-Identifier: GPL-3.0-or-later
// `formwright machine send | origin | frame | stop`: a machine driven from the terminal. Nothing moves before a person
// typed yes.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "system/files.h"
#include "base/format.h"
#include "machines/gcode/gcode_rules.h"
#include "machines/machine_commands.h"
#include "machines/machine_terminal.h"
#include "machines/ruida/ruida_bounds.h"

namespace formwright {
namespace {

constexpr double farthest_z_jog_mm = 50, z_jog_mm_per_s = 3;

std::vector<std::string> with_driving_flags(std::vector<std::string> flags) {
  flags.insert(flags.end(), driving_flags.begin(), driving_flags.end());
  return flags;
}

void show_progress(const Json& state) {
  if (::isatty(STDERR_FILENO) != 1 || !state["job"].is_object()) return;
  const Json& job = state["job"];
  const int count = std::max(1, job["line_count"].get<int>()), done = job["acknowledged"].get<int>();
  std::fprintf(stderr, "\r\033[K%3d %%  line %d of %d  %.0f s  %s", 100 * done / count, done, count,
               job["seconds"].get<double>(), state["phase"].get<std::string>().c_str());
}

/// A tool of another length stands where it is taken to stand only once z was set with it: the person jogs it down.
void ask_for_z(Terminal& terminal, const std::string& job) {
  for (;;) {
    const std::string answer = terminal.ask(
        "Z for " + job +
        ": type millimetres to move the tool (-1 lowers it), zero when its tip touches the stock, keep where z was set "
        "with this very tool, or stop:");
    if (answer == "keep") return;
    if (answer == "zero") return terminal.set_origin("z");
    if (answer == "stop") throw Error(ErrorCode::cancelled, "", "Stopped: " + job + " was not started.");
    char* end = nullptr;
    const double mm = std::strtod(answer.c_str(), &end);
    if (answer.empty() || *end != '\0' || !(std::abs(mm) <= farthest_z_jog_mm) || mm == 0) {
      std::fprintf(stderr, "A number of millimetres up to 50, zero, keep or stop.\n");
      continue;
    }
    terminal.session().command({{"do", "jog"}, {"z_mm", mm}, {"speed_mm_per_s", z_jog_mm_per_s}});
    terminal.run_until_rest("move the tool");
  }
}

/// Of a mill's first job, as --z says.
void know_z(Terminal& terminal, const std::string& job, const std::string& z) {
  if (z == "kept") return;
  if (z == "here") {
    terminal.confirm("Does the tip of the tool for " + job + " touch the stock's top? Z becomes 0 there.");
    return terminal.set_origin("z");
  }
  ask_for_z(terminal, job);
}

void run_job(Terminal& terminal, const std::string& file, const std::string& machine) {
  terminal.confirm("The job " + file + " starts on " + machine +
                   ": the machine moves and its laser or spindle turns on. Is somebody beside it, eyes protected?");
  Json start{{"do", "start"}, {"confirmed", true}};
  if (terminal.is_mill()) start["z"] = "kept";  // know_z or ask_for_z has set or confirmed it
  terminal.session().command(start);
  std::fprintf(stderr, "Running. Ctrl-C stops the machine.\n");
  terminal.run_until(
      [](const Json& s) {
        show_progress(s);
        return s["job"].is_object() && s["job"]["ended"].is_string();
      },
      1e9, "");
  if (::isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  const Json ended = terminal.state();
  const std::string how = ended["job"]["ended"].get<std::string>();
  if (how != "done") {
    const std::string why = ended["alarm"].is_object() ? Terminal::sentence_of(ended["alarm"], "")
                                                       : Terminal::sentence_of(ended["error"], "");
    throw Error(ErrorCode::could_not_solve, "machine",
                "The job ended before its end (" + how + ")" + (why.empty() ? "" : ": " + why) +
                    " Home the machine before the next job.");
  }
  std::printf("Done: %d lines in %.0f s.\n", ended["job"]["line_count"].get<int>(),
              ended["job"]["seconds"].get<double>());
  std::fflush(stdout);
}

}  // namespace

int machine_send(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags = read_machine_flags(words, with_driving_flags({"--job", "--z"}), {"--yes"}, {"--job"});
  const MachineRegistry registry = registry_of(flags);
  flags.needed("--job", "--job job.gcode");
  const std::vector<std::string>& files = flags.repeated.at("--job");
  std::vector<std::shared_ptr<const Bytes>> jobs;
  for (const std::string& file : files) jobs.push_back(read_file(file, "--job", max_machine_job_bytes));
  const std::string z = flags.value_or("--z", "");
  if (!z.empty() && z != "here" && z != "kept")
    throw Error(ErrorCode::invalid_input, "--z",
                "--z must be here (the tip touches the stock) or kept (z was set before with this tool).");
  const Machine machine = driven_machine(registry, flags);
  Terminal terminal(registry, machine, options_of(flags), interrupted, flags.given("--yes"));
  if (terminal.is_mill() && z.empty() && !Terminal::can_ask())
    throw Error(
        ErrorCode::invalid_input, "--z",
        "State where z is 0: add --z here if the tool's tip touches the stock now, or --z kept if z was set before with this tool.");
  if (terminal.is_mill() && files.size() > 1 && !Terminal::can_ask())
    throw Error(
        ErrorCode::invalid_input, "--job",
        "Between two jobs, z must be set with the next tool, and this is not a terminal that can ask: run the command in a terminal, or send the jobs one by one.");
  terminal.connect();
  // All of them first: a second job that cannot run is known before the first has cut anything.
  for (std::size_t i = files.size(); i-- > 0;)
    terminal.session().load(std::filesystem::path(files[i]).filename().string(), *jobs[i]);
  terminal.know_position();
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (i > 0) terminal.session().load(std::filesystem::path(files[i]).filename().string(), *jobs[i]);
    if (terminal.is_mill() && i == 0) know_z(terminal, files[i], z);
    if (terminal.is_mill() && i > 0) {
      std::fprintf(stderr, "Change the tool for %s; the spindle is off.\n", files[i].c_str());
      ask_for_z(terminal, files[i]);
    }
    run_job(terminal, files[i], machine.name);
  }
  return 0;
}

int machine_origin(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags = read_machine_flags(words, with_driving_flags({"--axes", "--at"}), {"--yes"});
  const MachineRegistry registry = registry_of(flags);
  const std::string at = flags.value_or("--at", "head");
  if (at != "head" && at != "corner")
    throw Error(ErrorCode::invalid_input, "--at",
                "--at must be head (where it stands) or corner (the bed's lower left).");
  const Machine machine = driven_machine(registry, flags);
  Terminal terminal(registry, machine, options_of(flags), interrupted, flags.given("--yes"));
  const std::string axes = flags.value_or("--axes", terminal.is_mill() && at == "head" ? "" : "xy");
  if (axes.empty())
    throw Error(ErrorCode::invalid_input, "--axes",
                "Say which axes: --axes xy, or --axes xyz when the tool's tip touches the stock.");
  if (axes.find_first_not_of("xyz") != std::string::npos)
    throw Error(ErrorCode::invalid_input, "--axes", "--axes must name x, y or z, such as xy or xyz.");
  if (at == "corner" && axes != "xy")
    throw Error(ErrorCode::invalid_input, "--axes",
                "The bed's corner is a place in x and y: leave --axes out, and set z by --axes z when the tip touches "
                "the stock.");
  terminal.connect();
  if (at == "corner" && terminal.state()["position_known"] != true && !terminal.can("home"))
    throw Error(
        ErrorCode::invalid_input, "--at",
        "A machine without limit switches does not know where the bed's corner is: jog to the material's corner and use --at head.");
  if (at == "corner") terminal.know_position();
  if (terminal.state()["phase"] == "alarm")
    throw Error(ErrorCode::could_not_solve, "machine",
                Terminal::sentence_of(terminal.state()["alarm"], "The machine is in alarm: home it first."));
  const bool touches = axes.find('z') != std::string::npos && terminal.is_mill();
  terminal.confirm(at == "corner" ? "The origin becomes the lower left corner of the bed."
                                  : "Where the head stands becomes 0 on " + axes + "." +
                                        (touches ? " Does the tool's tip touch the stock?" : ""));
  terminal.set_origin(axes, at);
  std::printf("%s is 0 at the %s.\n", axes.c_str(), at.c_str());
  return 0;
}

int machine_frame(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags = read_machine_flags(words, with_driving_flags({"--job"}), {"--yes"});
  const MachineRegistry registry = registry_of(flags);
  const auto job = read_file(flags.needed("--job", "--job job.gcode"), "--job", max_machine_job_bytes);
  const Machine machine = driven_machine(registry, flags);
  const auto gcode_bounds = [&] {
    const Json options = driver_options(machine, options_of(flags));
    const GcodeProgram program = GcodeProgram::read(*job, 256, options.value("controller", "") == "marlin");
    if (options.value("tool", "") != "printer") require_clear_path(program);  // a printer's jobs home it themselves
    return program.bounds();
  };
  const GcodeBounds bounds = machine.kind == MachineKind::ruida ? ruida_bounds(*job) : gcode_bounds();
  if (!bounds.named[0] && !bounds.named[1])
    throw Error(ErrorCode::invalid_input, "--job", "The job does not move in x and y: choose another.");
  Terminal terminal(registry, machine, options_of(flags), interrupted, flags.given("--yes"));
  terminal.connect();
  terminal.know_position();
  // An axis that the job does not name stays where it is.
  std::array<double, 4> frame{bounds.low_mm[0], bounds.low_mm[1], bounds.high_mm[0], bounds.high_mm[1]};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (bounds.named[axis]) continue;
    terminal.run_until([](const Json& s) { return s["work_mm"].is_array(); }, 5,
                       "The machine does not report where its head is: home it first.");
    frame[axis] = frame[axis + 2] = terminal.state()["work_mm"][axis].get<double>();
  }
  const auto range = [&](std::size_t axis) {
    return with_decimals(frame[axis], 1) + " to " + with_decimals(frame[axis + 2], 1) + " mm";
  };
  const std::string place = "x " + range(0) + ", y " + range(1);
  terminal.confirm("The head moves once around the job (" + place + "), laser off.");
  terminal.session().command({{"do", "frame"}, {"bounds_mm", frame}, {"confirmed", true}});
  terminal.run_until_rest("go around the job");
  std::printf("Framed: %s.\n", place.c_str());
  return 0;
}

int machine_stop(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags = read_machine_flags(words, driving_flags, {});
  const MachineRegistry registry = registry_of(flags);
  const Machine machine = driven_machine(registry, flags);
  if (const int holder = MachineLock::ask_to_stop(registry.data(), machine); holder > 0) {
    std::printf("%s is being stopped by the program that drives it (process %d).\n", machine.name.c_str(), holder);
    return 0;
  }
  Terminal terminal(registry, machine, options_of(flags), interrupted, true);
  terminal.session().command({{"do", "stop"}});
  terminal.run_until([](const Json& s) { return s["phase"] != "stopping"; }, 5,
                     machine.name + " does not answer: if it moves, switch it off.");
  std::printf("The stop command was sent to %s.\n", machine.name.c_str());
  return 0;
}

}  // namespace formwright
