// SPDX-License-Identifier: Apache-2.0
// Reads body points over time from CSV.
#include <algorithm>
#include <cmath>

#include "sim/recordings/recording_parts.hpp"

namespace handsel::sim {

using namespace recording_detail;

namespace {

/// Returns frames at uneven times resampled at their mean rate.
std::vector<BodyPoints> resample(const std::vector<double>& times,
                                 const std::vector<BodyPoints>& frames, double rate) {
  const auto n =
      static_cast<std::size_t>(std::floor((times.back() - times.front()) * rate + 1e-6)) + 1;
  std::vector<BodyPoints> out(n);
  std::size_t at = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = times.front() + static_cast<double>(i) / rate;
    while (at + 2 < times.size() && times[at + 1] <= t) ++at;
    const double fraction = std::clamp((t - times[at]) / (times[at + 1] - times[at]), 0.0, 1.0);
    for (std::size_t k = 0; k < out[i].size(); ++k)
      out[i][k] = (1 - fraction) * frames[at][k] + fraction * frames[at + 1][k];
  }
  return out;
}

/// Reads a file line by line; each member throws ConfigError "name:line: what".
class BodyCsv {
 public:
  explicit BodyCsv(const std::string& name) : name_(name) {}

  void read_line(std::string_view line, std::size_t number) {
    last_ = number;
    if (number == 1) return read_header(line);
    if (!line.empty()) read_row(line, number);
  }
  Recording recording() const;

 private:
  void read_header(std::string_view line);
  void add_column(std::string_view column, std::size_t index);
  void check_columns() const;
  void read_row(std::string_view line, std::size_t number);
  void add_time(double time, std::size_t number);
  void add_frame(const std::array<Vector3, kBodyJoints.size()>& at, std::size_t number);
  bool has(int j) const { return count_[static_cast<std::size_t>(3 * j)] > 0; }

  const std::string& name_;
  std::vector<int> columns_;  // 3 x joint + axis; -1: time
  std::array<int, 3 * kBodyJoints.size()> count_{};
  std::vector<double> times_;
  std::vector<BodyPoints> frames_;
  Person body_;
  std::size_t last_{0};
};

void BodyCsv::read_header(std::string_view line) {
  const auto names = cells(line);
  for (std::size_t c = 0; c < names.size(); ++c) add_column(names[c], c);
  check_columns();
}

void BodyCsv::add_column(std::string_view column, std::size_t index) {
  if (column == "time" || column == "t") {
    if (index != 0) fail_at(name_, 1, "time must be the first column");
    columns_.push_back(-1);
    return;
  }
  const int j =
      column.size() > 2 ? body_joint_index(std::string(column.substr(0, column.size() - 2))) : -1;
  const char axis = column.empty() ? ' ' : column.back();
  if (j < 0 || axis < 'x' || axis > 'z' ||
      (column[column.size() - 2] != '.' && column[column.size() - 2] != '_'))
    fail_at(name_, 1,
            "column " + std::to_string(index + 1) +
                " must be time or <joint>.x, .y or .z of a REP-155 joint such as r_wrist.x");
  columns_.push_back(3 * j + axis - 'x');
  if (++count_[static_cast<std::size_t>(columns_.back())] > 1)
    fail_at(name_, 1, "column " + std::string(column) + " is there twice");
}

void BodyCsv::check_columns() const {
  if (columns_.empty() || columns_[0] != -1)
    fail_at(name_, 1, "the first column must be time, in seconds");
  for (std::size_t j = 0; j < kBodyJoints.size(); ++j) {
    if (count_[3 * j] != count_[3 * j + 1] || count_[3 * j] != count_[3 * j + 2])
      fail_at(name_, 1, std::string(kBodyJoints[j]) + " needs the columns .x, .y and .z");
  }
  for (const int j : {kHead, kWaist, kShoulder[0], kShoulder[1]})
    if (!has(j))
      fail_at(name_, 1,
              std::string("the columns of ") + kBodyJoints[static_cast<std::size_t>(j)] +
                  " are missing");
  if (!(has(kElbow[0]) && has(kWrist[0])) && !(has(kElbow[1]) && has(kWrist[1])))
    fail_at(name_, 1,
            "the columns of an arm are missing: l_elbow and l_wrist, or r_elbow and r_wrist");
}

void BodyCsv::read_row(std::string_view line, std::size_t number) {
  if (number > kMaxRows) fail_at(name_, number, "more than " + std::to_string(kMaxRows) + " rows");
  const auto row = cells(line);
  if (row.size() != columns_.size())
    fail_at(name_, number,
            "has " + std::to_string(row.size()) + " columns, the first line names " +
                std::to_string(columns_.size()));
  std::array<Vector3, kBodyJoints.size()> at{};
  for (std::size_t c = 0; c < row.size(); ++c) {
    const double v = number_in(row[c]);
    if (!std::isfinite(v) || std::abs(v) > 1e7)
      fail_at(name_, number,
              "column " + std::to_string(c + 1) + " is not a finite number within 1e7");
    if (columns_[c] >= 0) {
      at[static_cast<std::size_t>(columns_[c] / 3)][columns_[c] % 3] = v;
    } else {
      add_time(v, number);
    }
  }
  add_frame(at, number);
}

void BodyCsv::add_time(double time, std::size_t number) {
  if (!times_.empty() && time <= times_.back())
    fail_at(name_, number,
            "time " + std::to_string(time) + " is not after " + std::to_string(times_.back()));
  if (!times_.empty() && time - times_.back() > 1)
    fail_at(name_, number,
            "time jumps by " + std::to_string(time - times_.back()) +
                " s; at most 1 s is bridged (is time in seconds?)");
  times_.push_back(time);
}

void BodyCsv::add_frame(const std::array<Vector3, kBodyJoints.size()>& at, std::size_t number) {
  ObservedPerson seen;
  for (std::size_t j = 0; j < kBodyJoints.size(); ++j)
    if (has(static_cast<int>(j))) seen.joints.push_back({kBodyJoints[j], at[j], 1.0});
  if (frames_.empty()) {
    BodyPoints first{};
    for (std::size_t j = 0; j < first.size(); ++j) first[j] = at[j];
    check_body(first, name_, number);
    body_.stature = std::clamp(trunk_stature(first), 1.2, 2.2);
  }
  body_.joints = fit_body(seen, frames_.empty() ? nullptr : &body_, body_.stature);
  frames_.push_back(points_of(body_.joints));
}

Recording BodyCsv::recording() const {
  if (frames_.size() < 2)
    fail_at(name_, std::max<std::size_t>(1, last_), "needs at least two rows of positions");
  const double rate = static_cast<double>(frames_.size() - 1) / (times_.back() - times_.front());
  if (!(rate <= 1000))
    fail_at(name_, last_,
            "has " + std::to_string(rate) +
                " rows a second, must be at most 1000 (is time in seconds?)");
  return finish(resample(times_, frames_, rate), rate, has(kAnkle[0]) || has(kAnkle[1]));
}

}  // namespace

Recording parse_body_csv(std::string_view text, const std::string& name) {
  BodyCsv csv(name);
  for_each_line(text,
                [&](std::string_view line, std::size_t number) { csv.read_line(line, number); });
  return csv.recording();
}

}  // namespace handsel::sim
