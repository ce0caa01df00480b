// SPDX-License-Identifier: Apache-2.0
// Grasp lists for tests: hands and objects of the project by name, made once per process.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {

inline std::filesystem::path deploy_folder() {
  return std::filesystem::path(HANDSEL_SOURCE_DIR) / "deploy";
}

inline std::shared_ptr<const HandGeometry> hand_kit(const std::string& name) {
  static std::map<std::string, std::shared_ptr<const HandGeometry>> kits;
  auto& hand_geometry = kits[name];
  if (!hand_geometry)
    hand_geometry = std::make_shared<const HandGeometry>(
        HandModel::load(deploy_folder() / "hands" / name / (name + ".txtpb")));
  return hand_geometry;
}

inline const ObjectModel* object_model(const std::string& name) {
  static std::map<std::string, ObjectModel> models;
  if (models.find(name) == models.end())
    models[name] = ObjectModel::load(deploy_folder() / "objects" / name / (name + ".txtpb"));
  return &models[name];
}

struct HandOnObject {
  std::shared_ptr<const HandGeometry> hand_geometry;
  std::shared_ptr<const Graspable> object;
  GraspList list;
};

inline const HandOnObject& hand_on_object(const std::string& hand, const std::string& object,
                                          std::uint32_t positions = 40,
                                          std::uint32_t orientations = 72) {
  static std::map<std::string, HandOnObject> made;
  static std::map<std::string, std::shared_ptr<const FingerWorkspaces>> workspaces;
  HandOnObject& h = made[hand + "/" + object + "/" + std::to_string(positions) + "/" +
                         std::to_string(orientations)];
  if (h.hand_geometry) return h;
  h.hand_geometry = hand_kit(hand);
  if (!workspaces[hand])
    workspaces[hand] = std::make_shared<const FingerWorkspaces>(make_workspaces(*h.hand_geometry));
  GraspListSettings settings;
  settings.positions = positions;
  settings.orientations = orientations;
  h.object = std::make_shared<const Graspable>(*object_model(object), h.hand_geometry->tip_radius(),
                                               settings.step_fraction, settings.seed);
  h.list = list_grasps(h.hand_geometry, workspaces[hand], h.object, settings);
  return h;
}

}  // namespace handsel::grasp_planner
