// SPDX-License-Identifier: Apache-2.0
// Bad settings of each component and the files beside them: task domain, calibration, profiles of
// people, the transport's own XML.
#include "tests/system/bad_files/bad_files.hpp"

namespace handsel::test {
namespace {

/// The settings are copied beside the bad one, so that the component finds the others.
std::string component(const std::string& name) {
  return "env sh -c 'cp -n {source}/deploy/config/*.txtpb {folder}; exec handsel_" + name +
         " --standby --scenario give_mug --domain {domain} --config {folder}'";
}

/// A shipped settings file with one line replaced: the first that begins with `key`.
std::string changed(const std::string& file, const std::string& key, const std::string& line) {
  std::string text = source_file("deploy/config/" + file);
  const std::size_t at = ("\n" + text).find("\n" + key);
  if (at == std::string::npos) return with(text, key, line);
  return text.replace(at, text.find('\n', at) - at, line);
}

class Settings {
 public:
  Settings(BadFiles& table, std::string component, std::string file)
      : table_(table), component_(std::move(component)), file_(std::move(file)) {}

  /// Adds a key with a refused value and the error text; "is ..." abbreviates "<key>: is ...".
  Settings& key(const std::string& name, const std::string& value, const std::string& says) {
    const std::string sentence = says.rfind("is ", 0) == 0 ? name + ": " + says : says;
    return add(name + "_" + std::to_string(++rows_),
               changed(file_, name + ":", name + ": " + value), sentence);
  }
  Settings& text(const std::string& row, const std::string& content, const std::string& says) {
    return add(row, content, says);
  }
  Settings& missing() {
    table_.push_back(
        {component_ + "_missing/" + file_, "",
         "env sh -c 'cp {source}/deploy/config/*.txtpb {folder}; rm {}; exec handsel_" +
             component_ + " --standby --scenario give_mug --domain {domain} --config {folder}'",
         file_, 3, "", BadFile::Kind::missing});
    return *this;
  }

 private:
  Settings& add(const std::string& row, const std::string& content, const std::string& says) {
    table_.push_back({component_ + "_" + row + "/" + file_, content, component(component_), says});
    return *this;
  }

  BadFiles& table_;
  std::string component_, file_;
  int rows_{0};
};

void add_components(BadFiles& table) {
  Settings(table, "spark", "spark.txtpb")
      .key("publish_period", "nan", "is nan, must be a number in (0, 10]")
      .key("human_period", "0", "is 0, must be")
      .key("joint_noise", "-1", "is -1, must be")
      .key("danger_zone", "0.05", "contact_zone: the zones must grow")
      .key("trunk_acceleration", "11", "trunk_sudden_acceleration: must be at least")
      .key("joint_acceleration", "21", "joint_sudden_acceleration: must be at least")
      .key("lost_speed", "1e400", "is inf, must be")
      .text("unknown_key", "speed: 1\n", "spark.txtpb:1")
      .text("binary", std::string("\0\377\1", 3), "spark.txtpb:1")
      .missing();
  Settings(table, "supervisor", "supervisor.txtpb")
      .key("period", "-inf", "is -inf, must be")
      .key("speed_override", "1.5", "is 1.5, must be")
      .key("plan_nodes", "-1", "Expected integer")
      .key("plan_depth", "4294967295", "is 4.29497e+09, must be")
      .key("domain", "\"\"", "must name the file of the task domain")
      .missing();
  Settings(table, "trajectory_controller", "trajectory_controller.txtpb")
      .key("period", "nan", "is nan, must be")
      .key("late_limit", "1.5", "Expected integer")
      .key("recoil_limit", "2", "is 2, must be a number in [0, 1]")
      .text("empty", "", "view: must be given")
      .missing();
  Settings(table, "path_planner", "path_planner.txtpb")
      .key("step", "inf", "is inf, must be")
      .key("verify_step", "\"small\"", "Expected double")
      .key("max_idle_rounds", "0", "is 0, must be")
      .key("smoothing_rounds", "-5", "is -5, must be");
  Settings(table, "grasp_planner", "grasp_planner.txtpb")
      .key("positions", "4000000000", "is 4e+09, must be")
      .key("grip_friction", "1.1", "is 1.1, must be")
      .text("small_pool", "transfer_pool: 9\n", "transfer_pool: must be at least transfer_partners")
      .key("cone_edges", "3", "is 3, must be");
  Settings(table, "manipulation_planner", "manipulation_planner.txtpb")
      .key("otp_max_ahead", "0.3", "otp_max_ahead: must be at least otp_min_ahead")
      .text("sparse_crowd", "place_min_gap: 0.06\n", "place_min_gap: must be at most place_gap")
      .text("short_trail", "offer_trail: 1.0\n", "offer_trail: must be above offer_rest")
      .key("planning_time", "nan", "is nan, must be")
      .key("carry_speed", "7", "is 7, must be")
      .key("hand_timeout", "-1", "is -1, must be");
  Settings(table, "collision_checker", "collision_checker.txtpb")
      .key("period", "0", "is 0, must be")
      .key("horizon", "nan", "is nan, must be");
  Settings(table, "costmap", "costmap.txtpb")
      .key("resolution", "1e-400", "is 0, must be")
      .key("repeat", "0.6", "is 0.6, must be");
  Settings(table, "costmap", "cost.txtpb")
      .key("safety_radius", "inf", "is inf, must be")
      .key("w_safety", "-1", "is -1, must be");
  Settings(table, "trajectory_planner", "trajectory_planner.txtpb")
      .key("corner_step", "nan", "is nan, must be")
      .key("allowed_excess", "1", "is 1, must be");
  Settings(table, "attention", "attention.txtpb")
      .key("tick", "nan", "is nan, must be")
      .key("contact_zone", "9", "the zones must grow")
      .key("gaze_advantage", "1.01", "is 1.01, must be a number in [0, 1]");
  Settings(table, "bridge", "bridge.txtpb")
      .key("port", "70000", "is 70000, must be")
      .key("rate", "nan", "is nan, must be")
      .key("max_clients", "0", "is 0, must be");
  Settings(table, "sim", "sim.txtpb")
      .key("step", "1", "is 1, must be")
      .key("position_noise", "nan", "is nan, must be")
      .key("solver_iterations", "2000000000", "is 2e+09, must be")
      .key("taking_directions", "0", "is 0, must be")
      .key("person_close_time", "0", "is 0, must be")
      .key("taking_place_max_lean", "0.4", "taking_place_max_lean: must be at most person_max_lean")
      .key("taking_max_offer_speed", "0.3", "must be at most taking_max_target_speed")
      .key("taking_max_early_target_speed", "0.3", "taking_max_early_offer_speed: must be at most")
      .key("taking_min_reach_time", "2", "taking_min_reach_time: must be at most")
      .key("taking_hold_gap", "0.01", "taking_touch_gap: must be at most taking_hold_gap")
      .key("external_min_motion", "0.2", "must be at most external_max_motion");
  Settings(table, "ros2_lane", "ros2_lane.txtpb")
      .key("people_rate", "nan", "is nan, must be")
      .key("tf_rate", "900", "is 900, must be");
  Settings(table, "position_arm", "position_arm.txtpb").key("cycle", "nan", "is nan, must be");
  Settings(table, "reflex_arm", "reflex_arm.txtpb")
      .key("joint_deceleration", "inf", "is inf, must be");
}

void add_companions(BadFiles& table) {
  Settings(table, "spark", "calibration.txtpb")
      .text("days_nan", "valid_days: nan\n", "calibration.txtpb:1:valid_days: is nan")
      .text("no_camera", "sources { source: \"a\" speaks_in: CAMERA }\n", "T_world_camera")
      .text("source_twice", "sources { source: \"a\" }\nsources { source: \"a\" }\n",
            "is there twice")
      .text("no_name", "sources { }\n", "a source has no name")
      .text("quaternion_zero",
            "sources { source: \"a\" speaks_in: CAMERA T_world_camera { orientation { w: 0 } } }\n",
            "norm 0")
      .text("mirrored",
            "robots { robot: \"jido\" T_world_base { rotation: [-1, 0, 0, 0, 1, 0, 0, 0, 1] } }\n",
            "mirrors")
      .text("no_date", "robots { robot: \"jido\" measured: \"2026-02-30\" }\n", "no date")
      .text("far", "robots { robot: \"jido\" T_world_base { position { x: 1e5 } } }\n",
            "x: is 100000");
  Settings(table, "spark", "people.txtpb")
      .text("height_nan", "people { id: \"a\" height: nan }\n", "people.txtpb:1:height: is nan")
      .text("person_twice", "people { id: \"a\" }\npeople { id: \"a\" }\n", "two profiles")
      .text("giant", "people { id: \"a\" height: 17 }\n", "is 17, must be a number in [0, 2.5]");
  Settings(table, "supervisor", "tasks.txtpb")
      .text("tasks_binary", std::string("\1\2\3", 3), "tasks.txtpb:1")
      .text("cost_nan", "tasks { name: \"t\" methods { cost: nan } }\n",
            "tasks.txtpb:1:cost: is nan")
      .text("no_methods", "tasks { name: \"t\" }\n", "has no methods")
      .text("task_twice",
            "tasks { name: \"t\" methods { name: \"m\" } }\ntasks { name: \"t\" methods { name: "
            "\"m\" } }\n",
            "is there already")
      .text("no_predicate",
            "tasks { name: \"t\" methods { name: \"m\" when { is: \"flies ?x\" } } }\n",
            "is no predicate")
      .text("endless", "tasks { name: \"t\" methods { name: \"m\" steps { task: \"u\" } } }\n",
            "neither a task nor an action")
      .text("both", "tasks { name: \"t\" methods { name: \"m\" steps { task: \"t\" all { } } } }\n",
            "either a task or all")
      .missing();
}

void add_transport(BadFiles& table) {
  const std::string watch =
      "env CYCLONEDDS_URI=file://{} handsel topic hz robot_state --seconds 0.1 --domain {domain}";
  const auto xml = [&](const std::string& name, const std::string& content,
                       const std::string& says) {
    table.push_back({"dds/" + name + ".xml", content, watch, says});
  };
  xml("empty", "", "is no XML");
  xml("binary", std::string("\0\1\377", 3), "is no XML");
  xml("deep", std::string(3000, '<'), "is no XML");
  xml("unknown", "<CycloneDDS><Domain><Speed>1</Speed></Domain></CycloneDDS>",
      "the DDS configuration cannot be used");
  xml("size_nan",
      "<CycloneDDS><Domain><Internal><MaxSampleSize>nan</MaxSampleSize></Internal></Domain></"
      "CycloneDDS>",
      "the DDS configuration cannot be used");
  table.push_back(
      {"dds/missing.xml", "", watch, "missing.xml is not there", 3, "", BadFile::Kind::missing});
  table.push_back(
      {"dds/folder.xml", "", watch, "folder.xml is not there", 3, "", BadFile::Kind::folder});
}

}  // namespace

void add_settings(BadFiles& table) {
  add_components(table);
  add_companions(table);
  add_transport(table);
}

}  // namespace handsel::test
