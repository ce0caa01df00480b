// SPDX-License-Identifier: Apache-2.0
// Binds SPARK to a bus.
#pragma once

#include <memory>

#include "common/base/advised_period.hpp"
#include "common/bus/bus.hpp"
#include "common/bus/process.hpp"
#include "common/config/schema/scenario.pb.h"
#include "common/messages/attention.hpp"
#include "common/messages/system.hpp"
#include "common/messages/task.hpp"
#include "components/spark/calibration.hpp"
#include "components/spark/facts/fact_finder.hpp"
#include "components/spark/left_out_report.hpp"
#include "components/spark/people/people_tracker.hpp"
#include "components/spark/robots/robots_link.hpp"
#include "components/spark/scene/scene_news.hpp"
#include "components/spark/scene_model.hpp"

namespace handsel::spark {

class Node {
 public:
  Node(Bus& bus, const NodeContext& context);

 private:
  Node(Bus& bus, const NodeContext& context, const config::Scenario& place);
  void observe(const HumanObservation& observation, const Receipt& receipt);
  HumanState people(TimePoint now, LeftOut* left_out = nullptr) const;
  void publish_people(TimePoint now);
  std::string trouble(TimePoint now) const;
  void publish(const Scene& scene, TimePoint now);
  void publish_news(TimePoint now);  // publishes the scene if it has news
  void interpret(TimePoint now);     // publishes facts and scene when due

  Bus& bus_;
  settings::SparkSettings settings_;
  Calibration calibration_;
  std::map<std::string, Vector3> eyes_;  // viewpoint of each source
  PeopleTracker tracker_;
  SceneModel scene_;
  FactFinder facts_;
  AdvisedPeriod facts_period_, scene_period_, news_period_;
  std::unique_ptr<Publisher<HumanState>> human_out_;
  std::unique_ptr<Publisher<Scene>> scene_out_;
  std::unique_ptr<Publisher<Facts>> facts_out_;
  RobotsLink robots_;
  LeftOutReport left_out_;
  TimePoint started_, people_published_{};
  // whether the safety state was received, which names the people lost before the start
  bool knows_lost_{false};
  SceneNews news_;
};

}  // namespace handsel::spark
