// SPDX-License-Identifier: Apache-2.0
// Queues of requests and goals: duplicates are harmless, newer replaces older where configured, and
// every queue is bounded.
#include <gtest/gtest.h>

#include <random>

#include "common/base/request_queue.hpp"
#include "common/messages/planning.hpp"
#include "components/supervisor/goal_inbox.hpp"

namespace handsel::queues_test {
namespace {

using Queue = RequestQueue<PathReply>;
using Admission = Queue::Admission;

TEST(RequestQueue, works_once_and_lets_newer_requests_replace_older_ones) {
  Queue queue(OlderRequests::supersede);
  EXPECT_EQ(queue.admit({1, 1}), Admission::fresh);
  EXPECT_EQ(queue.admit({1, 1}), Admission::under_way);
  EXPECT_EQ(queue.admit({1, 2}), Admission::fresh);
  EXPECT_TRUE(queue.superseded({1, 1}));
  EXPECT_FALSE(queue.superseded({1, 2}));
  EXPECT_EQ(queue.admit({2, 1}), Admission::fresh) << "another client";
  PathReply reply;
  reply.id = {1, 2};
  reply.length = 4;
  queue.close(reply);
  EXPECT_EQ(queue.admit({1, 2}), Admission::answered);
  EXPECT_EQ(queue.answer({1, 2})->length, 4);
  EXPECT_EQ(queue.admit({1, 0}), Admission::superseded);
}

TEST(RequestQueue, leaves_requests_beside_each_other_where_all_are_wanted) {
  Queue queue(OlderRequests::keep);
  EXPECT_EQ(queue.admit({1, 5}), Admission::fresh);
  EXPECT_EQ(queue.admit({1, 3}), Admission::fresh);
  EXPECT_FALSE(queue.superseded({1, 3}));
}

TEST(RequestQueue, cancels_what_is_not_answered_and_what_comes_late) {
  Queue queue(OlderRequests::keep);
  for (std::uint64_t number : {1, 2, 3}) queue.admit({7, number});
  EXPECT_EQ(queue.cancel({7, 2}).size(), 2u);
  EXPECT_EQ(queue.admit({7, 0}), Admission::cancelled);
  EXPECT_EQ(queue.admit({7, 4}), Admission::fresh);
  EXPECT_EQ(queue.admit({8, 0}), Admission::fresh) << "another client has cancelled nothing";
}

TEST(RequestQueue, is_full_at_its_bound_and_has_room_again_after_an_answer) {
  Queue queue(OlderRequests::keep, {.open = 4});
  for (std::uint64_t number = 1; number <= 4; ++number)
    EXPECT_EQ(queue.admit({number, 1}), Admission::fresh);
  EXPECT_EQ(queue.admit({9, 1}), Admission::full);
  PathReply reply;
  reply.id = {2, 1};
  queue.close(reply);
  EXPECT_EQ(queue.admit({9, 1}), Admission::fresh) << "a request that found no room may come again";
}

TEST(RequestQueue, does_not_grow_with_ever_new_clients) {
  Queue queue(OlderRequests::supersede);
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const RequestId id{random(), 1 + random() % 3};
    if (i % 7 == 0) queue.cancel(id);
    if (queue.admit(id) != Admission::fresh || i % 2 == 0) continue;
    PathReply reply;
    reply.id = id;
    queue.close(reply);
  }
  EXPECT_LE(queue.open(), 64u);
  EXPECT_LE(queue.clients(), 64u);
}

using GoalAdmission = supervisor::GoalInbox::Admission;

TaskGoal goal(std::uint64_t id, TaskKind kind) {
  TaskGoal out;
  out.id = id;
  out.kind = kind;
  return out;
}

TEST(GoalInbox, a_flood_of_tasks_leaves_room_for_a_pause) {
  supervisor::GoalInbox inbox(64);
  for (std::uint64_t id = 1; id <= 10000; ++id) inbox.put(goal(id, TaskKind::give));
  EXPECT_EQ(inbox.size(), 64u);
  EXPECT_EQ(inbox.turned_away(), 10000u - 64u);
  EXPECT_EQ(inbox.put(goal(20000, TaskKind::pause)), GoalAdmission::taken);
  EXPECT_EQ(inbox.put(goal(20000, TaskKind::pause)), GoalAdmission::known);
  EXPECT_EQ(inbox.take_turned_away().size(), 64u) << "refusals of one cycle are bounded";
  EXPECT_EQ(inbox.take().size(), 65u);
  EXPECT_TRUE(inbox.empty());
}

TEST(GoalInbox, a_goal_that_was_turned_away_may_come_again) {
  supervisor::GoalInbox inbox(1);
  inbox.put(goal(1, TaskKind::give));
  EXPECT_EQ(inbox.put(goal(2, TaskKind::give)), GoalAdmission::turned_away);
  inbox.take();
  EXPECT_EQ(inbox.put(goal(2, TaskKind::give)), GoalAdmission::taken);
}

}  // namespace
}  // namespace handsel::queues_test
