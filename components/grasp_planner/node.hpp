// The grasp planner on a Bus.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/config/schema/grasp_planner.pb.h"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/regrasp/grasp_book.hpp"
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"

namespace handsel::grasp_planner {

/// Returns the settings of the grasp lists. ConfigError names the field that is wrong. `seed`: of
/// the contact points and samples.
GraspListSettings list_settings(const config::GraspPlannerSettings& text, std::uint64_t seed);
/// Returns the settings of the choice. ConfigError names the field that is wrong.
ChoiceSettings choice_settings(const config::GraspPlannerSettings& text);

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  void prepare(const Scene& scene);
  void answer(const GraspRequest& request);
  void choose(const GraspRequest& request, bool reply);
  void propose(TimePoint now);
  void answer(const RegraspRequest& request);
  /// Why hands for it cannot be searched, one sentence; empty: they can.
  std::string objection(const RegraspRequest& request) const;

  Bus& bus_;
  config::GraspPlannerSettings settings_;
  ObjectLibrary objects_;
  std::shared_ptr<const HandKit> kit_;
  std::shared_ptr<const GraspChooser> chooser_;
  std::shared_ptr<GraspBook> book_;  // used by jobs only, one after the other
  // used by jobs only; nullptr: no hand of a person is known
  std::shared_ptr<TransferBook> transfers_;
  std::vector<ArmBook> arms_;  // used by jobs only; the first has the geometry and the lists above
  RegraspSettings regrasp_settings_;
  std::unique_ptr<Publisher<GraspReply>> reply_out_;
  std::unique_ptr<Publisher<RegraspReply>> regrasp_out_;
  std::unique_ptr<Publisher<GraspCandidates>> candidates_out_;
  Scene scene_;
  HumanState people_;
  std::set<std::string> prepared_;  // models whose list was asked for
  std::deque<GraspReply> replies_;  // the latest: asking twice is harmless
  std::deque<RequestId> pending_;
  std::optional<RequestId> regrasp_pending_;
  std::size_t regrasps_waiting_{0};
  std::optional<RegraspReply> regrasp_reply_;  // the latest
  GraspRequest served_;                        // the request whose object candidates are kept up for
  TimePoint served_at_{};
  bool serving_{}, proposing_{};
  Pose T_world_proposed_{Pose::Identity()};
  GraspCandidates candidates_;
};

}  // namespace handsel::grasp_planner
