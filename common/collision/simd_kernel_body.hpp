// SPDX-License-Identifier: Apache-2.0
// SIMD kernels of collision and distance. Included only by the source file of each register width,
// which sets kWidth by simd_math.hpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/collision/simd_math.hpp"

namespace handsel::detail {
namespace {

constexpr float kIdentityPose[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// Collision check of kWidth states of the robot, one in each element of a register.
struct Pass {
  const SimdTables& tables;  ///< robot and scene: joints, sphere trees, solids, pairs
  SimdMemory& memory;        ///< scratch memory of the check
  bool swept{};              ///< each state stands for all within +-half of it
  bool stop_at_first{};      ///< one state in collision is enough

  /// Returns whether the search can stop: no state is left, or one collision is enough and found.
  bool settled(const M& found, const M& left) const noexcept {
    return !any_of(left) || (stop_at_first && any_of(found));
  }

  /// Returns the pose of a body: rows of a 3x4 matrix, kWidth states each.
  float* pose(int body) const noexcept { return memory.pose + body * 12 * kBatchStates; }

  /// Writes for each body how far its points may move within +-half of the states [m]. `half`: a
  /// row for each joint, kBatchStates columns [rad].
  void compute_sweep_margins(const float* half) const noexcept {
    for (int body = 0; body <= tables.joint_count; ++body) {
      V sum = 0.0f;
      const float* reach = tables.reach + body * tables.joint_count;
      for (int j = 0; j < tables.joint_count; ++j)
        if (reach[j] > 0.0f)
          sum += abs(load(half + tables.joints[j].row * kBatchStates) * tables.joints[j].factor) *
                 reach[j];
      store(sum, memory.margin + body * kBatchStates);
    }
  }
  /// Returns how far the two bodies of a pair may move relative to each other within +-half [m].
  V pair_margin(int pair, const float* half) const noexcept {
    V sum = 0.0f;
    const float* reach = tables.pair_reach + pair * tables.joint_count;
    for (int j = 0; j < tables.joint_count; ++j)
      if (reach[j] > 0.0f)
        sum += abs(load(half + tables.joints[j].row * kBatchStates) * tables.joints[j].factor) *
               reach[j];
    return sum;
  }

  /// Returns the centre of a sphere in the root frame: x, y and z of kWidth states each [m].
  /// Computed once in a pass.
  const float* node_position(int index) const noexcept {
    float* at = memory.position + index * 3 * kBatchStates;
    if (memory.stamp[index] == memory.now) return at;
    memory.stamp[index] = memory.now;
    const SimdNode& node = tables.nodes[index];
    const float* T = pose(node.body);
    for (int i = 0; i < 3; ++i)
      store(load(T + (4 * i) * kWidth) * node.x + load(T + (4 * i + 1) * kWidth) * node.y +
                load(T + (4 * i + 2) * kWidth) * node.z + load(T + (4 * i + 3) * kWidth),
            at + i * kWidth);
    return at;
  }

  /// Returns in which states a sphere touches or overlaps a solid; NaN counts as a collision.
  [[gnu::always_inline]] static M meets(const SimdSolid& s, const V& x, const V& y, const V& z,
                                        const V& r) noexcept {
    const V lx = x * s.axes[0] + y * s.axes[1] + (z * s.axes[2] - s.at[0]);
    const V ly = x * s.axes[3] + y * s.axes[4] + (z * s.axes[5] - s.at[1]);
    const V lz = x * s.axes[6] + y * s.axes[7] + (z * s.axes[8] - s.at[2]);
    const V reach = r + s.radius;
    const V dz = positive(abs(lz) - s.half[2]);
    if (s.cylinder > 0.0f) {
      const V across = positive(sqrt(lx * lx + ly * ly) - s.cylinder);
      return !(across * across + dz * dz > reach * reach);
    }
    const V dx = positive(abs(lx) - s.half[0]), dy = positive(abs(ly) - s.half[1]);
    return !(dx * dx + dy * dy + dz * dz > reach * reach);
  }

  /// Returns the states in which the spheres of the tree under `index` collide with one of the
  /// listed solids.
  M descend(int index, const std::int32_t* list, int count, M todo, int depth) const noexcept {
    const SimdNode& node = tables.nodes[index];
    const float* at = node_position(index);
    const V x = load(at), y = load(at + kWidth), z = load(at + 2 * kWidth);
    V r = node.radius;
    if (swept) r += load(memory.margin + node.body * kBatchStates);
    const bool leaf = node.children == 0 || depth == kMaxTreeDepth;
    std::int32_t* kept = memory.lists + depth * memory.max_list_size;
    int left = 0;
    M found(false);
    for (int k = 0; k < count; ++k) {
      const M hit = todo && meets(tables.solids[list[k]], x, y, z, r);
      if (!any_of(hit)) continue;
      if (!leaf) {
        kept[left++] = list[k];
        continue;
      }
      found = found || hit;
      todo = todo && !hit;
      if (settled(found, todo)) return found;
    }
    if (leaf || left == 0) return found;
    for (int c = 0; c < node.children; ++c) {
      const M hit = descend(node.first_child + c, kept, left, todo, depth + 1);
      found = found || hit;
      todo = todo && !hit;
      if (settled(found, todo)) return found;
    }
    return found;
  }

  /// Broad phase: writes to `kept` the solids that the root sphere can reach in at least one of the
  /// states, and returns their number.
  int near(const SimdSearch& s, const M& todo, std::int32_t* kept) const noexcept {
    const SimdNode& node = tables.nodes[s.root];
    const float* at = node_position(s.root);
    const V x = load(at), y = load(at + kWidth), z = load(at + 2 * kWidth);
    const float low[3] = {hmin(where(todo, x)), hmin(where(todo, y)), hmin(where(todo, z))};
    const float high[3] = {hmax(where(todo, x)), hmax(where(todo, y)), hmax(where(todo, z))};
    float center[3], spread2 = 0.0f;
    for (int i = 0; i < 3; ++i) {
      center[i] = 0.5f * (low[i] + high[i]);
      spread2 += 0.25f * (high[i] - low[i]) * (high[i] - low[i]);
    }
    float radius = node.radius + 1.00001f * std::sqrt(spread2) + 1e-6f;
    if (swept) radius += hmax(where(todo, load(memory.margin + node.body * kBatchStates)));
    int left = 0;
    for (int first = 0; first < s.solids; first += kBatchStates) {
      const SimdSolids& row = tables.solid_rows[s.first_row + first / kBatchStates];
      for (int g = 0; g < kBatchStates && first + g < s.solids; g += kWidth) {
        V d2 = 0.0f;
        for (int i = 0; i < 3; ++i) {
          const V local = load(row.axes[3 * i] + g) * center[0] +
                          load(row.axes[3 * i + 1] + g) * center[1] +
                          (load(row.axes[3 * i + 2] + g) * center[2] - load(row.at[i] + g));
          const V outside = positive(abs(local) - load(row.half[i] + g));
          d2 += outside * outside;
        }
        const V reach = load(row.radius + g) + radius;
        std::uint32_t hits = bits(!(d2 > reach * reach));
        for (; hits != 0; hits &= hits - 1) {
          const int k = first + g + __builtin_ctz(hits);
          if (k < s.solids) kept[left++] = tables.solid_list[s.first_solid + k];
        }
      }
    }
    return left;
  }

  /// Returns the states in which a part of the robot collides with its solids.
  M search(const SimdSearch& s, M todo) const noexcept {
    const std::int32_t* list = tables.solid_list + s.first_solid;
    if (s.nodes == 0) {
      if (s.first_row < 0) return descend(s.root, list, s.solids, todo, 0);
      const int left = near(s, todo, memory.lists);
      return left == 0 ? M(false) : descend(s.root, memory.lists, left, todo, 1);
    }
    const SimdNode& node = tables.nodes[s.root];
    const float* at = node_position(s.root);
    const V x = load(at), y = load(at + kWidth), z = load(at + 2 * kWidth);
    V r = node.radius;
    if (swept) r += load(memory.margin + node.body * kBatchStates);
    std::int32_t* kept = memory.lists;
    int left = 0;
    for (int k = 0; k < s.solids; ++k)
      if (any_of(todo && meets(tables.solids[list[k]], x, y, z, r))) kept[left++] = list[k];
    M found(false);
    for (int i = 0; left > 0 && i < s.nodes; ++i) {
      const M hit = descend(tables.node_list[s.first_node + i], kept, left, todo, 1);
      found = found || hit;
      todo = todo && !hit;
      if (settled(found, todo)) break;
    }
    return found;
  }

  /// Returns the states in which two sphere trees overlap, or are within `margin` [m].
  M overlap(int a, int b, const V& margin, const M& todo) const noexcept {
    const SimdNode &na = tables.nodes[a], &nb = tables.nodes[b];
    const float *pa = node_position(a), *pb = node_position(b);
    const V x = load(pa) - load(pb), y = load(pa + kWidth) - load(pb + kWidth),
            z = load(pa + 2 * kWidth) - load(pb + 2 * kWidth);
    const V reach = margin + (na.radius + nb.radius);
    M open = todo && !(x * x + y * y + z * z > reach * reach);
    if ((na.children == 0 && nb.children == 0) || !any_of(open)) return open;
    const bool first = nb.children == 0 || (na.children != 0 && na.radius > nb.radius);
    const SimdNode& split = first ? na : nb;
    M found(false);
    for (int c = 0; c < split.children; ++c) {
      const M hit = first ? overlap(split.first_child + c, b, margin, open)
                          : overlap(a, split.first_child + c, margin, open);
      found = found || hit;
      open = open && !hit;
      if (settled(found, open)) break;
    }
    return found;
  }

  /// Returns the states in collision with the scene or with the robot itself.
  M run(const float* q, const float* half, M todo) const noexcept {
    const M asked = todo;
    forward(tables.joints, tables.joint_count, kIdentityPose, q, memory.pose);
    if (swept) compute_sweep_margins(half);
    for (int i = 0; i < tables.search_count; ++i) {
      todo = todo && !search(tables.searches[i], todo);
      if (settled(asked && !todo, todo)) return asked && !todo;
    }
    for (int i = 0; i < tables.pair_count; ++i) {
      const SimdPair& pair = tables.pairs[i];
      const V margin = swept ? pair_margin(i, half) : V(0.0f);
      const SimdNode &na = tables.nodes[pair.a], &nb = tables.nodes[pair.b];
      const float *pa = node_position(pair.a), *pb = node_position(pair.b);
      const V x = load(pa) - load(pb), y = load(pa + kWidth) - load(pb + kWidth),
              z = load(pa + 2 * kWidth) - load(pb + 2 * kWidth);
      const V reach = margin + (na.radius + nb.radius);
      const M near = todo && !(x * x + y * y + z * z > reach * reach);
      if (!any_of(near)) continue;
      M open = near;
      for (int k = 0; k < pair.pairs && any_of(open); ++k) {
        const SimdNodePair& nodes = tables.node_pairs[pair.first + k];
        open = open && !overlap(nodes.a, nodes.b, margin, open);
      }
      todo = todo && !(near && !open);
      if (settled(asked && !todo, todo)) return asked && !todo;
    }
    return asked && !todo;
  }
};

/// Checks the states of `state_bits`. `q`, `half`: a row for each joint, kBatchStates columns
/// [rad]; with `half` each state stands for all within +-half of it. Returns a bit for each state
/// in collision; with `stop_at_first` perhaps not all of them.
std::uint32_t check(const SimdTables& tables, SimdMemory& memory, const float* q, const float* half,
                    std::uint32_t state_bits, bool stop_at_first) noexcept {
  std::uint32_t out = 0;
  const Pass pass{tables, memory, half != nullptr, stop_at_first};
  for (int g = 0; g < kBatchStates; g += kWidth) {
    const std::uint32_t here = state_bits >> g;
    if (here == 0) break;
    const M todo = M::__from_bitset(std::bitset<kWidth>(here & ((std::uint64_t{1} << kWidth) - 1)));
    if (!any_of(todo)) continue;
    ++memory.now;
    out |= bits(pass.run(q + g, half == nullptr ? nullptr : half + g, todo)) << g;
    if (stop_at_first && out != 0) break;
  }
  return out;
}

/// Writes the distances of `count` capsules of the robot to 16 of people [m]: distance[16 * i + k]
/// is exact where it is at most `slack` above the smallest, else a lower bound. Returns the
/// smallest; negative: overlap.
float distances(const SimdCapsule* robot, int count, const SimdCapsules& people, float slack,
                float* distance) noexcept {
  float nearest = 1e30f;
  for (int i = 0; i < count; ++i) {
    const SimdCapsule& c = robot[i];
    for (int g = 0; g < 16; g += kWidth) {
      const V x = c.mx - load(people.mx + g), y = c.my - load(people.my + g),
              z = c.mz - load(people.mz + g);
      const V apart = sqrt(x * x + y * y + z * z), radii = c.radius + load(people.radius + g);
      nearest = std::min(nearest, hmin(apart - radii));
      store(apart - (c.reach + load(people.reach + g)), distance + 16 * i + g);
    }
  }
  for (int i = 0; i < count; ++i) {
    const SimdCapsule& c = robot[i];
    for (int g = 0; g < 16; g += kWidth) {
      if (!any_of(load(distance + 16 * i + g) <= nearest + slack)) continue;
      const V dx = load(people.dx + g), dy = load(people.dy + g), dz = load(people.dz + g),
              bb = load(people.dd + g), over_bb = load(people.over_dd + g);
      const V rx = c.ax - load(people.ax + g), ry = c.ay - load(people.ay + g),
              rz = c.az - load(people.az + g);
      const V ab = c.dx * dx + c.dy * dy + c.dz * dz, ar = c.dx * rx + c.dy * ry + c.dz * rz,
              br = dx * rx + dy * ry + dz * rz;
      const V det = c.dd * bb - ab * ab;
      V s = unit((ab * br - ar * bb) / max(det, V(1e-12f)));
      const V t = unit((ab * s + br) * over_bb);
      s = unit((ab * t - ar) * c.over_dd);
      const V x = rx + s * c.dx - t * dx, y = ry + s * c.dy - t * dy, z = rz + s * c.dz - t * dz;
      const V d = sqrt(x * x + y * y + z * z) - (c.radius + load(people.radius + g));
      store(d, distance + 16 * i + g);
      nearest = std::min(nearest, hmin(d));
    }
  }
  return nearest;
}

}  // namespace
}  // namespace handsel::detail
