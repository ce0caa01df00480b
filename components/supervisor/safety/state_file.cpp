// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/safety/state_file.hpp"

#include <algorithm>
#include <array>
#include <cinttypes>
#include <cmath>
#include <cstdio>

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include "common/config/schema/safety_state.pb.h"

namespace handsel::supervisor {
namespace {

constexpr const char* kHeader = "handsel safety state 1 ";
constexpr double kMaxAge = 1e8;                  // max age of a lost person [s]
constexpr double kMaxCoordinate = 1e4;           // max coordinate of a joint [m]
constexpr int kMaxPeople = 16, kMaxJoints = 32;  // max numbers of people, joints of a person

/// Returns the CRC-32 of IEEE 802.3.
std::uint32_t checksum(const std::string& text) {
  std::uint32_t crc = 0xffffffffu;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
  }
  return ~crc;
}

/// Suppresses the messages of the parser.
struct Silent : google::protobuf::io::ErrorCollector {
  void AddError(int, google::protobuf::io::ColumnNumber, const std::string&) override {}
};

bool within(double value, double low, double high) {
  return std::isfinite(value) && value >= low && value <= high;
}

bool good(const config::StoredPoint& p) {
  return within(p.x(), -kMaxCoordinate, kMaxCoordinate) &&
         within(p.y(), -kMaxCoordinate, kMaxCoordinate) &&
         within(p.z(), -kMaxCoordinate, kMaxCoordinate);
}

bool good(const config::StoredPerson& person) {
  return within(person.stature(), 0.3, 3.0) && within(person.age(), 0, kMaxAge) &&
         within(person.inflation(), 0, 2 * kMaxAge) && person.joints_size() <= kMaxJoints &&
         std::all_of(person.joints().begin(), person.joints().end(),
                     [](const auto& joint) { return good(joint.position()); });
}

bool good(const config::StoredSafetyState& state) {
  return state.revision() > 0 && state.permission_revision() > 0 &&
         state.permission_revision() <= state.revision() && within(state.override_factor(), 0, 1) &&
         state.lost_size() <= kMaxPeople &&
         std::all_of(state.lost().begin(), state.lost().end(),
                     [](const auto& person) { return good(person); });
}

Person person_of(const config::StoredPerson& stored, double since) {
  Person person;
  person.id = stored.id();
  person.stature = stored.stature();
  person.age = std::min(kMaxAge, stored.age() + since);
  person.inflation = stored.inflation();
  for (const auto& joint : stored.joints()) {
    BodyJoint body;
    body.name = joint.name();
    body.position = {joint.position().x(), joint.position().y(), joint.position().z()};
    person.joints.push_back(body);
  }
  return person;
}

}  // namespace

std::string write_state(const DurableState& state, Stamp written) {
  const SafetyState& s = state.safety;
  config::StoredSafetyState stored;
  stored.set_stamp(written);
  stored.set_revision(s.revision);
  stored.set_permission_revision(state.permission_revision);
  stored.set_paused(s.paused);
  stored.set_override_factor(s.override_factor);
  stored.set_fault(s.fault);
  stored.set_awaits_person(s.awaits_person);
  stored.set_reason(s.reason);
  const double since =
      s.stamp > 0 ? std::max(0.0, static_cast<double>(written - s.stamp) * 1e-9) : 0.0;
  for (const Person& person : s.lost) {
    config::StoredPerson& out = *stored.add_lost();
    out.set_id(person.id);
    out.set_stature(person.stature);
    out.set_age(std::min(kMaxAge, person.age + since));
    out.set_inflation(person.inflation);
    for (const BodyJoint& joint : person.joints) {
      config::StoredJoint& point = *out.add_joints();
      point.set_name(joint.name);
      point.mutable_position()->set_x(joint.position.x());
      point.mutable_position()->set_y(joint.position.y());
      point.mutable_position()->set_z(joint.position.z());
    }
  }
  std::string body;
  google::protobuf::TextFormat::PrintToString(stored, &body);
  std::array<char, 16> sum{};
  std::snprintf(sum.data(), sum.size(), "%08" PRIx32, checksum(body));
  return kHeader + std::string(sum.data()) + "\n" + body;
}

std::variant<DurableState, StateDamage> read_state(const std::string& text, Stamp now) {
  const std::size_t end = text.find('\n');
  const std::string header = text.substr(0, end);
  if (end == std::string::npos || !header.starts_with(kHeader))
    return StateDamage{"it does not begin with \"" + std::string(kHeader) + "CHECKSUM\""};
  const std::string body = text.substr(end + 1);
  std::array<char, 16> sum{};
  std::snprintf(sum.data(), sum.size(), "%08" PRIx32, checksum(body));
  if (header != kHeader + std::string(sum.data())) return StateDamage{"its checksum is wrong"};
  config::StoredSafetyState stored;
  google::protobuf::TextFormat::Parser parser;
  Silent silent;
  parser.RecordErrorsTo(&silent);
  if (!parser.ParseFromString(body, &stored))
    return StateDamage{"its fields are not those of this version"};
  if (!good(stored)) return StateDamage{"a field is out of range"};

  DurableState state;
  SafetyState& s = state.safety;
  s.stamp = now;
  s.revision = stored.revision();
  state.permission_revision = stored.permission_revision();
  s.paused = stored.paused();
  s.override_factor = stored.override_factor();
  s.fault = stored.fault();
  s.awaits_person = stored.awaits_person();
  s.reason = stored.reason();
  const double since = std::max(0.0, static_cast<double>(now - stored.stamp()) * 1e-9);
  for (const auto& person : stored.lost()) s.lost.push_back(person_of(person, since));
  return state;
}

}  // namespace handsel::supervisor
