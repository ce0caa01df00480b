// SPDX-License-Identifier: Apache-2.0
// The visitor every message describes itself to, once: the same description converts to and from
// the IDL struct, validates, prints JSON and lists the leaves of a sample or fills one for tests. A
// description is `void describe(WireIo&, Domain&, Idl&)` naming each pair of fields with its
// bounds.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "common/base/time.hpp"
#include "common/geometry/pose.hpp"
#include "common/wire/message_type.hpp"
#include "idl/geometry.h"

namespace handsel {

/// Closed interval a number must lie in; open_low leaves its lower end out.
struct Range {
  double low, high;      ///< ends of the interval, both included
  bool open_low{false};  ///< `low` itself is excluded
};
inline constexpr Range kCoordinate{-1e4, 1e4};    // [m], [rad], and their first derivatives
inline constexpr Range kAcceleration{-1e6, 1e6};  // [rad/s^2]
inline constexpr Range kForce{-1e5, 1e5};         // [N], [Nm]
inline constexpr Range kPush{0, 1e5};             // [N]
inline constexpr Range kFraction{0, 1};
inline constexpr Range kSigned{-1, 1};
inline constexpr Range kTime{0, 1e9};    // [s]
inline constexpr Range kPeriod{0, 1e4};  // [s]
inline constexpr double kHorizon = 1e9;  // stands for infinity on the wire
inline constexpr std::size_t kMaxAxes = 64;

/// Visitor of one message in one mode; the factories choose the mode. After the first violation of
/// a bound all further calls do nothing, and ok() is false.
class WireIo {
 public:
  /// Domain -> wire, validated. `message`: its type, for `why`; a stamp of 0 becomes `now`.
  static WireIo to_wire(const char* message, Stamp now, std::string& why);
  /// Wire -> domain, validated. `left_out`: receives the count of left-out elements; may be
  /// null.
  static WireIo from_wire(const char* message, std::string& why,
                          LeftOutElements* left_out = nullptr);
  /// Appends the domain value to `out` as JSON; numbers that are not finite become null.
  static WireIo json(std::string& out);
  /// Calls `visit`, which must outlive the visitor, with each leaf of the wire sample.
  static WireIo leaves(const std::function<void(const WireLeaf&)>& visit);
  /// Writes a valid wire sample: lists of two elements, or `full`: every list and text at its
  /// bound.
  static WireIo fill(bool full);

  /// Returns whether no bound was violated so far; the first violation is in `why`.
  bool ok() const { return !failed_; }
  /// Returns the path of a field of the open part, e.g. "RobotState.position[3]"; within a list
  /// that of the current element.
  std::string path(const char* field) const;

  /// Field `stamp` [ns]: must not be negative; a 0 is replaced when sent.
  void stamp(Stamp& m, std::int64_t& w);
  /// A number that must be finite and within `range`.
  void number(const char* field, double& m, double& w, Range range);
  /// A number from `low`, unbounded in the domain: anything above 1e9 is sent as 1e9, which is
  /// received as infinity.
  void horizon(const char* field, double& m, double& w, double low);
  /// An integer of any value.
  void integer(const char* field, std::uint64_t& m, std::uint64_t& w);
  /// An integer from `low` to `high`, both included.
  void integer(const char* field, std::uint32_t& m, std::uint32_t& w, std::uint32_t low = 0,
               std::uint32_t high = UINT32_MAX);
  /// A truth value; a received byte other than 0 and 1 is malformed.
  void flag(const char* field, bool& m, bool& w);

  /// A name is refused when empty; a sentence that is too long is cut when sent, other texts
  /// refused.
  enum class Text { name, maybe_empty, sentence };
  /// A text of at most N - 1 bytes of UTF-8 without control characters other than tab and line
  /// feed.
  template <std::size_t N>
  void text(const char* field, std::string& m, char (&w)[N], Text kind) {
    text_field(field, m, w, N - 1, kind);
  }
  /// An enumerator; `names` are those of all values in order, and a value beyond them is malformed.
  template <class E, class W>
  void choice(const char* field, E& m, W& w, std::span<const char* const> names) {
    std::uint32_t mi = static_cast<std::uint32_t>(m);
    static_assert(sizeof(W) == sizeof(std::uint32_t));
    std::uint32_t wi = 0;
    std::memcpy(&wi, &w, sizeof wi);  // the received value may be no enumerator at all
    choice_field(field, mi, wi, &w, names);
    if (mode_ == Mode::to_wire || mode_ == Mode::fill) w = static_cast<W>(wi);
    if (mode_ == Mode::from_wire) m = static_cast<E>(mi);
  }

  /// A point or vector, each coordinate within `range`.
  void point(const char* field, Vector3& m, handsel_Vector3& w, Range range = kCoordinate);
  /// Unit vector, normalised when its norm is 1 +- 1e-3. Without `meant` the field has no meaning:
  /// any value is accepted, and +x is sent and received.
  void direction(const char* field, Vector3& m, handsel_Vector3& w, bool meant = true);
  /// A pose: a proper rotation when sent; a quaternion of norm 1 +- 1e-3 when received, then
  /// normalised.
  void pose(const char* field, Pose& m, handsel_Pose& w);
  /// Force [N] and torque [Nm], each component within kForce.
  void wrench(const char* field, Wrench& m, handsel_Wrench& w);

  /// At most `bound` numbers, each within `range`.
  template <class Seq>
  void vector(const char* field, Vector& m, Seq& w, Range range, std::size_t bound = kMaxAxes) {
    if (failed_) return;
    if (mode_ == Mode::to_wire && fits(field, static_cast<std::size_t>(m.size()), bound))
      resize(w, static_cast<std::size_t>(m.size()));
    if (mode_ == Mode::fill) resize(w, full_ ? bound : kFew);
    numbers(field, m, w._buffer, w._length, bound, range);
  }
  /// At most `bound` indices from 0 to `high`.
  template <class Seq>
  void indices(const char* field, std::vector<std::uint32_t>& m, Seq& w, std::size_t bound,
               std::uint32_t high) {
    if (!open_list(field, m, w, bound)) return;
    for (std::size_t i = 0; i < size(m, w); ++i) {
      at(static_cast<int>(i));
      std::uint32_t none = 0;
      integer(field, wire_only() ? none : m[i], mode_ == Mode::json ? none : w._buffer[i], 0, high);
    }
    close_list();
  }
  /// At most `bound` bytes, none above `high`.
  template <class Seq>
  void bytes(const char* field, std::vector<std::uint8_t>& m, Seq& w, std::size_t bound,
             std::uint8_t high = 255) {
    if (failed_) return;
    if (mode_ == Mode::to_wire && fits(field, m.size(), bound)) resize(w, m.size());
    if (mode_ == Mode::fill) resize(w, full_ ? bound : 1);
    octets(field, m, w._buffer, w._length, bound, high);
  }
  /// At most `bound` elements, each visited by its own describe(). `cut`: what exceeds the bound is
  /// left out when sent instead of refused.
  template <class T, class Seq>
  void list(const char* field, std::vector<T>& m, Seq& w, std::size_t bound, bool cut = false) {
    using W = std::remove_reference_t<decltype(*w._buffer)>;
    if (!open_list(field, m, w, bound, cut)) return;
    T no_element{};
    static W no_wire{};
    for (std::size_t i = 0; i < size(m, w, bound) && !failed_; ++i) {
      at(static_cast<int>(i));
      open(nullptr);
      describe(*this, wire_only() ? no_element : m[i],
               mode_ == Mode::json ? no_wire : w._buffer[i]);
      close();
    }
    close_list();
  }
  /// Runs `part`. What is malformed in it when received is counted as left out and does not fail
  /// the message. True: it is well-formed.
  template <class Part>
  bool spare(Part&& part) {
    if (failed_) return false;
    const int depth = depth_;
    part();
    if (!failed_ || mode_ != Mode::from_wire) return !failed_;
    leave_out(depth);
    return false;
  }
  /// As list(). When received, a malformed element is left out and counted, and so is what exceeds
  /// the bound: for observations, whose elements do not depend on each other. Returns how many were
  /// left out.
  template <class T, class Seq>
  std::size_t spared_list(const char* field, std::vector<T>& m, Seq& w, std::size_t bound) {
    if (mode_ != Mode::from_wire) {
      list(field, m, w, bound);
      return 0;
    }
    if (failed_) return 0;
    const std::size_t n = std::min<std::size_t>(w._length, bound);
    if (n < w._length) spare([&] { fits(field, w._length, bound); });
    m.resize(n);
    stack_[depth_++] = {field, -1};
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; ++i) {
      at(static_cast<int>(i));
      const bool good = spare([&] {
        open(nullptr);
        describe(*this, m[kept], w._buffer[i]);
        close();
      });
      kept += good ? 1 : 0;
    }
    --depth_;
    m.resize(kept);
    return w._length - kept;
  }
  /// At most `bound` texts, each as in text(). `cut`: what exceeds the bound is left out when sent
  /// instead of refused.
  template <class Seq>
  void texts(const char* field, std::vector<std::string>& m, Seq& w, std::size_t bound,
             Text kind = Text::name, bool cut = false) {
    if (!open_list(field, m, w, bound, cut)) return;
    std::string no_text;
    for (std::size_t i = 0; i < size(m, w, bound); ++i) {
      at(static_cast<int>(i));
      char no_wire[sizeof(*w._buffer)] = {};
      text_field(field, wire_only() ? no_text : m[i], mode_ == Mode::json ? no_wire : w._buffer[i],
                 sizeof(*w._buffer) - 1, kind);
    }
    close_list();
  }
  /// A field that is a struct, visited by its own describe().
  template <class T, class W>
  void part(const char* field, T& m, W& w) {
    if (failed_) return;
    open(field);
    describe(*this, m, w);
    close();
  }
  /// A rule over several fields of the domain value, checked when converting only. A violation is
  /// reported as the field's path followed by `sentence`.
  void check(bool holds, const char* field, const char* sentence);
  /// Returns whether the visitor converts and has not failed: then rules may be computed from
  /// domain values.
  bool converting() const {
    return !failed_ && (mode_ == Mode::to_wire || mode_ == Mode::from_wire);
  }

  /// Opens the whole message; needed for JSON only.
  void begin();
  /// Closes the whole message; needed for JSON only.
  void end();

 private:
  enum class Mode : std::uint8_t { to_wire, from_wire, json, leaves, fill };
  struct Step {
    const char* field;
    int index;
  };
  explicit WireIo(Mode mode) : mode_(mode) {}

  void text_field(const char* field, std::string& m, char* w, std::size_t bound, Text kind);
  void choice_field(const char* field, std::uint32_t& m, std::uint32_t& w, void* leaf,
                    std::span<const char* const> names);
  void numbers(const char* field, Vector& m, double* w, std::size_t length, std::size_t bound,
               Range range);
  void octets(const char* field, std::vector<std::uint8_t>& m, std::uint8_t* w, std::size_t length,
              std::size_t bound, std::uint8_t high);
  bool in_range(const char* field, double value, Range range);
  void leaf(const char* field, WireLeaf::Kind kind, void* value, std::size_t size);
  bool fits(const char* field, std::size_t size, std::size_t bound);
  void fail(const char* field, const std::string& sentence);
  void leave_out(int depth);
  void at(int index);
  void open(const char* field);
  void close();
  void begin_json_list(const char* field);
  void close_list();
  void separator();
  void json_key(const char* field);
  void json_number(double value);

  /// Prepares the receiving side of a list; false when there is nothing to walk.
  template <class T, class Seq>
  bool open_list(const char* field, std::vector<T>& m, Seq& w, std::size_t bound,
                 bool cut = false) {
    if (failed_) return false;
    if (mode_ == Mode::to_wire) {
      const std::size_t n = cut && m.size() > bound ? bound : m.size();
      if (!fits(field, n, bound)) return false;
      resize(w, n);
    } else if (mode_ == Mode::from_wire) {
      if (!fits(field, w._length, bound)) return false;
      m.resize(w._length);
    } else if (mode_ == Mode::fill) {
      resize(w, full_ ? bound : kFew);
    }
    begin_json_list(field);
    stack_[depth_++] = {field, -1};
    return true;
  }
  template <class T, class Seq>
  std::size_t size(const std::vector<T>& m, const Seq& w, std::size_t bound = SIZE_MAX) const {
    if (failed_) return 0;
    if (mode_ == Mode::json) return m.size();
    return mode_ == Mode::to_wire ? std::min(m.size(), bound) : w._length;
  }
  /// Elements up to _maximum stay initialised, so that their buffers are reused and freed.
  template <class Seq>
  static void resize(Seq& w, std::size_t n) {
    if (n > w._maximum) {
      auto* grown = static_cast<decltype(w._buffer)>(dds_alloc(n * sizeof(*w._buffer)));
      std::memset(static_cast<void*>(grown), 0, n * sizeof(*w._buffer));
      if (w._buffer) {
        std::memcpy(static_cast<void*>(grown), static_cast<const void*>(w._buffer),
                    w._maximum * sizeof(*w._buffer));
        dds_free(w._buffer);
      }
      w._buffer = grown;
      w._maximum = static_cast<std::uint32_t>(n);
      w._release = true;
    }
    w._length = static_cast<std::uint32_t>(n);
  }

  /// Returns whether the domain value is unused.
  bool wire_only() const { return mode_ == Mode::leaves || mode_ == Mode::fill; }

  static constexpr int kDepth = 12;
  static constexpr std::size_t kFew = 2;  // elements of a list in a sample that is not full
  Mode mode_;
  bool full_{false};
  bool failed_{false};
  bool first_{true};
  int depth_{0};
  Step stack_[kDepth];
  const char* message_{""};
  Stamp now_{};
  std::string* text_{};
  LeftOutElements* left_out_{};
  const std::function<void(const WireLeaf&)>* visit_{};
};

}  // namespace handsel
