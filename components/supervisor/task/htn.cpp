// SPDX-License-Identifier: Apache-2.0
#include "components/supervisor/task/htn.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <unordered_map>

#include "components/supervisor/task/grounding.hpp"

namespace handsel::supervisor {
namespace {

constexpr double kEqualCost = 1e-9;  // max difference of equal costs

/// Returns the tree without tasks that need no action.
std::vector<PlanLine> with_something_to_do(const std::vector<PlanLine>& tree) {
  std::vector<PlanLine> out;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    bool any = i == 0 || tree[i].action >= 0 || tree[i].skipped;
    for (std::size_t k = i + 1; k < tree.size() && tree[k].depth > tree[i].depth && !any; ++k)
      any = tree[k].action >= 0 || tree[k].skipped;
    if (any) out.push_back(tree[i]);
  }
  return out;
}

class Search {
 public:
  Search(const Domain& domain, const World& world, const Forbidden& forbidden,
         const PlanLimits& limits)
      : domain_(domain), world_(world), ground_{world_}, forbidden_(forbidden), limits_(limits) {}

  Plan run(int task, const std::vector<std::string>& args) {
    Item root;
    root.call.index = task;
    root.frame = std::make_shared<const Frame>(frame_of(world_, args));
    root.min_cost = domain_.tasks[static_cast<std::size_t>(task)].min_cost;
    State start = world_.state;
    step(start, push(root, nullptr), 0);
    best_.nodes = nodes_;
    best_.proven = nodes_ < limits_.nodes && !too_deep_;
    if (!best_.found) {
      best_.reason = !blame_.empty() ? blame_
                     : too_deep_     ? "the tasks of the domain lead ever deeper without an end"
                     : nodes_ >= limits_.nodes
                         ? "no plan was found in " + std::to_string(limits_.nodes) + " states"
                         : "there is no method to " + task_text(task, frame_of(world_, args));
    }
    return std::move(best_);
  }

 private:
  /// Work to do: a call with bound arguments, an `all`, or one of its instances.
  struct Item {
    enum class Kind { call, all, one } kind{Kind::call};
    Call call;                   // index and whether it is an action; its arguments are `frame`
    const CompiledStep* step{};  // for all and one
    std::shared_ptr<const Frame> frame;
    std::uint32_t depth{};
    double min_cost{};
  };
  struct Link;
  using Agenda = std::shared_ptr<const Link>;
  struct Link {
    Item item;
    Agenda rest;
    double min_cost;     // of the item and the rest
    std::uint64_t hash;  // of the item and the rest
  };

  Agenda push(Item item, const Agenda& rest) const {
    std::uint64_t h = rest ? rest->hash : 7;
    const auto mix = [&h](std::uint64_t v) { h = (h ^ v) * 1099511628211ULL, h ^= h >> 31; };
    mix(static_cast<std::uint64_t>(item.kind) * 2 + (item.call.action ? 1 : 0));
    mix(item.kind == Item::Kind::call ? static_cast<std::uint64_t>(item.call.index)
                                      : reinterpret_cast<std::uintptr_t>(item.step));
    for (const Symbol s : *item.frame) mix(static_cast<std::uint64_t>(s) + 1000003);
    const double min_cost = item.min_cost + (rest ? rest->min_cost : 0);
    return std::make_shared<const Link>(Link{std::move(item), rest, min_cost, h});
  }

  Item call_item(const Call& call, const Frame& frame, std::uint32_t depth) const {
    Item item;
    item.call = {call.action, call.index, {}};
    Frame args;
    for (const Term& t : call.args) args.push_back(ground_.symbol(t, frame));
    item.frame = std::make_shared<const Frame>(std::move(args));
    item.depth = depth;
    item.min_cost = call.action ? domain_.actions[static_cast<std::size_t>(call.index)].cost
                                : domain_.tasks[static_cast<std::size_t>(call.index)].min_cost;
    return item;
  }

  std::string task_text(int index, const Frame& args) const {
    const CompiledTask& task = domain_.tasks[static_cast<std::size_t>(index)];
    return ground_.fill(task.text, task.parameters, task.types, args);
  }

  /// Stores the reason of the first alternative that leads farthest.
  void blame(const std::string& reason) {
    if (reason.empty()) return;
    if (here_ != nullptr && here_->empty()) *here_ = reason;
    if (!blame_.empty() && actions_.size() <= blame_at_) return;
    blame_ = reason;
    blame_at_ = actions_.size();
  }

  void step(State& state, const Agenda& agenda, double cost) {
    if (nodes_ >= limits_.nodes) return;
    ++nodes_;
    const double min_cost = cost + (agenda ? agenda->min_cost : 0);
    if (best_.found && min_cost >= best_.cost - kEqualCost) return;
    if (!agenda) {
      best_.found = true;
      best_.cost = cost;
      best_.actions = actions_;
      best_.tree = with_something_to_do(tree_);
      return;
    }
    std::uint64_t key = state.hash() * 31 + agenda->hash;
    const auto [seen, is_new] = seen_.try_emplace(key, cost);
    if (!is_new && seen->second <= cost + kEqualCost) return;
    seen->second = cost;
    const std::size_t lines = tree_.size();
    switch (agenda->item.kind) {
      case Item::Kind::call:
        agenda->item.call.action ? act(state, agenda, cost) : decompose(state, agenda, cost);
        break;
      case Item::Kind::all:
        each(state, agenda, cost);
        break;
      case Item::Kind::one:
        one(state, agenda, cost);
        break;
    }
    tree_.resize(lines);
  }

  void act(const State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    const CompiledAction& action = domain_.actions[static_cast<std::size_t>(item.call.index)];
    if (const Test* test = failing(ground_, action.when, *item.frame, state)) {
      blame(ground_.fill(test->otherwise, action.parameters, action.types, *item.frame));
      return;
    }
    PlannedAction out = planned(domain_, ground_, item.call.index, *item.frame);
    if (const auto no = forbidden_.find(out.text()); no != forbidden_.end()) {
      blame(no->second);
      return;
    }
    out.cost = action.cost + ground_.extra(action.extra, *item.frame, state);
    State next = state;
    change(ground_, action, *item.frame, next);
    tree_.push_back({out.text(), item.depth, static_cast<int>(actions_.size()), false, ""});
    const double sum = cost + out.cost;
    actions_.push_back(std::move(out));
    step(next, agenda->rest, sum);
    actions_.pop_back();
  }

  struct Choice {
    const CompiledMethod* method;
    Frame frame;
    double cost, estimate;
  };

  void decompose(State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    const CompiledTask& task = domain_.tasks[static_cast<std::size_t>(item.call.index)];
    if (item.depth >= limits_.depth) {
      too_deep_ = true;
      return;
    }
    tree_.push_back({task_text(item.call.index, *item.frame), item.depth, -1, false, ""});
    std::vector<Choice> choices;
    for (const CompiledMethod& method : task.methods) {
      Frame frame = *item.frame;
      frame.resize(method.names.size(), kUnbound);
      const std::size_t before = choices.size();
      mismatch_.clear();
      const std::function<void()> found = [&] {
        const double own = method.cost + ground_.extra(method.extra, frame, state);
        choices.push_back({&method, frame, own, own + method.min_cost - method.cost});
      };
      bind({method.tests, method, state, found}, 0, frame);
      if (choices.size() == before) blame(mismatch_);
    }
    std::stable_sort(choices.begin(), choices.end(),
                     [](const Choice& a, const Choice& b) { return a.estimate < b.estimate; });
    for (const Choice& choice : choices) {
      Agenda next = agenda->rest;
      for (auto s = choice.method->steps.rbegin(); s != choice.method->steps.rend(); ++s) {
        if (!s->all) {
          next = push(call_item(s->call, choice.frame, item.depth + 1), next);
          continue;
        }
        Item all;
        all.kind = Item::Kind::all;
        all.step = &*s;
        all.frame = std::make_shared<const Frame>(choice.frame);
        all.depth = item.depth + 1;
        method_of_[&*s] = choice.method;
        next = push(all, next);
      }
      const std::size_t lines = tree_.size();
      step(state, next, cost + choice.cost);
      tree_.resize(lines);
    }
  }

  void lack(const Test& test, const CompiledMethod& method, const Frame& frame) {
    if (mismatch_.empty() && !test.otherwise.empty())
      mismatch_ = ground_.fill(test.otherwise, method.names, method.types, frame);
  }

  /// Tests that bind the variables of a method in one state.
  struct BindingProblem {
    const std::vector<Test>& tests;      // of the method or of one of its steps
    const CompiledMethod& method;        // its variables are in the frame
    const State& state;                  // evaluates the literals
    const std::function<void()>& found;  // called for every binding
  };

  /// Finds every binding of the frame's variables that passes the tests from `at` on.
  void bind(const BindingProblem& problem, std::size_t at, Frame& frame) {
    if (at == problem.tests.size()) return problem.found();
    const Test& test = problem.tests[at];
    const State& state = problem.state;
    if (test.enumerate >= 0) {
      Symbol& slot = frame[static_cast<std::size_t>(test.enumerate)];
      for (const Symbol s :
           world_.all(problem.method.types[static_cast<std::size_t>(test.enumerate)])) {
        slot = s;
        bind(problem, at + 1, frame);
      }
      slot = kUnbound;
      return;
    }
    std::vector<int> open;
    for (const Term& t : test.literal.args)
      if (t.variable >= 0 && frame[static_cast<std::size_t>(t.variable)] == kUnbound)
        open.push_back(t.variable);
    if (open.empty()) {
      if (ground_.holds(test.literal, frame, state))
        bind(problem, at + 1, frame);
      else
        lack(test, problem.method, frame);
      return;
    }
    bool any = false;
    const auto [first, last] = state.range(test.literal.predicate);
    for (std::size_t i = first; i < last; ++i) {
      const Atom atom = state.entries()[i].atom;
      bool fits = true;
      for (std::size_t k = 0; k < test.literal.args.size() && fits; ++k) {
        const Term& t = test.literal.args[k];
        const Symbol has = ground_.symbol(t, frame);
        if (has == kUnbound)
          frame[static_cast<std::size_t>(t.variable)] = atom.args[k];
        else
          fits = has == kAny || has == atom.args[k];
      }
      if (fits) {
        any = true;
        bind(problem, at + 1, frame);
      }
      for (const int v : open) frame[static_cast<std::size_t>(v)] = kUnbound;
    }
    if (!any) lack(test, problem.method, frame);
  }

  void each(State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    const CompiledStep& s = *item.step;
    struct One {
      Frame frame;
      double order;
    };
    std::vector<One> ones;
    Frame frame = *item.frame;
    for (const int v : s.own) frame[static_cast<std::size_t>(v)] = kUnbound;
    const CompiledMethod& method = *method_of_[&s];
    const std::function<void()> found = [&] {
      const double* value = s.ordered ? state.find(ground_.atom(s.order, frame)) : nullptr;
      ones.push_back({frame, s.ordered && value == nullptr ? 1e9
                             : value != nullptr            ? *value
                                                           : 0.0});
    };
    bind({s.tests, method, state, found}, 0, frame);
    std::stable_sort(ones.begin(), ones.end(),
                     [](const One& a, const One& b) { return a.order < b.order; });
    Agenda next = agenda->rest;
    for (auto o = ones.rbegin(); o != ones.rend(); ++o) {
      Item one;
      one.kind = Item::Kind::one;
      one.step = &s;
      one.frame = std::make_shared<const Frame>(std::move(o->frame));
      one.depth = item.depth;
      for (const Call& call : s.calls) one.min_cost += call_item(call, *one.frame, 0).min_cost;
      if (s.skip_cost > 0) one.min_cost = std::min(one.min_cost, s.skip_cost);
      next = push(one, next);
    }
    step(state, next, cost);
  }

  void one(State& state, const Agenda& agenda, double cost) {
    const Item& item = agenda->item;
    Agenda next = agenda->rest;
    for (auto call = item.step->calls.rbegin(); call != item.step->calls.rend(); ++call)
      next = push(call_item(*call, *item.frame, item.depth), next);
    if (item.step->skip_cost <= 0) return step(state, next, cost);
    std::string mine, *before = std::exchange(here_, &mine);
    const std::size_t lines = tree_.size();
    step(state, next, cost);
    tree_.resize(lines);
    here_ = before;
    const Call& first = item.step->calls.front();
    const Item what = call_item(first, *item.frame, 0);
    const std::string text = first.action
                                 ? planned(domain_, ground_, first.index, *what.frame).text()
                                 : task_text(first.index, *what.frame);
    tree_.push_back(
        {text, item.depth, -1, true, mine.empty() ? "there is no method to do it" : mine});
    step(state, agenda->rest, cost + item.step->skip_cost);
    tree_.resize(lines);
  }

  const Domain& domain_;
  World world_;  // a copy: names of the domain are added
  Ground ground_;
  const Forbidden& forbidden_;
  const PlanLimits limits_;
  // The min cost at which a state was reached with the same calls left to do.
  std::unordered_map<std::uint64_t, double> seen_;
  std::unordered_map<const CompiledStep*, const CompiledMethod*> method_of_;  // of an all
  std::vector<PlannedAction> actions_;
  std::vector<PlanLine> tree_;
  std::uint64_t nodes_{0};
  bool too_deep_{false};
  std::string blame_;
  std::size_t blame_at_{0};
  std::string mismatch_;        // why the present method is not applicable
  std::string* here_{nullptr};  // first reason inside the instance that may be skipped
  Plan best_;
};

}  // namespace

std::string left_out(const Plan& plan) {
  std::string out;
  for (const PlanLine& line : plan.tree)
    if (line.skipped) out += (out.empty() ? "" : "; ") + line.text + ": " + line.reason;
  return out;
}

std::string PlannedAction::text() const {
  const std::string what = object.empty() ? "something" : object;
  switch (kind) {
    case ActionKind::go_to:
      return "go to " + (object.empty() ? "rest" : object);
    case ActionKind::pick:
      return "pick " + what + (human.empty() ? "" : " for " + human);
    case ActionKind::give:
      return "give " + what + (human.empty() ? "" : " to " + human) +
             (both_hands ? " with both hands" : "");
    case ActionKind::receive:
      return "receive " + what + (human.empty() ? "" : " from " + human);
    case ActionKind::drive:
      for (const std::string* target : {&object, &surface, &human})
        if (!target->empty()) return "drive to " + *target;
      return "drive to the place";
    default:
      return std::string(name(kind)) + " " + what + (surface.empty() ? "" : " on " + surface);
  }
}

Plan make_plan(const Domain& domain, const World& world, int task,
               const std::vector<std::string>& args, const Forbidden& forbidden,
               const PlanLimits& limits) {
  return Search(domain, world, forbidden, limits).run(task, args);
}

}  // namespace handsel::supervisor
