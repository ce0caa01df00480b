// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/task_planner.hpp"

#include <algorithm>

namespace handsel::supervisor {
namespace {

std::string or_nothing(const std::string& text) { return text.empty() ? "-" : text; }

std::string names(const World& world, Type type) {
  std::string out;
  for (const Symbol s : world.all(type)) out += (out.empty() ? "" : ", ") + world.text(s);
  return out;
}

bool is_model(const Scene& scene, const std::string& text) {
  return std::any_of(scene.objects.begin(), scene.objects.end(),
                     [&](const SceneObject& o) { return o.model == text; });
}

class Resolver {
 public:
  Resolver(const World& world, const Scene& scene, TaskQuery& out)
      : world_(world), scene_(scene), out_(out) {}

  void object(const std::string& text, bool or_model = false) {
    if (text.empty() || world_.is(Type::object, text) || (or_model && is_model(scene_, text)))
      return;
    const std::string there = names(world_, Type::object);
    unseen(text, std::string("there is nothing called ") + text + " here; " +
                     (there.empty() ? "nothing is seen" : "there is " + there));
  }
  void surface(const std::string& text) {
    if (text.empty() || world_.is(Type::surface, text)) return;
    const std::string there = names(world_, Type::surface);
    refuse(text + (is_box(text) ? " is no surface to put things on" : " is no surface here") +
           (there.empty() ? "; there is none" : "; there is " + there));
  }
  void person(const std::string& text) {
    if (text.empty() || world_.is(Type::human, text)) return;
    const std::string there = names(world_, Type::human);
    unseen(text, "nobody called " + text + " is in sight" +
                     (there.empty() ? "; nobody is" : "; in sight is " + there));
  }
  void want(const std::string& text, const char* task, const char* what) {
    if (text.empty()) refuse(std::string(task) + " needs the name of " + what);
  }
  void refuse(const std::string& reason) {
    if (out_.reason.empty()) out_.reason = reason;
  }

 private:
  void unseen(const std::string& text, const std::string& reason) {
    if (!out_.reason.empty()) return;
    out_.reason = reason;
    out_.unseen = text;
  }
  bool is_box(const std::string& text) const {
    return std::any_of(scene_.boxes.begin(), scene_.boxes.end(),
                       [&](const SceneBox& b) { return b.id == text; });
  }
  const World& world_;
  const Scene& scene_;
  TaskQuery& out_;
};

}  // namespace

std::string drive_target(const TaskGoal& goal) {
  for (const std::string* name : {&goal.object, &goal.surface, &goal.human})
    if (!name->empty()) return *name;
  return "a place";
}

std::string text_of(const TaskGoal& goal) {
  const std::string thing = goal.object.empty() ? "something" : goal.object;
  const std::string who = goal.human.empty() ? "somebody" : goal.human;
  switch (goal.kind) {
    case TaskKind::give:
      return "give " + thing + " to " + who;
    case TaskKind::receive:
      return "receive " + thing + " from " + who +
             (goal.onto.empty() ? "" : " and place it on " + goal.onto);
    case TaskKind::place:
      return "place " + thing + " on " + goal.surface;
    case TaskKind::clear:
      return "clear " + goal.surface + (goal.onto.empty() ? "" : " onto " + goal.onto);
    case TaskKind::tidy:
      return "tidy " + thing + " into " + goal.onto;
    case TaskKind::drive:
      return "drive to " + drive_target(goal);
    case TaskKind::go_to:
      return "go to " + (goal.surface.empty() ? "rest" : goal.surface);
    default:
      return std::string(name(goal.kind)) + " " + thing;
  }
}

TaskQuery query_for(const TaskGoal& goal, const Domain& domain, const World& world,
                    const Scene& scene) {
  TaskQuery out;
  out.task = domain.task(name(goal.kind));
  if (out.task < 0) {
    out.reason = std::string("the domain has no task ") + name(goal.kind);
    return out;
  }
  Resolver resolve(world, scene, out);
  const char* task = name(goal.kind);
  switch (goal.kind) {
    case TaskKind::give:
      resolve.want(goal.object, task, "an object");
      resolve.object(goal.object);
      resolve.person(goal.human);
      out.args = {goal.object, or_nothing(goal.human)};
      out.needs_person = goal.human.empty() && world.all(Type::human).empty();
      break;
    case TaskKind::receive:
      resolve.object(goal.object);
      resolve.person(goal.human);
      resolve.surface(goal.onto);
      out.args = {or_nothing(goal.object), or_nothing(goal.human), or_nothing(goal.onto)};
      out.needs_person = goal.human.empty() && world.all(Type::human).empty();
      break;
    case TaskKind::place:
      resolve.want(goal.object, task, "an object");
      resolve.want(goal.surface, task, "a surface");
      resolve.surface(goal.surface);
      resolve.object(goal.object);
      out.args = {goal.object, goal.surface};
      break;
    case TaskKind::clear:
      resolve.want(goal.surface, task, "a surface");
      resolve.surface(goal.surface);
      resolve.surface(goal.onto);
      if (goal.onto == goal.surface)
        resolve.refuse(goal.surface +
                       " cannot be cleared onto itself; name another surface or none");
      out.args = {goal.surface, or_nothing(goal.onto)};
      break;
    case TaskKind::tidy:
      resolve.want(goal.object, task, "an object, or of a kind of object");
      resolve.want(goal.onto, task, "a surface");
      resolve.surface(goal.onto);
      resolve.object(goal.object, true);
      out.args = {goal.object, goal.onto};
      break;
    case TaskKind::drive:
      resolve.object(goal.object);
      resolve.surface(goal.surface);
      resolve.person(goal.human);
      out.args = {or_nothing(goal.object), or_nothing(goal.surface), or_nothing(goal.human)};
      break;
    case TaskKind::go_to:
      if (!goal.surface.empty() && goal.surface != "rest")
        resolve.refuse("there is no configuration called " + goal.surface + "; there is rest");
      out.args = {or_nothing(goal.surface)};
      break;
    default:
      resolve.want(goal.object, task, "an object");
      resolve.object(goal.object);
      out.args = {goal.object};
      break;
  }
  const std::size_t wanted = domain.tasks[static_cast<std::size_t>(out.task)].types.size();
  if (out.args.size() != wanted)
    resolve.refuse("the domain's task " + std::string(task) + " has " + std::to_string(wanted) +
                   " parameters, this goal fills " + std::to_string(out.args.size()));
  return out;
}

std::string already(const TaskGoal& goal) {
  switch (goal.kind) {
    case TaskKind::give:
      return (goal.human.empty() ? "somebody" : goal.human) + " has " + goal.object + " already";
    case TaskKind::place:
      return goal.object + " is on " + goal.surface + " already";
    case TaskKind::clear:
      return goal.surface + " is clear already";
    case TaskKind::tidy:
      return goal.object + " is on " + goal.onto + " already";
    case TaskKind::drive:
      return drive_target(goal) + " is within reach already";
    case TaskKind::pick:
    case TaskKind::lift:
      return "the robot has " + goal.object + " in its hand already";
    default:
      return "nothing has to be done";
  }
}

}  // namespace handsel::supervisor
