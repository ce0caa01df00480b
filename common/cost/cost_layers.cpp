// SPDX-License-Identifier: Apache-2.0
#include "common/cost/cost_layers.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace handsel {
namespace {

constexpr const char* kComfort = "arm_comfort";
constexpr Duration kComplaintLasts = std::chrono::seconds(10);
constexpr std::size_t kMaxLayers = 16;

bool ours(const std::string& layer) {
  return std::find(std::begin(kOwnLayers), std::end(kOwnLayers), layer) != std::end(kOwnLayers);
}

}  // namespace

OutsideCost LayersNow::outside_cost(const Vector3& p) const {
  OutsideCost out;
  for (const auto& grid : outside) {
    const GridValue value = grid->value(p);
    out.cost += grid->weight() * (value.forbidden ? 1.0 : value.cost);
    if (value.forbidden) out.forbidden_by = grid.get();
  }
  return out;
}

void CostLayers::put(const Costmap& map, TimePoint sent, TimePoint now) {
  if (ours(map.layer) && map.layer != kComfort) return;
  if (std::string why = CostGrid::fault(map); !why.empty()) {
    leave_out(map.layer, why, now);
  } else if (now - sent > stale_) {
    leave_out(map.layer, too_old(map.layer), now);
  } else if (kept_.size() >= kMaxLayers && !kept_.contains(map.layer)) {
    leave_out(
        map.layer,
        "cost layer \"" + map.layer + "\": there are " + std::to_string(kMaxLayers) + " already",
        now);
  } else {
    kept_[map.layer] = {std::make_shared<const CostGrid>(map), sent};
    if (complained_about_ == map.layer) complaint_.clear();
  }
}

LayersNow CostLayers::at(TimePoint now) {
  forget_stale(now);
  LayersNow out;
  for (const auto& [layer, kept] : kept_) {
    if (layer == kComfort)
      out.comfort = kept.grid;
    else
      out.outside.push_back(kept.grid);
  }
  return out;
}

std::string CostLayers::complaint(TimePoint now) {
  forget_stale(now);
  if (now - complained_ > kComplaintLasts) complaint_.clear();
  return complaint_;
}

void CostLayers::forget_stale(TimePoint now) {
  for (auto it = kept_.begin(); it != kept_.end();) {
    if (now - it->second.sent <= stale_) {
      ++it;
      continue;
    }
    if (!ours(it->first)) leave_out(it->first, too_old(it->first), now);
    it = kept_.erase(it);
  }
}

void CostLayers::leave_out(const std::string& layer, const std::string& why, TimePoint now) {
  ++left_out_;
  complaint_ = why + ": left out";
  complained_about_ = layer;
  complained_ = now;
}

std::string CostLayers::too_old(const std::string& layer) const {
  char text[96];
  std::snprintf(text, sizeof text, "\" was sent more than %.1f s ago", to_seconds(stale_));
  return "cost layer \"" + layer + text;
}

}  // namespace handsel
