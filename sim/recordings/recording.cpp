// SPDX-License-Identifier: Apache-2.0
#include "sim/recordings/recording.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/errors.hpp"
#include "common/config/text_file.hpp"
#include "common/model/human/two_bones.hpp"
#include "sim/recordings/recording_parts.hpp"

namespace handsel::sim {

using namespace recording_detail;

namespace recording_detail {

constexpr double kMaxTravel = 0.5;  // max travel of a body that is not made to walk on the spot [m]
constexpr double kHeadUp = 0.93;    // height of the head joint, divided by the stature

[[noreturn]] void fail_at(const std::string& name, std::size_t line, const std::string& what) {
  throw ConfigError(name + ":" + std::to_string(line) + ": " + what);
}

void for_each_line(std::string_view text,
                   const std::function<void(std::string_view, std::size_t)>& act) {
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    act(line, ++number);
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
}

std::vector<std::string_view> cells(std::string_view line) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
    while (!cell.empty() && cell.back() == ' ') cell.remove_suffix(1);
    out.push_back(cell);
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

double number_in(std::string_view cell) {
  double value{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value)
             ? value
             : std::nan("");
}

double trunk_stature(const BodyPoints& p) { return (p[kHead] - p[kWaist]).norm() / kTrunk; }

void check_body(const BodyPoints& p, const std::string& name, std::size_t line) {
  const auto [factor, unit] = unit_of(trunk_stature(p));
  if (factor != 1) {
    const std::string size =
        "from waist to head the body measures " + std::to_string((p[kHead] - p[kWaist]).norm());
    fail_at(
        name, line,
        size + (factor > 0 ? ", which looks like " + std::string(unit) : ", which is no person's") +
            "; positions must be in metres");
  }
  if (p[kHead].z() - p[kWaist].z() < 0.5 * (p[kHead] - p[kWaist]).norm())
    fail_at(name, line,
            "the head is not above the waist; z must be up, and the first frame must show a body "
            "that stands or sits");
  if (((p[kShoulder[0]] - p[kShoulder[1]]).cwiseProduct(Vector3(1, 1, 0))).norm() < 0.05)
    fail_at(
        name, line,
        "the shoulders are less than 5 cm apart: the direction in which the body faces is unknown");
}

Recording finish(std::vector<BodyPoints> frames, double rate, bool lower_body_recorded) {
  const Vector3 left = frames[0][kShoulder[0]] - frames[0][kShoulder[1]];
  const double yaw = std::atan2(-left.x(), left.y());  // forward = left x up
  const Vector3 origin(frames[0][kWaist].x(), frames[0][kWaist].y(), 0);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(-yaw, Vector3::UnitZ()).toRotationMatrix();
  Recording recording;
  recording.rate = rate;
  double travel = 0, lowest = 1e9;
  std::vector<double> heights;
  for (BodyPoints& frame : frames) {
    for (Vector3& p : frame) p = R * (p - origin);
    travel = std::max(travel, frame[kWaist].head<2>().norm());
    lowest = std::min({lowest, frame[kAnkle[0]].z(), frame[kAnkle[1]].z()});
    heights.push_back(frame[kHead].z());
  }
  const auto upright = heights.begin() + static_cast<std::ptrdiff_t>(heights.size() * 9 / 10);
  std::nth_element(heights.begin(), upright, heights.end());
  recording.stature = std::clamp(
      lower_body_recorded ? (*upright - lowest) / (kHeadUp - kAnkleUp) : *upright / kHeadUp, 1.0,
      2.4);
  const double raise = lower_body_recorded ? kAnkleUp * recording.stature - lowest : 0.0;
  std::array<double, 2> max_reach{-1e9, -1e9}, when{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vector3 travelled = travel > kMaxTravel
                                  ? Vector3(frames[i][kWaist].x(), frames[i][kWaist].y(), -raise)
                                  : Vector3(0, 0, -raise);
    for (Vector3& p : frames[i]) p -= travelled;
    for (std::size_t s = 0; s < 2; ++s) {
      const double reach = frames[i][kHand[s]].x() - frames[i][kWaist].x();
      if (reach > max_reach[s]) max_reach[s] = reach, when[s] = static_cast<double>(i) / rate;
    }
  }
  recording.frames = std::move(frames);
  recording.taking = max_reach[0] > max_reach[1] ? Side::left : Side::right;
  recording.contact = when[recording.taking == Side::left ? 0 : 1];
  return recording;
}

BodyPoints points_of(const std::vector<BodyJoint>& joints) {
  BodyPoints p;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = joints[i].position;
  return p;
}

}  // namespace recording_detail

namespace {

constexpr std::uintmax_t kMaxBytes = 256u << 20;  // max size of a file [byte]
constexpr double kKthPalm = 0.09;  // wrist to the centre of the hand in the KTH set [m]

std::string text_of(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw ConfigError(file.string() + " is a folder, must be a file");
  if (!is_there(file)) throw MissingError("recording " + file.string() + " cannot be opened");
  return read_text_file(file, kMaxBytes);
}

std::vector<Pose> read_poses(const std::filesystem::path& file) {
  const std::string text = text_of(file), name = file.string();
  std::vector<Pose> poses;
  std::size_t last = 0;
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    last = number;
    if (number == 1) {
      if (line != "x,y,z,q0,q1,q2,q3")
        fail_at(name, number, "the first line must be x,y,z,q0,q1,q2,q3");
      return;
    }
    if (number > kMaxRows) fail_at(name, number, "more than " + std::to_string(kMaxRows) + " rows");
    const auto row = cells(line);
    std::array<double, 7> v{};
    for (std::size_t i = 0; i < std::min(v.size(), row.size()); ++i) {
      v[i] = number_in(row[i]);
      if (!std::isfinite(v[i]))
        fail_at(name, number, "column " + std::to_string(i + 1) + " is not a finite number");
    }
    if (row.size() != v.size()) fail_at(name, number, "expected 7 numbers separated by commas");
    const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
    if (!(std::abs(q.norm() - 1) <= 0.01))
      fail_at(name, number,
              "the quaternion's length is " + std::to_string(q.norm()) + ", must be 1");
    poses.push_back(make_pose({v[0], v[1], v[2]}, q));
  });
  if (poses.size() < 2) fail_at(name, std::max<std::size_t>(1, last), "needs at least two rows");
  return poses;
}

Recording load_kth(const std::filesystem::path& folder) {
  const auto file = [&](const char* part) {
    return folder / ("taker_" + std::string(part) + "_pose_saved.csv");
  };
  const auto read = [&](const char* part) { return read_poses(file(part)); };
  const auto hip = read("hip"), chest = read("chest"), neck = read("neck"), head = read("head");
  const std::array<std::vector<Pose>, 2> upper{read("LUArm"), read("RUArm")},
      lower{read("LFArm"), read("RFArm")}, hand{read("LHand"), read("RHand")};
  const std::size_t n = hip.size();
  for (const auto* part :
       {&chest, &neck, &head, &upper[0], &upper[1], &lower[0], &lower[1], &hand[0], &hand[1]}) {
    if (part->size() != n) {
      throw ConfigError(folder.string() + ": its files have " + std::to_string(n) + " and " +
                        std::to_string(part->size()) + " rows, they must agree");
    }
  }
  std::vector<BodyPoints> frames(n);
  for (std::size_t i = 0; i < n; ++i) {
    BodyPoints& p = frames[i];
    p[kHead] = head[i].translation();
    p[kNeck] = neck[i].translation();
    p[kTorso] = chest[i].translation();
    p[kWaist] = hip[i].translation();
    const Vector3 across = (upper[0][i].translation() - upper[1][i].translation())
                               .cwiseProduct(Vector3(1, 1, 0))
                               .normalized();
    for (std::size_t s = 0; s < 2; ++s) {
      const double sign = s == 0 ? 1 : -1;
      p[kShoulder[s]] = upper[s][i].translation();
      p[kElbow[s]] = lower[s][i].translation();
      p[kWrist[s]] = hand[s][i].translation();
      p[kHand[s]] = hand[s][i].translation() + sign * kKthPalm * hand[s][i].linear().col(0);
      p[kHip[s]] = hip[i].translation() + sign * 0.1 * across;
      p[kKnee[s]] = p[kHip[s]].cwiseProduct(Vector3(1, 1, 0.53));
      p[kAnkle[s]] = p[kHip[s]].cwiseProduct(Vector3(1, 1, 0.09));
    }
  }
  check_body(frames[0], file("hip").string(), 2);
  return finish(std::move(frames), 120, false);
}

}  // namespace

void Recording::sample(double t, BodyPoints& out) const {
  const double at = std::clamp(t * rate, 0.0, static_cast<double>(frames.size() - 1));
  const std::size_t i = std::min(static_cast<std::size_t>(at), frames.size() - 2);
  const double part = at - static_cast<double>(i);
  for (std::size_t k = 0; k < out.size(); ++k)
    out[k] = (1 - part) * frames[i][k] + part * frames[i + 1][k];
}

std::pair<double, const char*> unit_of(double stature) {
  constexpr std::pair<double, const char*> kUnits[] = {
      {1, "metres"}, {0.01, "centimetres"}, {0.001, "millimetres"}, {0.0254, "inches"}};
  for (const auto& unit : kUnits)
    if (stature * unit.first >= 1.1 && stature * unit.first <= 2.3) return unit;
  return {0, ""};
}

Recording load_recording(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path)) return load_kth(path);
  const std::string file = path.filename().string();
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (file.ends_with("_pose_saved.csv"))
    return load_kth(path.has_parent_path() ? path.parent_path() : ".");
  if (!std::filesystem::exists(path))
    throw MissingError("recording " + path.string() + " is not there");
  if (ending == ".bvh") return parse_bvh_recording(text_of(path), path.string());
  if (ending == ".csv") return parse_body_csv(text_of(path), path.string());
  throw ConfigError("recording " + path.string() +
                    " must be a folder of the KTH handover set, a .csv or a .bvh file");
}

std::filesystem::path resolve_recording(const std::filesystem::path& recording,
                                        const std::filesystem::path& data_root) {
  if (!recording.is_relative()) return recording;
  if (data_root.empty())
    throw MissingError(
        "recording " + recording.string() +
        " is relative, HANDSEL_DATA is not set and there is no ../shared/data beside the project");
  return data_root / recording;
}

Recording retarget(const Recording& recording, double stature) {
  const BodyPoints model = points_of(standing_body(Vector3::Zero(), 0, stature));
  const double k = stature / recording.stature;
  double lowest = 1e9;
  for (const BodyPoints& p : recording.frames)
    lowest = std::min({lowest, p[kAnkle[0]].z(), p[kAnkle[1]].z()});
  Recording out = recording;
  out.stature = stature;
  for (std::size_t f = 0; f < out.frames.size(); ++f) {
    const BodyPoints& from = recording.frames[f];
    BodyPoints& to = out.frames[f];
    const auto copy_bone = [&](int parent, int child) {
      const Vector3 along = (from[child] - from[parent]).norm() > 1e-6
                                ? Vector3(from[child] - from[parent])
                                : Vector3(from[kHead] - from[kWaist]);
      to[child] = to[parent] + (model[child] - model[parent]).norm() * along.stableNormalized();
    };
    to[kWaist] = Vector3(k * from[kWaist].x(), k * from[kWaist].y(), 0);
    copy_bone(kWaist, kTorso);
    copy_bone(kTorso, kNeck);
    copy_bone(kNeck, kHead);
    for (std::size_t s = 0; s < 2; ++s) {
      copy_bone(kNeck, kShoulder[s]);
      const auto bone = [&](const BodyPoints& p, int a, int b) { return (p[b] - p[a]).norm(); };
      const double upper = bone(model, kShoulder[s], kElbow[s]),
                   lower = bone(model, kElbow[s], kWrist[s]);
      const double palm = bone(model, kWrist[s], kHand[s]);
      const double arm_length = bone(from, kShoulder[s], kElbow[s]) +
                                bone(from, kElbow[s], kWrist[s]) + bone(from, kWrist[s], kHand[s]);
      const double reach_fraction = bone(from, kShoulder[s], kHand[s]) / std::max(arm_length, 1e-6);
      const Vector3 root = to[kShoulder[s]];
      to[kHand[s]] = root + reach_fraction * (upper + lower + palm) *
                                (from[kHand[s]] - from[kShoulder[s]]).stableNormalized();
      to[kWrist[s]] = to[kHand[s]] + palm * (from[kWrist[s]] - from[kHand[s]]).stableNormalized();
      const Vector3 arm = to[kWrist[s]] - root;
      const double reach =
          std::clamp(arm.norm(), std::abs(upper - lower) + 1e-6, upper + lower - 1e-9);
      const Vector3 back = (reach - arm.norm()) * arm.stableNormalized();
      to[kWrist[s]] += back;
      to[kHand[s]] += back;
      to[kElbow[s]] = bend(root, to[kWrist[s]], upper, lower,
                           root + k * (from[kElbow[s]] - from[kShoulder[s]]));
      copy_bone(kWaist, kHip[s]);
      copy_bone(kHip[s], kKnee[s]);
      copy_bone(kKnee[s], kAnkle[s]);
    }
    const double lift = std::min(from[kAnkle[0]].z(), from[kAnkle[1]].z()) - lowest;
    const double raise =
        kAnkleUp * stature + k * lift - std::min(to[kAnkle[0]].z(), to[kAnkle[1]].z());
    for (Vector3& p : to) p.z() += raise;
  }
  return out;
}

}  // namespace handsel::sim
