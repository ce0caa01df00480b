#include "sim/people/recording.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "common/base/errors.hpp"
#include "common/config/text_file.hpp"
#include "common/model/human/two_bones.hpp"
#include "sim/people/bvh.hpp"

namespace handsel::sim {

namespace {

constexpr std::size_t kMaxRows = 200000;
constexpr std::uintmax_t kMaxBytes = 256u << 20;
constexpr double kPalm = 0.09;     // wrist to the middle of the hand in the KTH set [m]
constexpr double kTravel = 0.5;    // a body that goes farther than this walks on the spot [m]
constexpr double kStature = 1.75;  // of a skeleton without a unit [m]
constexpr double kTrunk = 0.37;    // waist to head as a share of the stature, as in standing_body
constexpr double kHeadUp = 0.93, kAnkleUp = 0.039;

int joint(const char* name) { return body_joint_index(name); }
const int kHead = joint("head"), kNeck = joint("neck"), kTorso = joint("torso"),
          kWaist = joint("waist");
const int kShoulder[2] = {joint("l_shoulder"), joint("r_shoulder")},
          kElbow[2] = {joint("l_elbow"), joint("r_elbow")},
          kWrist[2] = {joint("l_wrist"), joint("r_wrist")},
          kHand[2] = {joint("l_hand"), joint("r_hand")}, kHip[2] = {joint("l_hip"), joint("r_hip")},
          kKnee[2] = {joint("l_knee"), joint("r_knee")},
          kAnkle[2] = {joint("l_ankle"), joint("r_ankle")};

[[noreturn]] void fail_at(const std::string& name, std::size_t line, const std::string& what) {
  throw ConfigError(name + ":" + std::to_string(line) + ": " + what);
}

std::string text_of(const std::filesystem::path& file) {
  std::error_code error;
  if (std::filesystem::is_directory(file, error))
    throw ConfigError(file.string() + " is a folder, must be a file");
  if (!is_there(file)) throw MissingError("recording " + file.string() + " cannot be opened");
  return read_text_file(file, kMaxBytes);
}

/// Calls with every line, its number, without line ends.
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

/// NaN when the cell is no finite number.
double number_in(std::string_view cell) {
  double value{};
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() && std::isfinite(value)
             ? value
             : std::nan("");
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

double trunk_stature(const BodyPoints& p) { return (p[kHead] - p[kWaist]).norm() / kTrunk; }

/// Positions must be in metres and z up; said of the first frame, which stands at `line`.
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

/// Turns world points into the recording's own frame and finds the reach.
Recording finish(std::vector<BodyPoints> frames, double rate, bool legs_recorded) {
  const Vector3 left = frames[0][kShoulder[0]] - frames[0][kShoulder[1]];
  const double yaw = std::atan2(-left.x(), left.y());  // facing = left x up
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
      legs_recorded ? (*upright - lowest) / (kHeadUp - kAnkleUp) : *upright / kHeadUp, 1.0, 2.4);
  const double raise = legs_recorded ? kAnkleUp * recording.stature - lowest : 0.0;
  std::array<double, 2> farthest{-1e9, -1e9}, when{};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vector3 gone = travel > kTravel
                             ? Vector3(frames[i][kWaist].x(), frames[i][kWaist].y(), -raise)
                             : Vector3(0, 0, -raise);
    for (Vector3& p : frames[i]) p -= gone;
    for (std::size_t s = 0; s < 2; ++s) {
      const double reach = frames[i][kHand[s]].x() - frames[i][kWaist].x();
      if (reach > farthest[s]) farthest[s] = reach, when[s] = static_cast<double>(i) / rate;
    }
  }
  recording.frames = std::move(frames);
  recording.taking = farthest[0] > farthest[1] ? Side::left : Side::right;
  recording.contact = when[recording.taking == Side::left ? 0 : 1];
  return recording;
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
      p[kHand[s]] = hand[s][i].translation() + sign * kPalm * hand[s][i].linear().col(0);
      p[kHip[s]] = hip[i].translation() + sign * 0.1 * across;
      p[kKnee[s]] = p[kHip[s]].cwiseProduct(Vector3(1, 1, 0.53));
      p[kAnkle[s]] = p[kHip[s]].cwiseProduct(Vector3(1, 1, 0.09));
    }
  }
  check_body(frames[0], file("hip").string(), 2);
  return finish(std::move(frames), 120, false);
}

BodyPoints points_of(const std::vector<BodyJoint>& joints) {
  BodyPoints p;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = joints[i].position;
  return p;
}

/// Frames at uneven times to frames at their mean rate.
std::vector<BodyPoints> even(const std::vector<double>& times,
                             const std::vector<BodyPoints>& frames, double rate) {
  const auto n =
      static_cast<std::size_t>(std::floor((times.back() - times.front()) * rate + 1e-6)) + 1;
  std::vector<BodyPoints> out(n);
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = times.front() + static_cast<double>(i) / rate;
    while (at + 2 < times.size() && times[at + 1] <= t) ++at;
    const double part = std::clamp((t - times[at]) / (times[at + 1] - times[at]), 0.0, 1.0);
    for (std::size_t k = 0; k < out[i].size(); ++k)
      out[i][k] = (1 - part) * frames[at][k] + part * frames[at + 1][k];
  }
  return out;
}

std::string plain(std::string_view name) {
  std::string out;
  for (const char c : name)
    if (c != '_' && c != '-' && c != '.' && c != ' ')
      out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// Index of the first of `names` among the joints; each also with "l"/"r" for "left"/"right". -1:
/// none.
int find_any(const Bvh& bvh, std::initializer_list<std::string> names) {
  for (const std::string& wanted : names) {
    const std::string brief = wanted.starts_with("left")    ? "l" + wanted.substr(4)
                              : wanted.starts_with("right") ? "r" + wanted.substr(5)
                                                            : wanted;
    for (std::size_t i = 0; i < bvh.joints.size(); ++i)
      if (const std::string has = plain(bvh.joints[i].name); has == wanted || has == brief)
        return static_cast<int>(i);
  }
  return -1;
}

/// Which joint of a skeleton is which point of the body; -1: none.
struct BvhMap {
  std::array<int, kBodyJoints.size()> joint{};
  int head_top{-1};
  std::array<int, 2> fingers{-1, -1};
};

BvhMap map_joints(const Bvh& bvh, const std::string& name) {
  BvhMap map;
  map.joint.fill(-1);
  const auto need = [&](int body, std::initializer_list<std::string> names) {
    map.joint[static_cast<std::size_t>(body)] = find_any(bvh, names);
    if (map.joint[static_cast<std::size_t>(body)] >= 0) return;
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "" : ", ") + n;
    fail_at(name, 1,
            std::string("no joint for the body's ") + kBodyJoints[static_cast<std::size_t>(body)] +
                "; known names are " + all);
  };
  const auto child_of = [&](int parent) {
    for (std::size_t i = 0; i < bvh.joints.size(); ++i)
      if (bvh.joints[i].parent == parent && bvh.joints[i].offset.norm() > 1e-9)
        return static_cast<int>(i);
    return -1;
  };
  need(kHead, {"head"});
  need(kNeck, {"neck", "neck1"});
  need(kTorso, {"spine2", "spine1", "chest2", "chest", "thorax", "upperback", "spine"});
  int& torso = map.joint[static_cast<std::size_t>(kTorso)];  // not where the neck is
  for (int i = map.joint[static_cast<std::size_t>(kNeck)];
       i > 0 && torso == bvh.joints[static_cast<std::size_t>(i)].parent &&
       bvh.joints[static_cast<std::size_t>(i)].offset.norm() < 1e-9;)
    i = torso, torso = bvh.joints[static_cast<std::size_t>(i)].parent;
  need(kWaist, {"hips", "pelvis", "hip", "root"});
  for (std::size_t s = 0; s < 2; ++s) {
    const std::string side = s == 0 ? "left" : "right";
    need(kShoulder[s],
         {side + "arm", side + "upperarm", side + "uparm", side + "shldr", side + "shoulder"});
    need(kElbow[s], {side + "forearm", side + "elbow", side + "lowarm", side + "lowerarm"});
    need(kWrist[s], {side + "hand", side + "wrist"});
    need(kHip[s],
         {side + "upleg", side + "hip", side + "thigh", side + "upperleg", side + "upperleg"});
    need(kKnee[s], {side + "leg", side + "knee", side + "shin", side + "lowleg", side + "lowerleg",
                    side + "calf"});
    need(kAnkle[s], {side + "foot", side + "ankle"});
    map.fingers[s] = child_of(map.joint[static_cast<std::size_t>(kWrist[s])]);
  }
  map.head_top = child_of(map.joint[static_cast<std::size_t>(kHead)]);
  return map;
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

Recording parse_body_csv(std::string_view text, const std::string& name) {
  std::vector<int> columns;  // 3 x joint + axis; -1: time
  std::array<int, 3 * kBodyJoints.size()> count{};
  std::vector<double> times;
  std::vector<BodyPoints> frames;
  Person body;
  std::size_t last = 0;
  const auto has = [&](int j) { return count[static_cast<std::size_t>(3 * j)] > 0; };
  const auto read_header = [&](std::string_view line) {
    const auto names = cells(line);
    for (std::size_t c = 0; c < names.size(); ++c) {
      const std::string_view column = names[c];
      if (column == "time" || column == "t") {
        if (c != 0) fail_at(name, 1, "time must be the first column");
        columns.push_back(-1);
        continue;
      }
      const int j = column.size() > 2
                        ? body_joint_index(std::string(column.substr(0, column.size() - 2)))
                        : -1;
      const char axis = column.empty() ? ' ' : column.back();
      if (j < 0 || axis < 'x' || axis > 'z' ||
          (column[column.size() - 2] != '.' && column[column.size() - 2] != '_'))
        fail_at(name, 1,
                "column " + std::to_string(c + 1) +
                    " must be time or <joint>.x, .y or .z of a REP-155 joint such as r_wrist.x");
      columns.push_back(3 * j + axis - 'x');
      if (++count[static_cast<std::size_t>(columns.back())] > 1)
        fail_at(name, 1, "column " + std::string(column) + " is there twice");
    }
    if (columns.empty() || columns[0] != -1)
      fail_at(name, 1, "the first column must be time, in seconds");
    for (std::size_t j = 0; j < kBodyJoints.size(); ++j) {
      if (count[3 * j] != count[3 * j + 1] || count[3 * j] != count[3 * j + 2])
        fail_at(name, 1, std::string(kBodyJoints[j]) + " needs the columns .x, .y and .z");
    }
    for (const int j : {kHead, kWaist, kShoulder[0], kShoulder[1]})
      if (!has(j))
        fail_at(name, 1,
                std::string("the columns of ") + kBodyJoints[static_cast<std::size_t>(j)] +
                    " are missing");
    if (!(has(kElbow[0]) && has(kWrist[0])) && !(has(kElbow[1]) && has(kWrist[1])))
      fail_at(name, 1,
              "the columns of an arm are missing: l_elbow and l_wrist, or r_elbow and r_wrist");
  };
  for_each_line(text, [&](std::string_view line, std::size_t number) {
    last = number;
    if (number == 1) return read_header(line);
    if (line.empty()) return;
    if (number > kMaxRows) fail_at(name, number, "more than " + std::to_string(kMaxRows) + " rows");
    const auto row = cells(line);
    if (row.size() != columns.size())
      fail_at(name, number,
              "has " + std::to_string(row.size()) + " columns, the first line names " +
                  std::to_string(columns.size()));
    ObservedPerson seen;
    std::array<Vector3, kBodyJoints.size()> at{};
    for (std::size_t c = 0; c < row.size(); ++c) {
      const double v = number_in(row[c]);
      if (!std::isfinite(v) || std::abs(v) > 1e7)
        fail_at(name, number,
                "column " + std::to_string(c + 1) + " is not a finite number within 1e7");
      if (columns[c] >= 0) {
        at[static_cast<std::size_t>(columns[c] / 3)][columns[c] % 3] = v;
        continue;
      }
      if (!times.empty() && v <= times.back())
        fail_at(name, number,
                "time " + std::to_string(v) + " is not after " + std::to_string(times.back()));
      if (!times.empty() && v - times.back() > 1)
        fail_at(name, number,
                "time jumps by " + std::to_string(v - times.back()) +
                    " s; at most 1 s is bridged (is time in seconds?)");
      times.push_back(v);
    }
    for (std::size_t j = 0; j < kBodyJoints.size(); ++j)
      if (has(static_cast<int>(j))) seen.joints.push_back({kBodyJoints[j], at[j], 1.0});
    if (frames.empty()) {
      BodyPoints first{};
      for (std::size_t j = 0; j < first.size(); ++j) first[j] = at[j];
      check_body(first, name, number);
      body.stature = std::clamp(trunk_stature(first), 1.2, 2.2);
    }
    body.joints = fit_body(seen, frames.empty() ? nullptr : &body, body.stature);
    frames.push_back(points_of(body.joints));
  });
  if (frames.size() < 2)
    fail_at(name, std::max<std::size_t>(1, last), "needs at least two rows of positions");
  const double rate = static_cast<double>(frames.size() - 1) / (times.back() - times.front());
  if (!(rate <= 1000))
    fail_at(name, last,
            "has " + std::to_string(rate) +
                " rows a second, must be at most 1000 (is time in seconds?)");
  return finish(even(times, frames, rate), rate, has(kAnkle[0]) || has(kAnkle[1]));
}

Recording parse_bvh_recording(std::string_view text, const std::string& name) {
  const Bvh bvh = parse_bvh(text, name);
  if (bvh.frames() < 2)
    fail_at(name, 1, "one frame is a posture, not a motion: needs at least two frames");
  const BvhMap map = map_joints(bvh, name);
  std::vector<Vector3> points;
  bvh.positions(0, points);
  const auto at = [&](int body) {
    return points[static_cast<std::size_t>(map.joint[static_cast<std::size_t>(body)])];
  };
  const Vector3 up = at(kHead) - at(kWaist);
  const int axis = up.y() > std::abs(up.z()) ? 1 : 2;
  if (up[axis] < 0.5 * up.norm())
    fail_at(name, 1, "the body in the first frame does not stand along +y or +z");
  std::vector<BodyPoints> frames(bvh.frames());
  double scale = 0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    bvh.positions(f, points);
    if (axis == 1)
      for (Vector3& p : points) p = Vector3(p.x(), -p.z(), p.y());
    BodyPoints& body = frames[f];
    for (std::size_t i = 0; i < body.size(); ++i)
      if (map.joint[i] >= 0) body[i] = points[static_cast<std::size_t>(map.joint[i])];
    if (map.head_top >= 0)
      body[kHead] = (body[kHead] + points[static_cast<std::size_t>(map.head_top)]) / 2;
    if (f == 0) {
      const auto leg = [&](int s) {
        return (body[kHip[s]] - body[kKnee[s]]).norm() + (body[kKnee[s]] - body[kAnkle[s]]).norm();
      };
      const double stature = ((body[kHead] - body[kWaist]).norm() + (leg(0) + leg(1)) / 2) /
                             (kTrunk + 0.53 - kAnkleUp);
      if (!(stature > 1e-6)) fail_at(name, 1, "the skeleton has no size");
      const double unit = unit_of(stature).first;
      scale = unit > 0 ? unit : kStature / stature;
    }
    for (Vector3& p : body) p *= scale;
    const double palm = 0.054 * kStature;
    for (std::size_t s = 0; s < 2; ++s) {
      const Vector3 fingers =
          map.fingers[s] >= 0
              ? Vector3(scale * points[static_cast<std::size_t>(map.fingers[s])] - body[kWrist[s]])
              : Vector3(body[kWrist[s]] - body[kElbow[s]]);
      body[kHand[s]] = body[kWrist[s]] + palm * fingers.stableNormalized();
    }
  }
  check_body(frames[0], name, 1);
  return finish(std::move(frames), 1 / bvh.frame_time, true);
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
    const auto carry = [&](int parent, int child) {
      const Vector3 along = (from[child] - from[parent]).norm() > 1e-6
                                ? Vector3(from[child] - from[parent])
                                : Vector3(from[kHead] - from[kWaist]);
      to[child] = to[parent] + (model[child] - model[parent]).norm() * along.stableNormalized();
    };
    to[kWaist] = Vector3(k * from[kWaist].x(), k * from[kWaist].y(), 0);
    carry(kWaist, kTorso);
    carry(kTorso, kNeck);
    carry(kNeck, kHead);
    for (std::size_t s = 0; s < 2; ++s) {
      carry(kNeck, kShoulder[s]);
      const auto bone = [&](const BodyPoints& p, int a, int b) { return (p[b] - p[a]).norm(); };
      const double upper = bone(model, kShoulder[s], kElbow[s]),
                   lower = bone(model, kElbow[s], kWrist[s]);
      const double palm = bone(model, kWrist[s], kHand[s]);
      const double whole = bone(from, kShoulder[s], kElbow[s]) + bone(from, kElbow[s], kWrist[s]) +
                           bone(from, kWrist[s], kHand[s]);
      const double share = bone(from, kShoulder[s], kHand[s]) / std::max(whole, 1e-6);
      const Vector3 root = to[kShoulder[s]];
      to[kHand[s]] = root + share * (upper + lower + palm) *
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
      carry(kWaist, kHip[s]);
      carry(kHip[s], kKnee[s]);
      carry(kKnee[s], kAnkle[s]);
    }
    const double lift = std::min(from[kAnkle[0]].z(), from[kAnkle[1]].z()) - lowest;
    const double raise =
        kAnkleUp * stature + k * lift - std::min(to[kAnkle[0]].z(), to[kAnkle[1]].z());
    for (Vector3& p : to) p.z() += raise;
  }
  return out;
}

}  // namespace handsel::sim
