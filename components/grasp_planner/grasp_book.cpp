#include "components/grasp_planner/grasp_book.hpp"

namespace handsel::grasp_planner {

GraspBook::GraspBook(std::shared_ptr<const HandKit> kit, const GraspListSettings& settings, GraspStore store)
    : kit_(std::move(kit)), settings_(settings), store_(std::move(store)) {}

std::shared_ptr<const GraspPage> GraspBook::page(const ObjectModel& object, const std::function<bool()>& cancelled) {
  const std::uint64_t key = list_key(kit_->hand, object, settings_);
  if (const auto known = pages_.find(key); known != pages_.end()) return known->second;
  auto page = std::make_shared<GraspPage>();
  page->object = std::make_shared<const Graspable>(object, kit_->tip_radius(), settings_.step_share, settings_.seed);
  const std::uint64_t frames = frame_count(*kit_, *page->object, settings_);
  if (auto stored = store_.load(kit_->hand.name(), object.name, key, frames)) page->list = std::move(*stored);
  if (page->list.frames < frames) {
    if (!workspaces_) workspaces_ = std::make_shared<const FingerWorkspaces>(make_workspaces(*kit_));
    page->list = list_grasps(kit_, workspaces_, page->object, settings_, cancelled, std::move(page->list));
    if (cancelled && cancelled()) return nullptr;
    store_.save(page->list, key);
  }
  pages_[key] = page;
  return page;
}

}  // namespace handsel::grasp_planner
