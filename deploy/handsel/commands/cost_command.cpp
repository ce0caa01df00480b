// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/cost/cost_settings.hpp"
#include "common/model/human/human_body.hpp"
#include "deploy/handsel/cli/json_lines.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/pictures/cost_picture.hpp"

namespace handsel {
namespace {

struct CostOptions {
  std::string stance{"standing"}, settings, svg;
  double stature{1.75}, cell{0.04};
};

Person person_of(const CostOptions& options) {
  Person person;
  person.id = "person";
  person.stature = options.stature;
  person.joints = options.stance == "standing" ? standing_body(Vector3::Zero(), 0, options.stature)
                                               : sitting_body(Vector3::Zero(), 0, options.stature);
  person.gaze_known = true;
  person.gaze_origin = person.joints[static_cast<std::size_t>(body_joint_index("head"))].position;
  person.gaze_direction = Vector3(1, 0, -0.25).normalized();
  return person;
}

int run(const CostOptions& options) {
  const CostSettings settings = load_cost_settings(
      options.settings.empty() ? resource("config") : std::filesystem::path(options.settings));
  const Person person = person_of(options);
  if (!options.svg.empty()) {
    char title[160];
    std::snprintf(
        title, sizeof title,
        "Costs around a %s person of %.2f m, weights %g safety, %g visibility, %g comfort",
        options.stance.c_str(), options.stature, settings.w_safety, settings.w_visibility,
        settings.w_comfort);
    std::ofstream file(options.svg);
    file << cost_picture(person, settings, options.cell, title);
    if (!file.flush()) throw ConfigError(options.svg + ": cannot be written");
    std::fprintf(stderr, "wrote %s\n", options.svg.c_str());
    return 0;
  }
  return command::for_each_line(
      std::cin, std::cout, [&](const nlohmann::json& line) -> nlohmann::json {
        const CostParts parts = point_cost(person, command::vector3(line, "p"), settings);
        return {{"safety", parts.safety},
                {"visibility", parts.visibility},
                {"comfort", parts.comfort},
                {"distance", parts.distance},
                {"cost", weighted_cost(parts, settings)}};
      });
}

}  // namespace

void add_cost_command(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<CostOptions>();
  CLI::App* command = app.add_subcommand(
      "cost", "computes the human-aware costs of points around a person, or draws them");
  command->footer(
      R"(Without --svg the points are read from stdin, one line {"p": [x, y, z]} [m] for each; the
person stands or sits at the origin and faces +x.)");
  command->add_option("--stance", options->stance, "stance of the person")
      ->check(CLI::IsMember({"standing", "sitting"}))
      ->capture_default_str();
  command->add_option("--stature", options->stature, "stature of the person [m]")
      ->check(CLI::Range(1.0, 2.2))
      ->capture_default_str();
  command->add_option("--settings", options->settings,
                      "folder with cost.txtpb (default: the shipped one)");
  command->add_option("--svg", options->svg, "file for a picture of the three costs and their sum");
  command->add_option("--cell", options->cell, "size of a cell of the picture [m]")
      ->check(CLI::Range(0.005, 0.2))
      ->capture_default_str();
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace handsel
