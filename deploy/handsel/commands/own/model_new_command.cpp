// SPDX-License-Identifier: Apache-2.0
// handsel model new: the description of a user's robot from its URDF.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "common/base/errors.hpp"
#include "common/config/text_check.hpp"
#include "deploy/handsel/cli/terminal.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/commands/model_command.hpp"
#include "deploy/handsel/own_robot/robot_maker.hpp"

namespace handsel {
namespace {

namespace fs = std::filesystem;

struct RobotOptions {
  std::string urdf, srdf, joint_limits, name, out, hand, tool;
  std::vector<std::string> packages, without;
  int configurations{MatrixSettings{}.configurations};
  double time{60};
  bool replace{};
};

/// Returns the name of a robot from that of a file: letters, digits and "_"; others become "_".
std::string robot_name(const fs::path& file) {
  std::string name = file.stem().string();
  if (name.ends_with(".urdf")) name.erase(name.size() - 5);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  if (name.empty()) name = "robot";
  return name;
}

std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// Returns the URDF of a xacro file, expanded by the user's xacro program.
fs::path expanded(const fs::path& xacro, const fs::path& to) {
  if (!fs::exists(xacro)) throw MissingError("no file " + xacro.string());
  const std::string by_hand =
      "`xacro " + xacro.string() + " > robot.urdf`, then `handsel model new robot.urdf`";
  if (std::system("command -v xacro >/dev/null 2>&1") != 0)
    throw MissingError(
        xacro.string() +
        ": the program xacro is not installed here; expand the file where ROS is: " + by_hand);
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (std::system(
          ("xacro " + shell_quoted(xacro.string()) + " > " + shell_quoted(to.string())).c_str()) !=
      0)
    throw ConfigError(xacro.string() +
                      ": xacro does not expand the file, see above; correct it: " + by_hand);
  return to;
}

void print_made(const MadeRobot& made, const std::string& name) {
  std::map<PairKind, int> kinds;
  for (const LinkPair& pair : made.pairs) ++kinds[pair.kind];
  std::printf("%s: arm of %zu axes, hand of %zu, reach %.2f m, %d capsules\n", name.c_str(),
              made.parts.arm.size(), made.parts.hand.size(), made.reach, made.capsules);
  std::printf("  pairs of links: %d never touch, %d always, %d sometimes\n", kinds[PairKind::never],
              kinds[PairKind::always], kinds[PairKind::sometimes]);
  for (const std::string& note : made.notes) std::fprintf(stderr, "note: %s\n", note.c_str());
  std::printf("  only you can know:\n");
  for (const std::string& line : made.only_you) std::printf("  - %s\n", line.c_str());
}

int make_new(const RobotOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  RobotWishes wishes;
  const bool is_xacro = options.urdf.ends_with(".xacro");
  wishes.name =
      robot_name(options.name.empty() ? fs::path(options.urdf) : fs::path(options.name + ".urdf"));
  wishes.folder = options.out.empty() ? fs::path(wishes.name) : fs::path(options.out);
  std::error_code error;
  if (!options.replace && fs::exists(wishes.folder / (wishes.name + ".txtpb"), error))
    throw ConfigError((wishes.folder / (wishes.name + ".txtpb")).string() +
                      " is there already; --replace writes all files anew, --name another robot");
  wishes.urdf = is_xacro ? expanded(options.urdf, wishes.folder / (wishes.name + "_expanded.urdf"))
                         : fs::path(options.urdf);
  wishes.srdf = options.srdf;
  wishes.joint_limits = options.joint_limits;
  wishes.hand = options.hand;
  wishes.tool = options.tool;
  wishes.packages.assign(options.packages.begin(), options.packages.end());
  if (is_xacro)  // meshes lie around the xacro, not around the expanded file
    for (fs::path above = fs::absolute(options.urdf).parent_path(); above != above.root_path();
         above = above.parent_path())
      wishes.packages.push_back(above);
  wishes.without = options.without;
  wishes.matrix.configurations = options.configurations;
  bool in_time = true;
  const MadeRobot made = make_robot(wishes, [&](const std::string& what, double done) {
    if (progress_wanted()) std::fprintf(stderr, "\r\033[K%s, %.0f %%", what.c_str(), 100 * done);
    in_time = in_time && elapsed() < options.time;
    return in_time;
  });
  if (progress_wanted()) std::fprintf(stderr, "\r\033[K");
  print_made(made, wishes.name);
  if (!in_time)
    std::fprintf(stderr, "note: after %.0f s fewer configurations than asked for were sampled\n",
                 options.time);
  const std::vector<std::string> lacks = lacks_of(RobotModel::load(made.description));
  for (const std::string& lack : lacks) std::printf("  missing: %s\n", lack.c_str());
  std::printf("  written in %.1f s: %s and %zu more files\n", elapsed(), made.description.c_str(),
              made.files.size() - 1);
  std::printf("  try: handsel eval --scenario %s --trials 1\n", made.scenario.c_str());
  return lacks.empty() ? 0 : 1;
}

}  // namespace

void add_model_new_command(CLI::App& model, int& exit_code) {
  CLI::App* command = model.add_subcommand(
      "new", "creates the description of a robot from its URDF, in a folder of its own");
  command->footer(
      "example: handsel model new ur5e.urdf --srdf ur5e.srdf --joint-limits joint_limits.yaml");
  auto o = std::make_shared<RobotOptions>();
  command->add_option("urdf", o->urdf, "URDF of the robot, or xacro when xacro is installed")
      ->required();
  command->add_option("--srdf", o->srdf, "SRDF of MoveIt: pairs of links that cannot collide");
  command->add_option("--joint-limits", o->joint_limits,
                      "joint_limits.yaml of MoveIt: velocities, accelerations and jerks");
  command->add_option("--name", o->name, "name of the robot (default: the file's)");
  command->add_option("--out", o->out, "folder that is written (default: the name)");
  command->add_option("--hand", o->hand,
                      "hand description, name or file (default: that of the URDF, else parallel)");
  command->add_option("--tool", o->tool,
                      "link that carries the hand, or is its palm (default: searched for)");
  command
      ->add_option("--without", o->without,
                   "link that is left out, with all it carries; may be repeated")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--packages", o->packages,
                   "folder in which package:// is searched; may be repeated")
      ->expected(1)
      ->take_all();
  command
      ->add_option("--configurations", o->configurations,
                   "random configurations for the pairs of links that can touch")
      ->check(CLI::Range(1000, 10'000'000))
      ->capture_default_str();
  command->add_option("--time", o->time, "max time of sampling [s]")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->add_flag("--replace", o->replace, "replace an existing description");
  command->callback([o, &exit_code] { exit_code = make_new(*o); });
}

}  // namespace handsel
