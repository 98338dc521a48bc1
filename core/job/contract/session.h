// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Expensive state between jobs: parsed meshes and factorisations, by the content they were made from.
#include <any>
#include <functional>
#include <list>
#include <memory>
#include <string>

namespace formwright {

/// A least-recently-used store of shared objects. Not for several threads at once.
class Session {
 public:
  /// `capacity_mb`: what is kept beyond the object in use; the newest object is always kept.
  explicit Session(double capacity_mb = 2048) : capacity_mb_(capacity_mb) {}

  /// The object under `key`, or null.
  template <class T>
  std::shared_ptr<T> find(const std::string& key) {
    for (auto it = entries_.begin(); it != entries_.end(); ++it)
      if (it->key == key) {
        entries_.splice(entries_.begin(), entries_, it);
        if (auto* object = std::any_cast<std::shared_ptr<T>>(&entries_.front().object)) return *object;
        return nullptr;
      }
    return nullptr;
  }

  /// Keeps `object` under `key`; the oldest go when `memory_mb` of all together exceeds the capacity.
  template <class T>
  void keep(const std::string& key, std::shared_ptr<T> object, double memory_mb) {
    drop(key);
    entries_.push_front({key, std::move(object), memory_mb});
    used_mb_ += memory_mb;
    while (used_mb_ > capacity_mb_ && entries_.size() > 1) {
      used_mb_ -= entries_.back().memory_mb;
      entries_.pop_back();
    }
  }

  /// Forgets what was kept under keys that start with `prefix`.
  void drop(const std::string& prefix) {
    for (auto it = entries_.begin(); it != entries_.end();)
      if (it->key.starts_with(prefix)) {
        used_mb_ -= it->memory_mb;
        it = entries_.erase(it);
      } else {
        ++it;
      }
  }

  double used_mb() const { return used_mb_; }

 private:
  struct Entry {
    std::string key;
    std::any object;
    double memory_mb;
  };
  std::list<Entry> entries_;  // newest first
  double capacity_mb_, used_mb_ = 0;
};

}  // namespace formwright
