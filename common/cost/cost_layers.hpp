// SPDX-License-Identifier: Apache-2.0
// The layers of the cost map that count now, as their writers send them. Pure.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/cost/cost_grid.hpp"

namespace handsel {

struct OutsideCost {
  double cost{};  ///< weighted sum over the layers; what a layer forbids costs 1 there
  const CostGrid* forbidden_by{};  ///< null: by none
};

struct LayersNow {
  /// Arm comfort of comfort->person(), validated against the furniture; or null.
  std::shared_ptr<const CostGrid> comfort;
  /// What others add, in the order of their names.
  std::vector<std::shared_ptr<const CostGrid>> outside;

  /// Returns the comfort layer when it is about this person, else nullptr.
  const CostGrid* comfort_of(const std::string& person) const {
    return comfort && comfort->person() == person ? comfort.get() : nullptr;
  }
  /// Returns what outside layers add at a place in the world [m].
  OutsideCost outside_cost(const Vector3& p) const;
};

/// Keeps the newest "arm_comfort" and every outside layer. What cannot be used is left out, counted
/// and named.
class CostLayers {
 public:
  /// `stale`: a layer last sent longer ago counts no more.
  explicit CostLayers(Duration stale = std::chrono::seconds(1)) : stale_(stale) {}

  /// Takes a sample of a layer; a faulty or stale one is left out; "safety", "visibility" and
  /// "total" are ignored. `sent`: when its writer sent it, on the clock of `now`.
  void put(const Costmap& map, TimePoint sent, TimePoint now);
  /// Returns the layers that are not stale at `now`; drops those that are.
  LayersNow at(TimePoint now);

  /// Returns the number of samples with a fault or sent too long ago, and layers that fell silent.
  std::uint64_t left_out() const { return left_out_; }
  /// Returns what was left out last, one sentence; empty when that layer came again since, or ten
  /// seconds have passed.
  std::string complaint(TimePoint now);

 private:
  struct Kept {
    std::shared_ptr<const CostGrid> grid;
    TimePoint sent;
  };
  void leave_out(const std::string& layer, const std::string& why, TimePoint now);
  void forget_stale(TimePoint now);
  std::string too_old(const std::string& layer) const;

  Duration stale_;
  std::map<std::string, Kept> kept_;
  std::uint64_t left_out_{0};
  std::string complaint_, complained_about_;
  TimePoint complained_{};
};

}  // namespace handsel
