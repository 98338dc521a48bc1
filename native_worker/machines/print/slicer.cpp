// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/print/slicer.h"

#include <fcntl.h>
#include <linux/close_range.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/error.h"
#include "system/files.h"
#include "system/secret.h"

namespace formwright {
namespace {

constexpr std::uintmax_t max_sliced_bytes = std::uintmax_t{1} << 30;

/// A folder of ours that goes with this object.
class WorkFolder {
 public:
  explicit WorkFolder(const std::filesystem::path& data) : path(data / ("slicing-" + random_hex(8))) {
    std::error_code status;
    std::filesystem::create_directories(path / "home", status);
    std::filesystem::permissions(path, std::filesystem::perms::owner_all, status);
    if (!std::filesystem::is_directory(path / "home"))
      throw Error(ErrorCode::could_not_solve, "machine",
                  "There is no room to slice in " + data.string() + ": free some.");
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;
  ~WorkFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  const std::filesystem::path path;
};

bool plain_profile_name(const std::string& name) {
  return !name.empty() && name.size() <= 80 && name[0] != '.' && name[0] != '-' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) || c == '_' || c == '-' || c == ' ' || c == '.' || c == '@';
         });
}

/// The last lines the program wrote, without its time stamps.
std::string last_words(const std::filesystem::path& log) {
  std::error_code status;
  if (!std::filesystem::exists(log, status) || std::filesystem::file_size(log, status) == 0) return "";
  std::string text(as_text(*read_file(log, "sha256", std::uintmax_t{64} << 20)));
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  text = text.substr(text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 32; }, ' ');
  return text.substr(0, 240);
}

/// Starts it in a process group of its own, which ends with this thread.
pid_t start(const std::vector<std::string>& words, const std::filesystem::path& folder) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const std::string home = "HOME=" + (folder / "home").string(), temporary = "TMPDIR=" + folder.string();
  const char* environment[] = {home.c_str(), temporary.c_str(), "PATH=/usr/bin:/bin", "LC_ALL=C.UTF-8", nullptr};
  const std::string log = (folder / "log").string(), work = folder.string();
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child != 0) return child;
  // Between fork and exec only what is safe with other threads around.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);
  const int null = ::open("/dev/null", O_RDONLY | O_CLOEXEC),
            out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  ::dup2(null, STDIN_FILENO);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(out, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U,
                CLOSE_RANGE_CLOEXEC);  // pages' sockets and machines' ports are not the slicer's
  const rlimit file_limit{max_sliced_bytes, max_sliced_bytes}, no_core{0, 0};
  ::setrlimit(RLIMIT_FSIZE, &file_limit);
  ::setrlimit(RLIMIT_CORE, &no_core);
  ::setpriority(PRIO_PROCESS, 0, 5);
  if (::chdir(work.c_str()) != 0) ::_exit(127);
  ::execve(arguments[0], arguments.data(), const_cast<char**>(environment));
  ::_exit(127);
}

}  // namespace

std::string slicer_program() {
  static const std::string program = [] {
    for (const char* path : {"/usr/bin/prusa-slicer", "/usr/local/bin/prusa-slicer", "/usr/bin/PrusaSlicer",
                             "/opt/PrusaSlicer/prusa-slicer", "/opt/PrusaSlicer/bin/prusa-slicer"})
      if (::access(path, X_OK) == 0) return std::string(path);
    return std::string();
  }();
  return program;
}

std::vector<std::string> slicer_profiles(const std::filesystem::path& data) {
  std::vector<std::string> names;
  std::error_code status;
  for (std::filesystem::directory_iterator it(data / "slicer_profiles", status), end; !status && it != end;
       it.increment(status))
    if (it->path().extension() == ".ini" && plain_profile_name(it->path().stem().string()))
      names.push_back(it->path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

Bytes slice_model(ByteView model, const std::string& profile, const std::filesystem::path& data, double seconds_limit,
                  const std::atomic<bool>& cancelled) {
  const std::string program = slicer_program();
  if (program.empty())
    throw Error(ErrorCode::invalid_input, "machine",
                "PrusaSlicer is not installed: install prusa-slicer, or slice the STL yourself.");
  std::filesystem::path profile_file;
  if (!profile.empty()) {
    const auto names = slicer_profiles(data);
    if (std::find(names.begin(), names.end(), profile) == names.end())
      throw Error(ErrorCode::invalid_input, "profile",
                  "There is no profile of that name: export it from PrusaSlicer into " +
                      (data / "slicer_profiles").string() + ".");
    profile_file = data / "slicer_profiles" / (profile + ".ini");
  }
  if (model.size() < 84)
    throw Error(ErrorCode::invalid_input, "sha256", "The file is not a model: choose an STL or a 3MF file.");
  const WorkFolder folder(std::filesystem::absolute(data));
  const auto input = folder.path / (as_text(model).starts_with("PK") ? "model.3mf" : "model.stl"),
             output = folder.path / "sliced.gcode";
  write_file(input, model);
  std::vector<std::string> words{program, "--export-gcode"};
  if (!profile_file.empty()) words.insert(words.end(), {"--load", std::filesystem::absolute(profile_file).string()});
  // Behind what a profile or the 3MF itself says, so that it wins: no program of theirs is run.
  words.insert(words.end(), {"--post-process", "", "--output", output.string(), input.string()});
  const pid_t child = start(words, folder.path);
  if (child < 0)
    throw Error(ErrorCode::could_not_solve, "machine",
                "PrusaSlicer could not be started: the system has no room for another program.");
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds_limit);
  int status = 0;
  bool late = false;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    late = std::chrono::steady_clock::now() > end;
    if (late || cancelled) {
      ::kill(-child, SIGKILL);
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      break;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  ::kill(-child, SIGKILL);  // what it may have left behind
  if (cancelled) throw Error(ErrorCode::cancelled, "", "Cancelled.");
  if (late)
    throw Error(ErrorCode::could_not_solve, "sha256",
                "PrusaSlicer was not done after " + std::to_string(static_cast<int>(seconds_limit)) +
                    " s and was ended: give it a simpler model.");
  std::error_code ignored;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || !std::filesystem::exists(output, ignored)) {
    const std::string said = last_words(folder.path / "log");
    throw Error(ErrorCode::could_not_solve, "sha256",
                "PrusaSlicer could not slice the model" + (said.empty() ? "" : ": \"" + said + "\"") +
                    ". See whether the model is closed and fits the printer's bed.");
  }
  return *read_file(output, "sha256", max_sliced_bytes);
}

}  // namespace formwright
