// From geometry to facts: zones with hysteresis, approaching, attentive, reaching, who can reach what. Pure.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "common/base/time.hpp"
#include "common/config/spark.pb.h"
#include "common/messages/world.hpp"
#include "common/model/robot_capsules.hpp"

namespace handsel::spark {

class FactFinder {
 public:
  FactFinder(const config::SparkSettings& settings, std::shared_ptr<const RobotModel> robot);

  /// The facts that hold now, with how long they have held.
  Facts find(const Scene& scene, const HumanState& people, TimePoint now);

 private:
  using Key = std::tuple<FactKind, std::string, std::string>;
  struct Zone {
    int level{4};             // 0 contact ... 4 far
    TimePoint last_inside{};  // when the distance last confirmed this level
  };
  int zone_level(Zone& zone, double distance, TimePoint now) const;
  void person_facts(const Scene& scene, const Person& person, TimePoint now, std::vector<Fact>& out);
  void object_facts(const Scene& scene, const HumanState& people, std::vector<Fact>& out) const;

  config::SparkSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  std::vector<LinkCapsule> capsules_;
  std::vector<Pose> links_;
  std::map<std::string, Zone> zones_;
  std::map<Key, TimePoint> since_;
};

}  // namespace handsel::spark
