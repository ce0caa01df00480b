// SPDX-License-Identifier: Apache-2.0
// Many states of a robot checked at once by spheres around its links: "clear" is true of the exact
// shapes, "unclear" is for the exact check to decide. States lie side by side in the registers. Own
// method: covers make "clear" certain; the idea of several states of one motion at once is VAMP's
// (Thomason et al.).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "common/collision/batch_chain.hpp"
#include "common/collision/sphere_cover.hpp"
#include "common/model/robot_model.hpp"

namespace handsel {

/// What of a robot a solid is an obstacle for; bits.
enum RobotPart : std::uint8_t { kArmPart = 1, kHandPart = 2, kHeldPart = 4 };

class BatchWorld {
 public:
  static constexpr int kStates = detail::kBatchStates;  ///< states of one block

  /// A shape that moves with a link (or, held, with the tool link).
  struct Body {
    int link{};  ///< index into RobotModel::links()
    /// Frame of the shape; may be null for a box, cylinder, capsule or sphere no axis moves.
    std::shared_ptr<const SphereCover> cover;
    Shape shape;                          ///< for links that no axis moves
    Pose T_link_shape{Pose::Identity()};  ///< frame of the shape in the link's
    std::uint8_t what{kArmPart};          ///< one bit of RobotPart
  };
  /// A shape at rest in the world; a mesh needs a cover.
  struct Solid {
    Shape shape;                               ///< in its own frame
    std::shared_ptr<const SphereCover> cover;  ///< frame of the shape; null: none
    Pose T_world_shape{Pose::Identity()};      ///< frame of the shape
    /// Bits of RobotPart it is tested with.
    std::uint8_t against{kArmPart | kHandPart | kHeldPart};
  };

  explicit BatchWorld(const RobotModel& robot);

  /// The robot for states in which only `axes` differ from q: what the others join is one rigid
  /// body. `pairs`: bodies tested against each other; those whose relative pose no axis changes are
  /// left out, their verdict is the caller's.
  void set_robot(const std::vector<Body>& bodies, const std::vector<std::pair<int, int>>& pairs,
                 const std::vector<int>& axes, const Vector& q);
  /// Replaces the solids; to be called after set_robot.
  void set_solids(const std::vector<Solid>& solids, const Pose& T_world_base);

  /// Returns the bits of those of the first `count` (<= kStates) states that are unclear. All axes;
  /// those that do not move are ignored.
  std::uint32_t unclear(const Vector* states, int count);
  /// The same for states from + at (to - from). `any`: one unclear state is enough to know, the
  /// bits of others may be missing.
  std::uint32_t unclear_on_line(const Vector& from, const Vector& to, const double* at, int count,
                                bool any = false);
  /// The same for boxes of states, `low` to `high` on every moving axis: what is clear is so
  /// everywhere in its box.
  std::uint32_t unclear_boxes(const Vector* low, const Vector* high, int count);
  /// Returns the stretches [first, second] of the line, in parts of the line, that could not be
  /// shown clear; all states between them are, without steps. Checks stretches down to `finest`
  /// parts of the line, and no more than the given number of blocks of kStates stretches: what is
  /// left then is unclear.
  const std::vector<std::pair<double, double>>& unclear_stretches(const Vector& from,
                                                                  const Vector& to, double finest,
                                                                  int max_blocks);

  /// Poses of the links as the registers have them, for one state among those that the
  /// kernel checked last; for tests.
  Pose link_pose(int link, int slot) const;
  int spheres() const { return static_cast<int>(nodes_.size()); }  ///< of robot and solids
  std::uint64_t blocks() const { return blocks_; }                 ///< calls of the kernel so far
  /// Added to every radius for single precision [m].
  double rounding() const { return rounding_; }
  /// Another width than the widest, for tests and measurements.
  void set_kernels(const detail::SimdKernels& kernels) { kernels_ = &kernels; }

 private:
  struct Part {
    int body{};
    std::uint8_t what{};
    std::vector<int> shapes;  // indices into bodies
    int root{};
  };
  struct Free {
    void operator()(float* p) const { ::operator delete[](p, std::align_val_t(64)); }
  };
  using Floats = std::unique_ptr<float[], Free>;
  static Floats floats(std::size_t count);

  void place_trees(const std::vector<Body>& bodies);
  void make_pairs(const std::vector<Body>& bodies, const std::vector<std::pair<int, int>>& pairs);
  void find_reach();
  int add_tree(const SphereCover& cover, const Pose& T_body_shape, int body);
  int add_root(const std::vector<int>& roots, int body);
  bool add_solid(const Shape& shape, const Pose& T_root_shape);
  void put_in_rows(detail::SimdSearch& search);
  void allocate();
  std::uint32_t run(int count, bool swept, bool any = false);

  const RobotModel& robot_;
  const detail::SimdKernels* kernels_;
  BatchChain chain_;
  std::vector<Part> parts_;
  std::vector<detail::SimdNode> nodes_;
  std::vector<detail::SimdSolid> solids_;
  std::vector<detail::SimdSolids> solid_rows_;
  std::vector<std::int32_t> node_list_, solid_list_;
  std::vector<detail::SimdSearch> searches_;
  std::vector<detail::SimdPair> pairs_;
  std::vector<detail::SimdNodePair> node_pairs_;
  std::vector<float> reach_, pair_reach_;
  // Of the robot alone; set_solids puts its own behind.
  std::size_t own_nodes_{}, own_solids_{}, own_searches_{}, own_pairs_{}, own_node_list_{},
      own_solid_list_{}, own_node_pairs_{};
  double total_reach_{}, rounding_{};

  Floats pose_, margin_, position_, q_, half_;
  std::size_t position_room_{};
  std::vector<std::uint32_t> stamp_;
  std::vector<std::int32_t> lists_;
  detail::SimdTables tables_{};
  detail::SimdMemory memory_{};
  std::vector<std::pair<double, double>> open_, next_, unclear_;
  std::uint64_t blocks_{};
};

}  // namespace handsel
