// SPDX-License-Identifier: GPL-3.0-or-later
// `formwright machine send | frame | stop`: a machine driven from the terminal. Nothing moves before a person typed
// yes.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>

#include "base/error.h"
#include "files.h"
#include "machines/gcode_rules.h"
#include "machines/machine_commands.h"
#include "machines/machine_session.h"
#include "machines/ruida_bounds.h"

namespace formwright {
namespace {

using namespace std::chrono_literals;
constexpr std::uintmax_t most_job_bytes = std::uintmax_t{128} << 20;

std::atomic<bool> stop_asked{false};  // by another process

/// A session that is run from here, step by step.
class Terminal {
 public:
  Terminal(const MachineRegistry& registry, const Machine& machine, const Json& options,
           const std::atomic<bool>& interrupted, bool yes)
      : log_(registry.data()), machine_(machine), interrupted_(interrupted), yes_(yes) {
    const Json all = driver_options(machine, options);
    make_machine_driver(all);
    std::signal(SIGUSR1, [](int) { stop_asked = true; });
    auto lock = std::make_unique<MachineLock>(registry.data(), machine);
    auto port = open_machine_port(io_, machine, all.value("baud", machine.baud));
    session_ = std::make_shared<MachineSession>(io_, machine, all, std::move(port), std::move(lock), log_);
    session_->begin({[](const Json&) {},
                     [this](const Json& events) {
                       for (const Json& event : events) {
                         const std::string text = event.value("text", "");
                         if (event["event"] == "sent") ++unanswered_;
                         if (event["event"] == "received" && (text.starts_with("ok") || text.starts_with("error")))
                           unanswered_ = std::max(0, unanswered_ - 1);
                         if (event["event"] == "note") std::fprintf(stderr, "\r\033[K%s\n", text.c_str());
                       }
                     },
                     [this](const std::string& sentence) { gone_ = sentence; }});
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal() {
    if (!session_->over()) session_->end("The program ended.");
  }

  Json state() const { return session_->state(); }
  MachineSession& session() { return *session_; }
  /// Has the machine answered every line? (Serial controllers answer each with ok or error.)
  bool all_answered() const { return machine_.kind != MachineKind::serial || unanswered_ == 0; }

  /// Runs until `done(state)` is true. Ctrl-C, a closed terminal and a stop from elsewhere stop the machine first and
  /// then throw Error{cancelled}.
  template <class Done>
  void run_until(const Done& done, double patience_s, const std::string& otherwise) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
    for (;;) {
      io_.restart();
      io_.run_for(20ms);
      if (!gone_.empty()) throw Error(ErrorCode::could_not_solve, "machine", gone_);
      if (interrupted_ || stop_asked) stop_and_throw();
      if (done(session_->state())) return;
      if (std::chrono::steady_clock::now() > end) throw Error(ErrorCode::could_not_solve, "machine", otherwise);
    }
  }

  void connect() {
    run_until([](const Json& s) { return s["connection"] == "ready" && s["phase"] != "unknown"; }, 15,
              "Nothing answers at " + machine_.name +
                  ": see whether it is on, and whether controller and baud rate are right.");
  }

  /// Asks and throws Error{cancelled} unless the answer is yes. The port is served meanwhile.
  void confirm(const std::string& question) {
    if (yes_) return;
    if (::isatty(STDIN_FILENO) != 1)
      throw Error(ErrorCode::invalid_input, "--yes",
                  "Nobody can be asked here: run it in a terminal, or add --yes when somebody stands at the machine.");
    std::fprintf(stderr, "%s Type yes: ", question.c_str());
    std::string answer;
    for (;;) {
      pollfd wait{STDIN_FILENO, POLLIN, 0};
      if (::poll(&wait, 1, 0) > 0) {
        if (!std::getline(std::cin, answer) || answer != "yes")
          throw Error(ErrorCode::cancelled, "", "Not confirmed: nothing was moved.");
        return;
      }
      run_until([](const Json&) { return true; }, 1, "");
    }
  }

  /// Where the head stands must be known before a job starts.
  void know_position() {
    const Json now = state();
    if (now["position_known"] == true) return;
    const auto can = [&](const char* what) {
      return std::find(now["can"].begin(), now["can"].end(), what) != now["can"].end();
    };
    if (can("home")) {
      confirm("Where the head stands is unknown. It moves to its switches now.");
      session_->command({{"do", "home"}, {"confirmed", true}});
      run_until(
          [](const Json& s) { return (s["phase"] == "idle" && s["position_known"] == true) || s["phase"] == "alarm"; },
          240, "Homing does not end: switch the machine off and see what blocks it.");
      if (const Json s = state(); s["phase"] == "alarm")
        throw Error(ErrorCode::could_not_solve, "machine", sentence_of(s["alarm"], "Homing failed."));
    } else if (can("set_origin")) {
      confirm("This machine has no switches to home to. Does the head stand at the lower left corner of the material?");
      session_->command({{"do", "set_origin"}, {"axes", "xy"}});
      run_until([](const Json& s) { return s["position_known"] == true; }, 5,
                "The machine does not take the origin: see its console.");
      // It was written to the board's memory, and some boards hear nothing while they write.
      const auto written = std::chrono::steady_clock::now() + 150ms;
      run_until([&](const Json&) { return std::chrono::steady_clock::now() > written; }, 5, "");
    } else {
      throw Error(ErrorCode::could_not_solve, "machine",
                  machine_.name + " is not ready (" + now["phase"].get<std::string>() +
                      "): " + sentence_of(now["alarm"], "see what it shows."));
    }
  }

  static std::string sentence_of(const Json& told, const std::string& otherwise) {
    if (!told.is_object()) return otherwise;
    std::string text = told.value("text", otherwise);
    if (const std::string mend = told.value("mend", ""); !mend.empty()) text += " " + mend;
    return text;
  }

  [[noreturn]] void stop_and_throw() {
    const bool from_elsewhere = stop_asked;
    if (from_elsewhere) session_->look_for_stop();
    else if (!session_->over()) session_->command({{"do", "stop"}});
    const auto end = std::chrono::steady_clock::now() + 3s;
    while (!session_->over() && session_->state()["phase"] == "stopping" && std::chrono::steady_clock::now() < end) {
      io_.restart();
      io_.run_for(20ms);
    }
    session_->end(from_elsewhere ? "Stopped by another process." : "Stopped with Ctrl-C, or its terminal was closed.");
    throw Error(ErrorCode::cancelled, "",
                "Stopped: laser off, the rest of the job is not sent. Home the machine before the next job.");
  }

 private:
  boost::asio::io_context io_{1};
  MachineLog log_;
  const Machine machine_;
  const std::atomic<bool>& interrupted_;
  const bool yes_;
  std::shared_ptr<MachineSession> session_;
  std::string gone_;
  int unanswered_ = 0;
};

MachineRegistry registry_of(const MachineFlags& flags) {
  return MachineRegistry(flags.given("--data") ? std::filesystem::path(flags.values.at("--data"))
                                               : default_data_folder());
}

Machine driven_machine(const MachineRegistry& registry, const MachineFlags& flags) {
  const std::string name = flags.needed("--machine", "--machine Laser");
  const auto machines = find_machines(registry);
  const Machine machine = choose_machine(machines, name);
  if (machine.kind != MachineKind::serial && machine.kind != MachineKind::ruida)
    throw Error(
        ErrorCode::invalid_input, "machine",
        machine.name + " is a " + to_string(machine.kind) + ": only serial machines and Ruida are driven from here.");
  return machine;
}

Json options_of(const MachineFlags& flags) {
  Json options = Json::object();
  if (flags.given("--controller")) {
    options["controller"] = flags.values.at("--controller");
    if (const SerialController* known = find_serial_controller(flags.values.at("--controller"))) {
      options["controller"] = known->controller;
      options["tool"] = known->tool;
    }
  }
  for (const auto& [flag, name] : {std::pair{"--bed-x-mm", "bed_x_mm"}, {"--bed-y-mm", "bed_y_mm"}}) {
    if (!flags.given(flag)) continue;
    char* end = nullptr;
    const double value = std::strtod(flags.values.at(flag).c_str(), &end);
    if (*end != '\0' || !std::isfinite(value))
      throw Error(ErrorCode::invalid_input, flag, std::string(flag) + " must be a number of millimetres.");
    options[name] = value;
  }
  return options;
}

const std::vector<std::string> run_flags{"--data", "--machine", "--job", "--controller", "--bed-x-mm", "--bed-y-mm"};

void show_progress(const Json& state) {
  if (::isatty(STDERR_FILENO) != 1 || !state["job"].is_object()) return;
  const Json& job = state["job"];
  const int count = std::max(1, job["line_count"].get<int>()), done = job["acknowledged"].get<int>();
  std::fprintf(stderr, "\r\033[K%3d %%  line %d of %d  %.0f s  %s", 100 * done / count, done, count,
               job["seconds"].get<double>(), state["phase"].get<std::string>().c_str());
}

}  // namespace

int machine_send(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags = read_machine_flags(words, run_flags, {"--yes"});
  const MachineRegistry registry = registry_of(flags);
  const std::string file = flags.needed("--job", "--job job.gcode");
  const auto job = read_file(file, "--job", most_job_bytes);
  const Machine machine = driven_machine(registry, flags);
  Terminal terminal(registry, machine, options_of(flags), interrupted, flags.given("--yes"));
  terminal.connect();
  terminal.session().load(std::filesystem::path(file).filename().string(), *job);
  terminal.know_position();
  terminal.confirm("The job " + file + " starts on " + machine.name +
                   ": the machine moves and its laser or spindle turns on. Is somebody beside it, eyes protected?");
  terminal.session().command({{"do", "start"}, {"confirmed", true}});
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
  return 0;
}

int machine_frame(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags = read_machine_flags(words, run_flags, {"--yes"});
  const MachineRegistry registry = registry_of(flags);
  const auto job = read_file(flags.needed("--job", "--job job.gcode"), "--job", most_job_bytes);
  const Machine machine = driven_machine(registry, flags);
  const auto gcode_bounds = [&] {
    const GcodeProgram program = GcodeProgram::read(*job, 256);
    require_clear_way(program);
    return program.bounds();
  };
  const GcodeBounds bounds = machine.kind == MachineKind::ruida ? ruida_bounds(*job) : gcode_bounds();
  if (bounds.empty) throw Error(ErrorCode::invalid_input, "--job", "The job moves nowhere: choose another.");
  Terminal terminal(registry, machine, options_of(flags), interrupted, flags.given("--yes"));
  terminal.connect();
  terminal.know_position();
  char place[128];
  std::snprintf(place, sizeof place, "x %.1f to %.1f mm, y %.1f to %.1f mm", bounds.low_mm[0], bounds.high_mm[0],
                bounds.low_mm[1], bounds.high_mm[1]);
  terminal.confirm("The head moves once around the job (" + std::string(place) + "), laser off.");
  terminal.session().command({{"do", "frame"},
                              {"bounds_mm", {bounds.low_mm[0], bounds.low_mm[1], bounds.high_mm[0], bounds.high_mm[1]}},
                              {"confirmed", true}});
  auto rests_since = std::chrono::steady_clock::now();
  terminal.run_until(
      [&](const Json& s) {
        if (s["phase"] == "alarm")
          throw Error(ErrorCode::could_not_solve, "machine",
                      Terminal::sentence_of(s["alarm"], "The machine is in alarm: see what it shows."));
        if (s["error"].is_object())
          throw Error(
              ErrorCode::could_not_solve, "machine",
              "The machine refused to go around the job: " + Terminal::sentence_of(s["error"], "see what it shows."));
        if (s["phase"] != "idle" || !terminal.all_answered()) rests_since = std::chrono::steady_clock::now();
        return std::chrono::steady_clock::now() - rests_since > 1500ms;  // reports come every half second
      },
      600, "The frame does not end, or a line of it was lost: see what the machine does, and try again.");
  std::printf("Framed: %s.\n", place);
  return 0;
}

int machine_stop(const std::vector<std::string>& words, const std::atomic<bool>& interrupted) {
  const MachineFlags flags =
      read_machine_flags(words, {"--data", "--machine", "--controller", "--bed-x-mm", "--bed-y-mm"}, {});
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
  std::printf("%s was told to stop.\n", machine.name.c_str());
  return 0;
}

}  // namespace formwright
