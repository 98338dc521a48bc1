// SPDX-License-Identifier: GPL-3.0-or-later
#include "system/checked_files.h"

#include <sys/stat.h>

#include "base/error.h"
#include "system/files.h"

namespace formwright {
namespace {

constexpr std::size_t max_remembered = 10000;

std::int64_t nanoseconds(const timespec& time) { return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec; }

}  // namespace

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileStamp{status.st_ino, static_cast<std::uint64_t>(status.st_size), nanoseconds(status.st_mtim),
                   nanoseconds(status.st_ctim)};
}

bool has_sha256(const std::filesystem::path& path, const std::string& sha256) {
  try {
    return sha256_of_file(path) == sha256;
  } catch (const Error&) {
    return false;
  }
}

bool CheckedFiles::known(const std::filesystem::path& path, const std::string& sha256) const {
  const auto it = files_.find(path);
  return it != files_.end() && it->second.sha256 == sha256 && stamp_of(path) == it->second.stamp;
}

void CheckedFiles::note(const std::filesystem::path& path, const std::string& sha256, const FileStamp& stamp) {
  if (files_.size() >= max_remembered) files_.clear();
  files_[path] = {sha256, stamp};
}

}  // namespace formwright
