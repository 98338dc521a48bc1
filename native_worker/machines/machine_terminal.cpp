// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_terminal.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iostream>

#include "system/files.h"

namespace formwright {
namespace {

using namespace std::chrono_literals;

std::atomic<bool> stop_asked{false};  // by another process

}  // namespace

Terminal::Terminal(const MachineRegistry& registry, const Machine& machine, const Json& options,
                   const std::atomic<bool>& interrupted, bool yes)
    : log_(registry.data()),
      machine_(machine),
      options_(driver_options(machine, options)),
      interrupted_(interrupted),
      yes_(yes) {
  make_machine_driver(options_);
  std::signal(SIGUSR1, [](int) { stop_asked = true; });
  auto lock = std::make_unique<MachineLock>(registry.data(), machine);
  auto port = open_machine_port(io_, machine, options_.value("baud", machine.baud));
  session_ = std::make_shared<MachineSession>(io_, machine, options_, std::move(port), std::move(lock), log_);
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

Terminal::~Terminal() {
  let_stop_end();
  if (!session_->over()) session_->end("The program ended.");
}

void Terminal::let_stop_end() {
  const auto end = std::chrono::steady_clock::now() + 3s;
  while (!session_->over() && session_->state()["phase"] == "stopping" && std::chrono::steady_clock::now() < end) {
    io_.restart();
    io_.run_for(20ms);
  }
}

void Terminal::serve() {
  io_.restart();
  io_.run_for(20ms);
  if (!gone_.empty()) throw Error(ErrorCode::could_not_solve, "machine", gone_);
  if (interrupted_ || stop_asked) stop_and_throw();
}

void Terminal::connect() {
  run_until([](const Json& s) { return s["connection"] == "ready" && s["phase"] != "unknown"; }, 15,
            "Nothing answers at " + machine_.name +
                ": check that the machine is on, and that controller and baud rate are right.");
}

bool Terminal::can_ask() { return ::isatty(STDIN_FILENO) == 1; }

std::string Terminal::ask(const std::string& question) {
  std::fprintf(stderr, "%s ", question.c_str());
  std::string answer;
  for (;;) {
    pollfd wait{STDIN_FILENO, POLLIN, 0};
    if (::poll(&wait, 1, 0) > 0) {
      if (!std::getline(std::cin, answer))
        throw Error(ErrorCode::cancelled, "", "Not confirmed: nothing more was moved.");
      return answer;
    }
    serve();
  }
}

void Terminal::confirm(const std::string& question) {
  if (yes_) return;
  if (!can_ask())
    throw Error(
        ErrorCode::invalid_input, "--yes",
        "This is not a terminal that can ask for confirmation: run the command in a terminal, or add --yes if somebody stands at the machine.");
  if (ask(question + " Type yes:") != "yes") throw Error(ErrorCode::cancelled, "", "Not confirmed: nothing was moved.");
}

bool Terminal::can(const char* what) const {
  const Json possible = state()["can"];
  return std::find(possible.begin(), possible.end(), what) != possible.end();
}

void Terminal::know_position() {
  const Json now = state();
  if (now["position_known"] == true) return;
  if (can("home")) {
    confirm("Where the head stands is unknown. It moves to its switches now.");
    session_->command({{"do", "home"}, {"confirmed", true}});
    run_until(
        [](const Json& s) { return (s["phase"] == "idle" && s["position_known"] == true) || s["phase"] == "alarm"; },
        240, "Homing did not end: switch the machine off and check what blocks it.");
    if (const Json s = state(); s["phase"] == "alarm")
      throw Error(ErrorCode::could_not_solve, "machine", sentence_of(s["alarm"], "Homing failed."));
  } else if (can("set_origin")) {
    confirm("This machine has no switches to home to. Does the head stand at the lower left corner of the material?");
    set_origin("xy");
    std::fprintf(stderr, "The machine has no switches: x and y are 0 where the head stands.\n");
    run_until([](const Json& s) { return s["position_known"] == true; }, 5,
              "The machine did not accept the origin: check its console.");
  } else {
    throw Error(
        ErrorCode::could_not_solve, "machine",
        machine_.name + " is not ready (" + now["phase"].get<std::string>() + "): " +
            sentence_of(now["alarm"], now["phase"] == "paused"
                                          ? "continue there, or end what it was doing by formwright machine stop."
                                          : "look at its display."));
  }
}

void Terminal::set_origin(const std::string& axes, const std::string& at) {
  session_->command({{"do", "set_origin"}, {"axes", axes}, {"at", at}});
  // It is written to the board's memory, and some boards hear nothing while they write.
  const auto written = std::chrono::steady_clock::now() + 150ms;
  run_until([&](const Json&) { return all_answered() && std::chrono::steady_clock::now() > written; }, 5,
            "The machine did not accept the origin: check its console.");
  if (const Json s = state(); s["error"].is_object())
    throw Error(ErrorCode::could_not_solve, "machine",
                "The machine refused the origin: " + sentence_of(s["error"], "look at its display."));
}

void Terminal::run_until_rest(const std::string& what) {
  auto rests_since = std::chrono::steady_clock::now();
  run_until(
      [&](const Json& s) {
        if (s["phase"] == "alarm")
          throw Error(ErrorCode::could_not_solve, "machine",
                      sentence_of(s["alarm"], "The machine is in alarm: look at its display."));
        if (s["error"].is_object())
          throw Error(ErrorCode::could_not_solve, "machine",
                      "The machine refused to " + what + ": " + sentence_of(s["error"], "look at its display."));
        if (s["phase"] != "idle" || !all_answered()) rests_since = std::chrono::steady_clock::now();
        return std::chrono::steady_clock::now() - rests_since > 1500ms;  // reports come every half second
      },
      600, "The move did not end, or a line was lost: check what the machine is doing, and try again.");
}

std::string Terminal::sentence_of(const Json& message, const std::string& otherwise) {
  if (!message.is_object()) return otherwise;
  std::string text = message.value("text", otherwise);
  if (const std::string fix = message.value("fix", ""); !fix.empty()) text += " " + fix;
  return text;
}

void Terminal::stop_and_throw() {
  const bool from_elsewhere = stop_asked;
  if (from_elsewhere) session_->look_for_stop();
  else if (!session_->over()) session_->command({{"do", "stop"}});
  let_stop_end();
  session_->end(from_elsewhere ? "Stopped by another process." : "Stopped with Ctrl-C, or its terminal was closed.");
  throw Error(ErrorCode::cancelled, "",
              "Stopped: laser off, the rest of the job is not sent. Home the machine before the next job.");
}

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

}  // namespace formwright
