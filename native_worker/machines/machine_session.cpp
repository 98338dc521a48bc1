// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/machine_session.h"

#include <algorithm>

#include "machines/controllers.h"
#include "base/error.h"

namespace formwright {
namespace {

constexpr double state_period_s = 0.1;

/// Commands after which something may move or shine: written through to the disk.
bool is_lasting(const std::string& what) { return what != "jog" && what != "jog_cancel" && what != "override"; }

}  // namespace

Json driver_options(const Machine& machine, Json options) {
  if (options.is_null()) options = Json::object();
  if (!options.is_object())
    throw Error(ErrorCode::invalid_input, "open", "open needs the machine's settings as an object.");
  if (!options.contains("controller")) {
    options["controller"] = machine.controller;
    if (const SerialController* known = find_serial_controller(machine.controller)) {
      options["controller"] = known->controller;
      if (!options.contains("tool")) options["tool"] = known->tool;
    }
  }
  if (!options.contains("baud") && machine.kind == MachineKind::serial) options["baud"] = machine.baud;
  const bool is_ruida = options["controller"] == "ruida";
  if (options["controller"] == "k40")
    throw Error(ErrorCode::invalid_input, "controller",
                "A K40 board is reached from the page over USB: connect it there.");
  if (is_ruida != (machine.kind == MachineKind::ruida))
    throw Error(
        ErrorCode::invalid_input, "controller",
        is_ruida ? "A Ruida is reached over the network: register it with formwright machine add --url ruida://ADDRESS."
                 : machine.name + " is a Ruida: choose that controller.");
  return options;
}

MachineSession::MachineSession(boost::asio::io_context& io, const Machine& machine, const Json& options,
                               std::shared_ptr<MachinePort> port, std::unique_ptr<MachineLock> lock, MachineLog& log)
    : timer_(io),
      machine_(machine),
      options_(options),
      driver_(make_machine_driver(options)),
      port_(std::move(port)),
      lock_(std::move(lock)),
      log_(log) {}

MachineSession::~MachineSession() {
  if (!over_) port_->close();
}

void MachineSession::begin(Listener listener) {
  listener_ = std::move(listener);
  log_.append(machine_, {{"event", "open"}, {"controller", driver_->state(now_s())["controller"]}}, true);
  port_->start(
      [this, self = weak_from_this()](ByteView bytes) {
        const auto alive = self.lock();
        if (!alive || over_) return;
        driver_->received(bytes, now_s());
        pump();
      },
      [this, self = weak_from_this()](const std::string& sentence) {
        const auto alive = self.lock();
        if (!alive || over_) return;
        driver_->closed(now_s());
        pump();
        over_ = true;
        timer_.cancel();
        lock_.reset();
        log_.append(machine_, {{"event", "gone"}, {"text", sentence}}, true);
        if (listener_.gone) listener_.gone(sentence);
      });
  driver_->opened(now_s());
  pump();
  tick();
}

void MachineSession::tick() {
  timer_.expires_after(std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(MachineDriver::tick_s)));
  timer_.async_wait([this, self = weak_from_this()](const boost::system::error_code& error) {
    const auto alive = self.lock();
    if (error || !alive || over_) return;
    driver_->tick(now_s());
    pump();
    if (!over_) tick();
  });
}

void MachineSession::pump(bool first) {
  auto packets = driver_->take_output();
  if (!packets.empty()) port_->write(std::move(packets), first);
  const Json events = driver_->take_events();
  for (const Json& event : events) {
    const Json what = event.value("event", Json());
    log_.append(machine_, event, what == "ended" || what == "note");
  }
  if (!events.empty() && listener_.events) listener_.events(events);
  publish();
}

void MachineSession::publish() {
  const double now = now_s();
  const Json state = driver_->state(now);
  std::string phase = state["phase"].get<std::string>() + "/" + state["connection"].get<std::string>();
  if (state["job"].is_object() && state["job"]["ended"].is_string())
    phase += "/" + state["job"]["ended"].get<std::string>();
  if (phase == reported_phase_ && now - reported_s_ < state_period_s) return;
  reported_phase_ = phase;
  reported_s_ = now;
  if (listener_.state) listener_.state(state);
}

void MachineSession::command(const Json& command) {
  if (over_) throw Error(ErrorCode::invalid_input, "do", "The machine is not connected: connect it first.");
  const std::string what = command.is_object() && command.contains("do") && command["do"].is_string()
                               ? command["do"].get<std::string>()
                               : "";
  if (what == "stop") {
    driver_->command(command, now_s());  // before anything else
    pump(true);
    log_.append(machine_, {{"event", "command"}, {"command", command}}, true);
    return;
  }
  log_.append(machine_, {{"event", "command"}, {"command", command}}, is_lasting(what));
  try {
    driver_->command(command, now_s());
  } catch (const Error& error) {
    log_.append(machine_, {{"event", "refused"}, {"text", error.what()}});
    throw;
  }
  pump();
}

void MachineSession::load_prepared(const std::string& name, PreparedJob& job, std::size_t bytes) {
  if (over_) throw Error(ErrorCode::invalid_input, "load", "The machine is not connected: connect it first.");
  driver_->load_prepared(name, job);
  log_.append(machine_, {{"event", "load"}, {"job", name}, {"bytes", bytes}}, true);
  pump();
}

bool MachineSession::can(const Json& state, const char* what) const {
  const Json& list = state["can"];
  return std::find(list.begin(), list.end(), what) != list.end();
}

void MachineSession::try_command(const char* what) {
  try {
    driver_->command({{"do", what}}, now_s());
    log_.append(machine_, {{"event", "command"}, {"command", {{"do", what}}}});
  } catch (const Error&) {
    // Its phase changed under us: what comes next in hold() is tried all the same.
  }
}

void MachineSession::hold(const std::string& why) {
  if (over_) return;
  const Json state = driver_->state(now_s());
  // Homing hears nothing but a reset.
  if (state["phase"] == "homing") try_command("stop");
  for (const char* what : {"focus_off", "jog_cancel", "pause"})
    if (can(state, what)) try_command(what);
  pump();
  log_.append(machine_, {{"event", "hold"}, {"text", why}}, true);
}

void MachineSession::end(const std::string& why) {
  if (over_) return;
  const Json state = driver_->state(now_s());
  const std::string phase = state["phase"].get<std::string>();
  const bool rests = phase == "idle" || phase == "alarm" || phase == "sleep" || phase == "check" || phase == "unknown";
  if (state["laser_on"] == true || job_active() || !rests) {
    try_command("stop");
    pump(true);
  }
  port_->flush();
  over_ = true;
  timer_.cancel();
  driver_->closed(now_s());
  for (const Json& event : driver_->take_events()) log_.append(machine_, event);
  port_->close();
  lock_.reset();
  log_.append(machine_, {{"event", "close"}, {"text", why}}, true);
}

void MachineSession::look_for_stop() {
  if (over_ || !lock_ || !lock_->stop_asked()) return;
  try {
    command({{"do", "stop"}});
  } catch (const Error&) {
    end("Stopped from the command line.");
  }
}

Json MachineSession::state() const { return driver_->state(now_s()); }

bool MachineSession::job_active() const {
  const Json state = driver_->state(now_s());
  return state["job"].is_object() && state["job"]["ended"].is_null();
}

}  // namespace formwright
