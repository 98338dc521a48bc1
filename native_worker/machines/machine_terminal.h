// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A machine driven from the terminal: a session that is run step by step, and the person who is asked before anything
// moves.
#include <boost/asio/io_context.hpp>
#include <atomic>
#include <chrono>
#include <string>
#include <vector>

#include "base/error.h"
#include "machines/machine_commands.h"
#include "machines/machine_session.h"

namespace formwright {

class Terminal {
 public:
  /// `yes`: somebody stands at the machine; confirm() does not ask then.
  Terminal(const MachineRegistry& registry, const Machine& machine, const Json& options,
           const std::atomic<bool>& interrupted, bool yes);
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;
  ~Terminal();

  Json state() const { return session_->state(); }
  MachineSession& session() { return *session_; }
  bool is_mill() const { return options_.value("tool", "laser") == "mill"; }
  /// Has the machine answered every line? (Serial controllers answer each with ok or error.)
  bool all_answered() const { return machine_.kind != MachineKind::serial || unanswered_ == 0; }

  /// Runs until `done(state)` is true. Ctrl-C, a closed terminal and a stop from elsewhere stop the machine first and
  /// then throw Error{cancelled}.
  template <class Done>
  void run_until(const Done& done, double patience_s, const std::string& otherwise) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(patience_s);
    for (;;) {
      serve();
      if (done(session_->state())) return;
      if (std::chrono::steady_clock::now() > end) throw Error(ErrorCode::could_not_solve, "machine", otherwise);
    }
  }

  void connect();
  /// Asks and throws Error{cancelled} unless the answer is yes. The port is served meanwhile.
  void confirm(const std::string& question);
  /// The line that is typed. The port is served meanwhile. Throws Error{cancelled} where the terminal closes.
  std::string ask(const std::string& question);
  static bool can_ask();
  /// Is this command possible now?
  bool can(const char* what) const;
  /// Where the head stands must be known before a job starts.
  void know_position();
  /// The head's place becomes 0 on these axes ("xy"), or the bed's corner does.
  void set_origin(const std::string& axes, const std::string& at = "head");
  /// Until every line is answered and the machine has rested a while. Throws Error{could_not_solve} on an alarm or a
  /// refused line.
  void run_until_rest(const std::string& what);

  static std::string sentence_of(const Json& message, const std::string& otherwise);

 private:
  /// A reset may still be owed to a machine that is being held.
  void let_stop_end();
  /// Lets the port and the clock run for 20 ms.
  void serve();
  [[noreturn]] void stop_and_throw();

  boost::asio::io_context io_{1};
  MachineLog log_;
  const Machine machine_;
  const Json options_;
  const std::atomic<bool>& interrupted_;
  const bool yes_;
  std::shared_ptr<MachineSession> session_;
  std::string gone_;
  int unanswered_ = 0;
};

// ---- flags that all commands which drive a machine take ----

inline const std::vector<std::string> driving_flags{"--data", "--machine", "--controller", "--bed-x-mm", "--bed-y-mm"};

MachineRegistry registry_of(const MachineFlags& flags);
/// The one that --machine names. Throws Error{invalid_input} for one that is not driven from here.
Machine driven_machine(const MachineRegistry& registry, const MachineFlags& flags);
Json options_of(const MachineFlags& flags);

}  // namespace formwright
