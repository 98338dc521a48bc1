// SPDX-License-Identifier: GPL-3.0-or-later
#include "system/files.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <vector>

#include "base/error.h"
#include "base/sha256.h"
#include "job/contract/file_pack.h"
#include "system/host.h"

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

std::shared_ptr<const Bytes> read_checked_file(const std::filesystem::path& path, const std::string& sha256,
                                               const std::string& where, std::uintmax_t limit_bytes) {
  auto bytes = read_file(path, where, limit_bytes);
  if (sha256_hex(*bytes) != sha256)
    throw Error(ErrorCode::invalid_input, where, path.string() + " was altered on the disk: send the file again.");
  return bytes;
}

std::shared_ptr<const Bytes> pack_folder(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                         const std::vector<std::string>& optional, const std::string& where) {
  std::vector<std::shared_ptr<const Bytes>> kept;
  std::map<std::string, ByteView> files;
  const auto add = [&](const std::string& name) {
    kept.push_back(read_file(folder / name, where));
    files[name] = *kept.back();
  };
  for (const std::string& name : names) add(name);
  for (const std::string& name : optional)
    if (std::filesystem::exists(folder / name)) add(name);
  return std::make_shared<const Bytes>(pack_files(files, Context()));
}

std::optional<Bytes> ResultFolder::find(const std::string& key) const {
  const std::filesystem::path path = folder_ / key;
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) return std::nullopt;
  try {
    return checked_content(*read_file(path, ""));
  } catch (const Error&) {
    return std::nullopt;
  }
}

void ResultFolder::keep(const std::string& key, const Bytes& result) const {
  try {
    make_folder(folder_);
    write_file(folder_ / key, with_checksum(result));
  } catch (const Error&) {
    // What cannot be kept is computed again.
  }
  release(key);
}

namespace {

struct ClaimOwner {
  std::string machine;
  long process = 0;
};

/// Nothing where the claim is just gone.
std::optional<ClaimOwner> owner_of(const std::filesystem::path& claim) {
  std::ifstream file(claim);
  ClaimOwner owner;
  if (!(file >> owner.machine >> owner.process)) return std::nullopt;
  return owner;
}

bool has_ended(const ClaimOwner& owner) { return owner.machine == machine_name() && !process_runs(owner.process); }

}  // namespace

std::optional<std::string> ResultFolder::claim_or_holder(const std::string& key) const {
  std::error_code status;
  std::filesystem::create_directories(folder_, status);
  const std::filesystem::path path = folder_ / (key + ".claim");
  // Linked when it is whole: a process that ends before then leaves no claim without an owner.
  const UploadFile own(temporary_name(path));
  std::ofstream text(own.path);
  if (!(text << machine_name() << " " << ::getpid() << std::flush))
    return std::nullopt;                    // nothing is shared on a full disk
  std::string holder = "another computer";  // where the claim goes before it is read
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (::link(own.path.c_str(), path.c_str()) == 0) return std::nullopt;
    if (errno != EEXIST) return std::nullopt;  // nor where there are no hard links
    const auto owner = owner_of(path);
    const auto written = std::filesystem::last_write_time(path, status);
    const bool old = !status && std::filesystem::file_time_type::clock::now() - written > std::chrono::minutes(10);
    if (owner) holder = owner->machine;
    if (!(owner && has_ended(*owner)) && !old) return holder;
    std::filesystem::remove(path, status);
  }
  return holder;
}

void ResultFolder::release(const std::string& key) const {
  std::error_code status;
  std::filesystem::remove(folder_ / (key + ".claim"), status);
}

void ResultFolder::remove_abandoned() const {
  remove_abandoned_files(folder_);
  std::error_code status;
  std::vector<std::filesystem::path> claims;
  for (std::filesystem::directory_iterator it(folder_, status), end; !status && it != end; it.increment(status))
    if (it->path().extension() == ".claim") claims.push_back(it->path());
  for (const auto& claim : claims)
    if (const auto owner = owner_of(claim); owner && (owner->process == ::getpid() || has_ended(*owner)))
      std::filesystem::remove(claim, status);
}

std::string sha256_of_file(const std::filesystem::path& path) {
  // Read, not mapped: an error of the disk in a mapping ends the process (SIGBUS).
  std::ifstream stream(path, std::ios::binary);
  Sha256 sum;
  std::vector<char> piece(1 << 20);
  while (stream) {
    stream.read(piece.data(), static_cast<std::streamsize>(piece.size()));
    sum.add(as_bytes({piece.data(), static_cast<std::size_t>(stream.gcount())}));
  }
  if (!stream.eof()) throw Error(ErrorCode::internal, "", path.string() + " cannot be read: check the disk.");
  return sum.hex();
}

std::filesystem::path default_data_folder() {
  if (const char* data = std::getenv("XDG_DATA_HOME"); data && *data) return std::filesystem::path(data) / "formwright";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home && *home ? home : ".") / ".local/share/formwright";
}

}  // namespace formwright
