// Double grasps: two hands on one object at a time (chapter sections 3.2.8 and 3.2.9).
#pragma once

#include <cstdint>
#include <vector>

#include "components/grasp_planner/grasp_list.hpp"

namespace handsel::grasp_planner {

/// One hand's side of a double grasp.
struct HandSide {
  const HandKit* kit{};
  const GraspList* list{};
  /// How natural the arm reaches each grasp, one a grasp of the list, the higher the better; empty: not asked.
  std::vector<double> posture;
};

struct DoubleGrasp {
  std::size_t first{}, second{};  ///< indices into the two lists
  double quality{};               ///< the smaller of the two
  double posture{};               ///< the smaller of the two; 0 when not asked
  double opposition{};            ///< angle between the directions from the object's middle to the two hands [rad]; pi: wrists opposed
  double score{};                 ///< quality and posture, each normalised over the list, summed
};

struct DoubleSettings {
  std::size_t most_of_each{200};  ///< best grasps taken from each list
  double clearance{0.0};          ///< between the hands [m]
  double least_opposition{0.0};   ///< [rad] for a transfer: wrists opposed by at least this
};

struct DoubleList {
  std::vector<DoubleGrasp> grasps;  ///< best score first
  std::uint64_t pairs{}, colliding{}, not_opposed{};
};

/// All pairs that do not collide. `p_object_middle`: of the object's box.
DoubleList list_double_grasps(const HandSide& a, const HandSide& b, const Vector3& p_object_middle, const DoubleSettings& settings = {});

}  // namespace handsel::grasp_planner
