// SPDX-License-Identifier: Apache-2.0
// A path as the nodes of a broken line.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace handsel {

/// Returns the rest of `path` (nodes) from `q`: `q` and the nodes after the point nearest to it;
/// empty when `q` is farther than `reach` from it (max norm), or at its end.
std::vector<Eigen::VectorXd> remainder(const std::vector<Eigen::VectorXd>& path,
                                       const Eigen::VectorXd& q, double reach);

}  // namespace handsel
