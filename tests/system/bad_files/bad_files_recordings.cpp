// SPDX-License-Identifier: Apache-2.0
// Bad recordings: motion of people (CSV, BVH), samples of a domain (MCAP), lines of trials.
#include <filesystem>
#include <limits>

#include "common/record/mcap_format.hpp"
#include "tests/system/bad_files/bad_files.hpp"

namespace handsel::test {
namespace {

void add_motion(BadFiles& table) {
  const std::string run = "run --headless --domain {domain} --human {}";
  for (const std::string kind : {"csv", "bvh"})
    for (const auto& entry : std::filesystem::directory_iterator(
             std::filesystem::path(HANDSEL_SOURCE_DIR) / "tests/fuzz/corpus" / kind)) {
      const std::string name = entry.path().filename().string();
      if (name.rfind("good", 0) != 0)
        table.push_back({kind + "/" + name, source_file("tests/fuzz/corpus/" + kind + "/" + name),
                         run, name + ":"});
    }
  table.push_back({"csv/binary.csv", std::string("\0\1\377", 3), run, "binary.csv:1"});
  table.push_back({"csv/long_line.csv", std::string(1 << 20, ','), run, "long_line.csv:1"});
  table.push_back({"bvh/binary.bvh", std::string("\0\1\377", 3), run, "binary.bvh:1"});
  table.push_back({"bvh/long_word.bvh", std::string(1 << 20, 'x'), run, "long_word.bvh:1"});
  table.push_back({"csv/missing.csv", "", run, "missing.csv", 3, "", BadFile::Kind::missing});
  table.push_back({"bvh/missing.bvh", "", run, "missing.bvh", 3, "", BadFile::Kind::missing});
  table.push_back(
      {"csv/unreadable.csv", "x", run, "cannot be read", 2, "", BadFile::Kind::unreadable});
}

std::string channel(std::uint16_t id, std::uint16_t schema, const std::string& topic) {
  std::string content;
  mcap::append(content, id);
  mcap::append(content, schema);
  mcap::append_text(content, topic);
  mcap::append_text(content, "cdr");
  mcap::append_text(content, "");
  std::string record;
  mcap::append_record(record, mcap::Op::channel, content);
  return record;
}

std::string message(std::uint16_t id, std::uint64_t time) {
  std::string content;
  mcap::append(content, id);
  mcap::append(content, std::uint32_t{1});
  mcap::append(content, time);
  mcap::append(content, time);
  content += "data";
  std::string record;
  mcap::append_record(record, mcap::Op::message, content);
  return record;
}

std::string chunk(const std::string& records, const std::string& compression, std::uint32_t crc,
                  std::uint64_t length) {
  std::string content;
  for (int i = 0; i < 3; ++i) mcap::append(content, std::uint64_t{records.size()});
  mcap::append(content, crc);
  mcap::append_text(content, compression);
  mcap::append(content, length);
  content += records;
  std::string record;
  mcap::append_record(record, mcap::Op::chunk, content);
  return record;
}

std::string chunk(const std::string& records) { return chunk(records, "", 0, records.size()); }

void add_mcap(BadFiles& table) {
  const std::string magic(mcap::kMagic);
  const std::string begin = magic + channel(0, 0, "handsel/nothing");
  const auto mcap = [&](const std::string& name, const std::string& content,
                        const std::string& says) {
    table.push_back({"mcap/" + name + ".mcap", content, "replay {} --domain {domain}", says});
  };
  mcap("empty", "", "is no MCAP recording");
  mcap("text", "x,y,z\n1,2,3\n", "is no MCAP recording");
  mcap("magic_only", magic, "has none of the topics");
  mcap("other_topic", begin + chunk(message(0, 1)), "has none of the topics");
  mcap("unknown_channel", begin + message(7, 1), "a message of channel 7, which was not announced");
  mcap("far_future", begin + message(0, std::numeric_limits<std::uint64_t>::max()),
       "after the year 2262");
  mcap("gap_of_a_century", begin + message(0, 0) + message(0, 3'155'760'000'000'000'000),
       "a recording has at most 30 days");
  mcap("checksum", begin + chunk(message(0, 1), "", 12345, message(0, 1).size()),
       "checksum does not fit");
  mcap("compressed", begin + chunk("abc", "lz4", 0, 3), "a chunk compressed with lz4");
  mcap("compression_long", begin + chunk("abc", std::string(100000, 'z'), 0, 3),
       "a chunk compressed with zzz");
  mcap("chunk_length", begin + chunk("abc", "", 0, 1ull << 60), "shorter than its fields");
  mcap("chunk_cut", begin + chunk(message(0, 1).substr(0, 20)), "ends within a record");
  mcap("chunk_in_chunk", begin + chunk(chunk(message(0, 1))), "a chunk within a chunk");
  std::string short_schema;
  mcap::append_record(short_schema, mcap::Op::schema, "a");
  mcap("schema_short", magic + short_schema, "shorter than its fields");
  std::string metadata;
  mcap::append_record(metadata, mcap::Op::metadata, std::string("\1\0\0\0m\377\377\377\177", 9));
  mcap("metadata_length", magic + metadata, "shorter than its fields");
  table.push_back({"mcap/missing.mcap", "", "replay {} --domain {domain}", "missing.mcap", 3, "",
                   BadFile::Kind::missing});
  table.push_back({"mcap/folder.mcap", "", "replay {} --domain {domain}", "is not a file", 2, "",
                   BadFile::Kind::folder});
}

void add_trials(BadFiles& table) {
  const auto lines = [&](const std::string& name, const std::string& content,
                         const std::string& says) {
    table.push_back({"eval/" + name + ".jsonl", content, "eval --from {}", says});
  };
  lines("binary", std::string("\0\1\377", 3), "binary.jsonl:1: this is not JSON");
  lines("no_scenario", "{\"seed\": 1}\n", "no_scenario.jsonl:1: this is no line of handsel eval");
  lines("wrong_type",
        "{\"scenario\": 3, \"seed\": \"x\", \"success\": \"perhaps\", \"attention\": []}\n",
        "wrong_type.jsonl:1");
  lines("list", "[1, 2]\n", "list.jsonl:1");
  lines("deep", std::string(100000, '[') + "\n", "nested deeper than 64");
  lines("overflow", "{\"scenario\": 1e400}\n", "overflow.jsonl:1: this is not JSON");
  table.push_back(
      {"eval/missing.jsonl", "", "eval --from {}", "missing.jsonl", 3, "", BadFile::Kind::missing});
  table.push_back(
      {"eval/folder.jsonl", "", "eval --from {}", "is not a file", 2, "", BadFile::Kind::folder});
}

}  // namespace

void add_recordings(BadFiles& table) {
  add_motion(table);
  add_mcap(table);
  add_trials(table);
}

}  // namespace handsel::test
