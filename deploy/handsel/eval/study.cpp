// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/eval/study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <sstream>
#include <stdexcept>

#include "common/base/errors.hpp"
#include "deploy/handsel/eval/trial.hpp"

namespace handsel {
namespace {

using Json = nlohmann::json;

struct Measure {
  const char* name;
  int decimals;
  bool of_success;  // reported for successful trials only
};
constexpr Measure kMeasures[] = {{"activations_ratio", 3, false},
                                 {"cpu_chain_s", 3, false},
                                 {"runs", 1, false},
                                 {"sensor_samples", 0, false},
                                 {"sensor_values", 0, false},
                                 {"min_separation_m", 4, false},
                                 {"below_separation_s", 3, false},
                                 {"ssm_violations", 2, false},
                                 {"closing_speed_m_s", 3, false},
                                 {"contact_force_n", 2, false},
                                 {"late_reactions", 3, false},
                                 {"reaction_p50_s", 3, false},
                                 {"interventions", 3, false},
                                 {"intervention_s", 3, false},
                                 {"peak_closing_speed_m_s", 3, false},
                                 {"duration_s", 2, true},
                                 {"robot_idle_s", 2, true},
                                 {"concurrent_s", 2, true},
                                 {"functional_delay_s", 2, true},
                                 {"discomfort", 3, false},
                                 {"legibility", 3, false}};

std::optional<double> value(const Json& line, const Measure& measure) {
  if (measure.of_success && !line.value("success", false)) return std::nullopt;
  const std::string name = measure.name;
  if (name == "activations_ratio") {
    const double max_activations = line.value("activations_at_pmin", 0.0);
    return max_activations > 0 ? std::optional(line["activations"].get<double>() / max_activations)
                               : std::nullopt;
  }
  if (name == "runs") {
    if (!line.contains("runs")) return std::nullopt;
    double sum = 0;
    for (const char* run : {"facts", "scene", "forecast", "cost_map", "paths"})
      sum += line["runs"].value(run, 0.0);
    return sum;
  }
  const auto at = line.find(name);
  return at != line.end() && at->is_number() ? std::optional(at->get<double>()) : std::nullopt;
}

double mean(const std::vector<double>& values) {
  return values.empty() ? 0.0
                        : std::accumulate(values.begin(), values.end(), 0.0) /
                              static_cast<double>(values.size());
}

std::string number(double v, int decimals) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, v);
  return text;
}

int successes(const std::map<std::uint64_t, Json>& trials) {
  return static_cast<int>(std::count_if(trials.begin(), trials.end(), [](const auto& t) {
    return t.second.value("success", false);
  }));
}

}  // namespace

PairedDifference paired_difference(const std::vector<double>& first,
                                   const std::vector<double>& second) {
  if (first.size() != second.size())
    throw std::invalid_argument("paired_difference: pairs are missing");
  constexpr int kResamples = 4000, kDraws = 10000;
  PairedDifference d;
  d.pairs = first.size();
  if (first.empty()) return d;
  std::vector<double> differences(first.size());
  std::transform(first.begin(), first.end(), second.begin(), differences.begin(), std::minus<>());
  d.first = mean(first);
  d.second = mean(second);
  d.difference = mean(differences);
  std::mt19937_64 random(1);
  const auto below = [&random](std::uint64_t n) { return random() % n; };
  std::vector<double> means(kResamples);
  for (double& m : means) {
    m = 0;
    for (std::size_t i = 0; i < differences.size(); ++i)
      m += differences[below(differences.size())];
    m /= static_cast<double>(differences.size());
  }
  std::sort(means.begin(), means.end());
  d.low = means[kResamples / 40];
  d.high = means[kResamples - 1 - kResamples / 40];
  int as_large = 0;
  for (int k = 0; k < kDraws; ++k) {
    double sum = 0;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < differences.size(); ++i, bits >>= 1) {
      if (i % 64 == 0) bits = random();
      sum += (bits & 1) ? differences[i] : -differences[i];
    }
    as_large +=
        std::abs(sum) >= std::abs(d.difference) * static_cast<double>(differences.size()) - 1e-12;
  }
  d.p = (1.0 + as_large) / (1.0 + kDraws);
  return d;
}

double mcnemar(int only_first, int only_second) {
  const int n = only_first + only_second;
  double tail = 0;
  for (int k = 0; k <= std::min(only_first, only_second); ++k)
    tail += std::exp(std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) -
                     n * std::log(2.0));
  return std::min(1.0, 2 * tail);
}

void Study::add(const Json& line) {
  lines_[line.at("scenario")][line.value("condition", line.at("attention").get<std::string>())]
        [line.at("seed")] = line;
  rows_.push_back(line);
}

std::vector<std::string> Study::scenarios() const {
  std::vector<std::string> names;
  for (const auto& [scenario, conditions] : lines_) names.push_back(scenario);
  return names;
}

std::vector<std::string> Study::conditions() const {
  std::set<std::string> names;
  for (const auto& [scenario, conditions] : lines_)
    for (const auto& [condition, trials] : conditions) names.insert(condition);
  return {names.begin(), names.end()};
}

std::vector<Json> Study::comparison(const std::string& reference) const {
  std::vector<Json> out;
  for (const auto& [scenario, conditions] : lines_) {
    const auto base = conditions.find(reference);
    if (base == conditions.end()) continue;
    for (const auto& [condition, trials] : conditions) {
      if (condition == reference) continue;
      const Json head{{"scenario", scenario}, {"condition", reference}, {"against", condition}};
      int only_first = 0, only_second = 0, pairs = 0;
      for (const auto& [seed, line] : base->second) {
        const auto other = trials.find(seed);
        if (other == trials.end()) continue;
        ++pairs;
        const bool a = line.value("success", false), b = other->second.value("success", false);
        only_first += a && !b;
        only_second += b && !a;
      }
      const int n1 = static_cast<int>(base->second.size()), n2 = static_cast<int>(trials.size());
      const int s1 = successes(base->second), s2 = successes(trials);
      Json success_row = head;
      success_row.update(
          {{"measure", "success"},
           {"mean", static_cast<double>(s1) / n1},
           {"mean_against", static_cast<double>(s2) / n2},
           {"low_of", {wilson_interval(s1, n1).first, wilson_interval(s2, n2).first}},
           {"high_of", {wilson_interval(s1, n1).second, wilson_interval(s2, n2).second}},
           {"difference", static_cast<double>(s1) / n1 - static_cast<double>(s2) / n2},
           {"p", mcnemar(only_first, only_second)},
           {"pairs", pairs}});
      out.push_back(success_row);
      for (const Measure& measure : kMeasures) {
        std::vector<double> first, second;
        for (const auto& [seed, line] : base->second) {
          const auto other = trials.find(seed);
          if (other == trials.end()) continue;
          const auto a = value(line, measure), b = value(other->second, measure);
          if (!a || !b) continue;
          first.push_back(*a);
          second.push_back(*b);
        }
        const PairedDifference d = paired_difference(first, second);
        if (d.pairs == 0) continue;
        Json row = head;
        row.update({{"measure", measure.name},
                    {"mean", d.first},
                    {"mean_against", d.second},
                    {"difference", d.difference},
                    {"low", d.low},
                    {"high", d.high},
                    {"p", d.p},
                    {"pairs", d.pairs}});
        out.push_back(row);
      }
    }
  }
  return out;
}

std::string Study::table(const std::string& reference) const {
  std::string text, head;
  for (const Json& row : comparison(reference)) {
    const std::string title = row["scenario"].get<std::string>() + ": " + reference + " against " +
                              row["against"].get<std::string>();
    char line[200];
    if (title != head) {
      head = title;
      text += "\n" + title + "\n";
      std::snprintf(line, sizeof line, "  %-20s %10s %10s %10s   %-22s %8s %6s\n", "",
                    reference.substr(0, 10).c_str(), "the other", "difference",
                    "95 % of the difference", "p", "pairs");
      text += line;
    }
    const std::string measure = row["measure"];
    const auto* known = std::find_if(std::begin(kMeasures), std::end(kMeasures),
                                     [&](const Measure& m) { return measure == m.name; });
    const int decimals = known == std::end(kMeasures) ? 3 : known->decimals;
    const auto show = [&](const char* key) {
      return row.contains(key) ? number(row[key].get<double>(), decimals) : std::string();
    };
    const std::string interval = row.contains("low")
                                     ? show("low") + " … " + show("high")
                                     : number(row["low_of"][0].get<double>(), 3) + "–" +
                                           number(row["high_of"][0].get<double>(), 3) + ", " +
                                           number(row["low_of"][1].get<double>(), 3) + "–" +
                                           number(row["high_of"][1].get<double>(), 3);
    std::snprintf(line, sizeof line, "  %-20s %10s %10s %10s   %-24s %8s %6d\n", measure.c_str(),
                  show("mean").c_str(), show("mean_against").c_str(), show("difference").c_str(),
                  interval.c_str(), number(row["p"].get<double>(), 4).c_str(),
                  row["pairs"].get<int>());
    text += line;
  }
  return text;
}

std::string Study::csv() const {
  std::string text = "order,scenario,condition,law,participant,seed,success,failure";
  for (const Measure& measure : kMeasures) text += std::string(",") + measure.name;
  text += "\n";
  std::size_t order = 0;
  for (const Json& line : rows_) {
    text += std::to_string(line.value("order", ++order)) + "," +
            line["scenario"].get<std::string>() + "," +
            line.value("condition", line["attention"].get<std::string>()) + "," +
            line.value("law", "") + "," + line.value("participant", "") + "," +
            std::to_string(line["seed"].get<std::uint64_t>()) + "," +
            (line.value("success", false) ? "1" : "0") + "," + line.value("failure", "");
    for (const Measure& measure : kMeasures) {
      const auto v = value(line, {measure.name, measure.decimals, false});
      text += "," + (v ? number(*v, 6) : std::string());
    }
    text += "\n";
  }
  return text;
}

std::string Study::plot(const std::string& scenario) const {
  struct Point {
    std::string condition;
    double x{}, y{}, dx{}, dy{};
  };
  std::vector<Point> points;
  const auto spread = [](const std::vector<double>& v) {
    const double m = mean(v);
    double sum = 0;
    for (double x : v) sum += (x - m) * (x - m);
    return v.size() < 2 ? 0.0
                        : 1.96 * std::sqrt(sum / static_cast<double>(v.size() - 1) /
                                           static_cast<double>(v.size()));
  };
  for (const auto& [condition, trials] : lines_.at(scenario)) {
    std::vector<double> cost, separation;
    for (const auto& [seed, line] : trials) {
      const auto c = value(line, {"cpu_chain_s", 0, false}),
                 s = value(line, {"min_separation_m", 0, false});
      if (!c || !s) continue;
      cost.push_back(*c);
      separation.push_back(*s);
    }
    if (!cost.empty())
      points.push_back({condition, mean(cost), mean(separation), spread(cost), spread(separation)});
  }
  constexpr double kWidth = 640, kHeight = 420, kLeft = 70, kRight = 20, kTop = 40, kBottom = 50;
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << kWidth << ' ' << kHeight
      << "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
         "fill=\"white\"/>\n<text x=\""
      << kLeft << "\" y=\"22\" font-size=\"14\">" << scenario
      << ": work of perception and planning, and least separation</text>\n";
  if (points.empty()) return svg.str() + "</svg>\n";
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
  for (const Point& p : points) {
    x0 = std::min(x0, p.x - p.dx), x1 = std::max(x1, p.x + p.dx);
    y0 = std::min(y0, p.y - p.dy), y1 = std::max(y1, p.y + p.dy);
  }
  const double mx = 0.08 * std::max(1e-6, x1 - x0), my = 0.08 * std::max(1e-6, y1 - y0);
  x0 -= mx, x1 += 3 * mx, y0 -= my, y1 += my;
  const auto px = [&](double x) {
    return kLeft + (x - x0) / (x1 - x0) * (kWidth - kLeft - kRight);
  };
  const auto py = [&](double y) {
    return kHeight - kBottom - (y - y0) / (y1 - y0) * (kHeight - kTop - kBottom);
  };
  for (int k = 0; k <= 4; ++k) {
    const double x = x0 + (x1 - x0) * k / 4, y = y0 + (y1 - y0) * k / 4;
    svg << "<path d=\"M" << px(x) << ' ' << py(y0) << 'V' << py(y1) << 'M' << px(x0) << ' ' << py(y)
        << 'H' << px(x1) << "\" stroke=\"#ddd\"/>\n<text x=\"" << px(x) << "\" y=\""
        << kHeight - kBottom + 16 << "\" text-anchor=\"middle\">" << number(x, 2)
        << "</text>\n<text x=\"" << kLeft - 6 << "\" y=\"" << py(y) + 4 << "\" text-anchor=\"end\">"
        << number(y, 3) << "</text>\n";
  }
  svg << "<text x=\"" << kWidth / 2 << "\" y=\"" << kHeight - 12
      << "\" text-anchor=\"middle\">CPU time of perception and planning a trial [s]</text>\n<text "
         "transform=\"translate(16 "
      << kHeight / 2 << ") rotate(-90)\" text-anchor=\"middle\">least separation [m]</text>\n";
  std::vector<Point> curve;
  std::copy_if(points.begin(), points.end(), std::back_inserter(curve),
               [](const Point& p) { return p.condition.starts_with("fixed"); });
  std::sort(curve.begin(), curve.end(),
            [](const Point& a, const Point& b) { return a.condition < b.condition; });
  for (std::size_t i = 0; i < curve.size(); ++i)
    svg << (i ? " L" : "<path fill=\"none\" stroke=\"#888\" d=\"M") << px(curve[i].x) << ' '
        << py(curve[i].y) << (i + 1 == curve.size() ? "\"/>\n" : "");
  for (const Point& p : points) {
    const char* colour = p.condition.starts_with("adaptive") ? "#c0392b"
                         : p.condition.starts_with("fixed")  ? "#888"
                                                             : "#2c5d9b";
    svg << "<path d=\"M" << px(p.x - p.dx) << ' ' << py(p.y) << 'H' << px(p.x + p.dx) << 'M'
        << px(p.x) << ' ' << py(p.y - p.dy) << 'V' << py(p.y + p.dy) << "\" stroke=\"" << colour
        << "\" opacity=\"0.5\"/>\n<circle cx=\"" << px(p.x) << "\" cy=\"" << py(p.y)
        << "\" r=\"4\" fill=\"" << colour << "\"/>\n<text x=\"" << px(p.x) + 7 << "\" y=\""
        << py(p.y) - 5 << "\" fill=\"" << colour << "\">" << p.condition << "</text>\n";
  }
  return svg.str() + "</svg>\n";
}

void write_study(const Study& study, const std::string& reference,
                 const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream out(folder / name);
    out << text;
    if (!out) throw ConfigError("cannot write " + (folder / name).string());
  };
  std::string lines;
  for (const Json& row : study.comparison(reference)) lines += row.dump() + "\n";
  write("comparison.jsonl", lines);
  write("table.txt", study.table(reference));
  write("trials.csv", study.csv());
  for (const std::string& scenario : study.scenarios())
    write(std::filesystem::path(scenario).stem().string() + ".svg", study.plot(scenario));
}

}  // namespace handsel
