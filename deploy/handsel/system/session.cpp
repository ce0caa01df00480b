// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/session.hpp"

#include <signal.h>
#include <unistd.h>

#include <random>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

volatile sig_atomic_t interrupts = 0;

void on_signal(int number) {
  interrupts = interrupts + 1;
  if (interrupts > 1 && number == SIGINT) _exit(130);
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

bool interrupted() { return interrupts > 0; }

Session::Session(int domain)
    : domain_(domain),
      bus_({.component = "handsel", .domain = static_cast<std::uint32_t>(domain), .health = false}),
      observer_(bus_),
      goals_(bus_.advertise<TaskGoal>()),
      next_task_(std::random_device{}()) {
  bus_.every(from_seconds(0.02),
             [](TimePoint) {});  // conditions are checked again even if nothing arrives
}

bool Session::wait(Duration limit, const std::function<bool()>& done) {
  bool held = false;
  bus_.run_until([&] { return interrupted() || (held = done()); }, limit);
  return held;
}

void Session::require_system() {
  if (!wait(from_seconds(1.0), [this] { return !snapshot().health.empty(); })) {
    throw MissingError("no Handsel system runs on DDS domain " + std::to_string(domain_) +
                       "; start one with `handsel up --domain " + std::to_string(domain_) + "`");
  }
}

std::uint64_t Session::new_task_id() { return (next_task_++ << 8) | 1u; }

bool Session::send(const TaskGoal& goal) {
  wait(from_seconds(1.0), [this] { return goals_->readers() > 1; });  // supervisor and spark
  return goals_->readers() > 0 && goals_->publish(goal);
}

}  // namespace handsel
