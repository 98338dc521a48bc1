// SPDX-License-Identifier: GPL-3.0-or-later
#include "jobs/solver_sandbox.h"

#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/sched.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>

namespace formwright {
namespace {

// linux/landlock.h, which is older than the kernel on many computers. The numbers are the same on all processors.
constexpr long create_ruleset = 444, add_rule = 445, restrict_self = 446;
constexpr std::uint32_t ask_version = 1, rule_path_beneath = 1;
enum : std::uint64_t {
  may_execute = 1u << 0,
  may_write_file = 1u << 1,
  may_read_file = 1u << 2,
  may_read_folder = 1u << 3,
  may_remove_folder = 1u << 4,
  may_remove_file = 1u << 5,
  may_make_folder = 1u << 7,
  may_make_file = 1u << 8,
  files_of_version_1 = (1u << 13) - 1,
  may_move = 1u << 13,       // version 2
  may_truncate = 1u << 14,   // version 3
  may_ask_device = 1u << 15  // version 5
};
enum : std::uint64_t { may_bind_tcp = 1, may_connect_tcp = 2 };  // version 4
struct Ruleset {
  std::uint64_t files, network;
};
struct __attribute__((packed)) PathRule {
  std::uint64_t allowed;
  std::int32_t parent;
};

void allow(int ruleset, const std::filesystem::path& path, std::uint64_t rights) {
  const int descriptor = ::open(path.c_str(), O_PATH | O_CLOEXEC);
  if (descriptor < 0) return;  // nothing there to be read
  struct stat status {};
  // Rights of folders alone are refused for files (landlock_add_rule(2), EINVAL).
  if (::fstat(descriptor, &status) == 0 && !S_ISDIR(status.st_mode))
    rights &= may_execute | may_write_file | may_read_file | may_truncate | may_ask_device;
  const PathRule rule{rights, descriptor};
  ::syscall(add_rule, ruleset, rule_path_beneath, &rule, 0);
  ::close(descriptor);
}

#if defined(__x86_64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t architecture = 0;
#endif

/// Calls that no solver needs, whatever their arguments.
constexpr std::uint32_t forbidden_calls[] = {
#ifdef SYS_fork
    SYS_fork,
#endif
#ifdef SYS_vfork
    SYS_vfork,
#endif
    SYS_execve,
    SYS_execveat,
    SYS_socket,
    SYS_socketpair,
    SYS_bind,
    SYS_connect,
    SYS_listen,
    SYS_accept,
    SYS_accept4,
    SYS_ptrace,
    SYS_process_vm_readv,
    SYS_process_vm_writev,
    SYS_kill,
    SYS_tkill,
    SYS_rt_sigqueueinfo,
    SYS_rt_tgsigqueueinfo,
    SYS_pidfd_open,
    SYS_pidfd_getfd,
    SYS_pidfd_send_signal,
    SYS_mount,
    SYS_umount2,
    SYS_pivot_root,
    SYS_chroot,
    SYS_setns,
    SYS_unshare,
    SYS_bpf,
    SYS_perf_event_open,
    SYS_keyctl,
    SYS_add_key,
    SYS_request_key,
    SYS_userfaultfd,
    SYS_io_uring_setup,
    SYS_io_uring_enter,
    SYS_io_uring_register,
    SYS_open_by_handle_at,
    SYS_init_module,
    SYS_finit_module,
    SYS_delete_module,
    SYS_kexec_load,
    SYS_reboot,
    SYS_swapon,
    SYS_swapoff,
    SYS_sethostname,
    SYS_setpriority,
    SYS_sched_setscheduler,
    SYS_sched_setparam,
    SYS_sched_setattr,
};

std::vector<sock_filter> filter_program() {
  constexpr std::uint32_t refused = SECCOMP_RET_ERRNO | EPERM, absent = SECCOMP_RET_ERRNO | ENOSYS;
  std::vector<sock_filter> program;
  const auto load = [&](std::size_t offset) {
    program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
  };
  const auto give = [&](std::uint32_t answer) { program.push_back(BPF_STMT(BPF_RET | BPF_K, answer)); };
  const auto low_word = [](int argument) {  // both processors are little-endian
    return offsetof(seccomp_data, args) + static_cast<std::size_t>(argument) * sizeof(std::uint64_t);
  };
  load(offsetof(seccomp_data, arch));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, architecture, 1, 0));
  give(refused);
  load(offsetof(seccomp_data, nr));
#if defined(__x86_64__)
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JGE | BPF_K, 0x40000000, 0, 1));  // the same calls, numbered as x32
  give(refused);
#endif
  for (const std::uint32_t call : forbidden_calls) {
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, call, 0, 1));
    give(refused);
  }
  // clone3 keeps its flags in memory, where a filter cannot look: without it, the C library uses clone.
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1));
  give(absent);
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone, 0, 4));
  load(low_word(0));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JSET | BPF_K, CLONE_THREAD, 1, 0));
  give(refused);
  give(SECCOMP_RET_ALLOW);
  // abort() and pthread_kill() signal threads of this process.
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_tgkill, 0, 4));
  load(low_word(0));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(::getpid()), 1, 0));
  give(refused);
  give(SECCOMP_RET_ALLOW);
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_prlimit64, 0, 4));
  load(low_word(0));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, 0, 1, 0));
  give(refused);
  give(SECCOMP_RET_ALLOW);
  give(SECCOMP_RET_ALLOW);
  return program;
}

}  // namespace

int landlock_version() {
  const long version = ::syscall(create_ruleset, nullptr, 0, ask_version);
  return version > 0 ? static_cast<int>(version) : 0;
}

bool restrict_files(const FileAccess& access) {
  const int version = landlock_version();
  if (version == 0) return false;
  Ruleset handled{files_of_version_1, 0};
  if (version >= 2) handled.files |= may_move;
  if (version >= 3) handled.files |= may_truncate;
  if (version >= 4) handled.network = may_bind_tcp | may_connect_tcp;
  if (version >= 5) handled.files |= may_ask_device;
  // Before version 4 the kernel knows the first field alone.
  const std::size_t size = version >= 4 ? sizeof handled : sizeof handled.files;
  const int ruleset = static_cast<int>(::syscall(create_ruleset, &handled, size, 0));
  if (ruleset < 0) return false;
  constexpr std::uint64_t reading = may_read_file | may_read_folder;
  constexpr std::uint64_t writing =
      reading | may_write_file | may_remove_folder | may_remove_file | may_make_folder | may_make_file | may_truncate;
  for (const auto& path : access.read) allow(ruleset, path, reading & handled.files);
  for (const auto& path : access.write) allow(ruleset, path, writing & handled.files);
  const bool restricted = ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 && ::syscall(restrict_self, ruleset, 0) == 0;
  ::close(ruleset);
  return restricted;
}

std::vector<std::filesystem::path> system_files() {
  return {"/usr",           "/lib",
          "/lib64",         "/etc/ld.so.cache",
          "/etc/localtime", "/proc/self",
          "/proc/cpuinfo",  "/proc/meminfo",
          "/proc/stat",     "/proc/sys/vm",
          "/dev/null",      "/dev/zero",
          "/dev/urandom",   "/sys/devices/system/cpu",
          "/sys/kernel/mm"};
}

bool system_call_filter_available() {
  if (architecture == 0) return false;
  const std::uint32_t action = SECCOMP_RET_ERRNO;
  return ::syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

bool filter_system_calls() {
  if (architecture == 0) return false;
  std::vector<sock_filter> program = filter_program();
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &filter) == 0;
}

}  // namespace formwright
