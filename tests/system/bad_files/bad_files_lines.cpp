// SPDX-License-Identifier: Apache-2.0
// Bad JSON Lines on standard input of the batch commands: each line is answered, the exit code
// is 2.
#include "tests/system/bad_files/bad_files.hpp"

namespace handsel::test {

void add_lines(BadFiles& table) {
  const auto line = [&](const std::string& name, const std::string& command,
                        const std::string& input, const std::string& says) {
    table.push_back({"lines/" + name, "", command, says, 2, input + "\n", BadFile::Kind::missing});
  };
  const std::string solve = "trajectory solve", smooth = "trajectory smooth",
                    sample = "trajectory sample", distance = "distance";
  line("binary", solve, std::string("\0\1\377", 3), "this is not JSON");
  line("cut", solve, "{\"p0\": [0", "this is not JSON");
  line("deep", solve, std::string(200000, '['), "nested deeper than 64");
  line(
      "deep_object", distance,
      [] {
        std::string text;
        for (int i = 0; i < 100000; ++i) text += "{\"a\":";
        return text;
      }(),
      "nested deeper than 64");
  line("seventeen_megabytes", solve, std::string(17u << 20, ' ') + "1", "may have 16 MB");
  line("not_an_object", solve, "3", "expected an object");
  line("overflow", solve, "{\"p0\": [1e400]}", "this is not JSON");
  line("nan", solve, "{\"p0\": [NaN]}", "this is not JSON");
  line("text_for_number", solve, "{\"p0\": [\"a\"]}", "must be a finite number");
  line("missing_field", solve, "{\"p0\": [0]}", "is missing");
  line("sizes_differ", solve,
       "{\"p0\":[0,0],\"v0\":[0],\"a0\":[0],\"pf\":[1],\"vf\":[0],\"af\":[0],\"vmax\":[1],\"amax\":"
       "[1],\"jmax\":[1]}",
       "error");
  line("limit_zero", solve,
       "{\"p0\":[0],\"v0\":[0],\"a0\":[0],\"pf\":[1],\"vf\":[0],\"af\":[0],\"vmax\":[0],\"amax\":["
       "1],\"jmax\":[1]}",
       "error");
  line("limit_tiny", solve,
       "{\"p0\":[0],\"v0\":[0],\"a0\":[0],\"pf\":[1e300],\"vf\":[0],\"af\":[0],\"vmax\":[1e-300],"
       "\"amax\":[1e-300],\"jmax\":[1e-300]}",
       "error");
  line("no_nodes", smooth, "{\"nodes\":[],\"vmax\":[1],\"amax\":[1],\"jmax\":[1]}", "error");
  line("nodes_differ", smooth, "{\"nodes\":[[0],[0,1]],\"vmax\":[1],\"amax\":[1],\"jmax\":[1]}",
       "error");
  line("no_axes", sample, "{\"axes\": []}", "must be a list of axes");
  line("duration_negative", sample,
       "{\"axes\":[{\"p0\":0,\"v0\":0,\"a0\":0,\"segments\":[[-1,1]]}]}", "not negative");
  line("duration_huge", sample, "{\"axes\":[{\"p0\":0,\"v0\":0,\"a0\":0,\"segments\":[[1e9,0]]}]}",
       "more than a million samples");
  line("shape_unknown", distance, "{\"a\":{\"type\":\"cone\"},\"b\":{\"type\":\"cone\"}}", "error");
  line("radius_negative", distance,
       "{\"a\":{\"type\":\"sphere\",\"r\":-1},\"Ta\":{\"xyz\":[0,0,0],\"quat_xyzw\":[0,0,0,1]},"
       "\"b\":{\"type\":\"sphere\",\"r\":1},"
       "\"Tb\":{\"xyz\":[0,0,0],\"quat_xyzw\":[0,0,0,1]}}",
       "must be greater than 0");
  line("quaternion_zero", distance,
       "{\"a\":{\"type\":\"sphere\",\"r\":1},\"Ta\":{\"xyz\":[0,0,0],\"quat_xyzw\":[0,0,0,0]},"
       "\"b\":{\"type\":\"sphere\",\"r\":1},"
       "\"Tb\":{\"xyz\":[0,0,0],\"quat_xyzw\":[0,0,0,1]}}",
       "must not be zero");
  line("cost_point", "cost", "{\"p\": [1, 2]}", "must have 3 numbers");
  line("fk_unknown_joint", "model fk jido", "{\"q\": {\"tail\": 1}}", "tail");
  line("fk_list", "model fk jido", "{\"q\": [1]}", "error");
  line("score_edges", "grasp score",
       "{\"points\":[[0,0,0]],\"inward_normals\":[[0,0,1]],\"mu\":0.5,\"edges\":1e300}",
       "whole number");
  line("score_normal_zero", "grasp score",
       "{\"points\":[[0,0,0]],\"inward_normals\":[[0,0,0]],\"mu\":0.5,\"edges\":8}", "is zero");
  line("score_ragged", "grasp score", "{\"wrenches\":[[1,0],[1]]}", "another dimension");
  line("plan_no_goals", "plan --robot jido --group arm", "{\"start\": {}, \"goals\": []}",
       "at least one goal");
  line("plan_group_type", "plan --robot jido --group arm",
       "{\"start\": {}, \"goals\": [{}], \"group\": 3}", "another type");
  line("plan_obstacle", "plan --robot jido --group arm",
       "{\"start\": {}, \"goals\": [{}], \"obstacles\": [{\"type\": \"box\", \"dims\": [-1, 1, 1], "
       "\"pos\": [0, 0, 0], \"quat_xyzw\": [0, "
       "0, 0, 1]}]}",
       "error");
  line("plan_human", "plan --robot jido --group arm",
       "{\"start\": {}, \"goals\": [{}], \"human\": {\"joints\": {\"tail\": [0, 0, 0]}}}", "tail");
  line("timed_no_nodes", "trajectory timed --robot jido", "{\"start\": {}, \"nodes\": 3}", "error");
  line("cartesian_nodes", "trajectory cartesian --robot jido", "{\"nodes\": [{\"p\": [0, 0]}]}",
       "error");
}

}  // namespace handsel::test
