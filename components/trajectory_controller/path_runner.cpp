#include "components/trajectory_controller/path_runner.hpp"

#include "components/trajectory_controller/setpoint_check.hpp"

namespace handsel::trajectory_controller {

std::string PathRunner::start(const Trajectory& trajectory, const KinematicLimits& limits, double factor) {
  if (std::string why = law_.init(trajectory, limits, dt_, std::clamp(factor, 0.0, 1.0)); !why.empty()) return why;
  trajectory_ = trajectory;
  limits_ = limits;
  finished_ = law_.finished();
  state_ = law_.state();
  return {};
}

bool PathRunner::step(double wanted) noexcept {
  if (finished_) return true;
  law_.set_target(law_.time() <= 0.0 ? std::max(0.0, wanted) : wanted);
  law_.advance(dt_);
  const MotionState3& next = law_.state();
  for (Eigen::Index i = 0; i < next.position.size(); ++i)
    if (!acceptable(state_, next, i, limits_, dt_)) return false;
  state_ = next;
  finished_ = law_.finished();
  return true;
}

}  // namespace handsel::trajectory_controller
