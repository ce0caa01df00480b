// SPDX-License-Identifier: Apache-2.0
// Runs planners in OMPL's framework: planners of this component as OMPL planners, and OMPL's
// planners on the space, samples, checks and costs of this component.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <ompl/base/Planner.h>

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// RRT-Connect, T-RRT or bidirectional T-RRT of this component as an OMPL planner. The space checks
/// whole edges instead of states through OMPL's callbacks. Start and goals are those of the problem
/// definition; the start must equal the start of the space.
class BatchPlanner : public ompl::base::Planner {
 public:
  BatchPlanner(const ompl::base::SpaceInformationPtr& si, SearchSpace& space, PlannerKind kind,
               std::uint64_t seed);
  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& stop) override;
  void clear() override;
  void getPlannerData(ompl::base::PlannerData& data) const override;
  Found take() { return std::move(found_); }  ///< Returns path and trees; to be called once.

 private:
  SearchSpace& space_;
  PlannerKind kind_;
  std::uint64_t seed_;
  Found found_;
  // referenced by the returned data
  mutable std::vector<std::shared_ptr<ompl::base::State>> states_;
};

/// Searches like search(), through OMPL: with OMPL's planner of that name or the one of this
/// component.
Found search_with_ompl(SearchSpace& space, const std::vector<Vector>& goals, PlannerKind kind,
                       bool stock, std::uint64_t seed);

}  // namespace handsel::path_planner
