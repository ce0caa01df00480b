// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/cost_picture.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>

#include "common/cost/person_frame.hpp"

namespace handsel {
namespace {

constexpr double kBehind = -1.0, kBefore = 2.0, kTop = 2.2;  // extent of the plane [m]
constexpr double kScale = 120, kGap = 46, kMargin = 44;      // [px/m], [px], [px]
// From no cost to the max: lightness decreases evenly, so that the picture also works in grey.
constexpr std::array kRamp = {"#f7fbf2", "#e0f0d9", "#c4e5c4", "#a2d9b4", "#7ac9b0", "#55b4b6",
                              "#3f9bbb", "#3b7fb4", "#3f61a3", "#3f4587", "#332a5f"};

std::string text(const char* format, auto... values) {
  char line[320];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

int level(double cost) {
  return std::clamp(static_cast<int>(cost * kRamp.size()), 0, static_cast<int>(kRamp.size()) - 1);
}

struct Panel {
  const char* name;
  std::function<double(const CostParts&)> cost;
};

/// Conversion between points of the plane (x in front of the person, z above the floor) and pixels.
struct Plane {
  explicit Plane(const Person& person) {
    const SimplifiedBody body = simplified_body(person);
    forward = torso_axes(person).col(0);
    forward.z() = 0;
    forward.normalize();
    origin = find_joint(person, "r_shoulder")->position;
    origin.z() = body.axis_bottom.z();
  }
  Vector3 at(double x, double z) const { return origin + x * forward + Vector3(0, 0, z); }
  double x_of(const Vector3& p) const { return (p - origin).dot(forward); }
  double z_of(const Vector3& p) const { return p.z() - origin.z(); }
  Vector3 origin, forward;
};

/// Draws the cost at the points of the plane, in cells of `cell` [m].
void draw_map(std::string& out, const Plane& plane,
              const std::function<double(const Vector3&)>& cost_at, double cell, double left,
              double top) {
  const int columns = static_cast<int>(std::lround((kBefore - kBehind) / cell)),
            rows = static_cast<int>(std::lround(kTop / cell));
  const double edge = cell * kScale;
  for (int row = 0; row < rows; ++row) {
    const double z = kTop - (row + 0.5) * cell;
    for (int from = 0; from < columns;) {
      const auto level_at = [&](int i) {
        return level(cost_at(plane.at(kBehind + (i + 0.5) * cell, z)));
      };
      const int here = level_at(from);
      int to = from + 1;
      while (to < columns && level_at(to) == here) ++to;
      out += text("<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\"/>\n",
                  left + from * edge, top + row * edge, (to - from) * edge + 0.3, edge + 0.3,
                  kRamp[static_cast<std::size_t>(here)]);
      from = to;
    }
  }
}

void draw_person(std::string& out, const Person& person, const Plane& plane, double left,
                 double top) {
  for (const BodyCapsule& part : body_capsules(person)) {
    const auto px = [&](const Vector3& p) { return left + (plane.x_of(p) - kBehind) * kScale; };
    const auto py = [&](const Vector3& p) { return top + (kTop - plane.z_of(p)) * kScale; };
    out += text("<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" stroke-width=\"%.1f\"/>\n",
                px(part.a), py(part.a), px(part.b) + 0.01, py(part.b), 2 * part.radius * kScale);
  }
}

void draw_axes(std::string& out, double left, double top) {
  const double width = (kBefore - kBehind) * kScale, height = kTop * kScale;
  for (int x = -1; x <= 2; ++x)
    out += text("<text x=\"%.0f\" y=\"%.0f\" text-anchor=\"middle\">%d m</text>\n",
                left + (x - kBehind) * kScale, top + height + 14, x);
  for (int z = 0; z <= 2; ++z)
    out += text("<text x=\"%.0f\" y=\"%.0f\" text-anchor=\"end\">%d m</text>\n", left - 5,
                top + (kTop - z) * kScale + 4, z);
  out += text(
      "<rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\" fill=\"none\" "
      "stroke=\"#888\"/>\n",
      left, top, width, height);
}

}  // namespace

std::string cost_picture(const Person& person, const CostSettings& settings, double cell,
                         const std::string& title) {
  const Panel panels[] = {
      {"safety: distance", [](const CostParts& c) { return c.safety; }},
      {"visibility: angle to the gaze", [](const CostParts& c) { return c.visibility; }},
      {"arm comfort", [](const CostParts& c) { return c.comfort; }},
      {"weighted sum", [&](const CostParts& c) { return weighted_cost(c, settings); }}};
  const Plane plane(person);
  const double width = (kBefore - kBehind) * kScale, height = kTop * kScale;
  const double all_wide = 2 * kMargin + 2 * width + kGap, all_high = 60 + 2 * (height + kGap) + 50;
  std::string out = text(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f "
      "%.0f\" font-family=\"sans-serif\" "
      "font-size=\"12\" fill=\"#222\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      all_wide, all_high, all_wide, all_high);
  out += text("<text x=\"%.0f\" y=\"24\" font-size=\"15\">%s</text>\n", kMargin, title.c_str());
  for (int i = 0; i < 4; ++i) {
    const int column = i % 2, row = i / 2;
    const double left = kMargin + column * (width + kGap), top = 60 + row * (height + kGap);
    out += text("<text x=\"%.0f\" y=\"%.0f\">%s</text>\n<g shape-rendering=\"crispEdges\">\n", left,
                top - 7, panels[i].name);
    const auto cost_at = [&](const Vector3& p) {
      return panels[i].cost(point_cost(person, p, settings));
    };
    draw_map(out, plane, cost_at, cell, left, top);
    out += "</g>\n<g stroke=\"#222\" stroke-opacity=\"0.28\" stroke-linecap=\"round\">\n";
    draw_person(out, person, plane, left, top);
    out += "</g>\n";
    draw_axes(out, left, top);
  }
  const double top = 60 + 2 * (height + kGap);
  for (std::size_t i = 0; i < kRamp.size(); ++i)
    out += text(
        "<rect x=\"%.1f\" y=\"%.1f\" width=\"24\" height=\"12\" fill=\"%s\" stroke=\"#888\" "
        "stroke-width=\"0.4\"/>\n",
        kMargin + 24.0 * static_cast<double>(i), top, kRamp[i]);
  out += text(
      "<text x=\"%.0f\" y=\"%.0f\">0</text><text x=\"%.0f\" y=\"%.0f\" "
      "text-anchor=\"end\">1</text>\n",
      kMargin, top + 26, kMargin + 24.0 * kRamp.size(), top + 26);
  out += text(
      "<text x=\"%.0f\" y=\"%.0f\">cost; plane through the right shoulder, the person looks to the "
      "right</text>\n",
      kMargin + 24.0 * kRamp.size() + 14, top + 10);
  return out + "</svg>\n";
}

}  // namespace handsel
