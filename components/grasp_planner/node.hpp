// SPDX-License-Identifier: Apache-2.0
// The grasp planner on a Bus.
#pragma once

#include <memory>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/config/settings/grasp_planner.hpp"
#include "common/model/human/holding_hand_average.hpp"
#include "components/grasp_planner/choice/candidates.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/list_preparation.hpp"
#include "components/grasp_planner/load.hpp"
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"
#include "components/grasp_planner/regrasp/regrasp_queue.hpp"
#include "components/grasp_planner/request_queue.hpp"

namespace handsel::grasp_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void on(const HumanState& people) {
    people_ = people;
    holding_.add(scene_, people);
  }
  HumanState people() const { return holding_.averaged(scene_, people_); }
  void answer(const GraspRequest& request);
  void choose(const GraspRequest& request, bool reply);
  void propose(TimePoint now);
  void answer(const RegraspRequest& request);

  Bus& bus_;
  settings::GraspPlannerSettings settings_;
  ObjectLibrary objects_;
  std::shared_ptr<const RobotModel> robot_;
  std::vector<ArmGrasps> arms_;  // lists and transfers: used by jobs only, one after the other
  std::vector<std::shared_ptr<const GraspChooser>> choosers_;  // of each of these arms
  ListPreparation lists_;
  RegraspSettings regrasp_settings_;
  std::unique_ptr<Publisher<GraspReply>> reply_out_;
  std::unique_ptr<Publisher<RegraspReply>> regrasp_out_;
  std::unique_ptr<Publisher<GraspCandidates>> candidates_out_;
  Scene scene_;
  HumanState people_;
  HoldingHandAverage holding_;
  // one request is worked on for up to some seconds; the latest replies are remembered
  RequestQueue<GraspReply> requests_{16, 8};
  RegraspQueue regrasps_{16};
  Candidates candidates_;
};

}  // namespace handsel::grasp_planner
