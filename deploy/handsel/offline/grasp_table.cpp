// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/offline/grasp_table.hpp"

#include <algorithm>
#include <cstdio>

#include "common/base/errors.hpp"
#include "components/grasp_planner/list/pinch.hpp"

namespace handsel {

using namespace grasp_planner;

double fitting_scale(const Vector3& extents, double opening) {
  std::array<double, 3> e = {extents.x(), extents.y(), extents.z()};
  std::sort(e.begin(), e.end());
  return e[1] >= 0.15 * opening && e[1] <= 0.75 * opening ? 1.0 : 0.5 * opening / e[1];
}

double opening_of(const HandGeometry& hand_geometry) {
  if (hand_geometry.hand.pinches()) return PinchMotion(hand_geometry).widest();
  double widest = 0;
  const Vector3 thumb = hand_geometry.chains[0].tip(hand_geometry.hand.pregrasp());
  for (std::size_t f = 1; f < hand_geometry.chains.size(); ++f)
    widest = std::max(widest,
                      (hand_geometry.chains[f].tip(hand_geometry.hand.pregrasp()) - thumb).norm());
  return widest;
}

TableRow table_row(const std::string& hand, const ListOptions& options, bool fit) {
  TableRow row;
  row.hand = hand;
  row.object = std::filesystem::path(options.object).stem().string();
  ListOptions o = options;
  try {
    if (fit) {
      ObjectModel object;
      try {
        object = object_of(o);
      } catch (const ConfigError&) {
        o.scale *= 1e-3;  // from millimetres
        object = object_of(o);
      }
      Eigen::AlignedBox3d box;
      for (const Vector3& v : object.mesh.vertices) box.extend(v);
      o.scale *= fitting_scale(box.sizes(), opening_of(*hand_geometry_of(hand)));
    }
    row.scale = o.scale / options.scale;
    const Listed listed = list_with(hand, o, true);
    row.size = listed.object->box().sizes().maxCoeff();
    row.triangles = listed.object->mesh().triangles.size();
    row.grasps = listed.list.grasps.size();
    row.frames = listed.list.frames;
    row.seconds = listed.seconds;
    if (row.grasps > 0) row.best = listed.list.grasps.front().grasp.quality;
    for (const std::string& s : sentences(listed.object->findings()))
      row.findings += (row.findings.empty() ? "" : " ") + s;
    const auto most_frequent =
        std::max_element(listed.list.reasons.begin() + 1, listed.list.reasons.end());
    row.reason = std::to_string(*most_frequent) + ": " +
                 reason_text(static_cast<FrameReason>(most_frequent - listed.list.reasons.begin()));
  } catch (const ConfigError& e) {
    row.reason = e.what();
  }
  return row;
}

std::string table_head() {
  char line[200];
  std::snprintf(line, sizeof line, "%-16s %-12s %8s %7s %9s %7s %7s %6s %7s  %s", "object", "hand",
                "scale", "size[m]", "triangles", "frames", "grasps", "best", "time[s]",
                "most frequent reason of the frames without a grasp");
  return line;
}

std::string table_line(const TableRow& r) {
  char line[200];
  std::snprintf(line, sizeof line, "%-16.16s %-12.12s %8.4g %7.3f %9zu %7llu %7zu %6.3f %7.2f  ",
                r.object.c_str(), r.hand.c_str(), r.scale, r.size, r.triangles,
                static_cast<unsigned long long>(r.frames), r.grasps, r.best, r.seconds);
  return line + r.reason;
}

}  // namespace handsel
