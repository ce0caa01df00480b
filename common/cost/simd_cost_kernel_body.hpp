// SPDX-License-Identifier: Apache-2.0
// The one source of the cost kernels, compiled once per register width.
#pragma once

#include "common/collision/simd_math.hpp"
#include "common/cost/simd_cost_kernel.hpp"
#include "common/cost/simd_functions.hpp"

namespace handsel::detail {
namespace {

// of a segment: its nearest point is known within 1/32768 of its length
constexpr int kHalvings = 14;

struct Place {
  V x, y, z;
};

[[gnu::always_inline]] inline Place transform(const float* T, const float p[3]) noexcept {
  const auto row = [&](int i) {
    return load(T + (4 * i) * kWidth) * p[0] + load(T + (4 * i + 1) * kWidth) * p[1] +
           load(T + (4 * i + 2) * kWidth) * p[2] + load(T + (4 * i + 3) * kWidth);
  };
  return {row(0), row(1), row(2)};
}

[[gnu::always_inline]] inline V to_head(const CostPerson& h, const Place& p) noexcept {
  const V x = p.x - h.head[0], y = p.y - h.head[1], z = p.z - h.head[2];
  return sqrt(x * x + y * y + z * z) - h.head_radius;
}

[[gnu::always_inline]] inline V to_cylinder(const CostPerson& h, const Place& p) noexcept {
  const V x = p.x - h.axis_x, y = p.y - h.axis_y, z = p.z - h.bottom;
  const V across = positive(sqrt(x * x + y * y) - h.radius),
          along = max(positive(z - h.height), -z);
  return sqrt(across * across + along * along);
}

/// The squared distance to a convex body is convex along a line: halves the segment by the sign of
/// its slope.
[[gnu::always_inline]] inline V segment_to_cylinder(const CostPerson& h, const Place& a,
                                                    const Place& d) noexcept {
  const V x = a.x - h.axis_x, y = a.y - h.axis_y, z = a.z - h.bottom;
  V low = 0.0f, high = 1.0f;
  for (int i = 0; i < kHalvings; ++i) {
    const V t = 0.5f * (low + high);
    const V px = x + t * d.x, py = y + t * d.y, pz = z + t * d.z;
    const V off = sqrt(px * px + py * py) + 1e-12f;
    const V slope = positive(off - h.radius) / off * (px * d.x + py * d.y) +
                    (positive(pz - h.height) - positive(-pz)) * d.z;
    where(slope >= 0.0f, high) = t;
    where(slope <= 0.0f, low) = t;
  }
  const V t = 0.5f * (low + high);
  return to_cylinder(h, {a.x + t * d.x, a.y + t * d.y, a.z + t * d.z});
}

[[gnu::always_inline]] inline V segment_to_head(const CostPerson& h, const Place& a,
                                                const Place& d) noexcept {
  const V x = h.head[0] - a.x, y = h.head[1] - a.y, z = h.head[2] - a.z;
  const V t = unit((x * d.x + y * d.y + z * d.z) / (d.x * d.x + d.y * d.y + d.z * d.z + 1e-12f));
  return to_head(h, {a.x + t * d.x, a.y + t * d.y, a.z + t * d.z});
}

void run_group(const CostTables& tables, const CostMemory& memory, const float* q,
               int first) noexcept {
  forward(tables.joints, tables.joint_count, tables.root, q, memory.pose);
  const auto pose = [&](int body) { return memory.pose + body * 12 * kBatchStates; };
  for (int i = 0; i < tables.point_count; ++i) {
    const Place p = transform(pose(tables.points[i].body), tables.points[i].p);
    float* out = memory.point + 3 * kBatchStates * i + first;
    store(p.x, out);
    store(p.y, out + kBatchStates);
    store(p.z, out + 2 * kBatchStates);
  }
  if (tables.people_count == 0) return;
  for (int i = 0; i < tables.capsule_count; ++i) {
    const CostCapsule& capsule = tables.capsules[i];
    const Place a = transform(pose(capsule.body), capsule.a),
                b = transform(pose(capsule.body), capsule.b);
    float* ends = memory.ends + 8 * kBatchStates * i;
    const V rows[6] = {a.x, a.y, a.z, b.x - a.x, b.y - a.y, b.z - a.z};
    for (int k = 0; k < 6; ++k) store(rows[k], ends + k * kWidth);
  }
  for (int k = 0; k < tables.people_count; ++k) {
    const CostPerson& h = tables.people[k];
    V nearest = 1e9f;
    for (int i = 0; i < tables.capsule_count; ++i) {
      float* ends = memory.ends + 8 * kBatchStates * i;
      const auto middle = [&](int c) {
        return load(ends + c * kWidth) + 0.5f * load(ends + (c + 3) * kWidth);
      };
      const Place m{middle(0), middle(1), middle(2)};
      const V d = min(to_head(h, m), to_cylinder(h, m)) - tables.capsules[i].radius;
      nearest = min(nearest, d);
      store(d - tables.capsules[i].half, ends + 6 * kWidth);
    }
    for (int i = 0; i < tables.capsule_count; ++i) {
      const float* ends = memory.ends + 8 * kBatchStates * i;
      if (none_of(load(ends + 6 * kWidth) < min(nearest, V(1.0f / h.over_safety_radius)))) continue;
      const Place a{load(ends), load(ends + kWidth), load(ends + 2 * kWidth)},
          d{load(ends + 3 * kWidth), load(ends + 4 * kWidth), load(ends + 5 * kWidth)};
      nearest = min(nearest, min(segment_to_head(h, a, d), segment_to_cylinder(h, a, d)) -
                                 tables.capsules[i].radius);
    }
    store(safety_of(max(min(nearest * -h.over_safety_radius, V(0.0f)), V(-1.0f))),
          memory.safety + kBatchStates * k + first);
    const float* tool = memory.point + first;
    const V x = load(tool) - h.eyes[0], y = load(tool + kBatchStates) - h.eyes[1],
            z = load(tool + 2 * kBatchStates) - h.eyes[2];
    const V far = x * x + y * y + z * z;
    const V cosine = (x * h.gaze[0] + y * h.gaze[1] + z * h.gaze[2]) / sqrt(far + 1e-12f);
    V seen = acos_fraction(max(min(cosine, V(1.0f)), V(-1.0f)));
    where(far > (h.cutoff > 0 ? h.cutoff * h.cutoff : -1.0f), seen) = 0.0f;
    store(seen, memory.visibility + kBatchStates * k + first);
  }
}

void run(const CostTables& tables, const CostMemory& memory, const float* q, int count) noexcept {
  for (int first = 0; first < count; first += kWidth) run_group(tables, memory, q + first, first);
}

}  // namespace
}  // namespace handsel::detail
