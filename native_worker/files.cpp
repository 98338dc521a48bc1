// SPDX-License-Identifier: GPL-3.0-or-later
#include "files.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <chrono>
#include <cstring>
#include <fstream>
#include <map>
#include <thread>

#include "base/context.h"
#include "base/error.h"
#include "base/sha256.h"
#include "job/file_pack.h"

namespace formwright {

std::shared_ptr<const Bytes> read_file(const std::filesystem::path& path, const std::string& where,
                                       std::uintmax_t limit_bytes) {
  std::error_code status;
  if (!std::filesystem::exists(path, status))
    throw Error(ErrorCode::invalid_input, where, "There is no file " + path.string() + ": check the name.");
  if (!std::filesystem::is_regular_file(path, status))
    throw Error(ErrorCode::invalid_input, where, path.string() + " is not a file: name a mesh file.");
  const std::uintmax_t size = std::filesystem::file_size(path, status);
  if (size > limit_bytes)
    throw Error(ErrorCode::invalid_input, where,
                path.string() + " is larger than " + std::to_string(limit_bytes >> 20) + " MB: simplify it first.");
  std::ifstream stream(path, std::ios::binary);
  auto bytes = std::make_shared<Bytes>(static_cast<std::size_t>(size));
  stream.read(reinterpret_cast<char*>(bytes->data()), static_cast<std::streamsize>(size));
  if (!stream) throw Error(ErrorCode::invalid_input, where, path.string() + " cannot be read: check its permissions.");
  return bytes;
}

void write_file(const std::filesystem::path& path, ByteView bytes) {
  const std::filesystem::path temporary = path.string() + ".part-" + std::to_string(::getpid());
  const auto fail = [&](const std::string& what) {
    const std::string reason = std::strerror(errno);
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw Error(ErrorCode::invalid_input, "out",
                path.string() + " cannot be " + what + " (" + reason + "): choose another folder or make room.");
  };
  const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) fail("written");
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::write(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      ::close(descriptor);
      fail("written");
    }
    done += static_cast<std::size_t>(count);
  }
  if (::fsync(descriptor) != 0 && errno != EINVAL) {
    ::close(descriptor);
    fail("written");
  }
  ::close(descriptor);
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail("put in its place");
}

std::shared_ptr<const Bytes> pack_folder(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                         const std::string& where) {
  std::vector<std::shared_ptr<const Bytes>> kept;
  std::map<std::string, ByteView> files;
  for (const std::string& name : names) {
    kept.push_back(read_file(folder / name, where));
    files[name] = *kept.back();
  }
  return std::make_shared<const Bytes>(pack_files(files, Context()));
}

std::optional<Bytes> ResultFolder::find(const std::string& key) const {
  const std::filesystem::path path = folder_ / key;
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) return std::nullopt;
  try {
    return *read_file(path, "");
  } catch (const Error&) {
    return std::nullopt;
  }
}

void ResultFolder::keep(const std::string& key, const Bytes& result) const {
  std::error_code status;
  std::filesystem::create_directories(folder_, status);
  try {
    // Threads of one process may keep the same key at once: each writes to a name of its own.
    const std::filesystem::path own =
        folder_ / (key + "-" + std::to_string(std::hash<std::thread::id>{}(std::this_thread::get_id())));
    write_file(own, result);
    std::filesystem::rename(own, folder_ / key, status);
  } catch (const Error&) {
    // What cannot be kept is computed again.
  }
  release(key);
}

namespace {

/// Ended processes whose parent has not asked for them yet still have their number: they do not run.
bool runs(long process) {
  if (::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) return false;
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return true;  // no /proc here, or not ours to read
  const std::size_t name_end = text.rfind(')');
  return name_end == std::string::npos || name_end + 2 >= text.size() ||
         (text[name_end + 2] != 'Z' && text[name_end + 2] != 'X');
}

}  // namespace

bool ResultFolder::claim(const std::string& key) const {
  std::error_code status;
  std::filesystem::create_directories(folder_, status);
  const std::filesystem::path path = folder_ / (key + ".claim");
  char machine[256] = "";
  ::gethostname(machine, sizeof machine - 1);
  for (int attempt = 0; attempt < 2; ++attempt) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor >= 0) {
      const std::string owner = std::string(machine) + " " + std::to_string(::getpid());
      const bool written = ::write(descriptor, owner.data(), owner.size()) == static_cast<ssize_t>(owner.size());
      ::close(descriptor);
      if (!written) release(key);
      return true;
    }
    if (errno != EEXIST) return true;  // a folder that cannot be written shares nothing
    std::ifstream claim(path);
    std::string owner_machine;
    long owner = 0;
    if (!(claim >> owner_machine >> owner)) return false;  // just being written, or just gone: ask again later
    const bool gone = owner_machine == machine && owner != ::getpid() && !runs(owner);
    const auto written = std::filesystem::last_write_time(path, status);
    const bool old = !status && std::filesystem::file_time_type::clock::now() - written > std::chrono::minutes(10);
    if (!gone && !old) return false;
    std::filesystem::remove(path, status);
  }
  return false;
}

void ResultFolder::release(const std::string& key) const {
  std::error_code status;
  std::filesystem::remove(folder_ / (key + ".claim"), status);
}

void share_results(const ResultFolder& folder, Host& host) {
  host.find_result = [folder](const std::string& key) { return folder.find(key); };
  host.keep_result = [folder](const std::string& key, const Bytes& bytes) { folder.keep(key, bytes); };
  host.claim_result = [folder](const std::string& key) { return folder.claim(key); };
  host.release_result = [folder](const std::string& key) { folder.release(key); };
}

std::string sha256_of_file(const std::filesystem::path& path) {
  const auto fail = [&] {
    return Error(ErrorCode::internal, "", path.string() + " cannot be read (" + std::strerror(errno) + ").");
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) throw fail();
  const std::size_t size = std::filesystem::file_size(path);
  if (size == 0) {  // cannot be mapped
    ::close(descriptor);
    return sha256_hex({});
  }
  void* data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  ::close(descriptor);
  if (data == MAP_FAILED) throw fail();
  ::madvise(data, size, MADV_SEQUENTIAL);
  const std::string hash = sha256_hex({static_cast<const std::byte*>(data), size});
  ::munmap(data, size);
  return hash;
}

std::filesystem::path default_data_folder() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data && *data) return std::filesystem::path(data) / "formwright";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home && *home ? home : ".") / ".local/share/formwright";
}

}  // namespace formwright
