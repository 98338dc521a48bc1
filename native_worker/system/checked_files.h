// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Remembers which files were found to have the SHA-256 they are known by, so that a large one is hashed again only when
// it was written to since.
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace formwright {

/// What changes with every write to a file: its number, size and times (inode(7)).
struct FileStamp {
  std::uint64_t inode = 0, bytes = 0;
  std::int64_t modified_ns = 0, changed_ns = 0;
  bool operator==(const FileStamp&) const = default;
};
/// Nothing where there is no such file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// Whether the file has this SHA-256. Reads all of it.
bool has_sha256(const std::filesystem::path& path, const std::string& sha256);

class CheckedFiles {
 public:
  /// Found intact, and not touched since.
  bool known(const std::filesystem::path& path, const std::string& sha256) const;
  /// It was found intact when it had this stamp.
  void note(const std::filesystem::path& path, const std::string& sha256, const FileStamp& stamp);

 private:
  struct Checked {
    std::string sha256;
    FileStamp stamp;
  };
  std::map<std::filesystem::path, Checked> files_;
};

}  // namespace formwright
