// SPDX-License-Identifier: Apache-2.0
#include "common/config/scenario.hpp"

#include <algorithm>
#include <random>
#include <set>

#include "common/base/errors.hpp"
#include "common/config/described.hpp"
#include "common/config/located.hpp"
#include "common/config/put_over.hpp"
#include "common/config/resources.hpp"
#include "common/config/setting.hpp"

namespace handsel {
namespace {

using Places = google::protobuf::TextFormat::ParseInfoTree;

constexpr const char* kClutter = "clutter";  // name under which the clutter number is reported

/// Random numbers of one draw, seeded by the seed and the draw's name, so that no draw affects
/// another.
class Random {
 public:
  Random(std::uint64_t seed, const std::string& name) {
    std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a
    for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
    generator_.seed(hash ^ (seed * 0x9e3779b97f4a7c15ULL));
  }
  /// Returns a number in [0, 1).
  double uniform() { return static_cast<double>(generator_() >> 11) * 0x1p-53; }
  /// Returns an integer in [0, count).
  int below(int count) { return std::min(count - 1, static_cast<int>(uniform() * count)); }

 private:
  std::mt19937_64 generator_;
};

double weight_of(const config::Variant& variant) {
  return variant.has_weight() ? variant.weight() : 1.0;
}

class Drawing {
 public:
  Drawing(const std::filesystem::path& file, std::uint64_t seed) : file_(file), seed_(seed) {
    load_text_proto(file, out_.scenario, places_);
    root_ = TextPlace(file.string(), &places_, config::Scenario::descriptor());
  }

  DrawnScenario draw() {
    config::Scenario& scenario = out_.scenario;
    check_draws();
    check_clutter(scenario, root_);
    const auto draws = scenario.draws();
    scenario.clear_draws();
    for (int i = 0; i < draws.size(); ++i) take_variant(draws[i], i);
    for (config::BoxDescription& box : *scenario.mutable_boxes()) draw_top(box);
    draw_clutter();
    return std::move(out_);
  }

 private:
  [[noreturn]] static void refuse(const TextPlace& at, const std::string& key,
                                  const std::string& sentence, int index = 0) {
    throw ConfigError(at.of(key, index) + ": " + sentence);
  }

  /// Refuses a missing description, as every seed may draw it.
  template <class Find>
  static void require_description(const TextPlace& at, const std::string& key, int index,
                                  const Find& find) {
    try {
      find();
    } catch (const MissingError& error) {
      throw MissingError(at.of(key, index) + ": " + error.what());
    }
  }

  void check_draws() const {
    std::set<std::string> names;
    for (int i = 0; i < out_.scenario.draws_size(); ++i) {
      const config::Draw& draw = out_.scenario.draws(i);
      const TextPlace at = root_.inside("draws", i);
      if (draw.name().empty()) refuse(root_, "draws", "a draw needs a name for the report", i);
      if (draw.name() == kClutter)
        refuse(at, "name", "is \"clutter\", under which the report has the number of objects");
      if (!names.insert(draw.name()).second)
        refuse(at, "name", "\"" + draw.name() + "\" is there twice; each draw needs its own");
      if (draw.variants().empty()) refuse(at, "name", "the draw has no variants");
      check_variants(draw, at);
    }
  }

  void check_variants(const config::Draw& draw, const TextPlace& in) const {
    std::set<std::string> names;
    double sum = 0;
    for (int i = 0; i < draw.variants_size(); ++i) {
      const config::Variant& variant = draw.variants(i);
      const TextPlace at = in.inside("variants", i), with = at.inside("with");
      if (variant.name().empty())
        refuse(in, "variants", "a variant needs a name for the report", i);
      if (!names.insert(variant.name()).second)
        refuse(at, "name", "\"" + variant.name() + "\" is there twice; each variant needs its own");
      sum += weight_of(variant);
      if (!variant.with().draws().empty())
        refuse(with, "draws", "a variant cannot hold draws; list them beside the others");
      if (!variant.with().robot().empty())
        require_description(with, "robot", 0, [&] {
          robot_description(described_name(file_, variant.with().robot()));
        });
      for (int k = 0; k < variant.with().objects_size(); ++k)
        if (const std::string& model = variant.with().objects(k).model(); !model.empty())
          require_description(with.inside("objects", k), "model", 0,
                              [&] { object_description(model); });
      check_clutter(variant.with(), with);
    }
    if (!(sum > 0)) refuse(in, "name", "the weights of the variants are all 0; one must be above");
  }

  static void check_clutter(const config::Scenario& scenario, const TextPlace& in) {
    for (int i = 0; i < scenario.clutter_size(); ++i) {
      const config::Clutter& clutter = scenario.clutter(i);
      const TextPlace at = in.inside(kClutter, i);
      if (clutter.on().empty())
        refuse(in, kClutter, "needs `on`: the box on which the objects stand", i);
      if (clutter.max_count() < clutter.min_count())
        refuse(at, "max_count",
               "is " + std::to_string(clutter.max_count()) + ", must be at least min_count, " +
                   std::to_string(clutter.min_count()));
      if (clutter.models().empty()) refuse(at, "on", "the clutter has no models to draw from");
      for (int k = 0; k < clutter.models_size(); ++k)
        require_description(at, "models", k, [&] { object_description(clutter.models(k)); });
    }
  }

  void take_variant(const config::Draw& draw, int index) {
    double sum = 0;
    for (const config::Variant& variant : draw.variants()) sum += weight_of(variant);
    double rest = Random(seed_, draw.name()).uniform() * sum;
    int taken = 0;
    for (int i = 0; i < draw.variants_size(); ++i) {
      const double weight = weight_of(draw.variants(i));
      if (!(weight > 0)) continue;
      taken = i;
      if (rest < weight) break;
      rest -= weight;
    }
    const config::Variant& variant = draw.variants(taken);
    out_.variants[draw.name()] = variant.name();
    if (!variant.has_with()) return;
    const auto* nested =
        places_.GetTreeForNested(config::Scenario::descriptor()->FindFieldByName("draws"), index)
            ->GetTreeForNested(config::Draw::descriptor()->FindFieldByName("variants"), taken)
            ->GetTreeForNested(config::Variant::descriptor()->FindFieldByName("with"), -1);
    put_over(out_.scenario, variant.with(), *nested,
             root_.inside("draws", index).inside("variants", taken).inside("with"));
  }

  void draw_top(config::BoxDescription& box) {
    if (!(box.top_jitter() > 0)) return;
    const double change = box.top_jitter() * (2 * Random(seed_, "top " + box.id()).uniform() - 1);
    box.clear_top_jitter();
    const double height = box.size().z() + change;
    if (!(height > 0))
      throw ConfigError(file_.string() + ": top_jitter of the box " + box.id() +
                        " must be below its height");
    box.mutable_size()->set_z(height);
    config::Vec3& centre = *box.mutable_pose()->mutable_xyz();
    centre.set_z(centre.z() + change / 2);
    out_.tops[box.id()] = centre.z() + height / 2;
  }

  void draw_clutter() {
    config::Scenario& scenario = out_.scenario;
    std::map<std::string, int> numbers, entries;  // last ones, by surface
    int count = 0;
    for (const config::Clutter& clutter : scenario.clutter()) {
      int& number = numbers[clutter.on()];
      Random random(seed_,
                    "clutter " + clutter.on() + " " + std::to_string(++entries[clutter.on()]));
      const int from = static_cast<int>(clutter.min_count());
      const int here = from + random.below(static_cast<int>(clutter.max_count()) - from + 1);
      count += here;
      for (int i = 0; i < here; ++i) {
        config::ObjectPlacement& object = *scenario.add_objects();
        object.set_id(clutter.on() + "_" + std::to_string(++number));
        object.set_model(clutter.models(random.below(clutter.models_size())));
        object.set_on(clutter.on());
        object.set_free_place(true);
        object.set_turn(3.14159);
        object.set_clearance(clutter.clearance());
      }
    }
    if (!scenario.clutter().empty()) out_.variants[kClutter] = std::to_string(count);
    scenario.clear_clutter();
  }

  std::filesystem::path file_;
  std::uint64_t seed_;
  Places places_;
  TextPlace root_;
  DrawnScenario out_;
};

}  // namespace

DrawnScenario draw_scenario(const std::filesystem::path& file, std::uint64_t seed) {
  return Drawing(file, seed).draw();
}

config::Scenario read_scenario(const std::filesystem::path& file, std::uint64_t seed) {
  return file.empty() ? config::Scenario() : draw_scenario(file, seed).scenario;
}

std::string scenario_robot(const std::string& scenario, std::uint64_t seed) {
  if (scenario.empty()) return "jido";
  const std::filesystem::path file = scenario_file(scenario);
  const config::Scenario read = read_scenario(file, seed);
  return read.robot().empty() ? "jido" : described_name(file, read.robot());
}

}  // namespace handsel
