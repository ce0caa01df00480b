// SPDX-License-Identifier: Apache-2.0
// A symbolic world of facts with the nominal effects of actions: objects on surfaces, in the
// robot's hand or in people's hands.
#pragma once

#include <map>
#include <set>
#include <string>

#include "common/messages/task.hpp"
#include "common/messages/world.hpp"

namespace handsel {

struct TaskWorld {
  std::map<std::string, std::string> on;       ///< object: surface
  std::map<std::string, std::string> held_by;  ///< object: person, or "robot"
  std::map<std::string, std::string>
      models;  ///< object: model; the object's own name where it is not here
  std::map<std::string, double>
      distance;  ///< object: from the shoulder [m]; 0.5 where it is not here, beyond 1 out of reach
  std::map<std::string, Vector3> surfaces{{"table", {0.7, 0.7, 0.7}},
                                          {"shelf", {0.7, 0.7, 0.7}}};  ///< size [m]
  std::map<std::string, bool> people;  ///< and whether they are attentive
  std::set<std::string> offering;      ///< people who offer their object

  std::set<std::string> objects() const {
    std::set<std::string> out;
    for (const auto& [object, where] : on) out.insert(object);
    for (const auto& [object, who] : held_by) out.insert(object);
    return out;
  }
  std::string in_hand() const {
    for (const auto& [object, who] : held_by)
      if (who == kRobotName) return object;
    return "";
  }
  double away(const std::string& object) const {
    const auto it = distance.find(object);
    return it == distance.end() ? 0.5 : it->second;
  }

  Facts facts() const {
    Facts out;
    const auto say = [&](FactKind kind, const std::string& subject, const std::string& object = "",
                         double value = 1) {
      out.facts.push_back({kind, subject, object, value, 1.0});
    };
    for (const auto& [object, surface] : on) say(FactKind::on_surface, object, surface);
    for (const auto& [object, who] : held_by) {
      if (who == kRobotName)
        say(FactKind::held_by_robot, object);
      else
        say(FactKind::held_by_human, object, who);
      if (offering.contains(who)) say(FactKind::offering, who, object);
    }
    for (const auto& object : objects())
      if (away(object) < 1) say(FactKind::reachable_by_robot, object, "", away(object));
    for (const auto& [person, attentive] : people) {
      say(FactKind::in_interaction_zone, person, "", 1.0);
      if (attentive) say(FactKind::attentive, person);
    }
    return out;
  }

  Scene scene() const {
    Scene out;
    double x = 0;
    for (const auto& [surface, size] : surfaces) {
      out.boxes.push_back({surface, make_pose({x, 0, 0}), size, true});
      x += 5;
    }
    out.boxes.push_back({"wall", make_pose({0, 3, 0}), {1, 0.1, 2}, false});
    std::map<std::string, int> many;
    for (const auto& object : objects()) {
      SceneObject seen;
      seen.id = object;
      const auto model = models.find(object);
      seen.model = model == models.end() ? object : model->second;
      if (const auto it = on.find(object); it != on.end()) {
        seen.holder = Holder::surface;
        seen.holder_id = it->second;
        const int n = many[it->second]++;
        for (const auto& box : out.boxes)
          if (box.id == it->second)
            seen.T_world_object =
                box.T_world_box *
                make_pose({-0.25 + 0.22 * (n % 3), -0.25 + 0.22 * (n / 3), box.size.z() / 2});
      } else {
        seen.holder = held_by.at(object) == kRobotName ? Holder::robot : Holder::human;
      }
      out.objects.push_back(seen);
    }
    return out;
  }

  /// Applies the effects of a successful action; false: the action is impossible here.
  bool perform(ActionKind kind, const std::string& object, const std::string& human,
               const std::string& surface) {
    const std::string hand = in_hand();
    switch (kind) {
      case ActionKind::pick:
        if (!hand.empty() || !on.contains(object) || away(object) >= 1) return false;
        on.erase(object);
        held_by[object] = kRobotName;
        return true;
      case ActionKind::place:
        if (hand != object || !surfaces.contains(surface)) return false;
        held_by.erase(object);
        on[object] = surface;
        distance.erase(object);
        return true;
      case ActionKind::give:
        if (hand != object || !people.contains(human)) return false;
        held_by[object] = human;
        return true;
      case ActionKind::receive:
        for (auto& [thing, who] : held_by)
          if (hand.empty() && who == human && (object.empty() || thing == object)) {
            who = kRobotName;
            return true;
          }
        return false;
      case ActionKind::regrasp:
        if (!(hand.empty() || hand == object) || !surfaces.contains(surface)) return false;
        held_by.erase(object);
        on[object] = surface;
        return true;
      case ActionKind::go_to:
        return true;
      default:
        return false;
    }
  }
};

}  // namespace handsel
