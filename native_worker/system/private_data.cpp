// SPDX-License-Identifier: GPL-3.0-or-later
#include "system/private_data.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <system_error>

namespace formwright {
namespace {

constexpr mode_t others = S_IRWXG | S_IRWXO;

/// What formwright puts into DATA.
constexpr std::array ours{"blobs",         "jobs",          "uploads",     "results",          "lock",
                          "machines.json", "machines.lock", "machine_log", "machine_sessions", "prints"};

/// Takes the rights of others away, of the entry itself and of all in it. Links are left alone.
void close_to_others(int folder, const char* name) {
  struct stat status {};
  if (::fstatat(folder, name, &status, AT_SYMLINK_NOFOLLOW) != 0 || status.st_uid != ::geteuid()) return;
  if (S_ISLNK(status.st_mode)) return;
  if ((status.st_mode & others) != 0) ::fchmodat(folder, name, status.st_mode & 07777 & ~others, 0);
  if (!S_ISDIR(status.st_mode)) return;
  const int inner = ::openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  DIR* entries = inner < 0 ? nullptr : ::fdopendir(inner);
  if (entries == nullptr) {
    if (inner >= 0) ::close(inner);
    return;
  }
  while (const dirent* entry = ::readdir(entries))
    if (const std::string found = entry->d_name; found != "." && found != "..")
      close_to_others(::dirfd(entries), found.c_str());
  ::closedir(entries);
}

}  // namespace

void make_new_files_private() { ::umask(077); }

void make_private(const std::filesystem::path& data) {
  struct stat status {};
  if (::stat(data.c_str(), &status) != 0 || !S_ISDIR(status.st_mode) || status.st_uid != ::geteuid()) return;
  const int folder = ::open(data.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  std::error_code unknown;
  const char* home = std::getenv("HOME");
  const bool of_others = (status.st_mode & S_ISVTX) != 0 || data.root_path() == data ||
                         (home != nullptr && std::filesystem::equivalent(data, home, unknown));
  // With the folder closed already, what is in it was closed when it was made.
  const bool open_to_others = (status.st_mode & others) != 0;
  if (open_to_others)
    for (const char* name : ours) close_to_others(folder, name);
  if (open_to_others && !of_others) ::fchmod(folder, status.st_mode & 07777 & ~others);
  ::close(folder);
}

}  // namespace formwright
