#include "components/grasp_planner/double_grasp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace handsel::grasp_planner {
namespace {

std::vector<HandShape::PlacedHand> place(const HandSide& side, std::size_t count) {
  std::vector<HandShape::PlacedHand> out;
  std::vector<std::vector<Pose>> T_hand_step;
  for (std::size_t i = 0; i < count; ++i) {
    const Grasp& g = side.list->grasps[i].grasp;
    side.kit->forward(g.hand_joints, T_hand_step);
    out.push_back(side.kit->shape.placed(T_hand_step, g.T_object_hand));
  }
  return out;
}

// Maps the values of all double grasps to [0, 1] and adds them to the scores.
template <class Value>
void add_normalised(std::vector<DoubleGrasp>& grasps, const Value& value) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const DoubleGrasp& g : grasps) {
    low = std::min(low, value(g));
    high = std::max(high, value(g));
  }
  if (!(high > low)) return;
  for (DoubleGrasp& g : grasps) g.score += (value(g) - low) / (high - low);
}

}  // namespace

DoubleList list_double_grasps(const HandSide& a, const HandSide& b, const Vector3& p_object_middle, const DoubleSettings& settings) {
  const std::size_t n = std::min(a.list->grasps.size(), settings.most_of_each), m = std::min(b.list->grasps.size(), settings.most_of_each);
  const auto hands_a = place(a, n), hands_b = place(b, m);
  const auto direction = [&](const HandSide& s, std::size_t i) {
    return Vector3((s.list->grasps[i].grasp.T_object_hand.translation() - p_object_middle).normalized());
  };
  DoubleList out;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < m; ++k) {
      ++out.pairs;
      DoubleGrasp d{i, k};
      d.opposition = std::acos(std::clamp(direction(a, i).dot(direction(b, k)), -1.0, 1.0));
      if (d.opposition < settings.least_opposition) {
        ++out.not_opposed;
        continue;
      }
      if (HandShape::hands_touch(hands_a[i], hands_b[k], settings.clearance)) {
        ++out.colliding;
        continue;
      }
      d.quality = std::min(a.list->grasps[i].grasp.quality, b.list->grasps[k].grasp.quality);
      if (!a.posture.empty() && !b.posture.empty()) d.posture = std::min(a.posture[i], b.posture[k]);
      out.grasps.push_back(d);
    }
  }
  add_normalised(out.grasps, [](const DoubleGrasp& g) { return g.quality; });
  add_normalised(out.grasps, [](const DoubleGrasp& g) { return g.posture; });
  std::stable_sort(out.grasps.begin(), out.grasps.end(), [](const DoubleGrasp& x, const DoubleGrasp& y) { return x.score > y.score; });
  return out;
}

}  // namespace handsel::grasp_planner
