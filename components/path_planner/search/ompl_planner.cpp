// SPDX-License-Identifier: Apache-2.0
#include "components/path_planner/search/ompl_planner.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <ompl/base/PlannerData.h>
#include <ompl/base/goals/GoalStates.h>
#include <ompl/base/objectives/MechanicalWorkOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/planners/rrt/BiTRRT.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/TRRT.h>
#include <ompl/util/Console.h>

#include "components/path_planner/search/connect.hpp"
#include "components/path_planner/search/random.hpp"
#include "components/path_planner/search/transition_connect.hpp"
#include "components/path_planner/search/transition_rrt.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace handsel::path_planner {
namespace {

Vector to_vector(const ob::State* state, int size) {
  return Eigen::Map<const Vector>(state->as<ob::RealVectorStateSpace::StateType>()->values, size);
}

void to_state(const Vector& q, ob::State* state) {
  Eigen::Map<Vector>(state->as<ob::RealVectorStateSpace::StateType>()->values, q.size()) = q;
}

class Sampler : public ob::StateSampler {
 public:
  Sampler(const ob::StateSpace* ompl_space, const SearchSpace& space, std::uint64_t seed)
      : ob::StateSampler(ompl_space), space_(space), random_(seed) {}
  void sampleUniform(ob::State* state) override {
    to_state(random_.within(space_.lower(), space_.upper()), state);
  }
  void sampleUniformNear(ob::State* state, const ob::State* near, double distance) override {
    const Vector center = to_vector(near, space_.size());
    to_state(random_.within((center.array() - distance).matrix().cwiseMax(space_.lower()),
                            (center.array() + distance).matrix().cwiseMin(space_.upper())),
             state);
  }
  void sampleGaussian(ob::State* state, const ob::State* mean, double deviation) override {
    Vector q = to_vector(mean, space_.size());
    for (double& x : q) x += deviation * random_.normal();
    to_state(q.cwiseMax(space_.lower()).cwiseMin(space_.upper()), state);
  }

 private:
  const SearchSpace& space_;
  Random random_;
};

class Validity : public ob::StateValidityChecker {
 public:
  Validity(const ob::SpaceInformationPtr& si, SearchSpace& space)
      : ob::StateValidityChecker(si), space_(space) {}
  bool isValid(const ob::State* state) const override {
    return space_.free(to_vector(state, space_.size()));
  }

 private:
  SearchSpace& space_;
};

class Motions : public ob::MotionValidator {
 public:
  Motions(const ob::SpaceInformationPtr& si, SearchSpace& space)
      : ob::MotionValidator(si), space_(space) {}
  bool checkMotion(const ob::State* from, const ob::State* to) const override {
    return space_.motion_free(to_vector(from, space_.size()), to_vector(to, space_.size()));
  }
  bool checkMotion(const ob::State* from, const ob::State* to,
                   std::pair<ob::State*, double>& last_valid) const override {
    const Vector a = to_vector(from, space_.size()), b = to_vector(to, space_.size());
    const int last = motion_states(a, b, space_.step()) - 1;
    for (int i = 1; i <= last; ++i) {
      if (space_.free(a + (b - a) * (static_cast<double>(i) / last))) continue;
      last_valid.second = static_cast<double>(i - 1) / last;
      if (last_valid.first) to_state(a + (b - a) * last_valid.second, last_valid.first);
      return false;
    }
    return true;
  }

 private:
  SearchSpace& space_;
};

/// Mechanical work of the human-aware cost, as needed by T-RRT's transition test; with an integral
/// cost every motion would be uphill.
class Work : public ob::MechanicalWorkOptimizationObjective {
 public:
  Work(const ob::SpaceInformationPtr& si, const SearchSpace& space)
      : ob::MechanicalWorkOptimizationObjective(si, 1e-4), space_(space) {}
  ob::Cost stateCost(const ob::State* state) const override {
    return ob::Cost(space_.costs().of(to_vector(state, space_.size())));
  }
  ob::Cost motionCost(const ob::State* from, const ob::State* to) const override {
    const Vector a = to_vector(from, space_.size()), b = to_vector(to, space_.size());
    return ob::Cost(space_.costs().work(a, b) + pathLengthWeight_ * (b - a).norm());
  }

 private:
  const SearchSpace& space_;
};

/// An OMPL planner whose random numbers start from the given seed.
template <class Planner>
class Seeded : public Planner {
 public:
  Seeded(const ob::SpaceInformationPtr& si, std::uint64_t seed) : Planner(si) {
    this->rng_.setLocalSeed(static_cast<std::uint_fast32_t>(Random(seed).bits() >> 33));
  }
};

ob::PlannerPtr stock_planner(const ob::SpaceInformationPtr& si, PlannerKind kind,
                             std::uint64_t seed, const Settings& settings) {
  switch (kind) {
    case PlannerKind::rrt: {
      auto planner = std::make_shared<Seeded<og::RRT>>(si, seed);
      planner->setRange(settings.connect_range);
      return planner;
    }
    case PlannerKind::trrt: {
      auto planner = std::make_shared<Seeded<og::TRRT>>(si, seed);
      planner->setRange(settings.transition_range);
      planner->setInitTemperature(settings.initial_temperature);
      planner->setFrontierThreshold(0.5 * settings.transition_range);
      return planner;
    }
    case PlannerKind::bitrrt: {
      auto planner = std::make_shared<og::BiTRRT>(si);
      planner->setRange(settings.transition_range);
      planner->setInitTemperature(settings.initial_temperature);
      planner->setFrontierThreshold(0.5 * settings.transition_range);
      return planner;
    }
    default: {
      auto planner = std::make_shared<Seeded<og::RRTConnect>>(si, seed);
      planner->setRange(settings.connect_range);
      return planner;
    }
  }
}

/// Returns the min distance between the tree from the start and the goals or the tree from the
/// goals.
double closest_approach(const ob::PlannerData& data, const std::vector<Vector>& goals, int size) {
  constexpr std::size_t kMaxStates = 1500;  // max number of compared states
  std::vector<Vector> from_start, from_goal = goals;
  for (unsigned i = 0; i < data.numVertices(); ++i) {
    const ob::PlannerDataVertex& vertex = data.getVertex(i);
    if (vertex.getState() == nullptr) continue;
    (vertex.getTag() == 2 ? from_goal : from_start).push_back(to_vector(vertex.getState(), size));
  }
  if (from_start.size() > kMaxStates)
    from_start.erase(from_start.begin(), from_start.end() - kMaxStates);
  if (from_goal.size() > kMaxStates) from_goal.resize(kMaxStates);
  double min_distance = std::numeric_limits<double>::infinity();
  for (const Vector& a : from_start)
    for (const Vector& b : from_goal) min_distance = std::min(min_distance, (a - b).squaredNorm());
  return std::sqrt(min_distance);
}

}  // namespace

BatchPlanner::BatchPlanner(const ob::SpaceInformationPtr& si, SearchSpace& space, PlannerKind kind,
                           std::uint64_t seed)
    : ob::Planner(si, kind == PlannerKind::trrt     ? "BatchTRRT"
                      : kind == PlannerKind::bitrrt ? "BatchBiTRRT"
                                                    : "BatchRRTConnect"),
      space_(space),
      kind_(kind),
      seed_(seed) {
  specs_.directed = true;
}

ob::PlannerStatus BatchPlanner::solve(const ob::PlannerTerminationCondition& stop) {
  checkValidity();
  const ob::State* start = pis_.nextStart();
  if (start == nullptr || to_vector(start, space_.size()) != space_.start())
    return ob::PlannerStatus::INVALID_START;
  std::vector<Vector> goals;
  while (const ob::State* goal = pis_.nextGoal()) goals.push_back(to_vector(goal, space_.size()));
  if (goals.empty()) return ob::PlannerStatus::INVALID_GOAL;
  space_.stop_when([&stop, is_evaluating = false]() mutable {
    if (is_evaluating) return false;  // the condition may call exhausted()
    is_evaluating = true;
    const bool stops = stop.eval();
    is_evaluating = false;
    return stops;
  });
  found_ = kind_ == PlannerKind::trrt     ? transition_rrt(space_, goals, seed_)
           : kind_ == PlannerKind::bitrrt ? transition_connect(space_, goals, seed_)
                                          : connect(space_, goals, seed_);
  space_.stop_when({});
  if (found_.path.empty()) return ob::PlannerStatus::TIMEOUT;
  auto path = std::make_shared<og::PathGeometric>(si_);
  ob::State* state = si_->allocState();
  for (const Vector& q : found_.path) {
    to_state(q, state);
    path->append(state);
  }
  si_->freeState(state);
  pdef_->addSolutionPath(path, false, 0.0, getName());
  return ob::PlannerStatus::EXACT_SOLUTION;
}

void BatchPlanner::clear() {
  ob::Planner::clear();
  found_ = {};
  states_.clear();
}

void BatchPlanner::getPlannerData(ob::PlannerData& data) const {
  ob::Planner::getPlannerData(data);
  states_.clear();
  for (std::size_t side = 0; side < found_.trees.size(); ++side) {
    const Tree& tree = found_.trees[side];
    const std::size_t first = states_.size();
    for (int i = 0; i < tree.size(); ++i) {
      states_.push_back(std::shared_ptr<ob::State>(
          si_->allocState(), [si = si_](ob::State* state) { si->freeState(state); }));
      to_state(tree[i], states_.back().get());
      const ob::PlannerDataVertex vertex(states_.back().get(), static_cast<int>(side) + 1);
      if (tree.parent(i) < 0)
        side == 0 ? data.addStartVertex(vertex) : data.addGoalVertex(vertex);
      else
        data.addEdge(
            ob::PlannerDataVertex(states_[first + static_cast<std::size_t>(tree.parent(i))].get(),
                                  static_cast<int>(side) + 1),
            vertex);
    }
  }
}

Found search_with_ompl(SearchSpace& space, const std::vector<Vector>& goals, PlannerKind kind,
                       bool stock, std::uint64_t seed) {
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  const int n = space.size();
  auto ompl_space = std::make_shared<ob::RealVectorStateSpace>(n);
  ob::RealVectorBounds bounds(n);
  for (int i = 0; i < n; ++i) {
    // A start at a joint limit may be beyond it by rounding, and is valid nevertheless.
    bounds.setLow(i, std::min(space.lower()[i], space.start()[i]));
    bounds.setHigh(i, std::max(space.upper()[i], space.start()[i]));
  }
  ompl_space->setBounds(bounds);
  std::uint64_t sampler_seed = seed;
  ompl_space->setStateSamplerAllocator(
      [&](const ob::StateSpace* s) { return std::make_shared<Sampler>(s, space, sampler_seed++); });
  auto si = std::make_shared<ob::SpaceInformation>(ompl_space);
  si->setStateValidityChecker(std::make_shared<Validity>(si, space));
  si->setMotionValidator(std::make_shared<Motions>(si, space));
  // BiT-RRT connects its trees within ten times this length.
  ompl_space->setLongestValidSegmentFraction(std::min(1.0, 0.3 / ompl_space->getMaximumExtent()));
  si->setup();

  auto definition = std::make_shared<ob::ProblemDefinition>(si);
  ob::ScopedState<> state(si);
  to_state(space.start(), state.get());
  definition->addStartState(state);
  auto goal_states = std::make_shared<ob::GoalStates>(si);
  goal_states->setThreshold(1e-9);
  for (const Vector& goal : goals) {
    to_state(goal, state.get());
    goal_states->addState(state);
  }
  definition->setGoal(goal_states);
  if (kind == PlannerKind::trrt || kind == PlannerKind::bitrrt)
    definition->setOptimizationObjective(std::make_shared<Work>(si, space));

  const ob::PlannerPtr planner =
      stock ? stock_planner(si, kind, seed, space.settings())
            : ob::PlannerPtr(std::make_shared<BatchPlanner>(si, space, kind, seed));
  planner->setProblemDefinition(definition);
  planner->setup();
  const ob::PlannerStatus status =
      planner->solve(ob::PlannerTerminationCondition([&space] { return space.exhausted(); }));

  Found found;
  if (!stock) {
    found = static_cast<BatchPlanner&>(*planner).take();
  } else {
    ob::PlannerData data(si);
    planner->getPlannerData(data);
    found.nodes = data.numVertices();
    if (status != ob::PlannerStatus::EXACT_SOLUTION)
      found.closest = closest_approach(data, goals, n);
  }
  if (status != ob::PlannerStatus::EXACT_SOLUTION) return found;
  found.path.clear();
  for (const ob::State* s : definition->getSolutionPath()->as<og::PathGeometric>()->getStates())
    found.path.push_back(to_vector(s, n));
  double min_distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < goals.size(); ++i) {
    const double d = (goals[i] - found.path.back()).norm();
    if (d < min_distance) {
      min_distance = d;
      found.goal = i;
    }
  }
  found.path.back() = goals[found.goal];
  return found;
}

}  // namespace handsel::path_planner
