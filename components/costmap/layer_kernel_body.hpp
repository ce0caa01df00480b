// SPDX-License-Identifier: Apache-2.0
// Included once for each register width, with HANDSEL_FILL_ROW naming the function.
#include <cmath>

#include "common/cost/simd_functions.hpp"
#include "components/costmap/layer_kernel.hpp"

namespace handsel::costmap::detail {
void HANDSEL_FILL_ROW(const RowPerson& person, const RowPoints& points,
                      const std::uint8_t* __restrict comfort, std::uint8_t* __restrict safety,
                      std::uint8_t* __restrict visibility,
                      std::uint8_t* __restrict total) noexcept {
  const RowPerson h = person;
  const float y = points.y, z = points.z, step = points.step;
  const int n = points.n;
  const float dy = y - h.axis_y, from_bottom = z - h.bottom,
              above = std::fmax(-from_bottom, from_bottom - h.height);
  const float hy = y - h.head[1], hz = z - h.head[2], head_yz = hy * hy + hz * hz;
  const float ey = y - h.eyes[1], ez = z - h.eyes[2], eyes_yz = ey * ey + ez * ez,
              gaze_yz = ey * h.gaze[1] + ez * h.gaze[2];
  const float cut = h.cutoff > 0 ? h.cutoff * h.cutoff : -1;
  for (int i = 0; i < n; ++i) {
    const float x = static_cast<float>(i) * step;
    const float dx = x - h.axis_x, outside = std::sqrt(dx * dx + dy * dy) - h.radius;
    const float out_x = outside > 0 ? outside : 0, out_z = above > 0 ? above : 0;
    const float deepest = outside > above ? outside : above,
                reach = std::sqrt(out_x * out_x + out_z * out_z);
    const float body = deepest < 0 ? deepest : reach;
    const float hx = x - h.head[0], head = std::sqrt(hx * hx + head_yz) - h.head_radius;
    const float d = body < head ? body : head;
    float u = -d * h.over_safety_radius;  // penetration - 1
    u = u > 0 ? 0 : u < -1 ? -1 : u;
    const float s = handsel::detail::safety_of(u);
    const float ex = x - h.eyes[0], far = ex * ex + eyes_yz;
    float cosine = (ex * h.gaze[0] + gaze_yz) / std::sqrt(far + 1e-12f);
    cosine = cosine > 1 ? 1 : cosine < -1 ? -1 : cosine;
    const float seen = handsel::detail::acos_fraction(cosine), v = far > cut ? 0 : seen;
    const float byte = static_cast<float>(static_cast<int>(comfort[i])),
                c = byte > 254 ? 254 : byte;
    // NOLINTBEGIN(bugprone-incorrect-roundings): lround does not vectorise; the values are in [0,
    // 254].
    safety[i] = static_cast<std::uint8_t>(static_cast<int>(254 * s + 0.5f));
    visibility[i] = static_cast<std::uint8_t>(static_cast<int>(254 * v + 0.5f));
    total[i] = static_cast<std::uint8_t>(
        static_cast<int>(254 * (h.w_safety * s + h.w_visibility * v) + h.w_comfort * c + 0.5f));
    // NOLINTEND(bugprone-incorrect-roundings)
  }
}

}  // namespace handsel::costmap::detail
