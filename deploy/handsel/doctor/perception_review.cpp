// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/doctor/perception_review.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

#include "common/model/human/human_body.hpp"
#include "common/model/human/palm.hpp"
#include "common/topics/topics.hpp"
#include "components/spark/sources.hpp"
#include "sim/recordings/recording.hpp"

namespace handsel {
namespace {

constexpr double kSlowest = 10, kFastest = 300;  // plausible rates [Hz]
constexpr double kSilence = 0.2;                 // silence that stops the robot [s]
constexpr double kOld = 0.25, kFuture = 0.01;    // max age, max time in the future [s]
constexpr double kOffset = 1.0;                  // exceeds the delay of any sensor [s]
constexpr double kJitter = 0.05;                 // max jitter [s]
constexpr double kMinReviewConfidence = 0.05;    // as in SPARK
constexpr double kTrunk = 0.37;                  // waist to head, ratio to the stature
constexpr double kFar = 10;                      // max distance of observed things [m]
constexpr std::size_t kEnough = 10;              // min samples for statistics

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

double quantile_of(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::string join(const std::set<std::string>& names, std::size_t max_names = 4) {
  std::string text;
  std::size_t n = 0;
  for (const std::string& name : names) {
    if (++n > max_names) return text + ", ...";
    text += (text.empty() ? "" : ", ") + name;
  }
  return text;
}

Finding bad(const std::string& subject, const std::string& text, const std::string& remedy) {
  return {subject, Verdict::bad, text, remedy};
}

const Vector3* joint_of(const ObservedPerson& person, const char* name) {
  for (const ObservedJoint& joint : person.joints)
    if (joint.name == name && joint.confidence >= kMinReviewConfidence) return &joint.position;
  return nullptr;
}

bool same(const std::vector<ObservedPerson>& a, const std::vector<ObservedPerson>& b) {
  return std::equal(
      a.begin(), a.end(), b.begin(), b.end(), [](const ObservedPerson& x, const ObservedPerson& y) {
        return std::equal(x.joints.begin(), x.joints.end(), y.joints.begin(), y.joints.end(),
                          [](const ObservedJoint& j, const ObservedJoint& k) {
                            return j.position == k.position;
                          });
      });
}

/// Returns the probable unit of a stamp that is no nanoseconds of the system clock.
std::string unit_of_stamp(Stamp stamp, Stamp now) {
  constexpr std::array<std::pair<double, const char*>, 3> kUnits = {
      {{1e9, "seconds"}, {1e6, "milliseconds"}, {1e3, "microseconds"}}};
  for (const auto& [factor, unit] : kUnits)
    if (std::abs(static_cast<double>(stamp) * factor / static_cast<double>(now) - 1) < 0.01)
      return unit;
  return "the time since something was started";
}

}  // namespace

std::string joint_meant(const std::string& name) {
  std::string plain;
  for (const char c : name)
    if (std::isalpha(static_cast<unsigned char>(c)))
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::string side;
  for (const auto& [word, prefix] : {std::pair{"left", "l_"}, std::pair{"right", "r_"}}) {
    if (const std::size_t at = plain.find(word); at != std::string::npos) {
      side = prefix;
      plain.erase(at, std::string(word).size());
    }
  }
  constexpr std::array<std::pair<const char*, const char*>, 4> kOther = {
      {{"pelvis", "waist"}, {"hips", "waist"}, {"chest", "torso"}, {"spine", "torso"}}};
  for (const auto& [other, ours] : kOther)
    if (plain == other) return ours;
  for (const char* joint : kBodyJoints) {
    const std::string bare = joint[1] == '_' ? joint + 2 : joint;
    if (joint[1] != '_'
            ? plain == bare && side.empty()
            : (plain == bare && std::string(joint).starts_with(side) && !side.empty()) ||
                  plain == joint[0] + bare)
      return joint;
  }
  return {};
}

bool SampleTimes::add(Stamp stamp, TimePoint arrival, Stamp system_arrival) {
  arrivals_.push_back(to_seconds(arrival.time_since_epoch()));
  system_arrival_ = system_arrival;
  if (stamp == 0) {
    ++unstamped_;
    return true;
  }
  if (stamp == last_) {
    ++repeated_;
    return false;
  }
  ages_.push_back(static_cast<double>(system_arrival - stamp) * 1e-9);
  backwards_ += stamp < last_;
  last_ = stamp;
  return true;
}

double SampleTimes::rate() const {
  if (arrivals_.size() < 2) return 0;
  return static_cast<double>(arrivals_.size() - 1) /
         std::max(1e-9, arrivals_.back() - arrivals_.front());
}

double SampleTimes::median_age() const { return quantile_of(ages_, 0.5); }

std::vector<Finding> SampleTimes::findings(const std::string& publisher,
                                           const std::string& what) const {
  std::vector<Finding> out;
  std::vector<double> gaps;
  for (std::size_t i = 1; i < arrivals_.size(); ++i)
    gaps.push_back(arrivals_[i] - arrivals_[i - 1]);
  const double hz = rate();
  if (hz < kSlowest) {
    out.push_back(bad(
        "rate", format("%s publishes %s %.1f times a second", publisher.c_str(), what.c_str(), hz),
        "15 to 120 times a second are right: the robot stops when it hears nothing for 0.2 s"));
  } else if (hz > kFastest) {
    out.push_back(bad(
        "rate", format("%s publishes %s %.0f times a second", publisher.c_str(), what.c_str(), hz),
        "15 to 120 times a second are right: publish each measurement once, as it comes"));
  } else if (std::count_if(gaps.begin(), gaps.end(), [](double gap) { return gap > kSilence; }) >=
             2) {
    out.push_back(bad("rate",
                      format("%s publishes %s irregularly: up to %.2f s pass without",
                             publisher.c_str(), what.c_str(), quantile_of(gaps, 1)),
                      "publish at an even rate, also while nobody is there; the robot stops after "
                      "0.2 s of silence"));
  }
  if (unstamped_ > 0) {
    out.push_back(bad(
        "stamp",
        format("%zu of %zu samples of %s have no stamp", unstamped_, count(), publisher.c_str()),
        "set stamp to the time of the measurement, in ns of the system clock (dds_time())"));
  }
  if (ages_.empty()) return out;
  const double age = median_age(), spread = quantile_of(ages_, 0.95) - age;
  if (last_ < 100'000'000'000'000'000) {
    out.push_back(
        bad("stamp",
            format("%s stamps with %lld, which looks like ", publisher.c_str(),
                   static_cast<long long>(last_)) +
                unit_of_stamp(last_, system_arrival_),
            "stamp in nanoseconds since 1970 of the system clock (dds_time(), CLOCK_REALTIME)"));
  } else if (age < -kFuture || age > kOffset) {
    out.push_back(bad("clock offset",
                      format("%s stamps %s %.3f s %s", publisher.c_str(), what.c_str(),
                             std::abs(age), age > 0 ? "in the past" : "in the future"),
                      "stamp with the time of measurement by the system clock, and run chrony or "
                      "PTP on the host that does"));
  } else if (age > kOld) {
    out.push_back(
        bad("age",
            format("%s of %s are %.2f s old when they come", what.c_str(), publisher.c_str(), age),
            "shorten the time from exposure to publication below 0.2 s: the robot keeps the room a "
            "person may have gone through"));
  } else if (spread > kJitter) {
    out.push_back(bad("jitter",
                      format("the age of %s from %s varies by %.0f ms", what.c_str(),
                             publisher.c_str(), 1e3 * spread),
                      "stamp with the time of exposure, not of sending, and publish at an even "
                      "pace; below 50 ms are right"));
  }
  if (backwards_ > 0 && out.empty()) {
    out.push_back(bad(
        "stamp", format("stamps of %s go back in time, %zu times", publisher.c_str(), backwards_),
        "give each source a name of its own, and publish its measurements in their order"));
  }
  if (count() >= kEnough && 5 * repeated_ > count()) {
    out.push_back(bad("repeated",
                      format("%zu of %zu samples of %s are the one before once more, stamp and all",
                             repeated_, count(), publisher.c_str()),
                      "publish a measurement once; what is repeated is no news to the robot"));
  }
  return out;
}

void PerceptionReview::on(const HumanObservation& seen, TimePoint arrival, Stamp system_arrival) {
  ++received_[TopicOf<HumanObservation>::row.topic];
  Bodies& bodies = people_[seen.source];
  const bool fresh = bodies.times.add(seen.stamp, arrival, system_arrival);
  bodies.coverage = seen.coverage;
  bodies.max_at_once = std::max(bodies.max_at_once, seen.people.size());
  const bool tells = std::any_of(seen.people.begin(), seen.people.end(),
                                 [](const ObservedPerson& p) { return !p.joints.empty(); });
  bodies.frozen += tells && fresh && same(seen.people, bodies.last);
  for (const ObservedPerson& person : seen.people) add_person(bodies, person);
  bodies.last = seen.people;
}

void PerceptionReview::add_person(Bodies& bodies, const ObservedPerson& person) const {
  ++bodies.bodies;
  bodies.ids.insert(person.body);
  for (const ObservedJoint& joint : person.joints) {
    ++bodies.joints;
    if (body_joint_index(joint.name) < 0 && !is_knuckle(joint.name))
      bodies.unknown_joints.insert(joint.name);
    else
      ++bodies.known_joints;
    bodies.unsure += joint.confidence < kMinReviewConfidence;
  }
  const Vector3 *head = joint_of(person, "head"), *waist = joint_of(person, "waist");
  if (head && waist && (*head - *waist).norm() > 1e-9) {
    bodies.statures.push_back((*head - *waist).norm() / kTrunk);
    bodies.up.push_back((*head - *waist).normalized());
  }
  const Vector3 *left_foot = joint_of(person, "l_ankle"), *right_foot = joint_of(person, "r_ankle");
  if (left_foot || right_foot) {
    bodies.lowest.push_back(
        std::min(left_foot ? left_foot->z() : 1e300, right_foot ? right_foot->z() : 1e300));
  }
  const Vector3 *left = joint_of(person, "l_shoulder"), *right = joint_of(person, "r_shoulder");
  if (person.has_gaze && left && right) {
    ++bodies.gazes;
    bodies.mirrored +=
        (*left - *right).cross(Vector3::UnitZ()).normalized().dot(person.gaze_direction) < -0.3;
  }
  const Vector3* middle = waist                   ? waist
                          : head                  ? head
                          : person.joints.empty() ? nullptr
                                                  : &person.joints.front().position;
  if (middle == nullptr) return;
  bodies.nearest = std::min(bodies.nearest, (*middle - ground_.base).head<2>().norm());
  bodies.outside += !spark::contains(bodies.coverage, *middle, 0);
}

void PerceptionReview::on(const ObjectObservation& seen, TimePoint arrival, Stamp system_arrival) {
  ++received_[TopicOf<ObjectObservation>::row.topic];
  Things& things = things_[seen.source];
  things.times.add(seen.stamp, arrival, system_arrival);
  things.max_at_once = std::max(things.max_at_once, seen.objects.size());
  for (const ObservedObject& object : seen.objects) {
    ++things.things;
    things.ids.insert(object.id);
    if (object.primitive.kind == PrimitiveKind::none && !ground_.models.contains(object.model))
      things.unknown_models.insert(
          object.id + (object.model.empty() ? " (no model)" : " (" + object.model + ")"));
    things.lowest = std::min(things.lowest, object.T_world_object.translation().z());
  }
}

void PerceptionReview::on_malformed(const std::string& topic, const std::string& why, bool whole) {
  Malformed& malformed = malformed_[topic];
  ++malformed.count;
  malformed.whole += whole;
  malformed.last = why;
}

std::vector<Finding> PerceptionReview::findings() const {
  std::vector<Finding> out;
  for (const auto& [topic, malformed] : malformed_) {
    const auto good = received_.find(topic);
    const std::size_t all = malformed.whole + (good == received_.end() ? 0 : good->second);
    const bool gaze = malformed.last.find("gaze_direction") != std::string::npos;
    out.push_back(
        bad(gaze ? "gaze" : "malformed",
            format("%zu of %zu samples on %s are malformed and dropped, in whole or in part: ",
                   malformed.count, all, topic.c_str()) +
                malformed.last,
            gaze ? "gaze_direction must be a unit vector, and finite; without a gaze leave "
                   "has_gaze false"
                 : "idl/perception.idl says what each field may hold; leave a joint out rather "
                   "than send NaN"));
  }
  for (const auto& [source, bodies] : people_) check_source(source, bodies, out);
  check_coverage(out);
  for (const auto& [source, things] : things_) check_source(source, things, out);
  return out;
}

void PerceptionReview::check_source(const std::string& source, const Bodies& bodies,
                                    std::vector<Finding>& out) const {
  const std::size_t before = out.size();
  for (Finding& finding : bodies.times.findings(source, "people"))
    out.push_back(std::move(finding));
  if (!bodies.unknown_joints.empty()) {
    std::string meant;
    for (const std::string& name : bodies.unknown_joints)
      if (const std::string joint = joint_meant(name); !joint.empty() && meant.empty())
        meant = joint + " for " + name;
    const std::string text =
        source + " names joints that are not known: " + join(bodies.unknown_joints);
    if (meant.empty() && bodies.known_joints > 0)
      out.push_back({"names", Verdict::note, text,
                     "they are left out; the names are those of REP-155 in idl/perception.idl"});
    else
      out.push_back(bad("names", text,
                        "use the names of REP-155 as in idl/perception.idl, such as " +
                            (meant.empty() ? "r_wrist" : meant)));
  }
  if (bodies.joints > 0 && bodies.unsure == bodies.joints)
    out.push_back(bad("confidence",
                      "every joint of " + source + " has a confidence below 0.05, none is counted",
                      "confidence is 0 to 1, 1 is sure"));
  if (bodies.known_joints > 0) check_frame(source, bodies, out);
  if (bodies.bodies >= kEnough &&
      bodies.ids.size() > std::max(3 * bodies.max_at_once, bodies.bodies / 5)) {
    out.push_back(bad("ids",
                      format("%s gives %zu ids to %zu people in %zu samples", source.c_str(),
                             bodies.ids.size(), bodies.max_at_once, bodies.times.count()),
                      "keep a body's id as long as it is tracked"));
  }
  if (bodies.bodies >= kEnough && 2 * bodies.frozen > bodies.times.count()) {
    out.push_back(
        bad("frozen",
            format("%zu of %zu samples of %s show the very same body with new stamps",
                   bodies.frozen, bodies.times.count(), source.c_str()),
            "publish what is measured now; a person stands never so still that no number changes"));
  }
  if (out.size() > before && out.back().verdict != Verdict::note) return;
  out.push_back({"inputs", Verdict::good,
                 format("%s comes %.0f times a second from %s, %.0f ms old",
                        TopicOf<HumanObservation>::row.topic, bodies.times.rate(), source.c_str(),
                        1e3 * bodies.times.median_age()),
                 ""});
  if (bodies.bodies == 0)
    out.push_back(
        {"people", Verdict::note, source + " sees nobody",
         "let somebody stand before the robot: size, frame and names can be checked then"});
  else if (!bodies.statures.empty())
    out.push_back(
        {"people", Verdict::good,
         format("%s sees %zu, about %.2f m tall, %.1f m from the robot's base", source.c_str(),
                bodies.max_at_once, quantile_of(bodies.statures, 0.5), bodies.nearest),
         ""});
}

void PerceptionReview::check_frame(const std::string& source, const Bodies& bodies,
                                   std::vector<Finding>& out) const {
  const char* const remedy =
      "publish positions in frame \"world\": metres, z up, the floor at z = 0, the robot's base "
      "where its description says";
  if (!bodies.statures.empty()) {
    const double stature = quantile_of(bodies.statures, 0.5);
    const auto [factor, unit] = sim::unit_of(stature);
    if (factor != 1) {
      out.push_back(bad("frame",
                        format("%s sees a person of %.4g m", source.c_str(), stature) +
                            (factor > 0 ? ", which looks like " + std::string(unit) : ""),
                        remedy));
      return;
    }
    std::array<std::vector<double>, 3> up;
    for (const Vector3& direction : bodies.up)
      for (int i = 0; i < 3; ++i) up[static_cast<std::size_t>(i)].push_back(direction[i]);
    const Vector3 middle(quantile_of(up[0], 0.5), quantile_of(up[1], 0.5), quantile_of(up[2], 0.5));
    if (middle.z() < 0.5) {
      const bool down = middle.y()<-0.5, y_up = middle.y()> 0.5, head_down = middle.z() < -0.5;
      out.push_back(bad("frame",
                        "the body " + source + " sees " +
                            (head_down ? "stands on its head: z points down"
                             : down    ? "lies: y points down, as in a camera's optical frame"
                             : y_up    ? "lies: y points up"
                                       : "lies: its head is not above its waist"),
                        remedy));
      return;
    }
  }
  if (!bodies.lowest.empty()) {
    const double floor = quantile_of(bodies.lowest, 0.5);
    if (floor < -0.15 || floor > 0.45) {
      out.push_back(
          bad("frame",
              format("the feet %s sees are at z = %.2f m: its floor is not that of \"world\"",
                     source.c_str(), floor),
              remedy));
      return;
    }
  }
  if (bodies.nearest > kFar && bodies.nearest < 1e299) {
    out.push_back(
        bad("reach",
            format("the nearest anybody %s sees comes to the robot is %.1f m: out of reach",
                   source.c_str(), bodies.nearest),
            remedy));
  } else if (2 * bodies.outside > bodies.bodies &&
             (bodies.coverage.low.array() < bodies.coverage.high.array()).all()) {
    out.push_back(bad("coverage", source + " sees people outside the volume it says it looks at",
                      "coverage holds all the source can see, in frame \"world\""));
  }
  if (bodies.gazes >= kEnough && 2 * bodies.mirrored > bodies.gazes) {
    out.push_back(bad(
        "gaze", "the people " + source + " sees look behind themselves",
        "left and right are exchanged, or gaze_direction points from what is seen to the eyes"));
  }
}

void PerceptionReview::check_coverage(std::vector<Finding>& out) const {
  if (people_.empty()) return;
  std::vector<Coverage> looked_at;
  std::string all;
  for (const auto& [source, bodies] : people_) {
    const Coverage& c = bodies.coverage;
    all += (all.empty() ? "" : ", ") + source;
    if ((c.low.array() < c.high.array()).all()) {
      looked_at.push_back(c);
    } else if (bodies.joints > 0 || bodies.bodies == 0) {
      out.push_back(bad("coverage", source + " says it looks at no volume (its coverage is empty)",
                        "set coverage to the box it looks at: only inside it is \"nobody is "
                        "there\" a fact, and without that the robot stays slow"));
    }
  }
  if (looked_at.empty() || spark::covers(looked_at, ground_.reach)) return;
  const Coverage& r = ground_.reach;
  out.push_back(bad("coverage",
                    "what " + all + " look" + (people_.size() == 1 ? "s" : "") +
                        " at does not contain the robot's reach",
                    format("the robot reaches x %.1f to %.1f, y %.1f to %.1f, z %.1f to %.1f m; "
                           "without that all looked at it stays slow or stops",
                           r.low.x(), r.high.x(), r.low.y(), r.high.y(), r.low.z(), r.high.z())));
}

void PerceptionReview::check_source(const std::string& source, const Things& things,
                                    std::vector<Finding>& out) const {
  const std::size_t before = out.size();
  for (Finding& finding : things.times.findings(source, "objects"))
    out.push_back(std::move(finding));
  if (!things.unknown_models.empty()) {
    out.push_back(bad(
        "names",
        source + " sees objects of models that have no description: " + join(things.unknown_models),
        "use a name under objects/, write a description there, or send the shape as a primitive"));
  }
  if (things.things > 0 && things.lowest < -0.1)
    out.push_back(bad(
        "frame", format("%s sees an object %.2f m under the floor", source.c_str(), -things.lowest),
        "publish poses in frame \"world\": metres, z up, the floor at z = 0"));
  if (things.things >= kEnough &&
      things.ids.size() > std::max(3 * things.max_at_once, things.things / 5))
    out.push_back(bad("ids",
                      format("%s gives %zu ids to %zu objects", source.c_str(), things.ids.size(),
                             things.max_at_once),
                      "an object keeps its id: tasks name it by that"));
  if (out.size() > before) return;
  out.push_back({"inputs", Verdict::good,
                 format("%s comes %.0f times a second from %s, %.0f ms old",
                        TopicOf<ObjectObservation>::row.topic, things.times.rate(), source.c_str(),
                        1e3 * things.times.median_age()),
                 ""});
}

}  // namespace handsel
