// The lists of one hand, made when first asked for, then remembered, and kept on disk when there is a store. For one thread at a time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "components/grasp_planner/grasp_store.hpp"

namespace handsel::grasp_planner {

/// An object with its list.
struct GraspPage {
  std::shared_ptr<const Graspable> object;
  GraspList list;
};

class GraspBook {
 public:
  GraspBook(std::shared_ptr<const HandKit> kit, const GraspListSettings& settings, GraspStore store);

  /// nullptr when cancelled. Throws ConfigError when the object cannot be grasped by any hand (its mesh).
  std::shared_ptr<const GraspPage> page(const ObjectModel& object, const std::function<bool()>& cancelled = {});

 private:
  std::shared_ptr<const HandKit> kit_;
  GraspListSettings settings_;
  GraspStore store_;
  std::shared_ptr<const FingerWorkspaces> workspaces_;
  std::map<std::uint64_t, std::shared_ptr<const GraspPage>> pages_;
};

}  // namespace handsel::grasp_planner
