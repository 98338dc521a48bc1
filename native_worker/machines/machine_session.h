// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A driver of core/machines at an open port: time, bytes, the log, and what happens when the one who steers is gone.
// The same for the worker and the command line. All calls on the thread that runs the io_context.
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "machines/controllers.h"
#include "machines/port/machine_log.h"
#include "machines/port/machine_port.h"

namespace formwright {

/// One program at a time has a machine: DATA/machine_sessions/ID.lock, with the number of its process.
class MachineLock {
 public:
  /// Throws Error{could_not_solve, "machine"} when another process has it.
  MachineLock(const std::filesystem::path& data, const Machine& machine);
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;
  ~MachineLock();
  /// Another process asked this one to stop the machine (`ask_to_stop`, then SIGUSR1). Tells that it was heard.
  bool stop_asked();
  /// Asks the process that has the machine to stop it and waits up to 3 s for it to hear. 0: nobody has it; else its
  /// number. Throws Error{could_not_solve, "machine"} when it does not hear.
  static int ask_to_stop(const std::filesystem::path& data, const Machine& machine);

 private:
  std::filesystem::path stop_file_;
  int descriptor_ = -1;
};

/// The driver options of this machine: `options` of the caller, with controller and speed as registered where they
/// are absent. Throws Error{invalid_input, "controller"} for one that does not speak over such a port.
Json driver_options(const Machine& machine, Json options);

/// Of a job file for a machine.
inline constexpr std::uintmax_t max_machine_job_bytes = std::uintmax_t{128} << 20;

class MachineSession : public std::enable_shared_from_this<MachineSession> {
 public:
  struct Listener {
    std::function<void(const Json& state)> state;           // at most 10 a second, and at every change of phase
    std::function<void(const Json& events)> events;         // a list, not empty
    std::function<void(const std::string& sentence)> gone;  // the port closed by itself; the session is over
  };
  /// Throws Error{invalid_input} for options the driver does not take.
  MachineSession(boost::asio::io_context& io, const Machine& machine, const Json& options,
                 std::shared_ptr<MachinePort> port, std::unique_ptr<MachineLock> lock, MachineLog& log);
  ~MachineSession();

  void begin(Listener listener);
  /// Throws Error invalid_input: what cannot be done now, or was not confirmed.
  void command(const Json& command);
  void load(const std::string& name, ByteView job) { load_prepared(name, *prepare_job(options_, job), job.size()); }
  /// `job`: of prepare_job() with `options()`, on any thread. It then holds what was loaded before.
  void load_prepared(const std::string& name, PreparedJob& job, std::size_t bytes);
  const Json& options() const { return options_; }
  /// The one who steered is gone: laser off and feed hold, in whatever is going on; homing is stopped.
  void hold(const std::string& why);
  /// Stops what runs and closes the port.
  void end(const std::string& why);
  /// Looks whether another process asks for a stop.
  void look_for_stop();

  /// The driver of a session that is over, for one who has time to free its job.
  std::unique_ptr<MachineDriver> take_driver() { return over_ ? std::move(driver_) : nullptr; }

  Json state() const;
  bool job_active() const;  // started and not ended, also while it is held
  bool over() const { return over_; }

 private:
  double now_s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }
  bool can(const Json& state, const char* what) const;
  void try_command(const char* what);
  void tick();
  void pump(bool first = false);
  void publish();

  boost::asio::steady_timer timer_;
  const Machine machine_;
  const Json options_;
  std::unique_ptr<MachineDriver> driver_;
  std::shared_ptr<MachinePort> port_;
  std::unique_ptr<MachineLock> lock_;
  MachineLog& log_;
  Listener listener_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double reported_s_ = -1;
  std::string reported_phase_;
  bool over_ = false;
};

}  // namespace formwright
