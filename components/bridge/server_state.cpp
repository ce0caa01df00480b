// SPDX-License-Identifier: Apache-2.0
#include "components/bridge/server_state.hpp"

#include <cstdio>
#include <random>

#include "components/bridge/web_socket_client.hpp"

namespace handsel::bridge {

namespace {

constexpr std::uint64_t kOfPage = 2;  // low byte of the id of a task that the page has given

}  // namespace

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(static_cast<int>(1e3 * seconds));
}

TimePoint monotonic() {
  return TimePoint(
      std::chrono::duration_cast<Duration>(std::chrono::steady_clock::now().time_since_epoch()));
}

ServerState::ServerState(ServerSettings s, Site where, Catalogue catalogue, std::string json)
    : settings(std::move(s)),
      site(std::move(where)),
      hub(std::move(catalogue), [this](const std::string& uri) { return site.fetch(uri); }),
      config(std::move(json)),
      gate(settings.token),
      queue((std::uint64_t{std::random_device{}()} << 8U) | kOfPage) {}

void ServerState::report(const std::string& kind, const std::string& what) {
  if (reported_kinds.insert(kind).second)
    std::fprintf(stderr, "bridge: %s; more of this kind are only counted\n", what.c_str());
}

void ServerState::update_wanted() {
  std::bitset<kMaxChannels> now;
  for (std::size_t i = 0; i < hub.catalogue().channels.size(); ++i) {
    for (const auto& client : clients) now[i] = now[i] || client->viewer().wants(i);
    if (!now[i]) hub.forget(i);
  }
  const std::lock_guard lock(mutex);
  wanted = now;
}

void ServerState::publish_counters() {
  counters.clients = clients.size();
  counters.open = connections.size() + clients.size();
  const std::lock_guard lock(mutex);
  published = counters;
}

}  // namespace handsel::bridge
