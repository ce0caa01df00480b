// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/pictures/speed_picture.hpp"

#include <cstdio>
#include <utility>

namespace handsel {
namespace {

constexpr int kCurveSamples = 400;
constexpr double kWide = 560, kHigh = 150, kLeft = 46, kTop = 34, kGap = 52;  // [px]

template <class... Values>
std::string text(const char* format, Values... values) {
  char line[320];
  std::snprintf(line, sizeof line, format, values...);
  return line;
}

std::string line_of(const SpeedCurve& curve, const std::vector<double>& values, double top,
                    const char* style) {
  std::string out = "<polyline points=\"";
  for (std::size_t i = 0; i < values.size(); ++i)
    out += text("%.1f,%.1f ", kLeft + curve.progress[i] * kWide, top + (1 - values[i]) * kHigh);
  return out + "\" fill=\"none\" " + style + "/>\n";
}

}  // namespace

SpeedCurve speed_curve(const Trajectory& trajectory, const std::vector<int>& axes,
                       const Vector& limits, const Vector& rest,
                       const trajectory_planner::SpeedAlong& people) {
  SpeedCurve curve;
  Vector q = rest;
  double gone = 0;
  Vector last = trajectory.at(0).position;
  for (int k = 0; k <= kCurveSamples; ++k) {
    const MotionState3 state = trajectory.at(trajectory.duration() * k / kCurveSamples);
    gone += (state.position - last).norm();
    last = state.position;
    q(axes) = state.position;
    const auto sample = people.at(q);
    curve.progress.push_back(gone);
    curve.cost.push_back(sample.cost);
    curve.allowed.push_back(sample.factor.velocity);
    curve.speed.push_back((state.velocity.cwiseAbs().array() / limits.array()).maxCoeff());
  }
  for (double& progress : curve.progress) progress /= gone > 0 ? gone : 1;
  return curve;
}

std::string speed_picture(const std::vector<SpeedCurve>& curves) {
  const double wide = kLeft + kWide + 20,
               high = kTop + static_cast<double>(curves.size()) * (kHigh + kGap) + 12;
  std::string out = text(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f "
      "%.0f\" font-family=\"sans-serif\" "
      "font-size=\"12\" fill=\"#222\">\n<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
      wide, high, wide, high);
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const SpeedCurve& curve = curves[k];
    const double top = kTop + static_cast<double>(k) * (kHigh + kGap);
    out += text("<text x=\"%.0f\" y=\"%.0f\" font-weight=\"bold\">%s</text>\n", kLeft, top - 8,
                curve.title.c_str());
    for (const double level : {0.0, 0.5, 1.0})
      out += text(
          "<line x1=\"%.0f\" x2=\"%.0f\" y1=\"%.1f\" y2=\"%.1f\" stroke=\"#ddd\"/><text x=\"%.0f\" "
          "y=\"%.1f\" "
          "text-anchor=\"end\">%.1f</text>\n",
          kLeft, kLeft + kWide, top + (1 - level) * kHigh, top + (1 - level) * kHigh, kLeft - 6,
          top + (1 - level) * kHigh + 4, level);
    out += line_of(curve, curve.cost, top, "stroke=\"#b35a00\" stroke-width=\"1.6\"");
    out += line_of(curve, curve.allowed, top,
                   "stroke=\"#777\" stroke-width=\"1.2\" stroke-dasharray=\"5 3\"");
    out += line_of(curve, curve.speed, top, "stroke=\"#1f5fa8\" stroke-width=\"2\"");
  }
  const double bottom = kTop + static_cast<double>(curves.size()) * (kHigh + kGap) - kGap + 20;
  out += text("<text x=\"%.0f\" y=\"%.0f\">the path, begin to end</text>\n", kLeft, bottom);
  const std::pair<const char*, const char*> names[] = {
      {"#b35a00", "human-aware cost"}, {"#777", "allowed"}, {"#1f5fa8", "speed"}};
  double x = kLeft + 170;
  for (const auto& [colour, what] : names) {
    out += text("<text x=\"%.0f\" y=\"%.0f\" fill=\"%s\">%s</text>\n", x, bottom, colour, what);
    x += 130;
  }
  return out + "</svg>\n";
}

}  // namespace handsel
