// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/go_sender.hpp"

namespace handsel::supervisor {

std::optional<Go> GoSender::step(const Go& go, TimePoint now) {
  const bool changed = go.epoch != sent_.epoch || go.allowed != sent_.allowed ||
                       go.override_factor != sent_.override_factor ||
                       go.state_revision != sent_.state_revision;
  if (!changed && to_seconds(now - sent_at_) < 0.99 * period_) return std::nullopt;
  sent_ = go;
  sent_at_ = now;
  return go;
}

}  // namespace handsel::supervisor
