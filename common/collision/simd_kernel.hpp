// SPDX-License-Identifier: Apache-2.0
// Sixteen states of a robot side by side: forward kinematics, then the spheres around its links
// against solids and against each other. Plain data, lengths in metres: spheres in the frame of
// their body, solids in that of the root. Single precision: the caller adds its rounding to the
// radii, as BatchWorld does. Written once for any register width,
// chosen when the program runs; free of Eigen, whose alignment depends on the width. Nothing here
// allocates, locks or throws.
#pragma once

#include <cstdint>

namespace handsel::detail {

constexpr int kBatchStates = 16;

/// A joint that moves a body: body number = joint number + 1, body 0 is the root. T_parent_joint by
/// rows; z is the axis.
struct SimdJoint {
  float T[12];
  std::int32_t parent;   // body
  std::int32_t row;      // of the positions, >= 0: fixed joints are none
  float factor, offset;  // joint value = factor * position + offset [rad] or [m]
  std::int32_t slides;   // 1: along z; 0: turns about z
};

/// A sphere in the frame of the body it moves with [m]; everything its children cover is inside.
struct SimdNode {
  float x, y, z, radius;
  std::int32_t first_child, children, body, reserved;
};

/// A rounded box, segment or point, or for `cylinder` > 0 a cylinder of this radius about its third
/// axis, half[2] its half length [m]. Root frame: axes by rows, `at`: products with the centre.
struct SimdSolid {
  float axes[9], at[3], half[3], radius, cylinder;
};

/// Sixteen solids side by side, cylinders as the boxes around them; those that are not there are
/// far away.
struct SimdSolids {
  alignas(64) float axes[9][kBatchStates], at[3][kBatchStates], half[3][kBatchStates],
      radius[kBatchStates];
};

/// Spheres that must stay clear of solids: the tree under node `root`; for `nodes` > 0 only the
/// subtrees under node_list[first_node] and on, against the solids that the sphere of `root` meets.
/// `first_row`: first of solid_rows with the same solids; -1: none.
struct SimdSearch {
  std::int32_t root, first_node, nodes, first_solid, solids, first_row;
};

/// Trees that must stay clear of each other: below the roots a and b, the pairs of nodes from
/// node_pairs[first] on. The row of a pair in pair_reach is its index in `pairs`.
struct SimdPair {
  std::int32_t a, b, first, pairs;
};
struct SimdNodePair {
  std::int32_t a, b;
};

struct SimdTables {
  const SimdJoint* joints;
  const SimdNode* nodes;
  const SimdSolid* solids;
  const SimdSolids* solid_rows;
  const std::int32_t *node_list, *solid_list;
  const SimdSearch* searches;
  const SimdPair* pairs;
  const SimdNodePair* node_pairs;
  // [body][joint]: no sphere centre of the body is farther from the joint's axis; a row has
  // `joint_count`.
  const float* reach;
  const float* pair_reach;  // [pair][joint]: the same for the motion of one against the other
  std::int32_t joint_count, node_count, search_count, pair_count;
};

/// Memory for one check at a time; on 64 bytes. Sizes in floats: pose 12 x bodies x kBatchStates,
/// margin bodies x kBatchStates (how far `half` moves a body [m]), position 3 x nodes x
/// kBatchStates (centres, root frame [m]). stamp: one a node, the `now` at which its
/// position was computed. The kernels count `now` up; the owner clears stamps before it overflows.
struct SimdMemory {
  float *pose, *margin, *position;
  std::uint32_t* stamp;
  std::uint32_t now;
  std::int32_t* lists;  // room for solid lists: kMaxTreeDepth x the longest list
  std::int32_t max_list_size;
};
constexpr int kMaxTreeDepth = 12;  ///< depth at which `check` takes the nodes of a tree as leaves

/// Sixteen capsules of people side by side, in any frame shared with the robot's [m]: axis a to
/// a + d, middle m; dd = d.d, over_dd = 1 / dd (0 for a ball), `reach`: radius of the ball about m
/// around the capsule. Those that are not there are a thousand kilometres away.
struct SimdCapsules {
  alignas(64) float ax[16], ay[16], az[16], dx[16], dy[16], dz[16], dd[16], over_dd[16], radius[16],
      reach[16], mx[16], my[16], mz[16];
};
struct SimdCapsule {
  float ax, ay, az, dx, dy, dz, dd, over_dd, radius, reach, mx, my, mz;
};

struct SimdKernels {
  const char* name;
  int width;  ///< states in a register
  /// q: positions, [row][kBatchStates], radians between about -50 and 50. `half`: how far each
  /// joint row moves to either side of the state, or nullptr. Returns the bits of those of the
  /// given states in which some sphere is not clear; `any`: of the first ones found, where the
  /// search ends.
  std::uint32_t (*check)(const SimdTables& tables, SimdMemory& memory, const float* q,
                         const float* half, std::uint32_t state_bits, bool any) noexcept;
  /// Distances of each capsule of `robot` to the sixteen, less the radii, to distance[16 * count];
  /// those surely beyond the nearest by `slack` may be lower bounds. Returns the min.
  float (*distances)(const SimdCapsule* robot, int count, const SimdCapsules& people, float slack,
                     float* distance) noexcept;
};

extern const SimdKernels kSimdKernelsBase;
#ifdef HANDSEL_SIMD_UNITS
extern const SimdKernels kSimdKernelsAvx2;
extern const SimdKernels kSimdKernelsAvx512;
#endif
/// Returns the kernels of the widest registers that this processor has.
const SimdKernels& simd_kernels() noexcept;

}  // namespace handsel::detail
