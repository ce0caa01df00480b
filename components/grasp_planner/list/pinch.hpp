// SPDX-License-Identifier: Apache-2.0
// Grasps of a hand of two pads: a place of the surface for the first pad, the surface opposite for
// the second, patches of contact on both. Own method. The pads' areas hold what two points could
// not.
#pragma once

#include <optional>

#include "components/grasp_planner/list/grasp_list.hpp"

namespace handsel::grasp_planner {

/// How the two pads of a hand close: all its axes together, from the widest opening (0) to the
/// narrowest (1).
class PinchMotion {
 public:
  explicit PinchMotion(const HandGeometry& hand_geometry);

  /// Returns the configuration of all hand axes. `closed`: 0 at the widest opening, 1 at the
  /// narrowest.
  Vector configuration_at(double closed) const { return open_ + closed * (closed_ - open_); }
  /// Returns the distance of the pads along the direction the first one presses [m].
  double gap(const Vector& q) const;
  /// Returns the gap of the hand at its widest opening [m].
  double widest() const { return widest_; }
  /// Returns the configuration with this gap [m]; nullopt when the hand opens less or closes no
  /// further.
  std::optional<Vector> at_gap(double gap) const;
  /// Returns the frame of a finger's pad in the hand.
  Pose T_hand_pad(std::size_t finger, const std::vector<Pose>& T_hand_step) const;

 private:
  const HandGeometry& hand_geometry_;
  Vector open_, closed_;
  double widest_{};
};

class PinchSearch {
 public:
  PinchSearch(const HandGeometry& hand_geometry, const Graspable& object,
              const GraspListSettings& settings);

  /// Returns the number of frames: places of the surface times turns of the hand about the
  /// surface's normal; as many as the settings' positions and orientations, or fewer.
  std::uint64_t frames() const { return places_ * kTurns; }

  /// A grasp without its quality. Its contacts are the corners of the patches, in the order of the
  /// fingers.
  struct Found {
    Grasp grasp;                         ///< with contacts, hand configuration and pre-grasp
    std::vector<PointContact> contacts;  ///< corners of the patches, object frame
    double force{};                      ///< mean cosine between the surface and the pads
  };
  /// Tests the frame with this number, below frames(). `counters`: work done is added. `why` says
  /// the reason when there is none.
  std::optional<Found> frame(std::uint64_t id, GraspList& counters, FrameReason& why);

 private:
  static constexpr std::uint64_t kTurns = 16;
  /// A place of the surface before a pad.
  struct Place {
    Eigen::Vector2d on_pad;  ///< frame of the pad [m]
    SurfaceHit hit;          ///< `along` from where the rays start
  };
  std::optional<Found> across(const SurfacePoint& place, const Vector3& along, double thickness,
                              GraspList& counters, FrameReason& why);
  bool close_on(double thickness, Grasp& g);
  void sample(const Pad& pad, const Pose& T_object_pad, std::vector<Place>& places);
  std::optional<double> settle(std::uint32_t finger, const Pose& T_object_pad, Found& found);
  bool fingers_touch(const std::vector<std::vector<Pose>>& T_hand_step, const Pose& T_object_hand,
                     double clearance, GraspList& counters) const;
  void grip(Found& found, std::size_t max_on_a_pad) const;

  const HandGeometry& hand_geometry_;
  const Graspable& object_;
  const GraspListSettings& settings_;
  PinchMotion motion_;
  std::uint64_t places_{}, stride_{1};
  std::vector<SurfaceHit> hits_;
  std::vector<std::vector<Pose>> T_closed_, T_open_;
};

}  // namespace handsel::grasp_planner
