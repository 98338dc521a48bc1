// SPDX-License-Identifier: GPL-3.0-or-later
#include "slurm/task_list.h"

#include <algorithm>

#include "base/data/json.h"
#include "system/durable_files.h"
#include "system/files.h"
#include "system/host.h"

namespace formwright {
namespace {

constexpr int list_version = 1;

Error refused(const std::filesystem::path& file, const std::string& what) {
  return {ErrorCode::invalid_input, "tasks", file.string() + " " + what};
}

std::vector<ListedTask> tasks_of(const Json& share) {
  std::vector<ListedTask> tasks;
  for (const Json& task : share)
    tasks.push_back(
        {task.at("key").get<std::string>(), task.at("recipe").get<std::string>(), task.at("input").get<std::string>()});
  return tasks;
}

}  // namespace

std::vector<std::vector<ListedTask>> shares_of(const std::vector<ListedTask>& tasks, const std::vector<double>& work,
                                               double seconds_per_work, double share_seconds, std::size_t max_shares) {
  const std::size_t min_count = std::max<std::size_t>(1, (tasks.size() + max_shares - 1) / max_shares);
  std::vector<std::vector<ListedTask>> shares;
  double seconds = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const double own = work[i] * seconds_per_work;
    const bool has_room = !shares.empty() && (shares.back().size() < min_count ||
                                              (seconds_per_work > 0 && seconds + own <= share_seconds));
    if (!has_room) {
      shares.emplace_back();
      seconds = 0;
    }
    shares.back().push_back(tasks[i]);
    seconds += own;
  }
  return shares;
}

void write_task_list(const std::filesystem::path& file, const std::vector<std::vector<ListedTask>>& shares) {
  Json list = Json::array();
  for (const auto& share : shares) {
    Json tasks = Json::array();
    for (const ListedTask& task : share)
      tasks.push_back({{"key", task.key}, {"recipe", task.recipe}, {"input", task.input_key}});
    list.push_back(std::move(tasks));
  }
  write_file(file, with_checksum(as_bytes(json_text({{"version", list_version}, {"shares", list}}))));
}

std::vector<ListedTask> read_share(const std::filesystem::path& file, std::size_t index) {
  const auto content = checked_content(*read_file(file, "tasks"));
  if (!content) throw refused(file, "was cut short or altered: start the job again.");
  const Json list = Json::parse(as_text(*content), nullptr, false);
  if (!list.is_object() || list.value("version", Json()) != list_version)
    throw refused(file, "was written by another version: run the same version of formwright on every computer.");
  const Json shares = list.value("shares", Json::array());
  if (!shares.is_array() || index >= shares.size())
    throw refused(file, "has " + std::to_string(shares.size()) + " shares, numbered from 0, and none of the number " +
                            std::to_string(index) + ".");
  try {
    return tasks_of(shares[index]);
  } catch (const Json::exception&) {
    throw refused(file, "has a share that is no list of tasks: start the job again.");
  }
}

}  // namespace formwright
