// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What all machines have in common for those who hold the port: a driver gets what arrived and what the person
// wants, and says what to write. It has no clock and no port of its own, so the same one runs in the page, in the
// worker, on the command line and in tests.
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "base/data/json.h"
#include "machines/driver/driver_options.h"

namespace formwright {

enum class MachinePhase {
  unknown,
  idle,
  homing,
  jogging,
  running,
  pausing,
  paused,
  stopping,
  alarm,
  door,
  check,
  sleep
};
const char* to_string(MachinePhase phase);

enum class MachineConnection { closed, greeting, ready, silent };
const char* to_string(MachineConnection connection);

/// The job that was started last.
struct MachineJob {
  std::string name;
  int line_count = 0, sent = 0, acknowledged = 0;
  int line_now = 0;  // of the file, counted from 1: the last one that the machine has taken in
  double started_s = 0, ended_s = 0;
  std::string ended;  // "", "done", "stopped", "failed" or "cut_off"
};

/// A job as a driver reads it: reading a large one takes seconds, and needs nothing but the machine's options.
class PreparedJob {
 public:
  virtual ~PreparedJob() = default;
};

class MachineDriver {
 public:
  virtual ~MachineDriver() = default;

  /// The port is open; nothing has been said yet. Times are seconds of any clock that only goes forward.
  virtual void opened(double now_s) = 0;
  /// The port is gone: a job that ran is cut off, nothing is kept to be sent later, where the head stands is unknown.
  virtual void closed(double now_s) = 0;
  virtual void received(ByteView bytes, double now_s) = 0;
  /// To be called every `tick_s` or oftener while the port is open.
  virtual void tick(double now_s) = 0;
  static constexpr double tick_s = 0.05;

  /// What the person wants: {"do": NAME, ...}, docs/machines.md. Throws Error invalid_input (`where`: the field) where
  /// it cannot be done now, or moves the machine or turns its laser on without "confirmed": true.
  virtual void command(const Json& command, double now_s) = 0;
  /// Takes a job without starting it. Throws Error invalid_input ("job": with the line).
  void load(const std::string& name, ByteView job) { load_prepared(name, *prepare(job)); }
  /// The first half of `load`, which leaves the driver as it is.
  virtual std::unique_ptr<PreparedJob> prepare(ByteView job) const = 0;
  /// The second half, in no time. `job` then holds what was loaded before, to be freed where that delays nobody.
  virtual void load_prepared(const std::string& name, PreparedJob& job) = 0;
  /// docs/machines.md, "State".
  virtual Json state(double now_s) const = 0;

  /// Packets to be written in this order since the last call: those that stop something come first. Serial lines join
  /// them; USB and UDP send each as one transfer.
  std::vector<Bytes> take_output();
  /// What was said since the last call: [{"event": "sent" | "received" | "note" | "ended", "text" or "how", "now_s"}].
  Json take_events();

 protected:
  void write(std::string_view bytes) { output_.push_back(to_bytes(bytes)); }
  /// Ahead of everything that was not taken yet.
  void write_urgently(std::string_view bytes);
  void drop_output() { output_.clear(); }
  /// The lines that are whole now; the rest waits for its end.
  std::vector<std::string> lines_in(ByteView bytes);
  void forget_half_lines() { heard_.clear(); }
  bool job_active() const { return job_ && job_->ended.empty(); }
  /// False where no job was running.
  bool end_job(const char* how, double now_s);
  /// The state that every controller has; drivers fill in their own. `axes_known`: of x, y and z, is the head's place
  /// in work coordinates known? The whole position counts as known where x and y are.
  Json common_state(const char* controller, MachineConnection connection, MachinePhase phase,
                    const std::array<bool, 3>& axes_known, double now_s) const;

  std::optional<MachineJob> job_;
  void say(const char* event, std::string_view text, double now_s);
  void note(std::string_view text, double now_s) { say("note", text, now_s); }

 private:
  std::vector<Bytes> output_;
  std::size_t urgent_count_ = 0;
  std::string heard_;
  Json events_ = Json::array();
};

// ---- what drivers share ----
namespace machines_detail {

/// What a driver makes of a job's file.
template <class Program>
struct PreparedProgram final : PreparedJob {
  explicit PreparedProgram(Program p) : program(std::move(p)) {}
  Program program;
};
template <class Program>
std::unique_ptr<PreparedJob> prepared(Program program) {
  return std::make_unique<PreparedProgram<Program>>(std::move(program));
}
template <class Program>
Program& program_in(PreparedJob& job) {
  return dynamic_cast<PreparedProgram<Program>&>(job).program;
}

[[noreturn]] void refuse(const std::string& where, const std::string& sentence);
/// Throws unless command["confirmed"] is true.
void require_confirmation(const Json& command, const std::string& what_happens);
/// Where the person says that z is 0 for a mill's job: at the tip now ("here"), or where it was set before ("kept").
/// Throws Error invalid_input where the command has no such "z".
enum class ZChoice { here, kept };
ZChoice z_choice_of(const Json& command);
/// For the state, "z_choice": where z is 0 in machine coordinates, and how long ago it was set here; null where
/// unknown.
Json z_choice_json(std::optional<double> origin_machine_mm, std::optional<double> set_s, double now_s);
/// As fallback of number_of: the command must give the number.
inline constexpr double absent_number = std::numeric_limits<double>::quiet_NaN();
/// A number of the command in its range; `fallback` where it is absent, an error where that is NaN.
double number_of(const Json& command, const char* name, double minimum, double maximum, double fallback);
/// What to "do". Throws where it is no command, is not known to any machine, or the machine is not connected.
std::string command_name(const Json& command, MachineConnection connection);
[[noreturn]] void refuse_in_phase(const std::string& what, MachinePhase phase);
/// bounds_mm: left, low, right, high.
std::array<double, 4> bounds_of(const Json& command);
/// The corners of bounds_mm, once around and back.
std::array<std::array<double, 2>, 5> corners_around(const std::array<double, 4>& bounds_mm);
/// "line": 1 to `longest` characters that can be printed.
std::string line_of(const Json& command, std::size_t longest);
/// "axes" as the words "X0Y0", "xy" where it is absent; `space` before each.
std::string zero_words(const Json& command, const char* space);
Json job_json(const MachineJob& job, double now_s);
/// For the state, "alarm": what happened, and what to do.
Json alarm_json(int code, const std::string& text, const std::string& fix);
/// "12.5": at most three decimals, none that are zero.
std::string decimal(double value);

}  // namespace machines_detail
}  // namespace formwright
