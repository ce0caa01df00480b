// SPDX-License-Identifier: Apache-2.0
#include "components/spark/sources.hpp"

#include <algorithm>
#include <array>
#include <cstdio>

namespace handsel::spark {

bool contains(const Coverage& box, const Vector3& p, double margin) {
  const Eigen::Array3d m(margin, margin, 0);
  return (p.array() >= box.low.array() + m).all() && (p.array() <= box.high.array() - m).all();
}

std::string why_not_active(const Source& source, TimePoint now, double max_age) {
  const double age = source.age(now);
  if (age <= max_age) return "";
  if (!source.unknown_age.empty()) return source.unknown_age;
  char text[80];
  if (!source.repeats && source.latency > max_age)
    std::snprintf(text, sizeof text, "is late: its pictures are %.2f s old", source.latency);
  else
    std::snprintf(text, sizeof text, "%s for %.1f s",
                  source.repeats ? "repeats itself" : "is silent", age);
  return text;
}

std::vector<SourceView> views_of(const std::map<std::string, Source>& sources, TimePoint now,
                                 double max_age) {
  constexpr double kMaxAge = 1e9;  // max age in HumanState [s]
  std::vector<SourceView> out;
  for (const auto& [name, source] : sources) {
    const std::string why = why_not_active(source, now, max_age);
    out.push_back({name, source.coverage.low, source.coverage.high,
                   std::clamp(source.age(now), 0.0, kMaxAge), why.empty(), why});
  }
  return out;
}

bool covers(const std::vector<Coverage>& boxes, const Coverage& box) {
  // Cuts the box into cells, each entirely inside or outside of every other box.
  std::array<std::vector<double>, 3> cuts;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    cuts[i] = {box.low[k], box.high[k]};
    for (const Coverage& other : boxes)
      for (const double at : {other.low[k], other.high[k]})
        if (at > box.low[k] && at < box.high[k]) cuts[i].push_back(at);
    std::sort(cuts[i].begin(), cuts[i].end());
  }
  for (std::size_t x = 0; x + 1 < cuts[0].size(); ++x)
    for (std::size_t y = 0; y + 1 < cuts[1].size(); ++y)
      for (std::size_t z = 0; z + 1 < cuts[2].size(); ++z) {
        const Vector3 middle((cuts[0][x] + cuts[0][x + 1]) / 2, (cuts[1][y] + cuts[1][y + 1]) / 2,
                             (cuts[2][z] + cuts[2][z + 1]) / 2);
        if (std::none_of(boxes.begin(), boxes.end(),
                         [&](const Coverage& c) { return contains(c, middle, 0); }))
          return false;
      }
  return true;
}

bool observes(const Source& source, const Obstacles& obstacles, const Vector3& point) {
  if (!contains(source.coverage, point, 0)) return false;
  if (!source.eye) return true;
  const auto between = [&](const auto& thing) { return hides(thing, *source.eye, point); };
  return std::none_of(obstacles.robot.begin(), obstacles.robot.end(), between) &&
         std::none_of(obstacles.boxes.begin(), obstacles.boxes.end(), between);
}

bool at_boundary(const Source& source, const Vector3& place, double margin) {
  const bool observes = (source.coverage.low.array() < source.coverage.high.array()).all();
  return observes && !contains(source.coverage, place, margin);
}

}  // namespace handsel::spark
