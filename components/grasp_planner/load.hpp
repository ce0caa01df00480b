// What the grasp planner reads when it starts: settings, hands and the grasp lists of each.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "common/config/settings/grasp_planner.hpp"
#include "components/grasp_planner/choice/grasp_choice.hpp"
#include "components/grasp_planner/regrasp/grasp_cache.hpp"
#include "components/grasp_planner/regrasp/regrasp_desk.hpp"

namespace handsel::grasp_planner {

/// Returns the settings of the grasp lists. `seed`: of
/// the contact points and samples.
GraspListSettings list_settings(const settings::GraspPlannerSettings& text, std::uint64_t seed);
/// Returns the settings of the choice.
ChoiceSettings choice_settings(const settings::GraspPlannerSettings& text);
/// Returns the settings of the regrasp planner.
RegraspSettings regrasp_settings(const settings::GraspPlannerSettings& text);

/// Returns the settings of grasp_planner.txtpb in `folder`. Throws ConfigError "file:line:key:
/// ...".
settings::GraspPlannerSettings load_settings(const std::filesystem::path& folder);
/// Returns the store of lists on disk; one that keeps nothing when the settings say so.
GraspStore store_of(const settings::GraspPlannerSettings& text);
/// Returns the geometry of the robot's hand. ConfigError when the robot names no hand.
std::shared_ptr<const HandGeometry> load_hand_geometry(const RobotModel& robot);
/// Returns the robot of a description on its platform; nullptr: it has none.
std::shared_ptr<const RobotModel> mobile(const RobotModel& robot,
                                         const std::filesystem::path& description);
/// Returns the arms of the robot's description; the first has the geometry and the lists that are
/// there already.
std::vector<ArmGrasps> load_arms(const RobotModel& robot, const std::filesystem::path& description,
                                 const std::shared_ptr<const HandGeometry>& hand_geometry,
                                 const std::shared_ptr<GraspCache>& cache,
                                 const GraspListSettings& settings, const GraspStore& store);
/// Returns the lists of every arm; `first`: those of the first.
std::vector<std::shared_ptr<GraspCache>> caches_of(const std::shared_ptr<GraspCache>& first,
                                                   const std::vector<ArmGrasps>& arms);
/// Returns the transfers from the robot's hand to that of a person; nullptr: no such hand is known.
std::shared_ptr<TransferCache> make_transfer_cache(const settings::GraspPlannerSettings& text,
                                                   const std::shared_ptr<const HandGeometry>& robot,
                                                   const GraspStore& store);

}  // namespace handsel::grasp_planner
