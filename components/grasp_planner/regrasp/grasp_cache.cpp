// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/regrasp/grasp_cache.hpp"

#include "components/grasp_planner/list/grasp_fit.hpp"

namespace handsel::grasp_planner {

GraspCache::GraspCache(std::shared_ptr<const HandGeometry> hand_geometry,
                       const GraspListSettings& settings, GraspStore store)
    : hand_geometry_(std::move(hand_geometry)), settings_(settings), store_(std::move(store)) {}

std::shared_ptr<const CachedGrasps> GraspCache::page(const ObjectModel& object,
                                                     const std::function<bool()>& cancelled) {
  const std::uint64_t key = list_key(hand_geometry_->hand, object, settings_);
  if (const auto known = entries_.find(key); known != entries_.end()) return known->second;
  auto page = std::make_shared<CachedGrasps>();
  page->object = std::make_shared<const Graspable>(object, hand_geometry_->tip_radius(),
                                                   settings_.step_fraction, settings_.seed);
  const std::uint64_t frames = frame_count(*hand_geometry_, *page->object, settings_);
  if (auto stored = store_.load(hand_geometry_->hand.name(), object.name, key, frames);
      stored && fits(*stored, hand_geometry_->hand, object))
    page->list = std::move(*stored);
  page->list.min_margin = settings_.min_margin;
  if (page->list.frames < frames) {
    if (!workspaces_)
      workspaces_ = std::make_shared<const FingerWorkspaces>(make_workspaces(*hand_geometry_));
    page->list = list_grasps(hand_geometry_, workspaces_, page->object, settings_, cancelled,
                             std::move(page->list));
    if (cancelled && cancelled()) return nullptr;
    store_.save(page->list, key);
  }
  entries_[key] = page;
  return page;
}

TransferCache::TransferCache(std::shared_ptr<const HandGeometry> robot,
                             std::shared_ptr<const HandGeometry> taker,
                             const GraspListSettings& taker_settings,
                             const TransferSettings& settings, GraspStore store)
    : robot_(std::move(robot)),
      taker_(taker),
      cache_(std::move(taker), taker_settings, std::move(store)),
      settings_(settings) {}

std::shared_ptr<const TransferTable> TransferCache::table(const ObjectModel& object,
                                                          const CachedGrasps& page,
                                                          const std::function<bool()>& cancelled) {
  if (auto made = known(object.name)) return made;
  const auto taken = taker_entry(object, cancelled);
  if (!taken) return nullptr;
  const auto made = std::make_shared<const TransferTable>(HandSide{robot_.get(), &page.list},
                                                          HandSide{taker_.get(), &taken->list},
                                                          *page.object, settings_, cancelled);
  if (cancelled && cancelled()) return nullptr;
  return tables_[object.name] = made;
}

std::shared_ptr<const TransferTable> TransferCache::known(const std::string& object) const {
  const auto it = tables_.find(object);
  return it != tables_.end() ? it->second : nullptr;
}

std::shared_ptr<const CachedGrasps> TransferCache::taker_entry(
    const ObjectModel& object, const std::function<bool()>& cancelled) {
  return cache_.page(object, cancelled);
}

}  // namespace handsel::grasp_planner
