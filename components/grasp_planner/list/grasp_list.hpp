// SPDX-License-Identifier: Apache-2.0
// The list of grasps of one hand on one object (chapter sections 3.2.1 - 3.2.7): deterministic,
// unbiased, resumable.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "common/grasp/grip_force.hpp"
#include "common/messages/planning.hpp"
#include "components/grasp_planner/file_defaults.hpp"
#include "components/grasp_planner/hand/hand_geometry.hpp"
#include "components/grasp_planner/object/graspable.hpp"

namespace handsel::grasp_planner {

struct QualityWeights {
  double stability{file_defaults().weight_stability};  ///< epsilon
  /// Distance of the contacts' mean to the mass centre.
  double centre{file_defaults().weight_centre};
  /// Contact normals along the main axes of the force ellipsoids.
  double force{file_defaults().weight_force};
  /// 1 - normalised mean curvature at the contacts.
  double curvature{file_defaults().weight_curvature};
};

/// As the settings file has them by default, but with fewer orientations and without what the grip
/// force adds: `creep`, `weight_grip` and `min_margin`.
struct GraspListSettings {
  /// Of the grasp frame in the object's box, uniform.
  std::uint32_t positions{file_defaults().positions};
  /// In a large box as many more as make them about this far apart [m]; 0: never more.
  double spacing{file_defaults().spacing};
  std::uint32_t orientations{144};  ///< of the incremental grid over all rotations
  /// Distance of contact points / fingertip radius.
  double step_fraction{file_defaults().step_fraction};
  double friction{0};  ///< Coulomb coefficient; 0: the object's
  /// Of a linearised friction cone, >= 6.
  int cone_edges{static_cast<int>(file_defaults().cone_edges)};
  /// An epsilon from which on the stability counts as 1.
  double full_epsilon{file_defaults().full_epsilon};
  QualityWeights weights;  ///< of the terms of the quality
  /// Max alternatives per finger of a frame.
  std::uint32_t contacts_per_finger{file_defaults().contacts_per_finger};
  /// Max candidates checked per finger.
  std::uint32_t tries_per_finger{file_defaults().tries_per_finger};
  double depth{0.0008};  ///< max penetration of a touching finger model [m]
  /// Pre-grasp distance of the fingertips along the normal [m].
  double opening{file_defaults().opening};
  /// A pad bridges a hollow that is no deeper [m].
  double pad_hollow{file_defaults().pad_hollow};
  /// Min pre-grasp clearance of the whole finger [m].
  double open_clearance{file_defaults().open_clearance};
  GripForceSettings grip;  ///< grip force and load
  /// Distance that a fingertip may creep over the surface, which turns the normal where the surface
  /// is curved: the grip does not use that part of the friction cone [m].
  double creep{0};
  /// Weight of the grip margin / sturdy_margin, -2 to 1, beside the quality in the choice among the
  /// contacts of a frame.
  double weight_grip{0};
  double sturdy_margin{file_defaults().sturdy_margin};  ///< a grip margin that counts as 1 [N]
  /// Min grip margin of a grasp by which one hand alone bears the object [N].
  double min_margin{-std::numeric_limits<double>::infinity()};
  /// Min distance of the surface from the hand to count as free for another hand [m].
  double free_distance{file_defaults().free_distance};
  std::uint64_t seed{1};  ///< of the contact points; the same gives the same list
};

/// Why frames were given up; each frame that gave no grasp counts once.
enum class FrameReason : std::uint8_t {
  grasped,
  thumb_out_of_reach,    ///< no contact point in the thumb's workspace
  fingers_out_of_reach,  ///< in those of fewer than two other fingers
  palm_in_object,
  thumb_without_contact,  ///< inverse kinematics, direction of the push, collision or opening
  fingers_without_contact,
  fingers_collide,
  not_closed,        ///< no combination is force-closed
  nothing_opposite,  ///< a pinching hand: no surface opposite within its opening
  pad_off_surface,   ///< a pinching hand: a pad does not lie on the surface
  count
};
/// Returns the reason as a phrase for reports, e.g. "no surface in the workspace of the thumb".
const char* reason_text(FrameReason);

struct GraspScores {
  double stability{}, centre{}, force{}, curvature{};  ///< each [0, 1]
};

struct ListedGrasp {
  Grasp grasp;         ///< id = number of its frame; contacts in the order of the fingers
  GraspScores scores;  ///< terms of the quality before weighting
  double room{};       ///< fraction of the surface that is free for another hand, [0, 1]
};

struct GraspList {
  std::string hand, object;  ///< names of the hand and of the object model
  /// Those that bear the object first, of these best quality first; ties by id.
  std::vector<ListedGrasp> grasps;
  double min_margin{-std::numeric_limits<double>::infinity()};  ///< as in the settings [N]
  std::uint64_t frames{};                                       ///< tested
  /// Frames tested, by FrameReason; `grasped` those with a grasp.
  std::array<std::uint64_t, static_cast<std::size_t>(FrameReason::count)> reasons{};
  std::uint64_t finger_solutions{}, touch_tests{}, closure_tests{};  ///< work done

  /// Returns whether one hand alone bears the object by this grasp.
  bool bears(const Grasp& grasp) const { return grasp.margin >= min_margin; }
  /// Counts per reason of the frames without a grasp, e.g. {"113 frames", "..."}.
  Refusals refusals() const;
};

/// Positions of the grasp frame: cell centres of a uniform grid over the box, about `count` of
/// them.
std::vector<Vector3> uniform_positions(const Eigen::AlignedBox3d& box, std::uint32_t count);

/// Returns how many positions the settings give in a box.
std::uint32_t position_count(const Eigen::AlignedBox3d& box, const GraspListSettings& settings);

/// Returns how many frames these settings give for a hand on an object.
std::uint64_t frame_count(const HandGeometry& hand_geometry, const Graspable& object,
                          const GraspListSettings& settings);

/// Returns lists of different frames of the same hand and object as one.
GraspList merged(std::vector<GraspList> parts);

class GraspLister {
 public:
  /// `begun`: a list of the same hand, object and settings, but fewer orientations; it is
  /// continued. Empty: from the first frame.
  GraspLister(std::shared_ptr<const HandGeometry> hand_geometry,
              std::shared_ptr<const FingerWorkspaces> workspaces,
              std::shared_ptr<const Graspable> object, const GraspListSettings& settings,
              GraspList begun = {});
  ~GraspLister();
  GraspLister(GraspLister&&) noexcept;

  std::uint64_t frames() const;  ///< in all
  std::size_t found() const;     ///< grasps so far
  /// Tests these frames, each independent of all others: several listers may divide the work, their
  /// lists are merged afterwards.
  void test(std::uint64_t first, std::uint64_t count);
  /// Tests at most `count` more frames; false when there are none left. Frames go through all
  /// positions of an orientation before the next, so that more orientations only extend the list.
  bool advance(std::uint64_t count);
  /// Returns the list so far, best quality first.
  GraspList list() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// All frames at once; `cancelled` is asked now and then.
GraspList list_grasps(std::shared_ptr<const HandGeometry> hand_geometry,
                      std::shared_ptr<const FingerWorkspaces> workspaces,
                      std::shared_ptr<const Graspable> object, const GraspListSettings& settings,
                      const std::function<bool()>& cancelled = {}, GraspList begun = {});

}  // namespace handsel::grasp_planner
