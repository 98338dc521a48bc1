// SPDX-License-Identifier: GPL-3.0-or-later
#include "server/connections.h"

#include <algorithm>

namespace formwright {

std::size_t Connections::count(bool known) const {
  return static_cast<std::size_t>(
      std::count_if(all_.begin(), all_.end(), [&](const auto& c) { return c->known == known && !c->closed; }));
}

bool Connections::close_one(bool known, bool answering) {
  Connection* oldest = nullptr;
  for (const auto& c : all_)
    if (c->stream != nullptr && !c->closed && c->known == known && c->answering == answering &&
        (oldest == nullptr || c->since < oldest->since))
      oldest = c.get();
  if (oldest == nullptr) return false;
  oldest->closed = true;
  oldest->stream->close();
  return true;
}

std::shared_ptr<Connection> Connections::admit() {
  if (count(false) >= max_strangers && !close_one(false, false)) close_one(false, true);
  return all_.emplace_back(std::make_shared<Connection>());
}

bool Connections::recognise(const std::shared_ptr<Connection>& connection) {
  if (connection->known) return true;
  if (count(true) >= max_known && !close_one(true, false)) return false;
  connection->known = true;
  return true;
}

}  // namespace formwright
