#include "components/attention/looks.hpp"

#include <algorithm>

#include "common/model/human/body_index.hpp"

namespace handsel::attention {

bool robot_known(const World& w, const Body& body) {
  return w.active && w.active->position.size() == body.dof();
}
bool doing(const World& w, ActionKind kind) {
  return w.action && w.action->state == ActionState::running && w.action->kind == kind;
}

const Person* person_of_interest(const World& w, const Vector3& p, double lost_after) {
  if (!w.people) return nullptr;
  const Person* best = nullptr;
  double nearest = kInfinity;
  for (const Person& person : w.people->people) {
    if (person.joints.size() != kBodyJoints.size() || person.age > lost_after) continue;
    if (w.action && !w.action->human.empty() && w.action->human == person.id) return &person;
    const double d = (person.joints[body::torso].position - p).norm();
    if (d < nearest) {
      nearest = d;
      best = &person;
    }
  }
  return best;
}

bool holds(const World& w, FactKind kind, const std::string& person) {
  return w.facts && std::any_of(w.facts->facts.begin(), w.facts->facts.end(), [&](const Fact& f) {
           return f.kind == kind && (person.empty() || f.subject == person);
         });
}

bool attentive(const World& w, const std::string& person) {
  return !w.facts || holds(w, FactKind::attentive, person);
}

NearHand nearest_hand(const Person& person, const Vector3& p) {
  NearHand near;
  for (std::size_t j : {std::size_t{7}, std::size_t{11}}) {
    const double d = (person.joints[j].position - p).norm();
    if (d < near.distance) near = {d, person.joints[j].position, person.joints[j].velocity};
  }
  return near;
}

double urgency(double distance, double closing) {
  constexpr double kReference = 0.5;
  return std::max(0.0, closing > kReference ? distance * kReference / closing : distance);
}

double ramp(double x, double low, double high) {
  return std::clamp((x - low) / (high - low), 0.0, 1.0);
}

bool in_handover_with(const World& w, const std::string& person) {
  if (doing(w, ActionKind::pick)) return w.action->human == person && !person.empty();
  return (doing(w, ActionKind::give) || doing(w, ActionKind::receive)) &&
         (w.action->human.empty() || w.action->human == person);
}

SeparationExemption handover_exemption(const World& w) {
  SeparationExemption exception;
  if (!w.action || !w.action->exchange_engaged) return exception;
  exception.person = w.action->human;
  if (exception.person.empty() && w.people && w.people->people.size() == 1)
    exception.person = w.people->people.front().id;
  return exception;
}

}  // namespace handsel::attention
