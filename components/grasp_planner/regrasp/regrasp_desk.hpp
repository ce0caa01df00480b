// SPDX-License-Identifier: Apache-2.0
// Answers which hands to take an object with: the planner's steps with the grasps as messages have
// them.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/world.hpp"
#include "components/grasp_planner/arm_grasps.hpp"
#include "components/grasp_planner/regrasp/regrasp.hpp"

namespace handsel::grasp_planner {

struct RegraspAnswer {
  RegraspReply reply;       ///< as sent to the client; its reason says why there is no sequence
  std::uint64_t checked{};  ///< steps checked in detail
  std::uint64_t listed{};   ///< grasps that were listed for it
};

/// Returns why no hands can be searched for the request, one sentence; empty: they can. `arms`:
/// those with hands.
std::string objection(const RegraspRequest& request, const Scene& scene, const RobotModel& robot,
                      const std::vector<ArmGrasps>& arms, const ObjectLibrary& library);

/// Inputs of an answer.
struct RegraspStage {
  const RobotModel& robot;             ///< with all arms
  const std::vector<ArmGrasps>& arms;  ///< one or two
  const ObjectLibrary& library;        ///< described models
  const Scene& scene;                  ///< obstacles and the object
  const RegraspSettings& settings;     ///< of the planner
};

/// objection() is empty; `model`: of the object. The reply says why when there is no
/// sequence.
RegraspAnswer answer_regrasp(const RegraspRequest& request, const RegraspStage& stage,
                             const ObjectModel& model, const std::function<bool()>& cancelled = {});

/// Returns the modelled time of the work on one core, from its counts.
Duration regrasp_time(const RegraspAnswer& answer);

}  // namespace handsel::grasp_planner
