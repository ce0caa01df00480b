#include "components/grasp_planner/regrasp/grasp_book.hpp"

#include "components/grasp_planner/list/grasp_fit.hpp"

namespace handsel::grasp_planner {

GraspBook::GraspBook(std::shared_ptr<const HandGeometry> kit, const GraspListSettings& settings, GraspStore store)
    : kit_(std::move(kit)), settings_(settings), store_(std::move(store)) {}

std::shared_ptr<const GraspPage> GraspBook::page(const ObjectModel& object, const std::function<bool()>& cancelled) {
  const std::uint64_t key = list_key(kit_->hand, object, settings_);
  if (const auto known = pages_.find(key); known != pages_.end()) return known->second;
  auto page = std::make_shared<GraspPage>();
  page->object = std::make_shared<const Graspable>(object, kit_->tip_radius(), settings_.step_share, settings_.seed);
  const std::uint64_t frames = frame_count(*kit_, *page->object, settings_);
  if (auto stored = store_.load(kit_->hand.name(), object.name, key, frames); stored && fits(*stored, kit_->hand, object))
    page->list = std::move(*stored);
  if (page->list.frames < frames) {
    if (!workspaces_) workspaces_ = std::make_shared<const FingerWorkspaces>(make_workspaces(*kit_));
    page->list = list_grasps(kit_, workspaces_, page->object, settings_, cancelled, std::move(page->list));
    if (cancelled && cancelled()) return nullptr;
    store_.save(page->list, key);
  }
  pages_[key] = page;
  return page;
}

TransferBook::TransferBook(std::shared_ptr<const HandGeometry> robot, std::shared_ptr<const HandGeometry> taker,
                           const GraspListSettings& taker_settings, GraspStore store)
    : robot_(std::move(robot)), taker_(taker), book_(std::move(taker), taker_settings, std::move(store)) {}

std::shared_ptr<const TransferTable> TransferBook::table(const ObjectModel& object, const GraspPage& page,
                                                         const std::function<bool()>& cancelled) {
  if (auto made = known(object.name)) return made;
  const auto taken = taker_page(object, cancelled);
  if (!taken) return nullptr;
  auto& entry = tables_[object.name];
  entry = std::make_shared<const TransferTable>(HandSide{robot_.get(), &page.list}, HandSide{taker_.get(), &taken->list}, *page.object);
  return entry;
}

std::shared_ptr<const TransferTable> TransferBook::known(const std::string& object) const {
  const auto it = tables_.find(object);
  return it != tables_.end() ? it->second : nullptr;
}

std::shared_ptr<const GraspPage> TransferBook::taker_page(const ObjectModel& object, const std::function<bool()>& cancelled) {
  return book_.page(object, cancelled);
}

}  // namespace handsel::grasp_planner
