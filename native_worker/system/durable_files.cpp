// SPDX-License-Identifier: GPL-3.0-or-later
#include "system/durable_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <vector>

#include "base/sha256.h"

namespace formwright {
namespace {

constexpr std::string_view temporary_mark = ".part-", checksum_mark = "formwright-sha256 ";

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw StorageError(
      ErrorCode::invalid_input, "out",
      path.string() + " cannot be " + what + " (" + std::strerror(errno) + "): choose another folder or make room.");
}

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags) : number_(::open(path.c_str(), flags | O_CLOEXEC, 0644)) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    const int kept = errno;  // of the error that is being reported
    if (number_ >= 0) ::close(number_);
    errno = kept;
  }
  operator int() const { return number_; }

 private:
  int number_;
};

/// False with errno. Some file systems have nothing to synchronise, and say so with EINVAL (fsync(2)).
bool synchronise(int descriptor) { return ::fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS; }

void sync_folder(const std::filesystem::path& folder) {
  const Descriptor descriptor(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (descriptor < 0 && errno == EACCES) return;  // may be written to, yet not be read
  if (descriptor < 0 || !synchronise(descriptor)) fail(folder, "written");
}

bool write_all(int descriptor, ByteView bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  static std::atomic<unsigned> count{0};
  return path.string() + std::string(temporary_mark) + std::to_string(::getpid()) + "-" + std::to_string(++count);
}

void write_file(const std::filesystem::path& path, ByteView bytes) {
  const std::filesystem::path temporary = temporary_name(path);
  const auto give_up = [&](const std::string& what) {
    const int reason = errno;
    ::unlink(temporary.c_str());
    errno = reason;
    fail(path, what);
  };
  {
    const Descriptor descriptor(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    if (descriptor < 0) fail(path, "written");
    if (!write_all(descriptor, bytes) || !synchronise(descriptor)) give_up("written");
  }
  if (std::rename(temporary.c_str(), path.c_str()) != 0) give_up("put in its place");
  sync_folder(path.parent_path());
}

void make_folder(const std::filesystem::path& path) {
  std::error_code status;
  if (path.empty() || std::filesystem::is_directory(path, status)) return;
  make_folder(path.parent_path());
  std::filesystem::create_directory(path, status);
  if (status) {
    errno = status.value();
    fail(path, "made");
  }
  sync_folder(path.parent_path());
}

void sync_file(const std::filesystem::path& path) {
  const Descriptor descriptor(path, O_RDONLY);
  if (descriptor < 0 || !synchronise(descriptor)) fail(path, "written");
}

void move_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail(to, "put in its place");
  sync_folder(to.parent_path());
}

bool remove_for_good(const std::filesystem::path& path) {
  std::error_code status;
  std::filesystem::remove_all(path, status);
  if (status) return false;
  try {
    sync_folder(path.parent_path());
  } catch (const StorageError&) {
    return false;
  }
  return true;
}

bool process_runs(long process) {
  if (::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) return false;
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return true;  // no /proc here, or not ours to read
  const std::size_t name_end = text.rfind(')');
  return name_end == std::string::npos || name_end + 2 >= text.size() ||
         (text[name_end + 2] != 'Z' && text[name_end + 2] != 'X');
}

void remove_abandoned_files(const std::filesystem::path& folder) {
  std::error_code status;
  std::vector<std::filesystem::path> abandoned;
  for (std::filesystem::directory_iterator it(folder, status), end; !status && it != end; it.increment(status)) {
    const std::string name = it->path().filename().string();
    const std::size_t mark = name.rfind(temporary_mark);
    if (mark == std::string::npos) continue;
    const long process = std::strtol(name.c_str() + mark + temporary_mark.size(), nullptr, 10);
    if (process > 0 && (process == ::getpid() || !process_runs(process))) abandoned.push_back(it->path());
  }
  for (const auto& path : abandoned) std::filesystem::remove(path, status);
}

Bytes with_checksum(ByteView content) {
  Bytes file = to_bytes(std::string(checksum_mark) + sha256_hex(content) + "\n");
  file.insert(file.end(), content.begin(), content.end());
  return file;
}

std::optional<Bytes> checked_content(ByteView file) {
  constexpr std::size_t digits = 64, head = checksum_mark.size() + digits + 1;
  if (file.size() < head || !as_text(file).starts_with(checksum_mark)) return std::nullopt;
  const ByteView content = file.subspan(head);
  if (as_text(file)[head - 1] != '\n') return std::nullopt;
  if (as_text(file).substr(checksum_mark.size(), digits) != sha256_hex(content)) return std::nullopt;
  return Bytes(content.begin(), content.end());
}

}  // namespace formwright
