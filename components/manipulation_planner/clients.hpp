// SPDX-License-Identifier: Apache-2.0
// Requests to the other planners: their ids, retries, timeouts and cancellation.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/config/settings/manipulation_planner.hpp"
#include "common/messages/planning.hpp"
#include "components/manipulation_planner/outbox.hpp"
#include "components/manipulation_planner/routine.hpp"

namespace handsel::manipulation_planner {

/// Numbers requests and commands.
class Ids {
 public:
  /// `client` makes request ids unique over restarts; command ids start above it.
  explicit Ids(std::uint64_t client) : client_(client), commands_(client) {}

  /// Returns the id of a new request.
  RequestId next_request() { return {client_, ++requests_}; }
  /// Returns the id of the newest request to any planner.
  RequestId newest_request() const { return {client_, requests_}; }
  /// Returns the id of a new trajectory or hand command.
  std::uint64_t next_command() { return ++commands_; }

 private:
  std::uint64_t client_, requests_{0}, commands_;
};

/// Which replies a client accepts.
enum class Accepts {
  newest,  ///< only the reply to the newest request to any planner
  own,     ///< the reply to the newest request of this client
};

/// Timing of the requests of a client.
struct ClientSettings {
  double retry{};                    ///< period at which an unanswered request is sent again [s]
  double timeout{};                  ///< without a reply for this long a request has failed [s]
  Accepts accepts{Accepts::newest};  ///< which replies count
};

/// One kind of request: at most one of them waits for its reply.
template <class Request, class Reply>
class Client {
 public:
  /// `queue`: where requests are put to be sent; the references must outlive the client.
  Client(Ids& ids, Waiting& waiting, std::vector<Request>& queue, const ClientSettings& settings)
      : ids_(ids), waiting_(waiting), queue_(queue), settings_(settings) {}

  /// Gives the request the next id and drops the last reply.
  void open(Request& request) {
    request.id = id_ = ids_.next_request();
    reply_.reset();
    is_unanswered_ = true;
  }
  /// Sends a request once.
  void send(const Request& request) { queue_.push_back(request); }
  /// Sends an opened request again and again until its reply has come; a duplicate is harmless.
  /// Returns false if no reply has come in time. `request` must outlive the routine.
  Routine<bool> ask(const Request& request) {
    const auto has_come = [this] { return reply_.has_value(); };
    for (double waited = 0; !reply_ && waited < settings_.timeout; waited += settings_.retry) {
      send(request);
      co_await waiting_.until(has_come, settings_.retry);
    }
    co_return reply_.has_value();
  }
  /// Takes a reply; ignored unless this client accepts it.
  void on(const Reply& reply) {
    const RequestId expected = settings_.accepts == Accepts::own ? id_ : ids_.newest_request();
    if (reply.id != expected) return;
    reply_ = reply;
    is_unanswered_ = false;
  }
  /// Returns the reply to the opened request; nullopt: none has come.
  const std::optional<Reply>& reply() const { return reply_; }

  /// Marks the opened request, if it is unanswered, as of no further use.
  void drop() { is_dropped_ = is_unanswered_; }
  /// Returns once whether a request was dropped that the other planner must be asked to cancel.
  bool take_dropped() {
    if (!is_dropped_) return false;
    is_dropped_ = is_unanswered_ = false;
    return true;
  }

 private:
  Ids& ids_;
  Waiting& waiting_;
  std::vector<Request>& queue_;
  ClientSettings settings_;
  RequestId id_{};
  std::optional<Reply> reply_;
  bool is_unanswered_{false}, is_dropped_{false};
};

/// The requests to all planners, under ids of one sequence.
struct Clients {
  /// The references must outlive what is made.
  Clients(std::uint64_t client, Outbox& outbox, Waiting& waiting,
          const settings::ManipulationPlannerSettings& s)
      : ids(client),
        grasp(ids, waiting, outbox.grasp_requests, {s.request_retry, s.request_timeout}),
        regrasp(ids, waiting, outbox.regrasp_requests, {s.request_retry, s.regrasp_timeout}),
        path(ids, waiting, outbox.path_requests, {s.request_retry, s.request_timeout}),
        trajectory(ids, waiting, outbox.trajectory_requests, {s.request_retry, s.request_timeout}),
        comparison(ids, waiting, outbox.trajectory_requests,
                   {s.request_retry, s.request_timeout, Accepts::own}) {}

  Ids ids;                                                ///< of requests and commands
  Client<GraspRequest, GraspReply> grasp;                 ///< lists of grasps
  Client<RegraspRequest, RegraspReply> regrasp;           ///< plans for two hands
  Client<PathRequest, PathReply> path;                    ///< paths of the arm in use
  Client<TrajectoryRequest, TrajectoryReply> trajectory;  ///< trajectories that are to run
  /// Trajectory of the running path, timed for the people as they are now.
  Client<TrajectoryRequest, TrajectoryReply> comparison;
};

}  // namespace handsel::manipulation_planner
