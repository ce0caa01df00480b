// The visitor every message describes itself to, once: the same description converts to and from the IDL struct, validates, prints JSON and
// lists the leaves of a sample or fills one for tests. A description is `void describe(WireIo&, Domain&, Idl&)` naming each pair of fields
// with its bounds.
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
  double low, high;
  bool open_low{false};
};
inline constexpr Range kCoordinate{-1e4, 1e4};    // [m], [rad], and their first derivatives
inline constexpr Range kAcceleration{-1e6, 1e6};  // [rad/s^2]
inline constexpr Range kForce{-1e5, 1e5};         // [N], [Nm]
inline constexpr Range kPush{0, 1e5};             // [N]
inline constexpr Range kShare{0, 1};
inline constexpr Range kSigned{-1, 1};
inline constexpr Range kTime{0, 1e9};    // [s]
inline constexpr Range kPeriod{0, 1e4};  // [s]
inline constexpr double kHorizon = 1e9;  // stands for infinity on the wire
inline constexpr std::size_t kMaxAxes = 64;

class WireIo {
 public:
  static WireIo to_wire(const char* message, Stamp now, std::string& why);
  static WireIo from_wire(const char* message, std::string& why, LeftOutElements* left_out = nullptr);
  static WireIo json(std::string& out);
  static WireIo leaves(const std::function<void(const WireLeaf&)>& visit);
  static WireIo fill(bool full);

  bool ok() const { return !failed_; }
  /// Of a field of what is open just now; within a list its element.
  std::string path(const char* field) const;

  void stamp(Stamp& m, std::int64_t& w);
  void number(const char* field, double& m, double& w, Range range);
  /// Infinity in the domain is 1e9 on the wire.
  void horizon(const char* field, double& m, double& w, double low);
  void integer(const char* field, std::uint64_t& m, std::uint64_t& w);
  void integer(const char* field, std::uint32_t& m, std::uint32_t& w, std::uint32_t low = 0, std::uint32_t high = UINT32_MAX);
  void flag(const char* field, bool& m, bool& w);

  enum class Text { name, maybe_empty, sentence };  ///< a sentence too long is cut when sent, a name refused
  template <std::size_t N>
  void text(const char* field, std::string& m, char (&w)[N], Text kind) {
    text_field(field, m, w, N - 1, kind);
  }
  template <class E, class W>
  void choice(const char* field, E& m, W& w, std::span<const char* const> names) {
    std::uint32_t mi = static_cast<std::uint32_t>(m);
    static_assert(sizeof(W) == sizeof(std::uint32_t));
    std::uint32_t wi = 0;
    std::memcpy(&wi, &w, sizeof wi);  // what came may be no enumerator at all
    choice_field(field, mi, wi, &w, names);
    if (mode_ == Mode::to_wire || mode_ == Mode::fill) w = static_cast<W>(wi);
    if (mode_ == Mode::from_wire) m = static_cast<E>(mi);
  }

  void point(const char* field, Vector3& m, handsel_Vector3& w, Range range = kCoordinate);
  /// Unit vector, normalised when its norm is 1 +- 1e-3. Where it is not `meant`, it is +x.
  void direction(const char* field, Vector3& m, handsel_Vector3& w, bool meant = true);
  void pose(const char* field, Pose& m, handsel_Pose& w);
  void wrench(const char* field, Wrench& m, handsel_Wrench& w);

  template <class Seq>
  void vector(const char* field, Vector& m, Seq& w, Range range, std::size_t bound = kMaxAxes) {
    if (failed_) return;
    if (mode_ == Mode::to_wire && fits(field, static_cast<std::size_t>(m.size()), bound)) resize(w, static_cast<std::size_t>(m.size()));
    if (mode_ == Mode::fill) resize(w, full_ ? bound : kFew);
    numbers(field, m, w._buffer, w._length, bound, range);
  }
  template <class Seq>
  void indices(const char* field, std::vector<std::uint32_t>& m, Seq& w, std::size_t bound, std::uint32_t high) {
    if (!open_list(field, m, w, bound)) return;
    for (std::size_t i = 0; i < size(m, w); ++i) {
      at(static_cast<int>(i));
      std::uint32_t none = 0;
      integer(field, wire_only() ? none : m[i], mode_ == Mode::json ? none : w._buffer[i], 0, high);
    }
    close_list();
  }
  template <class Seq>
  void bytes(const char* field, std::vector<std::uint8_t>& m, Seq& w, std::size_t bound, std::uint8_t high = 255) {
    if (failed_) return;
    if (mode_ == Mode::to_wire && fits(field, m.size(), bound)) resize(w, m.size());
    if (mode_ == Mode::fill) resize(w, full_ ? bound : 1);
    octets(field, m, w._buffer, w._length, bound, high);
  }
  /// Elements describe themselves. `cut`: what exceeds the bound is left out when sent instead of refused.
  template <class T, class Seq>
  void list(const char* field, std::vector<T>& m, Seq& w, std::size_t bound, bool cut = false) {
    using W = std::remove_reference_t<decltype(*w._buffer)>;
    if (!open_list(field, m, w, bound, cut)) return;
    T no_element{};
    static W no_wire{};
    for (std::size_t i = 0; i < size(m, w, bound) && !failed_; ++i) {
      at(static_cast<int>(i));
      open(nullptr);
      describe(*this, wire_only() ? no_element : m[i], mode_ == Mode::json ? no_wire : w._buffer[i]);
      close();
    }
    close_list();
  }
  /// Runs `part`. What is malformed in it when received is counted as left out and does not fail the message. True: it is well-formed.
  template <class Part>
  bool spare(Part&& part) {
    if (failed_) return false;
    const int depth = depth_;
    part();
    if (!failed_ || mode_ != Mode::from_wire) return !failed_;
    leave_out(depth);
    return false;
  }
  /// As list(). When received, a malformed element is left out and counted, and so is what exceeds the bound: for observations, whose
  /// elements do not depend on each other. Returns how many were left out.
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
  /// `cut`: what exceeds the bound is left out when sent instead of refused.
  template <class Seq>
  void texts(const char* field, std::vector<std::string>& m, Seq& w, std::size_t bound, Text kind = Text::name, bool cut = false) {
    if (!open_list(field, m, w, bound, cut)) return;
    std::string no_text;
    for (std::size_t i = 0; i < size(m, w, bound); ++i) {
      at(static_cast<int>(i));
      char no_wire[sizeof(*w._buffer)] = {};
      text_field(field, wire_only() ? no_text : m[i], mode_ == Mode::json ? no_wire : w._buffer[i], sizeof(*w._buffer) - 1, kind);
    }
    close_list();
  }
  template <class T, class W>
  void part(const char* field, T& m, W& w) {
    if (failed_) return;
    open(field);
    describe(*this, m, w);
    close();
  }
  /// A rule over several fields of the domain value; judged when converting only. The sentence goes on after the field's name.
  void check(bool holds, const char* field, const char* sentence);
  /// True while domain values hold the message (converting), so that rules may be computed from them.
  bool converting() const { return !failed_ && (mode_ == Mode::to_wire || mode_ == Mode::from_wire); }

  void begin();  ///< of the whole message
  void end();

 private:
  enum class Mode : std::uint8_t { to_wire, from_wire, json, leaves, fill };
  struct Step {
    const char* field;
    int index;
  };
  explicit WireIo(Mode mode) : mode_(mode) {}

  void text_field(const char* field, std::string& m, char* w, std::size_t bound, Text kind);
  void choice_field(const char* field, std::uint32_t& m, std::uint32_t& w, void* leaf, std::span<const char* const> names);
  void numbers(const char* field, Vector& m, double* w, std::size_t length, std::size_t bound, Range range);
  void octets(const char* field, std::vector<std::uint8_t>& m, std::uint8_t* w, std::size_t length, std::size_t bound, std::uint8_t high);
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
  bool open_list(const char* field, std::vector<T>& m, Seq& w, std::size_t bound, bool cut = false) {
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
        std::memcpy(static_cast<void*>(grown), static_cast<const void*>(w._buffer), w._maximum * sizeof(*w._buffer));
        dds_free(w._buffer);
      }
      w._buffer = grown;
      w._maximum = static_cast<std::uint32_t>(n);
      w._release = true;
    }
    w._length = static_cast<std::uint32_t>(n);
  }

  /// The domain value is not looked at.
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
