// SPDX-License-Identifier: Apache-2.0
// Computes facts from geometry: zones, motion, gaze, visibility, reach, support, containment,
// proximity and handover. Pure.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/collision/collision_world.hpp"
#include "common/config/settings/spark.hpp"
#include "common/geometry/line_of_sight.hpp"
#include "common/messages/world.hpp"
#include "common/model/arm_reach.hpp"
#include "common/model/robot_capsules.hpp"
#include "components/spark/facts/fact_memory.hpp"
#include "components/spark/facts/handover_facts.hpp"

namespace handsel::spark {

class FactFinder {
 public:
  FactFinder(const settings::SparkSettings& settings, std::shared_ptr<const RobotModel> robot,
             ObjectLibrary objects);

  /// Returns the present facts with duration and evidence. Facts about the robot require its state.
  Facts find(const Scene& scene, const HumanState& people, TimePoint now);

 private:
  struct Zone {
    int level{4};             // 0 contact to 4 far
    TimePoint last_inside{};  // time of the last distance within this level
  };
  struct Extent {
    Eigen::AlignedBox3d box;  // world
    double radius{};          // of a sphere about the centre of the box [m]
  };
  int zone_level(Zone& zone, double distance, TimePoint now) const;
  void robot_facts(const Scene& scene, const Person& person, const RobotPartner& robot,
                   TimePoint now, std::vector<Candidate>& out);
  void gaze_facts(const Scene& scene, const HumanState& people, const Person& person,
                  const RobotPartner& robot, std::vector<Candidate>& out) const;
  void hand_facts(const Scene& scene, const Person& person, std::vector<Candidate>& out) const;
  void thing_facts(const Scene& scene, const HumanState& people, std::vector<Candidate>& out) const;
  Candidate reach_fact(const Scene& scene, const SceneObject& object) const;
  void pair_facts(const Scene& scene, std::size_t i, std::size_t k,
                  std::vector<Candidate>& out) const;
  Extent extent(const SceneObject& object) const;
  Vector3 p_world_robot(const Scene& scene) const;
  RobotPartner partner(const Scene& scene) const;

  settings::SparkSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  ObjectLibrary library_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_;
  std::vector<Extent> extents_;  // extents of the scene's objects
  std::vector<ArmReach> arms_;
  std::array<double, 4> zone_limits_;  // of the zones contact, danger, interaction and social [m]
  std::map<std::string, Zone> zones_;
  HandoverFacts handover_;
  FactMemory lasting_, instant_;  // with dwell time; for candidates with their own hysteresis
};

}  // namespace handsel::spark
