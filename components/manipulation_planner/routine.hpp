// SPDX-License-Identifier: Apache-2.0
// Routines that wait: an action is written top to bottom as a C++20 coroutine and resumed by
// step(); destroying it cancels it. No threads.
#pragma once

#include <coroutine>
#include <exception>
#include <optional>
#include <type_traits>
#include <utility>

#include "common/base/time.hpp"

namespace handsel::manipulation_planner {

/// A routine with a result; `co_await` it from another routine. Starts when awaited or resumed.
template <class T>
class [[nodiscard]] Routine {
 public:
  struct promise_type {
    std::optional<T> value;          ///< result; empty until the routine has ended
    std::coroutine_handle<> parent;  ///< routine that awaits this one; null: none

    /// Makes the owner of the frame.
    Routine get_return_object() { return Routine(Handle::from_promise(*this)); }
    /// Suspends at the beginning: the routine runs when it is started or awaited.
    std::suspend_always initial_suspend() noexcept { return {}; }
    /// Continues the routine that awaits this one; the frame stays until its owner destroys it.
    auto final_suspend() noexcept {
      struct Back {
        bool await_ready() noexcept { return false; }
        std::coroutine_handle<> await_suspend(std::coroutine_handle<promise_type> self) noexcept {
          return self.promise().parent ? self.promise().parent : std::noop_coroutine();
        }
        void await_resume() noexcept {}
      };
      return Back{};
    }
    /// Stores the result of co_return.
    void return_value(T v) { value = std::move(v); }
    /// Ends the process: an exception must not leave a routine.
    void unhandled_exception() { std::terminate(); }
  };
  using Handle = std::coroutine_handle<promise_type>;

  Routine() = default;
  explicit Routine(Handle handle) : handle_(handle) {}
  Routine(Routine&& other) noexcept { std::swap(handle_, other.handle_); }
  Routine& operator=(Routine&& other) noexcept {
    if (this != &other) {
      if (handle_) handle_.destroy();
      handle_ = {};
      std::swap(handle_, other.handle_);
    }
    return *this;
  }
  ~Routine() {
    if (handle_) handle_.destroy();
  }

  /// Runs the routine until it waits or ends; only once, and not for an empty owner.
  void start() { handle_.resume(); }
  explicit operator bool() const { return static_cast<bool>(handle_); }
  /// Returns whether the routine has ended; false for an empty owner.
  bool done() const { return handle_ && handle_.done(); }
  /// Returns the result; only after done().
  const T& result() const { return *handle_.promise().value; }

  /// Returns false: the routine runs first.
  bool await_ready() const noexcept { return false; }
  /// Starts the routine; at its end `parent` continues.
  std::coroutine_handle<> await_suspend(std::coroutine_handle<> parent) noexcept {
    handle_.promise().parent = parent;
    return handle_;
  }
  /// Moves the result out to the routine that awaited it.
  T await_resume() { return std::move(*handle_.promise().value); }

 private:
  Handle handle_{};
};

/// Where a routine waits: at most one condition at a time.
class Waiting {
 public:
  /// Resumes the waiting routine when its condition holds or its time is up.
  void poll(TimePoint now) {
    now_ = now;
    if (!handle_ || (!holds_(condition_) && now < deadline_)) return;
    const auto handle = handle_;
    handle_ = {};
    handle.resume();
  }
  /// Drops the condition: the routine that waits is not resumed any more. Needed where that routine
  /// is destroyed.
  void clear() { handle_ = {}; }
  /// Sets the time that timeouts count from.
  void set_now(TimePoint now) { now_ = now; }
  /// Returns the time of the last set_now() or poll().
  TimePoint now() const { return now_; }

  /// Lives in the waiting routine's frame. Conditions capture by reference or trivially: g++ 12 may
  /// copy the operands of co_await bitwise.
  template <class Condition>
  struct Until {
    static_assert(std::is_trivially_copyable_v<Condition>);
    Waiting& waiting;     ///< where the routine is resumed from
    Condition condition;  ///< callable without arguments, gives bool
    TimePoint deadline;   ///< resumed then at the latest
    /// Returns whether the condition holds already: then nothing waits.
    bool await_ready() const { return condition(); }
    /// Puts routine, condition and deadline where poll() finds them.
    void await_suspend(std::coroutine_handle<> handle) {
      waiting.handle_ = handle;
      waiting.condition_ = &condition;
      waiting.holds_ = [](const void* c) { return (*static_cast<const Condition*>(c))(); };
      waiting.deadline_ = deadline;
    }
    bool await_resume() const { return condition(); }  ///< false: the time ran out
  };
  /// Makes the awaitable that waits until the condition holds, `timeout` [s] at most; its result is
  /// whether the condition held.
  template <class Condition>
  Until<Condition> until(Condition condition, double timeout) {
    return {*this, condition, now_ + from_seconds(timeout)};
  }
  /// Makes the awaitable that waits for `duration` [s].
  auto pause(double duration) {
    return until([] { return false; }, duration);
  }

 private:
  std::coroutine_handle<> handle_{};
  const void* condition_{nullptr};
  bool (*holds_)(const void*){nullptr};
  TimePoint deadline_{}, now_{};
};

}  // namespace handsel::manipulation_planner
