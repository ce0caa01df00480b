// SPDX-License-Identifier: Apache-2.0
// Reads fixed boxes and viewpoints of the sources from a scenario. Pure.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/config/schema/scenario.pb.h"
#include "common/messages/world.hpp"
#include "components/spark/calibration.hpp"

namespace handsel::spark {

/// Returns the floor and the boxes of the scenario, in this order.
std::vector<SceneBox> boxes_of(const config::Scenario& scenario);
/// Returns the viewpoint of each source that has one, by the name of the source, world [m]:
/// calibrated cameras, and sensors of the scenario with occlusion.
std::map<std::string, Vector3> viewpoints_of(const config::Scenario& scenario,
                                             const Calibration& calibration);

}  // namespace handsel::spark
