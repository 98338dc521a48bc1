// SPDX-License-Identifier: GPL-3.0-or-later
#include "command_line/output_folder.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "base/data/json.h"
#include "system/files.h"

namespace formwright {
namespace {

constexpr const char *list_name = ".formwright.json", *aside_name = ".formwright-part-";
constexpr std::uintmax_t max_list_bytes = std::uintmax_t{1} << 20;

/// {"laser-job": ["job.gcode", ...], ...}; an empty object where there is none, or none that can be read.
Json read_list(const std::filesystem::path& folder) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(folder / list_name, status)) return Json::object();
  Json list = Json::parse(as_text(*read_file(folder / list_name, "--out", max_list_bytes)), nullptr, false);
  return list.is_object() ? list : Json::object();
}

/// A name in the folder itself: a list that somebody has written by hand must not lead out of it.
bool is_plain(const std::string& name) {
  return !name.empty() && name != "." && name != ".." && name.find('/') == std::string::npos;
}

void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

Error cannot_be_replaced(const std::filesystem::path& path, const std::string& why) {
  return {ErrorCode::invalid_input, "out", path.string() + " cannot be replaced (" + why + "): choose another folder."};
}

}  // namespace

OutputFolder::OutputFolder(std::filesystem::path folder, std::string command,
                           const std::vector<std::string>& possible_names)
    : folder_(std::move(folder)),
      aside_(folder_ / (aside_name + std::to_string(::getpid()))),
      command_(std::move(command)) {
  std::error_code status;
  sweep();
  const Json list = read_list(folder_);
  if (const auto mine = list.find(command_); mine != list.end() && mine->is_array()) {
    for (const Json& name : *mine)
      if (name.is_string() && is_plain(name.get<std::string>())) earlier_.push_back(name.get<std::string>());
  } else if (list.empty() && std::filesystem::exists(folder_ / "report.json", status)) {
    earlier_ = possible_names;
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(aside_, ignored);
}

void OutputFolder::make() const {
  std::error_code status;
  std::filesystem::create_directories(folder_, status);
  if (!std::filesystem::is_directory(folder_))
    throw Error(ErrorCode::invalid_input, "--out",
                "The folder " + folder_.string() + " cannot be made (" + status.message() + "): choose another.");
}

/// What processes that were killed have left aside.
void OutputFolder::sweep() const {
  std::error_code status;
  std::vector<std::filesystem::path> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, status)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(aside_name)) continue;
    const long process = std::strtol(name.c_str() + std::strlen(aside_name), nullptr, 10);
    if (process > 0 && ::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) left.push_back(entry.path());
  }
  for (const auto& path : left) std::filesystem::remove_all(path, status);
}

void OutputFolder::put(const std::string& name, ByteView bytes) {
  std::error_code status;
  std::filesystem::create_directory(aside_, status);
  write_file(aside_ / name, bytes);
  put_.push_back(name);
}

void OutputFolder::remove_earlier() {
  for (const std::string& name : earlier_) {
    std::error_code status;
    if (std::filesystem::is_directory(folder_ / name, status)) continue;
    std::filesystem::remove(folder_ / name, status);
    if (status) throw cannot_be_replaced(folder_ / name, status.message());
  }
  sync_folder(folder_);
}

void OutputFolder::write_list(const std::vector<std::string>& names) {
  Json list = read_list(folder_);
  for (auto& [command, files] : list.items())
    if (files.is_array())
      for (auto file = files.begin(); file != files.end();)
        file = std::find(names.begin(), names.end(), *file) != names.end() ? files.erase(file) : file + 1;
  list[command_] = names;
  write_file(folder_ / list_name, as_bytes(list.dump() + "\n"));
}

void OutputFolder::replace() {
  // The list first: a run that is killed from here on leaves nothing that the next one does not know.
  std::vector<std::string> both = earlier_;
  for (const std::string& name : put_)
    if (std::find(both.begin(), both.end(), name) == both.end()) both.push_back(name);
  write_list(both);
  remove_earlier();
  for (const std::string& name : put_) {
    std::error_code status;
    std::filesystem::rename(aside_ / name, folder_ / name, status);
    if (status) throw cannot_be_replaced(folder_ / name, status.message());
  }
  write_list(put_);
  sync_folder(folder_);
  earlier_ = put_;
}

void OutputFolder::clear() {
  if (earlier_.empty()) return;
  remove_earlier();
  write_list({});
  earlier_.clear();
}

}  // namespace formwright
