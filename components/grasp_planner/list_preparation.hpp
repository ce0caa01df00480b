// SPDX-License-Identifier: Apache-2.0
// Makes the grasp lists of the objects in the scene before anybody asks for them.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/node_context.hpp"
#include "components/grasp_planner/arm_grasps.hpp"

namespace handsel::grasp_planner {

/// Modelled time in which a list is read, as it is from an object's second day on.
inline constexpr Duration kReadList = std::chrono::milliseconds(5);

/// Makes lists in jobs, once for each model.
class ListPreparation {
 public:
  /// `arms`: their lists and transfers are used by jobs only. `bus` must outlive this object.
  ListPreparation(Bus& bus, ObjectLibrary objects, std::vector<ArmGrasps> arms);

  /// Makes the lists of the models that are new in the scene. A model that cannot be grasped by any
  /// hand makes the component degraded.
  void prepare(const Scene& scene);

 private:
  using Work = std::function<Duration(const std::function<bool()>& cancelled)>;
  void run(const Work& work);
  void prepare_pairs(const std::shared_ptr<GraspCache>& cache,
                     const std::shared_ptr<TransferCache>& transfers, const ObjectModel& model);

  Bus& bus_;
  ObjectLibrary objects_;
  std::vector<ArmGrasps> arms_;
  std::set<std::string> prepared_;  // models whose lists were asked for
};

}  // namespace handsel::grasp_planner
