// SPDX-License-Identifier: Apache-2.0
#include "components/grasp_planner/list/grasp_store.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <sstream>

#include "common/config/schema/grasp_planner.pb.h"

namespace handsel::grasp_planner {
namespace {

constexpr std::uint32_t kVersion =
    5;  // of the form on disk and of the method: raise it when either changes
constexpr std::uint32_t kPinchVersion = 1;  // of the method of hands of two pads

/// FNV-1a, 64 bit.
class Hash {
 public:
  void bytes(const void* data, std::size_t size) {
    const auto* p = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) value_ = (value_ ^ p[i]) * 0x100000001b3ULL;
  }
  void add(double v) { bytes(&v, sizeof v); }
  void add(std::uint64_t v) { bytes(&v, sizeof v); }
  void add(const std::string& s) {
    add(static_cast<std::uint64_t>(s.size()));
    bytes(s.data(), s.size());
  }
  void add(const Vector3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const Vector& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) add(v[i]);
  }
  void add(const Pose& T) {
    add(Vector3(T.translation()));
    for (int i = 0; i < 9; ++i) add(T.linear()(i / 3, i % 3));
  }
  void add(const TriangleMesh& m) {
    add(static_cast<std::uint64_t>(m.vertices.size()));
    for (const Vector3& v : m.vertices) add(v);
    for (const auto& t : m.triangles) bytes(t.data(), sizeof t);
  }
  void add(const PlacedShape& s) {
    add(s.T_parent_shape);
    add(static_cast<std::uint64_t>(s.shape.index()));
    if (const auto* p = std::get_if<Sphere>(&s.shape)) add(p->radius);
    if (const auto* p = std::get_if<Box>(&s.shape)) add(p->size);
    if (const auto* p = std::get_if<Cylinder>(&s.shape)) add(Vector3(p->radius, p->length, 0));
    if (const auto* p = std::get_if<Capsule>(&s.shape)) add(Vector3(p->radius, p->length, 0));
    if (const auto* p = std::get_if<MeshPtr>(&s.shape)) add(**p);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_{0xcbf29ce484222325ULL};
};

std::uint64_t checksum(config::StoredGraspList& list) {
  const std::uint64_t kept = list.checksum();
  list.clear_checksum();
  const std::string text = list.SerializeAsString();
  list.set_checksum(kept);
  Hash h;
  h.bytes(text.data(), text.size());
  return h.value();
}

template <class V>
void put(const V& v, google::protobuf::RepeatedField<double>* out) {
  for (Eigen::Index i = 0; i < v.size(); ++i) out->Add(v[i]);
}

Vector3 vector3(const google::protobuf::RepeatedField<double>& v) { return {v[0], v[1], v[2]}; }
Vector vector(const google::protobuf::RepeatedField<double>& v) {
  return Eigen::Map<const Vector>(v.data(), v.size());
}

std::optional<ListedGrasp> grasp_from(const config::StoredGrasp& in) {
  if (in.pose_size() != 12 || in.scores_size() != 4 ||
      in.hand_joints_size() != in.pregrasp_joints_size() ||
      in.hand_joints_size() != in.hand_effort_size())
    return std::nullopt;
  ListedGrasp out;
  Grasp& g = out.grasp;
  g.id = in.id();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) g.T_object_hand.matrix()(r, c) = in.pose(4 * r + c);
  }
  g.hand_joints = vector(in.hand_joints());
  g.pregrasp_joints = vector(in.pregrasp_joints());
  g.hand_effort = vector(in.hand_effort());
  for (const auto& c : in.contacts()) {
    if (c.position_size() != 3 || c.normal_size() != 3 || c.barycentric_size() != 3)
      return std::nullopt;
    g.contacts.push_back({c.finger(), vector3(c.position()), vector3(c.normal()), c.triangle(),
                          vector3(c.barycentric()), c.friction(), c.curvature()});
  }
  g.epsilon = in.epsilon();
  g.quality = in.quality();
  g.margin = in.margin();
  out.scores = {in.scores(0), in.scores(1), in.scores(2), in.scores(3)};
  out.room = in.room();
  return out;
}

void put_grasp(const ListedGrasp& in, config::StoredGrasp* out) {
  const Grasp& g = in.grasp;
  out->set_id(g.id);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 4; ++c) out->add_pose(g.T_object_hand.matrix()(r, c));
  }
  put(g.hand_joints, out->mutable_hand_joints());
  put(g.pregrasp_joints, out->mutable_pregrasp_joints());
  put(g.hand_effort, out->mutable_hand_effort());
  for (const Contact& c : g.contacts) {
    auto* s = out->add_contacts();
    s->set_finger(c.finger);
    put(c.position, s->mutable_position());
    put(c.normal, s->mutable_normal());
    s->set_triangle(c.triangle);
    put(c.barycentric, s->mutable_barycentric());
    s->set_friction(c.friction);
    s->set_curvature(c.curvature);
  }
  out->set_epsilon(g.epsilon);
  out->set_quality(g.quality);
  out->set_margin(g.margin);
  for (const double s :
       {in.scores.stability, in.scores.centre, in.scores.force, in.scores.curvature})
    out->add_scores(s);
  out->set_room(in.room);
}

}  // namespace

std::uint64_t list_key(const HandModel& hand, const ObjectModel& object,
                       const GraspListSettings& s) {
  Hash h;
  h.add(static_cast<std::uint64_t>(kVersion));
  for (const Link& l : hand.model().links()) {
    h.add(l.name);
    for (const PlacedShape& c : l.collision) h.add(c);
  }
  for (const Joint& j : hand.model().joints()) {
    h.add(j.T_parent_joint);
    h.add(j.axis);
    h.add(Vector3(j.parent, j.child, j.dof));
    h.add(Vector3(static_cast<double>(j.kind), j.mimic_factor, j.mimic_offset));
  }
  for (const Finger& f : hand.fingers()) {
    h.add(f.tip_link);
    h.add(f.tip_radius);
    if (f.pad) {
      h.add(f.pad->T_tip_pad);
      h.add(Vector3(f.pad->width, f.pad->height, 0));
    }
    for (const int a : f.axes) h.add(static_cast<std::uint64_t>(a));
  }
  h.add(hand.grip_force());
  h.add(hand.T_hand_grasp());
  for (const Vector* v :
       {&hand.rest(), &hand.pregrasp(), &hand.lower_contact(), &hand.upper_contact()})
    h.add(*v);
  h.add(object.mesh);
  for (const PlacedShape& p : object.parts) h.add(p);
  if (hand.pinches()) {
    h.add(static_cast<std::uint64_t>(kPinchVersion));
    for (const ObjectPart& part : object.parts)
      h.add(static_cast<std::uint64_t>(part.walls.empty()));
  }
  h.add(object.com);
  h.add(object.friction);
  h.add(object.mass);
  for (const double v : {static_cast<double>(s.positions),
                         s.spacing,
                         s.step_fraction,
                         s.friction,
                         static_cast<double>(s.cone_edges),
                         s.full_epsilon,
                         s.weights.stability,
                         s.weights.centre,
                         s.weights.force,
                         s.weights.curvature,
                         static_cast<double>(s.contacts_per_finger),
                         static_cast<double>(s.tries_per_finger),
                         s.depth,
                         s.opening,
                         s.open_clearance,
                         s.pad_hollow,
                         s.free_distance,
                         s.grip.max_normal,
                         s.grip.friction_fraction,
                         s.grip.acceleration,
                         s.grip.enough,
                         s.creep,
                         s.weight_grip,
                         s.sturdy_margin,
                         s.min_margin,
                         static_cast<double>(s.grip.edges)}) {
    h.add(v);
  }
  h.add(s.seed);
  return h.value();
}

std::filesystem::path default_store() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache != nullptr && *cache != '\0')
    return std::filesystem::path(cache) / "handsel";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
    return std::filesystem::path(home) / ".cache" / "handsel";
  return {};
}

std::string GraspStore::stem(const std::string& hand, const std::string& object,
                             std::uint64_t key) {
  const auto plain = [](std::string s) {
    for (char& c : s) {
      if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    }
    return s;
  };
  std::ostringstream name;
  name << "grasps-" << plain(hand) << '-' << plain(object) << '-' << std::hex << key << '-';
  return name.str();
}

std::filesystem::path GraspStore::file(const std::string& hand, const std::string& object,
                                       std::uint64_t key, std::uint64_t frames) const {
  return folder_ / (stem(hand, object, key) + std::to_string(frames) + ".pb");
}

std::optional<GraspList> GraspStore::load(const std::string& hand, const std::string& object,
                                          std::uint64_t key, std::uint64_t max_frames) const {
  if (folder_.empty()) return std::nullopt;
  const std::string begin = stem(hand, object, key);
  std::vector<std::uint64_t> known;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(begin, 0) != 0 || entry.path().extension() != ".pb") continue;
    const std::uint64_t frames = std::strtoull(name.c_str() + begin.size(), nullptr, 10);
    if (frames <= max_frames) known.push_back(frames);
  }
  std::sort(known.rbegin(), known.rend());
  for (const std::uint64_t frames : known) {
    auto list = read(file(hand, object, key, frames), key);
    if (list && list->frames == frames) return list;
  }
  return std::nullopt;
}

std::optional<GraspList> GraspStore::read(const std::filesystem::path& file, std::uint64_t key) {
  constexpr std::uintmax_t kMaxBytes = 256u << 20;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) ||
      std::filesystem::file_size(file, error) > kMaxBytes)
    return std::nullopt;
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  config::StoredGraspList stored;
  if (!stored.ParseFromString(bytes) || stored.version() != kVersion || stored.key() != key ||
      checksum(stored) != stored.checksum()) {
    return std::nullopt;
  }
  GraspList list;
  list.hand = stored.hand();
  list.object = stored.object();
  list.frames = stored.frames();
  if (stored.reasons_size() != static_cast<int>(list.reasons.size()) || stored.work_size() != 3)
    return std::nullopt;
  std::copy(stored.reasons().begin(), stored.reasons().end(), list.reasons.begin());
  list.finger_solutions = stored.work(0);
  list.touch_tests = stored.work(1);
  list.closure_tests = stored.work(2);
  for (const auto& g : stored.grasps()) {
    auto grasp = grasp_from(g);
    if (!grasp) return std::nullopt;
    list.grasps.push_back(std::move(*grasp));
  }
  return list;
}

bool GraspStore::save(const GraspList& list, std::uint64_t key) const {
  if (folder_.empty()) return false;
  config::StoredGraspList stored;
  stored.set_version(kVersion);
  stored.set_key(key);
  stored.set_hand(list.hand);
  stored.set_object(list.object);
  stored.set_frames(list.frames);
  for (const std::uint64_t r : list.reasons) stored.add_reasons(r);
  for (const std::uint64_t w : {list.finger_solutions, list.touch_tests, list.closure_tests})
    stored.add_work(w);
  for (const ListedGrasp& g : list.grasps) put_grasp(g, stored.add_grasps());
  stored.set_checksum(checksum(stored));
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  static std::atomic<unsigned> written{0};
  const std::filesystem::path target = file(list.hand, list.object, key, list.frames);
  std::filesystem::path beside = target;
  beside += "." + std::to_string(::getpid()) + "." + std::to_string(++written) + ".new";
  {
    std::ofstream out(beside, std::ios::binary | std::ios::trunc);
    if (!out || !stored.SerializeToOstream(&out) || !out.flush()) {
      std::filesystem::remove(beside, error);
      return false;
    }
  }
  std::filesystem::rename(beside, target, error);
  return !error;
}

}  // namespace handsel::grasp_planner
