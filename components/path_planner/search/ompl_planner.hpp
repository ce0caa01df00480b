// Planners in OMPL's harness: those of this component as one of its planners, and those of OMPL, on
// the space, samples, checks and costs of this component.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <ompl/base/Planner.h>

#include "components/path_planner/search/search.hpp"

namespace handsel::path_planner {

/// RRT-Connect, T-RRT or bidirectional T-RRT of this component. Whole edges are checked at once by
/// the space, not state by state through OMPL's callbacks; start and goals come from the problem
/// definition, the start must be that of the space.
class BatchPlanner : public ompl::base::Planner {
 public:
  BatchPlanner(const ompl::base::SpaceInformationPtr& si, SearchSpace& space, PlannerKind kind,
               std::uint64_t seed);
  ompl::base::PlannerStatus solve(const ompl::base::PlannerTerminationCondition& stop) override;
  void clear() override;
  void getPlannerData(ompl::base::PlannerData& data) const override;
  Found take() { return std::move(found_); }  ///< what was found, with the trees; once

 private:
  SearchSpace& space_;
  PlannerKind kind_;
  std::uint64_t seed_;
  Found found_;
  // that the data given out points to
  mutable std::vector<std::shared_ptr<ompl::base::State>> states_;
};

/// As `search`, through OMPL: its planner of that name, or that of this component.
Found search_with_ompl(SearchSpace& space, const std::vector<Vector>& goals, PlannerKind kind,
                       bool stock, std::uint64_t seed);

}  // namespace handsel::path_planner
