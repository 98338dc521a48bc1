// SPDX-License-Identifier: GPL-3.0-or-later
#include "system/work_places.h"

#include <utility>

#include "system/host.h"

namespace formwright {

void WorkPlaces::began(const std::string& key) {
  const std::scoped_lock lock(mutex_);
  running_here_.emplace(key, Clock::now());
  running_elsewhere_.erase(key);
}

void WorkPlaces::made(const std::string& key) {
  double seconds = -1;
  {
    const std::scoped_lock lock(mutex_);
    ++made_here_;
    if (const auto begun = running_here_.find(key); begun != running_here_.end()) {
      seconds = std::chrono::duration<double>(Clock::now() - begun->second).count();
      running_here_.erase(begun);
    }
  }
  if (seconds >= 0 && on_made_here) on_made_here(key, seconds);
}

void WorkPlaces::gave_up(const std::string& key) {
  const std::scoped_lock lock(mutex_);
  running_here_.erase(key);
}

void WorkPlaces::is_made_by(const std::string& machine, const std::string& key) {
  const std::scoped_lock lock(mutex_);
  if (running_here_.contains(key)) return;  // two predictions of this run may need the same simulation
  running_elsewhere_[key] = machine;
}

void WorkPlaces::found(const std::string& key) {
  const std::scoped_lock lock(mutex_);
  const auto other = running_elsewhere_.find(key);
  if (other == running_elsewhere_.end()) return;
  ++made_elsewhere_[other->second];
  running_elsewhere_.erase(other);
}

void WorkPlaces::set_engine_places(std::vector<WorkPlace> places) {
  const std::scoped_lock lock(mutex_);
  engine_ = std::move(places);
}

std::vector<WorkPlace> WorkPlaces::now() const {
  const std::scoped_lock lock(mutex_);
  std::vector<WorkPlace> places;
  if (const int running = static_cast<int>(running_here_.size()); running + made_here_ > 0)
    places.push_back({"", running, made_here_});
  std::map<std::string, WorkPlace> others;
  for (const auto& [key, machine] : running_elsewhere_) ++others[machine].running;
  for (const auto& [machine, done] : made_elsewhere_) others[machine].done = done;
  for (auto& [machine, place] : others) {
    place.name = machine;
    places.push_back(place);
  }
  places.insert(places.end(), engine_.begin(), engine_.end());
  return places;
}

std::shared_ptr<WorkPlaces> share_results(const ResultFolder& folder, Host& host) {
  auto places = std::make_shared<WorkPlaces>();
  host.find_result = [folder, places](const std::string& key) {
    auto found = folder.find(key);
    if (found) places->found(key);
    return found;
  };
  host.keep_result = [folder, places](const std::string& key, const Bytes& bytes) {
    folder.keep(key, bytes);
    places->made(key);
  };
  host.claim_result = [folder, places](const std::string& key) {
    const auto other = folder.claim_or_holder(key);
    if (other) places->is_made_by(*other == machine_name() ? "another run on this computer" : *other, key);
    else places->began(key);
    return !other;
  };
  host.release_result = [folder, places](const std::string& key) {
    folder.release(key);
    places->gave_up(key);
  };
  if (host.on_progress)
    host.on_progress = [places, report = std::move(host.on_progress)](Progress progress) {
      progress.places = places->now();
      report(progress);
    };
  return places;
}

std::string places_text(const std::vector<WorkPlace>& places) {
  std::string text;
  for (const WorkPlace& place : places) {
    std::string counts;
    const auto add = [&](int count, const char* what) {
      if (count > 0) counts += (counts.empty() ? " " : ", ") + std::to_string(count) + what;
    };
    add(place.running, " running");
    add(place.done, " done");
    add(place.waiting, " waiting");
    if (!counts.empty())
      text += (text.empty() ? "" : "; ") + (place.name.empty() ? std::string("this computer") : place.name) + counts;
  }
  return text;
}

}  // namespace formwright
