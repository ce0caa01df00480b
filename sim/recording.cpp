#include "sim/recording.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>

#include "common/base/errors.hpp"

namespace handsel::sim {

namespace {

constexpr std::size_t kMaxRows = 200000;
constexpr double kPalm = 0.09;  // wrist to the middle of the hand [m]

std::vector<Pose> read_poses(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw MissingError("recording " + file.string() + " cannot be opened");
  std::vector<Pose> poses;
  std::string line;
  std::size_t number = 0;
  const auto fail = [&](const std::string& what) { throw ConfigError(file.string() + ":" + std::to_string(number) + ": " + what); };
  while (std::getline(in, line)) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (number == 1) {
      if (line != "x,y,z,q0,q1,q2,q3") fail("the first line must be x,y,z,q0,q1,q2,q3");
      continue;
    }
    if (number > kMaxRows) fail("more than " + std::to_string(kMaxRows) + " rows");
    std::array<double, 7> v{};
    const char* at = line.data();
    const char* end = at + line.size();
    for (std::size_t i = 0; i < v.size(); ++i) {
      const auto [next, error] = std::from_chars(at, end, v[i]);
      if (error != std::errc() || !std::isfinite(v[i])) fail("column " + std::to_string(i + 1) + " is not a finite number");
      const bool last = i + 1 == v.size();
      if (last ? next != end : next == end || *next != ',') fail("expected 7 numbers separated by commas");
      at = next + (last ? 0 : 1);
    }
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (std::abs(q.norm() - 1) > 0.01) fail("the quaternion's length is " + std::to_string(q.norm()) + ", must be 1");
    poses.push_back(make_pose({v[0], v[1], v[2]}, q));
  }
  if (poses.size() < 2) fail("needs at least two rows");
  return poses;
}

int joint(const char* name) { return body_joint_index(name); }

}  // namespace

void Recording::sample(double t, BodyPoints& out) const {
  const double at = std::clamp(t * rate, 0.0, static_cast<double>(frames.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(at), frames.size() - 2);
  const double part = at - static_cast<double>(i);
  for (std::size_t k = 0; k < out.size(); ++k) out[k] = (1 - part) * frames[i][k] + part * frames[i + 1][k];
}

Recording load_recording(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder)) throw MissingError("recording folder " + folder.string() + " is not there");
  const auto read = [&](const char* part) { return read_poses(folder / ("taker_" + std::string(part) + "_pose_saved.csv")); };
  const auto hip = read("hip"), chest = read("chest"), neck = read("neck"), head = read("head");
  const std::array<std::vector<Pose>, 2> upper{read("LUArm"), read("RUArm")}, lower{read("LFArm"), read("RFArm")},
      hand{read("LHand"), read("RHand")};
  const std::size_t n = hip.size();
  for (const auto* part : {&chest, &neck, &head, &upper[0], &upper[1], &lower[0], &lower[1], &hand[0], &hand[1]}) {
    if (part->size() != n) {
      throw ConfigError(folder.string() + ": its files have " + std::to_string(n) + " and " + std::to_string(part->size()) +
                        " rows, they must agree");
    }
  }
  const Vector3 left = upper[0][0].translation() - upper[1][0].translation();
  const double yaw = std::atan2(-left.x(), left.y());  // facing = left x up
  const Vector3 origin(hip[0].translation().x(), hip[0].translation().y(), 0);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-yaw, Vector3::UnitZ()).toRotationMatrix();

  Recording recording;
  recording.frames.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto own = [&](const Pose& T) { return Vector3(R * (T.translation() - origin)); };
    BodyPoints& p = recording.frames[i];
    p[joint("head")] = own(head[i]);
    p[joint("neck")] = own(neck[i]);
    p[joint("torso")] = own(chest[i]);
    p[joint("waist")] = own(hip[i]);
    const Vector3 across = (own(upper[0][i]) - own(upper[1][i])).cwiseProduct(Vector3(1, 1, 0)).normalized();
    for (int s = 0; s < 2; ++s) {
      const std::string side = s == 0 ? "l_" : "r_";
      const double sign = s == 0 ? 1 : -1;
      p[joint((side + "shoulder").c_str())] = own(upper[s][i]);
      p[joint((side + "elbow").c_str())] = own(lower[s][i]);
      p[joint((side + "wrist").c_str())] = own(hand[s][i]);
      p[joint((side + "hand").c_str())] = own(hand[s][i]) + R * (sign * kPalm * hand[s][i].linear().col(0));
      const Vector3 hip_joint = own(hip[i]) + sign * 0.1 * across;
      p[joint((side + "hip").c_str())] = hip_joint;
      p[joint((side + "knee").c_str())] = hip_joint.cwiseProduct(Vector3(1, 1, 0.53));
      p[joint((side + "ankle").c_str())] = hip_joint.cwiseProduct(Vector3(1, 1, 0.09));
    }
  }
  std::array<double, 2> farthest{-1e9, -1e9}, when{};
  for (std::size_t i = 0; i < n; ++i) {
    for (int s = 0; s < 2; ++s) {
      const int h = joint(s == 0 ? "l_hand" : "r_hand");
      const double reach = recording.frames[i][h].x() - recording.frames[i][joint("waist")].x();
      if (reach > farthest[s]) farthest[s] = reach, when[s] = static_cast<double>(i) / recording.rate;
    }
  }
  recording.taking = farthest[0] > farthest[1] ? Side::left : Side::right;
  recording.contact = when[recording.taking == Side::left ? 0 : 1];
  return recording;
}

}  // namespace handsel::sim
