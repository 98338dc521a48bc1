// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Disks belong to the host.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/bytes.h"
#include "system/durable_files.h"

namespace formwright {

/// Throws Error{invalid_input, where} when the file cannot be read or is larger than `limit_bytes`.
std::shared_ptr<const Bytes> read_file(const std::filesystem::path& path, const std::string& where,
                                       std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// A file that is known by its SHA-256. Throws as read_file() does, and Error{invalid_input, where} when the bytes have
/// another one: the file was altered.
std::shared_ptr<const Bytes> read_checked_file(const std::filesystem::path& path, const std::string& sha256,
                                               const std::string& where,
                                               std::uintmax_t limit_bytes = std::uintmax_t{4} << 30);

/// A zip of these files of a folder (job/file_pack.h), and of those of `optional` that it has. Throws
/// Error{invalid_input, where} naming the file that is missing.
std::shared_ptr<const Bytes> pack_folder(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                         const std::vector<std::string>& optional, const std::string& where);

/// Intermediate results as files in a folder, which is made when it is needed. Safe for several processes at once:
/// results are put in their place whole and with their checksum, and the same key always means the same bytes. One that
/// was altered is not there. A folder that cannot be written keeps nothing.
class ResultFolder {
 public:
  explicit ResultFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::optional<Bytes> find(const std::string& key) const;
  void keep(const std::string& key, const Bytes& result) const;
  /// True for the first process that asks, until it keeps or releases. A claim whose process is gone (on this machine),
  /// or that is older than ten minutes, counts no more.
  bool claim(const std::string& key) const { return !claim_or_holder(key); }
  /// Nothing where claim() is true; else the name of the machine whose process has the claim.
  std::optional<std::string> claim_or_holder(const std::string& key) const;
  void release(const std::string& key) const;
  /// Removes what processes of this machine that have ended left half done. This process must not use the folder: what
  /// has its number is of an earlier one.
  void remove_abandoned() const;

 private:
  std::filesystem::path folder_;
};

/// SHA-256 of a file without holding it in memory. Throws Error{internal} when it cannot be read.
std::string sha256_of_file(const std::filesystem::path& path);

/// Where jobs, results and machines are kept unless --data says otherwise.
std::filesystem::path default_data_folder();

/// A file that goes with this object, unless it was renamed by then.
struct UploadFile {
  explicit UploadFile(std::filesystem::path p) : path(std::move(p)) {}
  UploadFile(const UploadFile&) = delete;
  UploadFile& operator=(const UploadFile&) = delete;
  ~UploadFile() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
  const std::filesystem::path path;
};

}  // namespace formwright
