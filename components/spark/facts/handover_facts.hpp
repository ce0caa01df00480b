// SPDX-License-Identifier: Apache-2.0
// Computes the facts of a handover between any two of people and robot: holding, offering, waiting,
// withdrawing and releasing objects. Pure.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/settings/spark.hpp"
#include "common/messages/world.hpp"
#include "components/spark/facts/fact_memory.hpp"

namespace handsel::spark {

/// The robot as a partner.
struct RobotPartner {
  Vector3 body{Vector3::Zero()};  ///< position of the body, world [m]
  Vector3 tool{Vector3::Zero()};  ///< position of the tool, world [m]
};

class HandoverFacts {
 public:
  explicit HandoverFacts(const settings::SparkSettings& settings) : settings_(settings) {}

  /// Adds the candidates of this sample. An object with force sensors is held by all whose grip
  /// force exceeds `grip_force`, until it falls below `grip_lost`; so both hold the object during
  /// the handover. Any other object has one holder. An object counts as released only if another
  /// holds it.
  void find(const Scene& scene, const HumanState& people, const RobotPartner& robot, TimePoint now,
            std::vector<Candidate>& out);

 private:
  using Pair = std::pair<std::string, std::string>;
  struct Moment {
    TimePoint at;
    std::string evidence;
  };
  std::set<std::string> holders(const SceneObject& object);
  void held_and_released(const SceneObject& object, TimePoint now, std::vector<Candidate>& out);
  void offered(const SceneObject& object, const HumanState& people, const RobotPartner& robot,
               TimePoint now, std::vector<Candidate>& out);
  void reached_for(const Person& person, const std::string& target, const Vector3& where,
                   TimePoint now, std::vector<Candidate>& out);
  void forget(const Scene& scene, const HumanState& people, TimePoint now);
  void waited_for(const Person& person, const Scene& scene, std::vector<Candidate>& out);

  settings::SparkSettings settings_;
  std::map<std::string, std::set<std::string>> holders_;  // by object
  // by object and last holder; by person and what the person withdrew from
  std::map<Pair, Moment> released_, withdrawn_;
  // By person and target: time of the last such sample.
  std::map<Pair, TimePoint> offering_, reaching_;
};

}  // namespace handsel::spark
