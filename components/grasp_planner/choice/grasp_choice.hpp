// SPDX-License-Identifier: Apache-2.0
// From the list of an object to the grasps that serve now: this robot, this scene, these people,
// where the object is to go (chapter sections 3.2.8 - 3.2.9 for one hand).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "common/collision/collision_world.hpp"
#include "common/config/settings/grasp_planner.hpp"
#include "common/model/manipulator.hpp"
#include "components/grasp_planner/list/grasp_list.hpp"
#include "components/grasp_planner/pair/transfer.hpp"

namespace handsel::grasp_planner {

/// Why a listed grasp is not feasible now.
enum class ChoiceReason : std::uint8_t {
  chosen,
  too_weak,       ///< the fingers of one hand would not bear the object
  below_support,  ///< a part of the hand would be in or under the support of the object
  out_of_reach,   ///< no arm configuration reaches it
  collision,      ///< arm or hand collides there
  cannot_lift,    ///< the arm cannot go straight up with it
  no_approach,    ///< no collision-free straight approach
  near_giver,     ///< too near to the body of the giver
  goal_support,   ///< below_support at the goal
  goal_taken,     ///< another object occupies the goal
  goal_out_of_reach,
  goal_collision,  ///< arm, hand or object
  goal_lowering,   ///< no straight path down with the object
  goal_leaving,    ///< no straight retreat for the opened hand
  hidden,          ///< too little of the object is seen past the hand
  not_considered,  ///< the budget was used up, or enough better ones were found
  count
};
/// Returns the reason as a phrase for reports, e.g. "arm or hand would collide at the grasp".
const char* reason_text(ChoiceReason);

/// How the object is put down in a grasp: arm axes.
struct PuttingDown {
  Vector above, at;  ///< with the object in the hand
  Vector off;        ///< the opened hand after its retreat
};

/// Where the platform was thought of.
struct PlatformSearch {
  bool asked{}, none{};  ///< none: the description of the robot has no platform
  /// Places tried, and of these those where the robot would collide, is too near to a person, or no
  /// grasp serves.
  std::uint64_t places{}, blocked{}, near_person{}, useless{};
};

/// Contacts of arm or hand at grasps, for the reason of a failed choice.
class NamedContacts {
 public:
  /// Returns whether enough contacts are counted: naming a contact costs a collision check.
  bool is_full() const { return count_ >= 100; }
  /// Counts a contact, "link forearm and box table".
  void add(const std::string& which) {
    ++count_;
    ++counts_[which];
  }
  /// Returns the commonest of the first 100 contacts; empty: none was counted.
  std::string commonest() const;

 private:
  int count_{};
  std::map<std::string, int> counts_;
};

/// The feasible grasps, and why others are not.
struct Choice {
  std::vector<Grasp> grasps;       ///< with arm_joints and approach_joints, best first
  std::vector<PuttingDown> goals;  ///< of each grasp, when there is a goal
  /// For a person, with the pairs known: how each of the grasps can be handed over; nullopt: no
  /// place was found.
  std::vector<std::optional<TransferPose>> transfers;
  /// Listed grasps by ChoiceReason, for the present place of the robot.
  std::array<std::uint64_t, static_cast<std::size_t>(ChoiceReason::count)> reasons{};
  NamedContacts contacts;            ///< of grasps where arm or hand would collide
  std::uint64_t reaches{};           ///< inverse kinematics solved or tried
  std::uint64_t transfer_reaches{};  ///< those for places to hand over
  std::uint64_t states{};            ///< robot states checked for collision
  std::uint64_t touch_tests{};       ///< hand against object
  PlatformSearch platform;           ///< result of the search for platform places

  /// Returns the counts per reason of the infeasible grasps and platform places.
  Refusals refusals() const;
  /// Returns one sentence for a choice without grasps: the number of listed grasps, the most
  /// frequent reasons with counts, and the number not tried.
  std::string why_none(const GraspList& list) const;
};

/// Inputs of a choice.
struct ChoiceInputs {
  const GraspRequest& request;        ///< the request
  const GraspList& list;              ///< grasps of the hand of the robot on the object
  const Graspable& object;            ///< the object of the request
  const Scene& scene;                 ///< with the object of the request
  const HumanState& people;           ///< everybody near
  std::function<bool()> cancelled{};  ///< may be empty
  /// Pairs of this list and the receiver's hand; without them only the free surface counts.
  const TransferTable* pairs{};
};

/// Chooses grasps; holds all inputs that do not change between requests.
class GraspChooser {
 public:
  /// Chooses for one arm of the robot. ConfigError when that arm has no hand at its tip, or the
  /// axes of its hand are not those of the hand description. `arm`: its name as hands_of()
  /// gives it. `mobile`: the robot on its platform (on_platform), or nullptr.
  GraspChooser(std::shared_ptr<const RobotModel> robot,
               std::shared_ptr<const HandGeometry> hand_geometry, ObjectLibrary library,
               const settings::GraspPlannerSettings& settings, const std::string& arm = "arm",
               std::shared_ptr<const RobotModel> mobile = nullptr);

  /// Chooses the grasps that are feasible now; deterministic for equal inputs. If none is feasible
  /// from the present place and the request allows it, platform places are searched, the shortest
  /// drive first; the reasons remain those of the present place.
  Choice choose(const ChoiceInputs& inputs) const;

 private:
  struct Search;
  struct Found;
  using Ranking = std::vector<std::pair<double, std::size_t>>;  // rank, place in the list
  // Checks ranked grasps until enough are found; the weak ones only where few others serve.
  std::vector<Found> consider_all(Search& search, const Ranking& order, const Ranking& weak) const;
  void search_places(Search& search, const Ranking& order, std::vector<Found>& found) const;

  std::shared_ptr<const RobotModel> robot_, mobile_;
  std::shared_ptr<const HandGeometry> hand_geometry_;
  ObjectLibrary library_;
  settings::GraspPlannerSettings settings_;
  Manipulator manipulator_;  // the arm that takes the object
  // unit, hand frame: retreat directions from a grasp, the straightest first
  std::vector<Vector3> retreats_;
};

}  // namespace handsel::grasp_planner
