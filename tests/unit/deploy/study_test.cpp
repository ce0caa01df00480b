// SPDX-License-Identifier: Apache-2.0
// Conditions with the same seeds are paired, and distinguished only if they differ.
#include "deploy/handsel/eval/study.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace handsel::study_test {
namespace {

using testing::HasSubstr;
using Json = nlohmann::json;

Json line(const std::string& condition, std::uint64_t seed, bool success, double separation,
          double cpu) {
  return {{"scenario", "give"}, {"attention", condition}, {"condition", condition},
          {"seed", seed},       {"success", success},     {"min_separation_m", separation},
          {"cpu_chain_s", cpu}, {"activations", 40},      {"activations_at_pmin", 100}};
}

const Json& row(const std::vector<Json>& rows, const std::string& measure) {
  for (const Json& r : rows)
    if (r["measure"] == measure) return r;
  throw std::logic_error("no row " + measure);
}

TEST(PairedDifference, finds_a_small_shift_that_every_pair_shows) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> place(0, 1), noise(0, 0.1);
  std::vector<double> a, b;
  for (int i = 0; i < 60; ++i) {
    const double common = place(random);
    a.push_back(common + 0.1 + noise(random));
    b.push_back(common);
  }
  const PairedDifference d = paired_difference(a, b);
  EXPECT_NEAR(d.difference, 0.1, 0.04);
  EXPECT_TRUE(d.unlike());
  EXPECT_LT(d.p, 0.001);
  const PairedDifference other_way = paired_difference(b, a);
  EXPECT_NEAR(other_way.difference, -d.difference, 1e-12);
}

TEST(PairedDifference, chance_is_called_chance_about_as_often_as_it_should) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0, 1);
  int unlike = 0, small = 0;
  for (int study = 0; study < 200; ++study) {
    std::vector<double> a(30), b(30);
    for (double* v : {a.data(), b.data()})
      for (int i = 0; i < 30; ++i) v[i] = noise(random);
    const PairedDifference d = paired_difference(a, b);
    unlike += d.unlike();
    small += d.p < 0.05;
  }
  EXPECT_NEAR(unlike, 10, 10);
  EXPECT_NEAR(small, 10, 10);
}

TEST(PairedDifference, nothing_and_equals_are_no_difference) {
  EXPECT_EQ(paired_difference({}, {}).pairs, 0u);
  EXPECT_FALSE(paired_difference({1, 2, 3}, {1, 2, 3}).unlike());
  EXPECT_EQ(paired_difference({1, 2, 3}, {1, 2, 3}).p, 1.0);
  EXPECT_THROW(paired_difference({1}, {}), std::invalid_argument);
}

/// Values of the binomial distribution.
TEST(McNemar, is_the_exact_test) {
  EXPECT_EQ(mcnemar(0, 0), 1.0);
  EXPECT_NEAR(mcnemar(0, 5), 0.0625, 1e-9);
  EXPECT_NEAR(mcnemar(9, 1), 0.021484375, 1e-9);
  EXPECT_EQ(mcnemar(3, 3), 1.0);
}

TEST(Study, compares_what_has_the_same_seed_and_hands_it_on) {
  Study study;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const double place = 0.01 * static_cast<double>(seed);
    study.add(line("max", seed, true, 0.2 + place, 2.0));
    study.add(line("adaptive", seed, seed != 3, 0.2 + place, 1.5));
    study.add(line("fixed:0.2", seed, true, 0.15 + place, 1.7));
    study.add(line("fixed:1", seed, true, 0.12 + place, 1.2));
  }
  study.add(line("adaptive", 99, true, 5.0, 50.0));
  const std::vector<Json> rows = study.comparison("adaptive");
  const Json& success = row(rows, "success");
  EXPECT_EQ(success["pairs"], 12);
  const auto against = [&](const std::string& condition, const std::string& measure) {
    for (const Json& r : rows)
      if (r["against"] == condition && r["measure"] == measure) return r;
    throw std::logic_error("no row");
  };
  EXPECT_NEAR(against("max", "cpu_chain_s")["difference"].get<double>(), -0.5, 1e-9)
      << "seed 99 has no partner";
  EXPECT_LT(against("max", "cpu_chain_s")["p"].get<double>(), 0.01);
  EXPECT_NEAR(against("max", "min_separation_m")["difference"].get<double>(), 0.0, 1e-9);
  EXPECT_THAT(study.table("adaptive"), HasSubstr("give: adaptive against max"));
  const std::string csv = study.csv();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 4 * 12 + 1);
  EXPECT_THAT(csv, HasSubstr("give,adaptive,"));
  const std::string svg = study.plot("give");
  EXPECT_THAT(svg, testing::StartsWith("<svg"));
  EXPECT_THAT(svg, HasSubstr(">adaptive</text>"));
  EXPECT_THAT(svg, HasSubstr("fill=\"none\" stroke=\"#888\""));
}

}  // namespace
}  // namespace handsel::study_test
