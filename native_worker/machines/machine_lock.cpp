// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "base/error.h"
#include "machines/machine_session.h"

namespace formwright {
namespace {

std::filesystem::path lock_file(const std::filesystem::path& data, const Machine& machine) {
  std::error_code status;
  std::filesystem::create_directories(data / "machine_sessions", status);
  return data / "machine_sessions" / (machine.id + ".lock");
}

int holder_of(int descriptor) {
  char text[32] = "";
  const ssize_t count = ::pread(descriptor, text, sizeof text - 1, 0);
  return count > 0 ? std::atoi(text) : 0;
}

}  // namespace

MachineLock::MachineLock(const std::filesystem::path& data, const Machine& machine) {
  const auto path = lock_file(data, machine);
  stop_file_ = path.string() + ".stop";
  descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (descriptor_ < 0)
    throw Error(ErrorCode::could_not_solve, "machine",
                "The folder " + data.string() + " cannot be written: choose another with --data.");
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    const int holder = holder_of(descriptor_);
    ::close(descriptor_);
    descriptor_ = -1;
    throw Error(ErrorCode::could_not_solve, "machine",
                machine.name + " is driven by another formwright (process " + std::to_string(holder) +
                    "): end that one, or stop the machine with formwright machine stop.");
  }
  std::error_code ignored;
  std::filesystem::remove(stop_file_, ignored);
  const std::string own = std::to_string(::getpid()) + "\n";
  if (::ftruncate(descriptor_, 0) != 0 || ::pwrite(descriptor_, own.data(), own.size(), 0) < 0) {
    // Another process that wants to stop the machine then finds no number, and says that it cannot.
  }
}

MachineLock::~MachineLock() {
  if (descriptor_ < 0) return;
  if (::ftruncate(descriptor_, 0) != 0) {
    // The lock goes all the same.
  }
  ::close(descriptor_);
}

bool MachineLock::stop_asked() {
  std::error_code status;
  return std::filesystem::remove(stop_file_, status);
}

int MachineLock::ask_to_stop(const std::filesystem::path& data, const Machine& machine) {
  const auto path = lock_file(data, machine);
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) return 0;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) {  // nobody has it
    ::close(descriptor);
    return 0;
  }
  const int holder = holder_of(descriptor);
  ::close(descriptor);
  const std::filesystem::path stop_file = path.string() + ".stop";
  const int request = ::open(stop_file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (request >= 0) ::close(request);
  if (holder > 1) ::kill(holder, SIGUSR1);
  std::error_code status;
  for (int i = 0; i < 60; ++i) {
    if (!std::filesystem::exists(stop_file, status)) return holder;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  throw Error(ErrorCode::could_not_solve, "machine",
              "The program that drives " + machine.name + " (process " + std::to_string(holder) +
                  ") does not respond: switch the machine off.");
}

}  // namespace formwright
