// The grasp planner on a Bus.
#pragma once

#include <memory>
#include <vector>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/config/settings/grasp_planner.hpp"
#include "components/grasp_planner/choice/candidates.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/list_preparation.hpp"
#include "components/grasp_planner/load.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"
#include "components/grasp_planner/regrasp/regrasp_queue.hpp"
#include "components/grasp_planner/request_queue.hpp"

namespace handsel::grasp_planner {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void answer(const GraspRequest& request);
  void choose(const GraspRequest& request, bool reply);
  void propose(TimePoint now);
  void answer(const RegraspRequest& request);

  Bus& bus_;
  settings::GraspPlannerSettings settings_;
  ObjectLibrary objects_;
  std::shared_ptr<const HandGeometry> hand_geometry_;
  std::shared_ptr<const GraspChooser> chooser_;
  std::shared_ptr<GraspCache> cache_;  // used by jobs only, one after the other
  // used by jobs only; nullptr: no hand of a person is known
  std::shared_ptr<TransferCache> transfers_;
  std::vector<ArmGrasps>
      arms_;  // used by jobs only; the first has the geometry and the lists above
  ListPreparation lists_;
  RegraspSettings regrasp_settings_;
  std::unique_ptr<Publisher<GraspReply>> reply_out_;
  std::unique_ptr<Publisher<RegraspReply>> regrasp_out_;
  std::unique_ptr<Publisher<GraspCandidates>> candidates_out_;
  Scene scene_;
  HumanState people_;
  // one request is worked on for up to some seconds; the latest replies are remembered
  RequestQueue<GraspReply> requests_{16, 8};
  RegraspQueue regrasps_{16};
  Candidates candidates_;
};

}  // namespace handsel::grasp_planner
