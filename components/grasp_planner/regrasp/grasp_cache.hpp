// SPDX-License-Identifier: Apache-2.0
// The lists of one hand, made when first asked for, then remembered, and kept on disk when there is
// a store. For one thread at a time.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include "components/grasp_planner/list/grasp_store.hpp"
#include "components/grasp_planner/pair/transfer.hpp"

namespace handsel::grasp_planner {

/// An object with its list.
struct CachedGrasps {
  std::shared_ptr<const Graspable> object;  ///< prepared for grasping, as the list has it
  GraspList list;                           ///< all its grasps by this hand
};

class GraspCache {
 public:
  GraspCache(std::shared_ptr<const HandGeometry> hand_geometry, const GraspListSettings& settings,
             GraspStore store);

  /// nullptr when cancelled. Throws ConfigError when the object cannot be grasped by any hand (its
  /// mesh).
  std::shared_ptr<const CachedGrasps> page(const ObjectModel& object,
                                           const std::function<bool()>& cancelled = {});

 private:
  std::shared_ptr<const HandGeometry> hand_geometry_;
  GraspListSettings settings_;
  GraspStore store_;
  std::shared_ptr<const FingerWorkspaces> workspaces_;
  std::map<std::uint64_t, std::shared_ptr<const CachedGrasps>> entries_;
};

/// Which grasps of a person's hand go with those of the robot's, by object; made when first asked
/// for. For one thread at a time.
class TransferCache {
 public:
  TransferCache(std::shared_ptr<const HandGeometry> robot,
                std::shared_ptr<const HandGeometry> taker, const GraspListSettings& taker_settings,
                const TransferSettings& settings, GraspStore store);

  /// `page`: of the robot's hand. nullptr when cancelled.
  std::shared_ptr<const TransferTable> table(const ObjectModel& object, const CachedGrasps& page,
                                             const std::function<bool()>& cancelled = {});
  /// The table when it was made already.
  std::shared_ptr<const TransferTable> known(const std::string& object) const;
  /// Of the taker's list; nullptr when cancelled.
  std::shared_ptr<const CachedGrasps> taker_entry(const ObjectModel& object,
                                                  const std::function<bool()>& cancelled = {});

 private:
  std::shared_ptr<const HandGeometry> robot_, taker_;
  GraspCache cache_;
  TransferSettings settings_;
  std::map<std::string, std::shared_ptr<const TransferTable>> tables_;
};

}  // namespace handsel::grasp_planner
