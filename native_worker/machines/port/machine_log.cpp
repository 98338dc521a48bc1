// SPDX-License-Identifier: GPL-3.0-or-later
#include "machines/port/machine_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>
#include <iostream>
#include <utility>
#include <vector>

#include "base/data/json_text.h"
#include "system/host.h"

namespace formwright {
namespace {

constexpr std::uintmax_t max_bytes = std::uintmax_t{512} << 20;   // of all logs together; the oldest go
constexpr std::streamoff tail_bytes = 4 << 20;                    // of a file, when the newest are asked for
constexpr std::size_t max_open = 32;                              // machines at once
constexpr std::size_t max_waiting_bytes = std::size_t{64} << 20;  // a disk that hangs must not fill the memory

double unix_seconds() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::vector<std::filesystem::path> files_oldest_first(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code status;
  for (std::filesystem::directory_iterator it(folder, status), end; !status && it != end; it.increment(status))
    if (it->path().extension() == ".jsonl") files.push_back(it->path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> last_lines(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = stream.tellg();
  std::vector<std::string> lines;
  if (size <= 0) return lines;
  const std::streamoff from = std::max<std::streamoff>(0, size - tail_bytes);
  stream.seekg(from);
  std::string line;
  if (from > 0) std::getline(stream, line);
  while (std::getline(stream, line)) lines.push_back(line);
  return lines;
}

}  // namespace

std::string MachineLog::utc_day() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[16];
  std::strftime(text, sizeof text, "%Y-%m-%d", &utc);
  return text;
}

MachineLog::~MachineLog() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
  }
  arrived_.notify_one();
  if (writer_.joinable()) writer_.join();
  close_all();
}

void MachineLog::sync() {
  for (const int descriptor : unsynced_)
    if (::fdatasync(descriptor) != 0) complain();
  unsynced_.clear();
}

void MachineLog::close_all() {
  sync();
  for (const auto& [machine, descriptor] : open_) ::close(descriptor);
  open_.clear();
}

void MachineLog::tidy() const {
  std::uintmax_t total = 0;
  const auto files = files_oldest_first(folder_);
  for (std::size_t i = files.size(); i-- > 0;) {
    std::error_code status;
    const std::uintmax_t bytes = std::filesystem::file_size(files[i], status);
    if (status) continue;  // gone meanwhile
    total += bytes;
    // Today's are written, by this program or another: what is put into a removed file is lost.
    const bool kept = i + 1 == files.size() || files[i].filename().string().starts_with(open_day_);
    if (total > max_bytes && !kept) std::filesystem::remove(files[i], status);
  }
}

int MachineLog::descriptor_for(const std::string& machine_id) {
  const std::string day = day_();
  if (day != open_day_) close_all();
  open_day_ = day;
  if (const auto known = open_.find(machine_id); known != open_.end()) return known->second;
  if (open_.size() >= max_open) close_all();
  std::error_code status;
  std::filesystem::create_directories(folder_, status);
  tidy();
  const auto path = folder_ / (day + "-" + machine_id + ".jsonl");
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (descriptor >= 0) open_[machine_id] = descriptor;
  return descriptor;
}

void MachineLog::complain() {
  if (complained_) return;
  complained_ = true;
  std::cerr << "formwright: the machine log in " << folder_.string()
            << " cannot be written: make room, or correct its permissions." << std::endl;
}

void MachineLog::write(const Entry& entry) {
  const int descriptor = descriptor_for(entry.machine_id);
  // One write a line: whatever happens to this program, a line is there whole or not at all.
  if (descriptor < 0 ||
      ::write(descriptor, entry.line.data(), entry.line.size()) != static_cast<ssize_t>(entry.line.size()))
    return complain();
  if (entry.lasting) unsynced_.insert(descriptor);
}

void MachineLog::write_all() {
  std::unique_lock lock(mutex_);
  for (;;) {
    arrived_.wait(lock, [&] { return ending_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const std::deque<Entry> entries = std::exchange(waiting_, {});
    waiting_bytes_ = 0;
    writing_ = true;
    lock.unlock();
    for (const Entry& entry : entries) write(entry);
    sync();
    lock.lock();
    writing_ = false;
    written_.notify_all();
  }
}

void MachineLog::append(const Machine& machine, Json entry, bool lasting) {
  entry["unix_s"] = unix_seconds();
  entry["machine"] = machine.id;
  entry["name"] = machine.name;
  std::string line = json_text(entry) + "\n";
  {
    const std::scoped_lock lock(mutex_);
    if (waiting_bytes_ + line.size() > max_waiting_bytes) return;  // the writer complains when the disk fails
    waiting_bytes_ += line.size();
    waiting_.push_back({machine.id, std::move(line), lasting});
    if (!writer_.joinable()) writer_ = std::thread([this] { write_all(); });
  }
  arrived_.notify_one();
}

void MachineLog::flush() const {
  std::unique_lock lock(mutex_);
  written_.wait(lock, [&] { return waiting_.empty() && !writing_; });
}

Json MachineLog::newest(std::size_t limit, bool lines) const {
  flush();
  std::vector<Json> entries;
  auto files = files_oldest_first(folder_);
  // Several machines may have a file for the same day, whose entries interleave: whole days are read.
  for (std::size_t i = files.size(); i-- > 0;) {
    const bool new_day = i + 1 >= files.size() ||
                         files[i].filename().string().substr(0, 10) != files[i + 1].filename().string().substr(0, 10);
    if (new_day && entries.size() >= limit) break;
    for (const std::string& line : last_lines(files[i])) {
      Json entry = parse_json_text(line);
      if (!entry.is_object() || !entry.contains("unix_s") || !entry["unix_s"].is_number())
        continue;  // cut off by a power failure
      const Json event = entry.value("event", Json());
      if (!lines && (event == "sent" || event == "received")) continue;
      entries.push_back(std::move(entry));
    }
  }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Json& a, const Json& b) { return a["unix_s"].get<double>() > b["unix_s"].get<double>(); });
  if (entries.size() > limit) entries.resize(limit);
  return entries;
}

}  // namespace formwright
