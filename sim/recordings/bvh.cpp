// SPDX-License-Identifier: Apache-2.0
#include "sim/recordings/bvh.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/errors.hpp"

namespace handsel::sim {

namespace {

constexpr std::size_t kMaxJoints = 512;         // max number of joints
constexpr std::size_t kMaxDepth = 128;          // max depth of the hierarchy
constexpr std::size_t kMaxValues = 40'000'000;  // max number of motion values
constexpr double kMaxMagnitude = 1e6;           // max magnitude of a number, file units
constexpr std::string_view kChannelNames[] = {"Xposition", "Yposition", "Zposition",
                                              "Xrotation", "Yrotation", "Zrotation"};

class Parser {
 public:
  Parser(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  Bvh parse() {
    expect("HIERARCHY");
    expect("ROOT");
    read_joint(-1, 0);
    if (peek() == "ROOT") fail("a second ROOT: one skeleton a file is read");
    if (bvh_.channels == 0) fail("the hierarchy has no channels");
    expect("MOTION");
    expect("Frames:");
    const double frames = number("the number of frames");
    if (!(frames >= 1) || frames != std::floor(frames))
      fail("Frames: must be a whole number of at least 1");
    if (frames * bvh_.channels > static_cast<double>(kMaxValues))
      fail("more than " + std::to_string(kMaxValues) + " values");
    expect("Frame");
    expect("Time:");
    bvh_.frame_time = number("the frame time");
    if (!(bvh_.frame_time > 1e-4 && bvh_.frame_time <= 1))
      fail("Frame Time: must be above 0.0001 and at most 1 second");
    read_frames(static_cast<std::size_t>(frames));
    return std::move(bvh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw ConfigError(name_ + ":" + std::to_string(line_) + ": " + what);
  }

  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  std::string_view peek() {
    while (at_ < text_.size() && blank(text_[at_])) {
      if (text_[at_] == '\n') ++next_line_;
      ++at_;
    }
    std::size_t end = at_;
    while (end < text_.size() && !blank(text_[end])) ++end;
    return text_.substr(at_, end - at_);
  }

  std::string_view token(const char* wanted) {
    const std::string_view found = peek();
    line_ = next_line_;
    if (found.empty()) fail(std::string("the file ends where ") + wanted + " should be");
    at_ += found.size();
    return found;
  }

  static std::string shown(std::string_view text) {
    std::string out = "\"";
    for (const char c : text.substr(0, 24)) out += c >= 32 && c < 127 ? c : '?';
    return out + "\"";
  }

  void expect(const char* word) {
    const std::string_view found = token(word);
    if (found != word) fail(std::string("expected ") + word + ", found " + shown(found));
  }

  double number(const char* what) {
    std::string_view found = token(what);
    const std::string_view whole = found;
    if (found.size() > 1 && found[0] == '+') found.remove_prefix(1);
    double value{};
    const auto [end, error] = std::from_chars(found.data(), found.data() + found.size(), value);
    if (error != std::errc() || end != found.data() + found.size() || !std::isfinite(value) ||
        std::abs(value) > kMaxMagnitude)
      fail(std::string(what) + " is " + shown(whole) + ", must be a number within 1e6");
    return value;
  }

  std::string joint_name() {
    std::string_view found = token("a joint's name");
    if (const auto colon = found.rfind(':');
        colon != std::string_view::npos && colon + 1 < found.size())
      found.remove_prefix(colon + 1);
    if (found == "{") fail("a joint has no name");
    return std::string(found.substr(0, 64));
  }

  int add_joint(std::string name, int parent) {
    if (bvh_.joints.size() >= kMaxJoints)
      fail("more than " + std::to_string(kMaxJoints) + " joints");
    if (bvh_.find(name) >= 0) fail("joint " + shown(name) + " is there twice");
    bvh_.joints.push_back({std::move(name), parent, Vector3::Zero(), {}, bvh_.channels});
    return static_cast<int>(bvh_.joints.size()) - 1;
  }

  void read_offset(int joint) {
    expect("OFFSET");
    for (int i = 0; i < 3; ++i)
      bvh_.joints[static_cast<std::size_t>(joint)].offset[i] = number("an offset");
  }

  void read_channels(int joint) {
    expect("CHANNELS");
    const double count = number("the number of channels");
    if (count != std::floor(count) || count < 0 || count > 6)
      fail("a joint has between 0 and 6 channels");
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const std::string_view found = token("a channel");
      const auto* const known =
          std::find(std::begin(kChannelNames), std::end(kChannelNames), found);
      if (known == std::end(kChannelNames))
        fail("channel " + shown(found) +
             " is unknown; there are Xposition ... Zposition, Xrotation ... Zrotation");
      const auto channel = static_cast<BvhChannel>(known - std::begin(kChannelNames));
      auto& channels = bvh_.joints[static_cast<std::size_t>(joint)].channels;
      if (std::find(channels.begin(), channels.end(), channel) != channels.end())
        fail("channel " + shown(found) + " is there twice");
      channels.push_back(channel);
      ++bvh_.channels;
    }
  }

  void read_joint(int parent, std::size_t depth) {
    if (depth > kMaxDepth) fail("the hierarchy is deeper than " + std::to_string(kMaxDepth));
    const int joint = add_joint(joint_name(), parent);
    expect("{");
    read_offset(joint);
    read_channels(joint);
    while (true) {
      const std::string_view found = token("JOINT, End Site or }");
      if (found == "}") return;
      if (found == "JOINT") {
        read_joint(joint, depth + 1);
      } else if (found == "End") {
        expect("Site");
        expect("{");
        std::string name = bvh_.joints[static_cast<std::size_t>(joint)].name + "_End";
        while (bvh_.find(name) >= 0) name += "_";
        read_offset(add_joint(std::move(name), joint));
        expect("}");
      } else {
        fail("expected JOINT, End Site or }, found " + shown(found));
      }
    }
  }

  void read_frames(std::size_t frames) {
    const std::size_t wanted = frames * static_cast<std::size_t>(bvh_.channels);
    bvh_.values.reserve(std::min(wanted, text_.size()));
    for (std::size_t i = 0; i < wanted; ++i) {
      if (peek().empty()) {
        line_ = next_line_;
        fail("the motion ends in frame " +
             std::to_string(i / static_cast<std::size_t>(bvh_.channels) + 1) + " of " +
             std::to_string(frames) + " announced by Frames:");
      }
      bvh_.values.push_back(number("a value"));
    }
    if (!peek().empty()) {
      line_ = next_line_;
      fail("there is more motion than the " + std::to_string(frames) + " frames of " +
           std::to_string(bvh_.channels) + " values announced");
    }
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_{0}, line_{1}, next_line_{1};
  Bvh bvh_;
};

}  // namespace

int Bvh::find(std::string_view joint) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (joints[i].name == joint) return static_cast<int>(i);
  return -1;
}

void Bvh::positions(std::size_t frame, std::vector<Vector3>& out) const {
  out.resize(joints.size());
  std::vector<Eigen::Matrix3d> R_world_joint(joints.size());
  const double* row = values.data() + frame * static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const BvhJoint& joint = joints[i];
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Vector3 at = joint.offset;
    bool moved = false;
    for (std::size_t c = 0; c < joint.channels.size(); ++c) {
      const double value = row[static_cast<std::size_t>(joint.first_channel) + c];
      const int axis = static_cast<int>(joint.channels[c]) % 3;
      if (joint.channels[c] < BvhChannel::x_rotation) {
        if (!moved) at.setZero();  // position channels replace the offset
        moved = true;
        at[axis] = value;
      } else {
        R = R * Eigen::AngleAxisd(value * M_PI / 180, Vector3::Unit(axis)).toRotationMatrix();
      }
    }
    if (joint.parent < 0) {
      out[i] = at;
      R_world_joint[i] = R;
    } else {
      const auto p = static_cast<std::size_t>(joint.parent);
      out[i] = out[p] + R_world_joint[p] * at;
      R_world_joint[i] = R_world_joint[p] * R;
    }
  }
}

Bvh parse_bvh(std::string_view text, const std::string& name) { return Parser(text, name).parse(); }

}  // namespace handsel::sim
