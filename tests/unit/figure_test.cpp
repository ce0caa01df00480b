// Draws docs/figures/corner_127.svg: three points, two straight legs at 127 degrees, V 0.1 m/s, A 0.3 m/s^2, J 0.9 m/s^3 (chapter figure
// 18). The file in the documentation must be what this draws; HANDSEL_WRITE_FIGURES=1 writes it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/trajectory/limits_check.hpp"
#include "common/trajectory/smooth.hpp"

namespace handsel {
namespace {

using Eigen::VectorXd;

const KinematicLimits kLimits{VectorXd::Constant(2, 0.1), VectorXd::Constant(2, 0.3), VectorXd::Constant(2, 0.9)};

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

class Drawing {
 public:
  Drawing(int width, int height) {
    out_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << height << "\" viewBox=\"0 0 " << width << ' '
         << height << "\" font-family=\"sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  }
  void text(double x, double y, const std::string& s, const char* colour = "#333") {
    out_ << "<text x=\"" << number(x) << "\" y=\"" << number(y) << "\" fill=\"" << colour << "\">" << s << "</text>\n";
  }
  void line(const std::vector<std::pair<double, double>>& points, const char* colour, double width = 1.2) {
    out_ << "<polyline fill=\"none\" stroke=\"" << colour << "\" stroke-width=\"" << width << "\" points=\"";
    for (const auto& [x, y] : points) out_ << number(x) << ',' << number(y) << ' ';
    out_ << "\"/>\n";
  }
  std::string finish() { return out_.str() + "</svg>\n"; }
  static std::string number(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", x + 0.0);
    return std::string(text) == "-0.00" ? "0.00" : text;
  }

 private:
  std::ostringstream out_;
};

/// A frame with one curve of x and one of y over time.
void curves(Drawing& d, double left, double top, const Trajectory& t, int derivative, double bound, const std::string& title) {
  const double width = 330, height = 100, longest = 14;
  const auto at = [&](double time, double value) {
    return std::pair{left + width * time / longest, top + height / 2 - value / bound * height / 2};
  };
  const double low = derivative == 0 ? 0 : -bound;
  d.line({at(0, low), at(longest, low)}, "#bbb", 0.8);
  d.line({at(0, low), at(0, bound)}, "#bbb", 0.8);
  if (derivative > 0) {
    d.line({at(0, 0), at(longest, 0)}, "#ddd", 0.6);
    d.line({at(0, bound / 1.1), at(longest, bound / 1.1)}, "#e0a0a0", 0.6);
    d.line({at(0, -bound / 1.1), at(longest, -bound / 1.1)}, "#e0a0a0", 0.6);
  }
  d.text(left, top - 4, title);
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<std::pair<double, double>> points;
    for (int k = 0; k <= 280; ++k) {
      const double time = t.duration() * k / 280;
      const MotionState3 s = t.at(time);
      points.push_back(at(time, (derivative == 0 ? s.position : derivative == 1 ? s.velocity : s.acceleration)[axis]));
    }
    d.line(points, axis == 0 ? "#1f5fa8" : "#2e8b57");
  }
}

std::string draw() {
  Drawing d(760, 720);
  const auto nodes = three_points();
  const auto at = [](const VectorXd& p) { return std::pair{60 + 700 * p[0], 330 - 700 * p[1]}; };
  d.line({at(nodes[0]), at(nodes[1]), at(nodes[2])}, "#999", 0.8);
  d.text(40, 24, "Transition at the middle of three points, legs of 0.5 m at 127\xc2\xb0; V 0.1 m/s, A 0.3 m/s\xc2\xb2, J 0.9 m/s\xc2\xb3");
  static constexpr std::array<const char*, 5> kColours{"#999999", "#c06000", "#a03070", "#2e8b57", "#1f5fa8"};
  static constexpr std::array<double, 5> kTaus{0, 0.25, 0.5, 0.75, 1.0};
  for (std::size_t k = 0; k < kTaus.size(); ++k) {
    const SmoothResult r = run(kTaus[k]);
    std::vector<std::pair<double, double>> points;
    for (int i = 0; i <= 700; ++i) {
      const VectorXd p = r.trajectory.at(r.trajectory.duration() * i / 700).position;
      if ((p - nodes[1]).norm() < 0.12) points.push_back(at(p));
    }
    d.line(points, kColours[k]);
    char label[120];
    std::snprintf(label, sizeof label, "\xcf\x84 = %.2f s: %.2f s, %s", kTaus[k], r.trajectory.duration(), name(r.corners[0].method));
    d.text(60, 60 + 16.0 * static_cast<double>(k), label, kColours[k]);
  }
  for (const double tau : {0.0, 1.0}) {
    const double left = tau == 0 ? 40 : 400;
    const Trajectory t = run(tau).trajectory;
    const std::string label = tau == 0 ? ", \xcf\x84 = 0" : ", \xcf\x84 = 1 s";
    curves(d, left, 380, t, 0, 0.85, "position x, y [m]" + label);
    curves(d, left, 480, t, 1, 0.11, "velocity [m/s]" + label);
    curves(d, left, 600, t, 2, 0.33, "acceleration [m/s\xc2\xb2]" + label);
  }
  return d.finish();
}

TEST(Corner127, DrawingInTheDocumentationIsWhatTheCodeDraws) {
  const std::string path = std::string(HANDSEL_SOURCE_DIR) + "/docs/figures/corner_127.svg", drawn = draw();
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
      if (std::sscanf(x.c_str(), "%lf,%lf", &xa, &ya) == 2 && std::sscanf(y.c_str(), "%lf,%lf", &xb, &yb) == 2) {
        ASSERT_NEAR(xa, xb, 0.021) << "line " << line;
        ASSERT_NEAR(ya, yb, 0.021) << "line " << line;
      } else {
        ASSERT_EQ(x, y) << "line " << line;
      }
    }
  }
  EXPECT_FALSE(std::getline(now, b)) << "the file is shorter than the drawing";
}

TEST(Corner127, LongerTransitionsSaveMoreAndKeepTheirLimits) {
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
}  // namespace handsel
