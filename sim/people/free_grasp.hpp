// SPDX-License-Identifier: Apache-2.0
// Where a person can hold an object: palm and digits fit around the object and keep clearance to a
// robot that holds the object, or leave room to a robot that takes the object. Own method: hand
// poses about the object, ordered by the strain of the person's arm, are tested with the digits
// closed to contact.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "common/model/human/hand_closure.hpp"
#include "common/model/human/human_wrist.hpp"
#include "sim/people/person_settings.hpp"

namespace handsel::sim {

/// A place for a person's hand on an object.
struct FreeGrasp {
  Pose T_object_hand{Pose::Identity()};  ///< as in HumanHand
  Closures closures{};                   ///< of the digits in contact with the object
  int digits_in_contact{};               ///< number of digits that touch the object
  double strain{};                       ///< of the person's arm and wrist, as in WristPosture
};

/// Inputs of the choice of a place.
struct FreeGraspQuery {
  const ObjectModel* object{};            ///< not null
  Pose T_world_object{Pose::Identity()};  ///< pose of the object
  HumanArm arm;                           ///< of the person, upright
  Vector3 forward{Vector3::UnitX()};      ///< direction of a lean, level, unit
  double trunk{};                         ///< height of the shoulder above the waist [m]
  double wrist{};                         ///< distance from the wrist to the palm's middle [m]
  Vector3 preferred{Vector3::UnitX()};    ///< preferred side of the object, world, unit
  const std::vector<HandPart>* robot{};   ///< parts of the robot, world; not null
  /// Side of the object on which this hand holds, of two hands on the object: direction from the
  /// centre of mass, world, unit; nullopt: the person takes the object with one hand.
  std::optional<Vector3> beside;
  /// Point of the object that is left to a receiver, world [m]; nullopt: the person does not give.
  std::optional<Vector3> p_left;
  /// Hand poses of failed attempts, frame of the object: the search avoids them.
  std::vector<Pose> avoided;
};

/// Searches the best place in parts, so that every step of the simulation is short.
class FreeGraspSearch {
 public:
  /// Copies the data of the query, except the object.
  FreeGraspSearch(const FreeGraspQuery& query, const HumanHand& shape,
                  const FreeGraspSettings& settings = {});

  /// Does the next part of the search, about 0.1 ms; returns whether the search is over.
  bool advance();
  bool over() const { return over_; }  ///< whether the search is over
  /// Returns the place found; nullopt: the robot leaves none in reach, or the search is not over.
  const std::optional<FreeGrasp>& found() const { return found_; }

 private:
  /// A pose of the hand with the cost by which poses are ordered.
  struct Candidate {
    Pose T_world_hand{Pose::Identity()};
    double cost{}, strain{};
    bool palm_touches{true};  // false: the digits alone hold
  };
  double distance(const Vector3& p_world) const;
  Vector3 inward(const Vector3& p_world) const;
  bool is_clear(const HandPart& part) const;
  void add_about(const Vector3& anchor, const Vector3& direction);
  void add(const Vector3& start, const Vector3& direction, const Vector3& fingers, double tilt);
  void add_candidate(Candidate candidate, const Vector3& direction, double near_left);
  HumanArm leaning_to(const Vector3& p_wrist) const;
  void consider(const Candidate& candidate);
  std::optional<FreeGrasp> test(const Candidate& candidate) const;
  double covered(const FreeGrasp& grasp) const;
  bool can_close(const Pose& T_world_hand, int digit, double closure) const;
  bool can_come(const Pose& T_world_hand) const;
  bool is_avoided(const Pose& T_world_hand) const;

  FreeGraspQuery query_;
  std::vector<HandPart> robot_;
  HumanHand shape_;
  FreeGraspSettings settings_;
  Pose T_object_world_;
  std::vector<Vector3> anchors_, directions_;
  std::vector<std::pair<Vector3, double>> surface_;  // points to leave free, object; weights
  std::size_t next_{0};  // pair of anchor and direction, then candidate, that comes next
  std::vector<Candidate> candidates_;
  bool ordered_{false}, over_{false};
  int usable_{0};       // number of usable candidates so far
  double min_cost_{0};  // of found_
  std::optional<FreeGrasp> found_;
};

/// Returns the best place, nullopt: the robot leaves none in reach.
std::optional<FreeGrasp> find_free_grasp(const FreeGraspQuery& query, const HumanHand& shape,
                                         const FreeGraspSettings& settings = {});

}  // namespace handsel::sim
