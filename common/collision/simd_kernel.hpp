// Sixteen states of a robot side by side: forward kinematics, then the spheres around its links
// against solids and against each other. Plain data in the frame of the robot's root, single
// precision; the rounding must be added to the radii. Written once for any register width,
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
  std::int32_t parent;  // body
  std::int32_t row;     // of the positions
  float factor, offset;
  std::int32_t slides;
};

/// A sphere that moves with a body; everything its children cover is inside.
struct SimdNode {
  float x, y, z, radius;
  std::int32_t first_child, children, body, reserved;
};

/// A box (or segment, or point) with rounded edges, or a cylinder when `cylinder` > 0: axes of the
/// shape by rows, then their products with its centre.
struct SimdSolid {
  float axes[9], at[3], half[3], radius, cylinder;
};

/// Sixteen solids side by side, cylinders as the boxes around them; those that are not there are
/// far away.
struct SimdSolids {
  alignas(64) float axes[9][kBatchStates], at[3][kBatchStates], half[3][kBatchStates],
      radius[kBatchStates];
};

/// Spheres that must stay clear of solids: below `root`, in the trees of `nodes` (all when there
/// are none). `first_row`: the same solids in rows of sixteen; -1: not there.
struct SimdSearch {
  std::int32_t root, first_node, nodes, first_solid, solids, first_row;
};

/// Trees that must stay clear of each other: below the roots a and b, the pairs of nodes. `reach`:
/// row of pair_reach.
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
/// margin bodies x kBatchStates, position 3 x nodes x kBatchStates. stamp: one a node.
struct SimdMemory {
  float *pose, *margin, *position;
  std::uint32_t* stamp;
  std::uint32_t now;
  std::int32_t* lists;  // room for solid lists: kMaxTreeDepth x the longest list
  std::int32_t max_list_size;
};
constexpr int kMaxTreeDepth = 12;

/// Capsules of one body of bones: 16 side by side; those that are not there are a thousand
/// kilometres away.
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
  /// those surely beyond the nearest by `slack` may be lower bounds. Returns the least.
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
