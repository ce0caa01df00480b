// The human-aware manipulation planner (MHP, chapter section 2.1): brings grasp, path and
// trajectory planner together to carry out one action. Pure: messages come in, time comes in,
// messages go out through the Outbox.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/pace.hpp"
#include "common/collision/collision_world.hpp"
#include "common/config/schema/manipulation_planner.pb.h"
#include "common/cost/human_cost.hpp"
#include "common/messages/attention.hpp"
#include "common/messages/execution.hpp"
#include "common/messages/planning.hpp"
#include "common/messages/task.hpp"
#include "common/messages/world.hpp"
#include "common/model/manipulator.hpp"
#include "common/model/robot_model.hpp"
#include "common/trajectory/switch.hpp"
#include "components/manipulation_planner/clients.hpp"
#include "components/manipulation_planner/handover/otp_search.hpp"
#include "components/manipulation_planner/motion/motion_end.hpp"
#include "components/manipulation_planner/motion/retreat_planner.hpp"
#include "components/manipulation_planner/outbox.hpp"
#include "components/manipulation_planner/placing/place_search.hpp"
#include "components/manipulation_planner/routine.hpp"
#include "components/manipulation_planner/snapshot.hpp"
#include "components/manipulation_planner/worker.hpp"

namespace handsel::manipulation_planner {

class ManipulationPlanner {
 public:
  /// `client` makes request ids unique over restarts; trajectory and hand command ids start above
  /// it.
  ManipulationPlanner(const config::ManipulationPlannerSettings& settings, std::shared_ptr<const RobotModel> robot, ObjectLibrary objects,
                      std::uint64_t client, CostSettings cost = {});

  /// Begins an action in place of the one that runs, or cancels the one with that id. A goal with
  /// the id of the last action changes nothing.
  void on(const ActionGoal& goal);
  /// Takes the newest scene; objects, boxes and base of the robot in the world frame.
  void on(const Scene& scene) { snapshot_.on(scene); }
  /// Takes the newest people, joints in the world frame.
  void on(const HumanState& people) { snapshot_.on(people); }
  /// Takes the facts that hold now; they replace all before.
  void on(const Facts& facts) { snapshot_.on(facts); }
  /// `sent`: when its writer sent the layer.
  void on(const Costmap& layer, TimePoint sent, TimePoint now) { snapshot_.on(layer, sent, now); }
  /// Takes the advised period of replanning and the gain of the human-aware cost; both hold for a
  /// moment only.
  void on(const AttentionAdvice& advice, TimePoint now) {
    live_pace_.advise(advice.replan_period, now);
    cost_gain_ = advice.cost_gain;
  }
  /// Takes the newest report of the controller: what holds the robot back, and how its command
  /// goes.
  void on(const ExecutionStatus& status) { snapshot_.on(status); }
  /// Takes what the controller runs, and its set point: the joints as commanded.
  void on(const ActiveTrajectory& active) { snapshot_.on(active); }
  /// Takes a reply; ignored unless it answers the newest request.
  void on(const GraspReply& reply) { clients_.grasp.on(reply); }
  /// Takes a reply; ignored unless it answers the newest request.
  void on(const RegraspReply& reply) { clients_.regrasp.on(reply); }
  /// Takes a reply; ignored unless it answers the newest request.
  void on(const PathReply& reply) { clients_.path.on(reply); }
  /// Takes a reply; ignored unless it answers the newest request or the comparison that was asked
  /// for.
  void on(const TrajectoryReply& reply);
  /// Counts one job of the outbox as ended; what it wrote may be read from now on.
  void job_done() { worker_.job_done(); }

  /// What became of running paths.
  struct LiveCounts {
    /// Asked for; came back as they were; cheaper but longer; switched to; refused before the
    /// switch; kept, but timed anew.
    std::uint64_t looks{}, kept{}, slower{}, taken{}, refused{}, retimed{};
  };
  /// Returns the counts since the start of the planner.
  const LiveCounts& live_counts() const { return live_counts_; }

  /// Carries the action on to `now` and adds to the outbox what it wants sent; called periodically,
  /// from one thread.
  void step(TimePoint now, Outbox& out);
  /// Returns the state of the action that runs or ran last, as of the last step().
  const ActionStatus& status() const { return status_; }
  /// Returns which cost layer was left out and why, one sentence; empty: none was.
  std::string complaint(TimePoint now) { return snapshot_.complaint(now); }

 private:
  static constexpr double kAnyLength = 1e9;
  struct Motion {
    ActionPhase phase{};
    std::vector<Vector> goals;  // arm axes, alternatives
    bool straight{false};
    std::vector<std::string> allowed;
    // the plan keeps clearance to these, but a brush foreseen on the path is no reason to hold
    std::vector<std::string> tolerated;
    double speed{1.0};
    double longest{kAnyLength};  // a path that is longer is none, sum of the legs' max norms [rad]
    double think{};              // for the path at most [s]; 0: as set
    // the goals are handover configurations for this person, chosen anew as they move; empty: they
    // stay
    std::string receiver;
    Vector3 receiver_at{Vector3::Zero()};  // their torso when the goals were chosen, world [m]
    // the motion ends when this person takes hold of what is held; empty: nobody
    std::string yields_to;
    // object that is to stay within aim_slack [m] of p_world_aim until the motion ends; empty: none
    std::string aims_at;
    Vector3 p_world_aim{Vector3::Zero()};
    double aim_slack{};
    double patience{std::numeric_limits<double>::infinity()};  // given up when it takes longer [s]
    std::string makes_room_for;                                // ends when this person offers what the goal is about ...
    bool any_offer{};                                          // ... however little room they have
    std::optional<Grasp> follows;                              // led before where that grasp is now, while it moves
  };
  struct PlannedPath {
    Outcome outcome;
    std::vector<Vector> nodes;
    std::string start_touches;  // why there is no path: the robot touches this where it stands
  };
  /// What the controller runs, and the path it came from.
  struct Running {
    std::uint64_t command{};
    double duration{};  // of its trajectory [s]
    std::vector<Vector> nodes;
    Vector speeds;  // as in TrajectoryReply, of the legs between the nodes
  };
  /// A path that is offered while another runs.
  struct Ways {
    std::optional<Trajectory> over;  // onto it; empty: nothing leads there
    // the old one, timed for the people as they are now; empty: it must be left
    std::optional<Trajectory> along;
    bool worth{true};  // switching to it
    // of the velocity limits, that what leads over keeps where it is not faster already
    double share{1};
    double reach{};  // joined at most this far from where the old one is left, max norm [rad]
  };
  /// Where the path that runs would be left, and what runs from there on.
  struct Leave {
    double at{}, offset{};  // on the time of what runs; of that at which its trajectory began [s]
    MotionState3 from;
    bool standing{};
    double rest{};  // of what runs, from there on, at full speed [s]
  };
  struct GraspList {
    Outcome outcome;
    std::vector<Grasp> grasps;
  };
  struct HandResult {
    Outcome outcome;
    HandState state{};
  };
  /// Where what is taken by a grasp can be put down.
  struct Destination {
    std::uint64_t grasp{};
    std::string object, surface;
    Pose T_world_object;
  };
  struct Serving {
    Outcome outcome;
    std::map<std::size_t, Destination> at;  // by the grasp's place in the list
    std::string objections;                 // why the others do not serve on the last surface
  };

  // Actions.
  Routine<Outcome> run(ActionGoal goal);
  /// `onto`: the surface it will be put down on, empty if that is not known.
  Routine<Outcome> pick(const std::string& object, const std::string& for_human, const std::string& onto);
  /// A person out of reach is waited for until that time.
  Routine<Outcome> keep_givable(std::vector<Grasp>& grasps, const std::string& object, const std::string& human, TimePoint patience);
  Routine<Outcome> try_grasp(const std::string& object, const std::string& for_human, const Grasp& grasp);
  Routine<Outcome> lift(const std::string& object, const std::string& for_human);
  Routine<Outcome> give(const std::string& object, const std::string& human);
  Routine<Outcome> place(const std::string& object, const std::string& surface);
  /// What is held, to above its place and down to it.
  Routine<Outcome> lower(const PuttingPosture& posture);
  /// `wanted` empty: whatever is offered; `giver` empty: whoever offers; `onto` as of pick(),
  /// empty: any surface.
  Routine<Outcome> receive(const std::string& wanted, const std::string& giver, const std::string& onto);
  /// `attempt`, from 1: the later, the longer may the path of the arm be.
  Routine<Outcome> take(const std::string& object, const std::string& giver, const Grasp& grasp, std::uint32_t attempt);
  Motion approach_to(const std::string& object, const std::string& giver, const Grasp& grasp, std::uint32_t attempt) const;
  /// Leaves the grasps whose approach and closing fingers keep clearance to the giver's hand, as it
  /// is seen now; with none left the result says so.
  Routine<Outcome> keep_off_fingers(const std::string& object, const std::string& giver, std::vector<Grasp>& grasps);
  /// From the offered object with the hand opened, along the path it came; the result is `why`.
  Routine<Outcome> draw_back(const std::string& object, const std::string& giver);
  Routine<Outcome> step_back(const std::string& object, const std::string& giver);
  Routine<Outcome> back_off(const std::string& object, const std::string& giver, const Grasp& grasp, const Outcome& why);
  /// An object and the person that offers it.
  struct Offer {
    std::string object, giver;
  };
  /// Retreats the hand where it leaves no room for an offer; nullopt: nothing was offered until
  /// that time.
  Routine<std::optional<Offer>> watch_for_offer(const std::string& wanted, const std::string& giver, TimePoint patience);
  /// The arm at rest, or moved from there as little as gives room before this person, else as far
  /// as it goes; nearest to rest first.
  std::vector<Vector> postures_before(const Person&) const;
  /// To one of these. `for_offer`: only until there is one.
  Routine<Outcome> make_room(const std::string& giver, bool for_offer = false);
  /// How much farther than it must be hand and arm are, in this configuration, from where this
  /// person would make an offer [m].
  double room_before(const Person&, const Vector& posture) const;
  bool crowds(const std::string& giver) const;
  bool room_is_made(const Motion& motion) const;
  bool holds_out(const Person& who, const SceneObject& held) const;
  void watch_offer();
  /// A step toward the hand that is near what they hold.
  bool comes_on(const std::string& giver) const;
  bool still_offered() const;  ///< the accepted object is offered, or was so just now
  std::optional<Offer> offered(const std::string& wanted, const std::string& giver) const;
  /// The grasp for where the object is now; nullopt: the arm does not reach it there.
  std::optional<Grasp> aimed(const std::string& object, const Grasp& grasp) const;
  bool strayed(const Motion& motion) const;
  /// A hand of that person has come to what the robot holds.
  bool comes_to_hand() const;
  bool takes_hold(const std::string& who) const;
  /// A hand of theirs is at it.
  bool at_hand_of(const std::string& who, const std::string& object) const;
  /// Other goals when what it aims at was shifted: for where that is now; nullopt: it was not, or
  /// the arm does not reach there.
  std::optional<Vector3> follow_offer(Motion& motion);
  Routine<Outcome> go_to_rest();

  // Two hands (actions/regrasp.cpp).
  struct RegraspSteps {
    Outcome outcome;
    std::vector<RegraspStep> steps;
  };
  /// What follows is done with that arm and its hand, as what they hold now.
  Routine<Outcome> use_arm(const std::string& arm);
  Routine<RegraspSteps> ask_regrasp(const std::string& object, const Pose& T_world_goal, bool both);
  Routine<Outcome> regrasp(const ActionGoal& goal);
  /// Until the scene has it standing somewhere, for a moment: what was just put down may still seem
  /// to be held.
  Routine<Outcome> wait_standing(const std::string& object);
  /// Where the object can stand: where the goal says, else free places on its surface, the nearest
  /// to an arm first.
  std::vector<Pose> places_for(const ActionGoal& goal, const SceneObject& object, const ObjectModel& model) const;
  Routine<Outcome> pass(const std::string& object, const RegraspStep& step);
  std::optional<Vector> meeting_posture(const RegraspStep& step) const;
  Routine<Outcome> put_down(const std::string& object, const RegraspStep& step);
  Routine<Outcome> let_go(const std::string& object, const Vector& closed, const Vector& after);
  Routine<Outcome> others_to_rest();
  Routine<Outcome> rest_all();
  Routine<Outcome> take_over(const std::string& object, const Grasp& grasp);
  Routine<Outcome> make_room();
  Vector3 p_world_shoulder() const;  // of the arm in use
  /// Both hands on it, up, over and down in a closed chain (actions/carry.cpp).
  Routine<Outcome> carry(const ActionGoal& goal);
  Routine<Outcome> take_together(const std::string& object, const RegraspStep& first, const RegraspStep& second);
  Routine<Outcome> grip(const Grasp& grasp, double share_of_mass);
  Routine<Outcome> move_together(const std::string& object, const std::string& follower, const std::vector<Pose>& T_world_object);
  Routine<Outcome> run_to_end(const TrajectoryCommand& command);
  HandState hand_state() const;
  std::string hand_name() const { return hand_ == 0 ? "" : fingers_.name; }  // as messages have it
  bool holds(const std::string& object) const;                               // the hand in use holds it, as the scene has it

  // Parts of actions. References are to what lives in the frame of the routine that awaits.
  Routine<GraspList> ask_grasps(const std::string& object, const std::string& for_human, std::uint32_t most);
  /// Which of the grasps, the first `most` of them, serve at one of the best `places` of the
  /// surface too (`onto` empty: of any), and where.
  Routine<Serving> serving(const std::string& object, const std::string& onto, const std::vector<Grasp>& grasps, std::size_t most,
                           std::size_t places);
  /// Grasps that serve at a free place of that surface too, which place() then tries first; if
  /// there is none, any.
  Routine<GraspList> ask_grasps_onto(const std::string& object, const std::string& surface);
  Routine<PlannedPath> plan_path(const Vector& start, const Motion& motion);
  Routine<Outcome> move(const Motion& motion);
  Routine<Outcome> execute(const std::vector<Vector>& nodes, Motion& motion);
  /// Returns how the motion of `command` ended; a motion of another command that still runs is
  /// stopped first, or it would go on while the next one is planned.
  Routine<Outcome> end_motion(std::uint64_t command);
  /// Ends whatever motion runs.
  Routine<Outcome> stop_motion();
  Routine<Outcome> send(const TrajectoryCommand& command);
  Routine<Outcome> go_on(Running& running, const Motion& motion);
  Routine<Outcome> go_over(Running& running, const Motion& motion, const Leave& leave, const std::shared_ptr<Ways>& ways,
                           const TrajectoryReply& timed, const std::vector<Vector>& nodes);
  /// The path that runs, as it would be timed for the people as they are now, where that makes a
  /// difference.
  Routine<Outcome> retime(Running& running, const Motion& motion, const Leave& leave, const std::vector<Vector>& nodes);
  bool gone(const Running& running) const;
  bool slipped() const;
  bool in_hand(const SceneObject& held) const;  ///< it is where the hand has hold of it
  void halt();
  void lose_object();
  /// Other goals when the receiver has moved so far that `goal` (arm axes) is no good handover
  /// configuration any more; true: it is none, even where there is no other.
  Routine<bool> follow(Motion& motion, const Vector& goal);
  struct ExchangeChoice {
    Outcome outcome;
    ExchangeSearch search;
    std::optional<double> kept;  // cost of the pose that was asked about
  };
  Routine<ExchangeChoice> choose_exchange(const std::string& receiver, const Pose* T_world_object);
  static void lead_to(const ExchangeSearch& search, const Person& receiver, Motion& motion);
  PathRequest path_request(const Vector& start, const Motion& motion);
  using TrajectoryClient = Client<TrajectoryRequest, TrajectoryReply>;
  TrajectoryRequest trajectory_request(TrajectoryClient& client, const std::vector<Vector>& nodes, const Vector& start,
                                       const Motion& motion);
  TrajectoryCommand command_for(const Trajectory& trajectory, const Motion& motion);
  /// What a motion that leads over from one trajectory to another is checked in.
  struct Around {
    Scene scene;
    HumanState people;
    LayersNow layers;
    Attachment attachment;
    std::vector<std::string> allowed;
    Vector posture;       // axes that are not the arm's
    double cost_gain{1};  // factor of what is saved of the human-aware cost, as attention has it
  };
  void weigh(Ways& ways, CollisionWorld& world, const Around& around, const MotionState3& from, bool standing) const;
  double cost_at(const Vector& q, const Vector& posture) const;
  double cost_along(const Trajectory& trajectory, const Vector& posture, double level) const;
  Switched join(const MotionState3& from, const Trajectory& to, const Ways& ways) const;
  std::optional<Trajectory> lead_over(CollisionWorld& world, const Around& around, const MotionState3& from, const Ways& ways) const;
  /// `share_of_mass`: of what is grasped, that this hand bears.
  Routine<HandResult> hand(HandAction action, const Vector& position, double timeout, const Vector* effort = nullptr,
                           double share_of_mass = 1.0);
  /// The same, only until the controller has acknowledged the command.
  Routine<Outcome> tell_hand(HandAction action, const Vector& position, const Vector* effort = nullptr, double share_of_mass = 1.0);
  Routine<Outcome> hand_opened();  ///< after it was commanded to move
  Routine<Outcome> withdraw(const std::string& touched, const Motion& next);
  Routine<Outcome> retreat(const std::string& allowed_person, const std::string& object);

  double time_to_exchange() const;  // as foreseen [s]
  bool at_rest() const;
  bool may_move() const;
  Outcome not_permitted() const;
  // the arm as commanded, hand and head as measured: gripping fingers are commanded beyond what
  // they touch
  Vector posture() const;
  void hold(const SceneObject& object);
  void release_object();
  void drop_action();
  void refuse(const std::string& what, const std::string& reason);
  static void place_world(CollisionWorld& world, const Scene& scene, const HumanState& people);
  Pose T_world_tool() const;
  std::optional<Vector> reach(const Pose& T_world_tool) const;
  // directions in the world, the likeliest first
  std::vector<Vector3> ways_out(const std::string& touched) const;

  config::ManipulationPlannerSettings settings_;
  std::shared_ptr<const RobotModel> robot_;
  std::vector<Manipulator> hands_;  // of the robot; the one in use:
  std::size_t hand_{0};
  Group arm_, fingers_;
  int palm_;
  WayOut way_out_;
  Pace live_pace_;  // of looking at the motion that runs
  double cost_gain_{1};

  Waiting waiting_;
  Outbox outbox_;
  Clients clients_;
  Worker worker_;
  Routine<Outcome> action_;
  ActionGoal goal_;
  Offer taken_up_;  // by receive; empty: none
  // nothing was offered farther out for so long that what is held before the body counts as offered
  bool waited_long_{};
  // the hand, while it moves: motions are planned for what it will be
  std::optional<Vector> opens_to_;
  bool at_offer_{};  // the hand, from the straight approach until the retreat has ended
  ActionStatus status_;

  Snapshot snapshot_;
  TimePoint free_at_{}, held_back_at_{}, held_at_{}, offered_at_{};
  // how long the forecast, or a person too near, has held the robot back [s]
  double blocked_for_{0};
  bool too_near_{false};
  // what a dropped action has set in motion is to end, until the controller has acknowledged it
  std::optional<TrajectoryCommand> halt_;
  TimePoint halted_at_{};

  Attachment attachment_;
  std::optional<Grasp> grasp_;
  std::vector<Destination> destinations_;
  LiveCounts live_counts_;
  // Used by jobs only, which run one after the other.
  std::shared_ptr<HumanCost> cost_;
};

}  // namespace handsel::manipulation_planner
