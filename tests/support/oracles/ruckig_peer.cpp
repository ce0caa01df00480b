// SPDX-License-Identifier: Apache-2.0
#include "tests/support/oracles/ruckig_peer.hpp"

#include <algorithm>
#include <array>
#include <ruckig/ruckig.hpp>

namespace handsel::test {

using Input = ruckig::InputParameter<kPeerAxes>;
using Numbers = std::array<double, kPeerAxes>;

struct RuckigPeer::Inside {
  explicit Inside(double period) : generator(period) {}
  ruckig::Ruckig<kPeerAxes> generator;
  ruckig::Trajectory<kPeerAxes> trajectory;
  std::vector<Input> inputs;
  Input running;
  ruckig::OutputParameter<kPeerAxes> output;
  bool busy{};
};

RuckigPeer::RuckigPeer(const std::vector<PeerProblem>& problems, double period)
    : inside_(std::make_unique<Inside>(period)) {
  for (const PeerProblem& p : problems) {
    Input& input = inside_->inputs.emplace_back();
    const auto put = [](const double(&x)[kPeerAxes], auto& out) {
      std::copy(std::begin(x), std::end(x), out.begin());
    };
    put(p.from[0], input.current_position);
    put(p.from[1], input.current_velocity);
    put(p.from[2], input.current_acceleration);
    put(p.to[0], input.target_position);
    put(p.to[1], input.target_velocity);
    put(p.to[2], input.target_acceleration);
    put(p.limits[0], input.max_velocity);
    put(p.limits[1], input.max_acceleration);
    put(p.limits[2], input.max_jerk);
  }
}

RuckigPeer::~RuckigPeer() = default;

bool RuckigPeer::solve(std::size_t problem) noexcept {
  const ruckig::Result result =
      inside_->generator.calculate(inside_->inputs[problem], inside_->trajectory);
  return result == ruckig::Result::Working || result == ruckig::Result::Finished;
}

double RuckigPeer::duration() const noexcept { return inside_->trajectory.get_duration(); }

void RuckigPeer::evaluate(double t, double* position, double* velocity,
                          double* acceleration) noexcept {
  Numbers x, v, a;
  inside_->trajectory.at_time(t, x, v, a);
  std::copy(x.begin(), x.end(), position);
  std::copy(v.begin(), v.end(), velocity);
  std::copy(a.begin(), a.end(), acceleration);
}

void RuckigPeer::tick(std::size_t problem) noexcept {
  if (!inside_->busy) inside_->running = inside_->inputs[problem];
  inside_->busy =
      inside_->generator.update(inside_->running, inside_->output) == ruckig::Result::Working;
  inside_->output.pass_to_input(inside_->running);
}

}  // namespace handsel::test
