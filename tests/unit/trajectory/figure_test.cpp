// SPDX-License-Identifier: Apache-2.0
// Draws docs/figures/corner_127.svg: three points, two straight segments at 127 degrees, V 0.1 m/s,
// A 0.3 m/s^2, J 0.9 m/s^3 (chapter figure 18). The file in the documentation must be identical;
// HANDSEL_WRITE_FIGURES=1 writes it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/path/smooth.hpp"

namespace handsel::figure_test {
namespace {

using Eigen::VectorXd;

const KinematicLimits kLimits{VectorXd::Constant(2, 0.1), VectorXd::Constant(2, 0.3),
                              VectorXd::Constant(2, 0.9)};

std::vector<VectorXd> three_points() {
  const double turn = (180 - 127) * M_PI / 180;
  VectorXd p1 = VectorXd::Zero(2), p2 = VectorXd::Zero(2), p3 = VectorXd::Zero(2);
  p2 << 0.5, 0;
  p3 << 0.5 + 0.5 * std::cos(turn), 0.5 * std::sin(turn);
  return {p1, p2, p3};
}

SmoothResult run(std::optional<double> tau) {
  SmoothSettings settings;
  settings.tau = tau;
  return smooth(three_points(), kLimits, settings);
}

/// Colours are classes, so that the drawing follows a dark page.
constexpr const char* kStyle =
    R"(<style>
text { fill: #222; } .paper { fill: #fff; } polyline { fill: none; stroke-width: 1.6; }
.axis { stroke: #777; stroke-width: 1; } .grid { stroke: #ddd; stroke-width: 0.7; } )"
    R"(.bound { stroke: #c33; stroke-width: 1; stroke-dasharray: 5 3; }
.x { stroke: #1f5fa8; } .y { stroke: #b35a00; } .t0 { stroke: #777; } )"
    R"(.t1 { stroke: #b35a00; } .t2 { stroke: #a0307a; } .t3 { stroke: #23804a; } )"
    R"(.t4 { stroke: #1f5fa8; }
@media (prefers-color-scheme: dark) {
text { fill: #ddd; } .paper { fill: #16181c; } .axis { stroke: #999; } )"
    R"(.grid { stroke: #34383f; } .bound { stroke: #ff7b72; }
.x { stroke: #6cb0ff; } .y { stroke: #ffa657; } .t0 { stroke: #aaa; } )"
    R"(.t1 { stroke: #ffa657; } .t2 { stroke: #f08bd0; } .t3 { stroke: #5fd38d; } )"
    R"(.t4 { stroke: #6cb0ff; }
}
</style>
<rect class="paper" width="100%" height="100%"/>
)";

using Points = std::vector<std::pair<double, double>>;

class Drawing {
 public:
  Drawing(int width, int height) {
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\""
         << height << "\" viewBox=\"0 0 " << width << ' ' << height
         << "\" font-family=\"sans-serif\" font-size=\"12\">\n"
         << kStyle;
  }
  void text(double x, double y, const std::string& s, const char* anchor = "start") {
    out_ << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" text-anchor=\"" << anchor
         << "\">" << s << "</text>\n";
  }
  void line(const Points& points, const std::string& kind) {
    out_ << "<polyline class=\"" << kind << "\" points=\"";
    for (const auto& [x, y] : points) out_ << number(x) << ',' << number(y) << ' ';
    out_ << "\"/>\n";
  }
  std::string finish() { return out_.str() + "</svg>\n"; }
  static std::string number(double x, int digits = 2) {
    char text[32];
    std::snprintf(text, sizeof text, "%.*f", digits, x + 0.0);
    return std::atof(text) == 0 && text[0] == '-' ? text + 1 : text;
  }

 private:
  std::ostringstream out_;
};

/// A frame with numbers at its axes.
struct Frame {
  double left, top, width, height, x_lo, x_hi, y_lo, y_hi;
  std::pair<double, double> at(double x, double y) const {
    return {left + width * (x - x_lo) / (x_hi - x_lo), top + height * (y_hi - y) / (y_hi - y_lo)};
  }
  void draw(Drawing& d, double x_step, double y_step, int digits, const std::string& across,
            const std::string& up) const {
    for (int k = 0; x_lo + k * x_step <= x_hi + 1e-9; ++k) {
      const double x = x_lo + k * x_step;
      d.line({at(x, y_lo), at(x, y_hi)}, "grid");
      d.text(at(x, y_lo).first, top + height + 15, Drawing::number(x, x_step < 1 ? 2 : 0),
             "middle");
    }
    for (int k = 0; y_lo + k * y_step <= y_hi + 1e-9; ++k) {
      const double y = y_lo + k * y_step;
      d.line({at(x_lo, y), at(x_hi, y)}, "grid");
      d.text(left - 6, at(x_lo, y).second + 4, Drawing::number(y, digits), "end");
    }
    d.line({at(x_lo, y_hi), at(x_lo, y_lo), at(x_hi, y_lo)}, "axis");
    d.text(left + width, top + height + 30, across, "end");
    d.text(left, top - 8, up);
  }
};

/// One curve of x and one of y over time, with the limits.
void curves(Drawing& d, const Frame& frame, const Trajectory& t, int derivative, double limit) {
  if (limit > 0) {
    for (const double bound : {limit, -limit})
      d.line({frame.at(frame.x_lo, bound), frame.at(frame.x_hi, bound)}, "bound");
  }
  for (int axis = 0; axis < 2; ++axis) {
    Points points;
    for (int k = 0; k <= 280; ++k) {
      const double time = t.duration() * k / 280;
      const MotionState3 s = t.at(time);
      points.push_back(frame.at(time, (derivative == 0   ? s.position
                                       : derivative == 1 ? s.velocity
                                                         : s.acceleration)[axis]));
    }
    d.line(points, axis == 0 ? "x" : "y");
  }
}

std::string draw() {
  Drawing d(860, 1010);
  const auto nodes = three_points();
  d.text(20, 24,
         "Corner of 127\xc2\xb0 between legs of 0.5 m; V 0.1 m/s, A 0.3 m/s\xc2\xb2, J 0.9 "
         "m/s\xc2\xb3 (dashed: limits, 10 % of excess "
         "allowed)");
  const Frame corner{80, 60, 560, 336, 0.40, 0.60, -0.02, 0.10};
  corner.draw(d, 0.02, 0.02, 2, "x [m]", "y [m], near the node");
  static constexpr std::array<double, 5> kTaus{0, 0.25, 0.5, 0.75, 1.0};
  for (std::size_t k = 0; k < kTaus.size(); ++k) {
    const SmoothResult r = run(kTaus[k]);
    Points points;
    for (int i = 0; i <= 2000; ++i) {
      const VectorXd p = r.trajectory.at(r.trajectory.duration() * i / 2000).position;
      if (p[0] >= corner.x_lo && p[0] <= corner.x_hi && p[1] <= corner.y_hi)
        points.push_back(corner.at(p[0], p[1]));
    }
    const std::string kind = "t" + std::to_string(k);
    d.line(points, kind);
    const double y = 90 + 36.0 * static_cast<double>(k);
    d.line({{660, y - 4}, {684, y - 4}}, kind);
    d.text(692, y,
           "\xcf\x84 = " + Drawing::number(kTaus[k]) +
               " s: " + Drawing::number(r.trajectory.duration()) + " s");
    d.text(692, y + 15, std::string(name(r.corners[0].method)));
  }
  for (const double tau : {0.0, 1.0}) {
    const double left = tau == 0 ? 80 : 500;
    const Trajectory t = run(tau).trajectory;
    const std::string of = tau == 0 ? " of x and y, \xcf\x84 = 0" : " of x and y, \xcf\x84 = 1 s";
    const Frame position{left, 470, 330, 110, 0, 12, 0, 0.8},
        velocity{left, 660, 330, 110, 0, 12, -0.12, 0.12},
        acceleration{left, 850, 330, 110, 0, 12, -0.4, 0.4};
    position.draw(d, 2, 0.2, 1, "t [s]", "position [m]" + of);
    velocity.draw(d, 2, 0.06, 2, "t [s]", "velocity [m/s]" + of);
    acceleration.draw(d, 2, 0.2, 1, "t [s]", "acceleration [m/s\xc2\xb2]" + of);
    curves(d, position, t, 0, 0);
    curves(d, velocity, t, 1, 0.1);
    curves(d, acceleration, t, 2, 0.3);
    d.line({{left + 230, 452}, {left + 250, 452}}, "x");
    d.text(left + 255, 456, "x");
    d.line({{left + 280, 452}, {left + 300, 452}}, "y");
    d.text(left + 305, 456, "y");
  }
  return d.finish();
}

TEST(Corner127, drawing_in_the_documentation_is_what_the_code_draws) {
  const std::string path = std::string(HANDSEL_SOURCE_DIR) + "/docs/figures/corner_127.svg",
                    drawn = draw();
  if (std::getenv("HANDSEL_WRITE_FIGURES")) std::ofstream(path) << drawn;
  std::ifstream file(path);
  ASSERT_TRUE(file) << path << " is missing";
  std::istringstream now(drawn);
  std::string a, b;
  int line = 0;
  while (std::getline(file, a)) {
    ++line;
    ASSERT_TRUE(std::getline(now, b)) << "line " << line;
    std::istringstream words_a(a), words_b(b);
    std::string x, y;
    while (words_a >> x) {
      ASSERT_TRUE(words_b >> y) << "line " << line;
      double xa, ya, xb, yb;
      if (std::sscanf(x.c_str(), "%lf,%lf", &xa, &ya) == 2 &&
          std::sscanf(y.c_str(), "%lf,%lf", &xb, &yb) == 2) {
        ASSERT_NEAR(xa, xb, 0.021) << "line " << line;
        ASSERT_NEAR(ya, yb, 0.021) << "line " << line;
      } else {
        ASSERT_EQ(x, y) << "line " << line;
      }
    }
  }
  EXPECT_FALSE(std::getline(now, b)) << "the file is shorter than the drawing";
}

TEST(Corner127, longer_transitions_save_more_and_keep_their_limits) {
  const double stop = run(0.0).duration_ptp;
  EXPECT_NEAR(run(0.0).trajectory.duration(), stop, 1e-9);
  for (const double tau : {0.25, 0.5, 0.75, 1.0}) {
    const SmoothResult r = run(tau);
    EXPECT_LE(r.trajectory.duration(), stop + 1e-9);
    EXPECT_EQ(why_not_within(r.trajectory, kLimits, 0.1 + 1e-9), "");
  }
  EXPECT_LT(run(1.0).trajectory.duration(), run(0.75).trajectory.duration());
  EXPECT_LT(run(0.75).trajectory.duration(), run(0.5).trajectory.duration() - 0.5);
}

}  // namespace
}  // namespace handsel::figure_test
