// SPDX-License-Identifier: Apache-2.0
// handsel._recording: what handsel/recording.py calls.
#include "common/base/errors.hpp"
#include "common/python/arguments.hpp"
#include "common/record/mcap.hpp"
#include "common/record/sample_table.hpp"

#include <pybind11/stl.h>

#include <map>
#include <set>

namespace handsel::python {
namespace {

/// Messages of one topic, while they are read.
struct Topic {
  std::string type, encoding;
  std::vector<std::int64_t> times;  // [ns]
  std::unique_ptr<idl::SampleTable> table;
  std::map<std::string, std::vector<std::string>> enumerations;
};
using Topics = std::map<std::string, Topic>;

/// Calls `use(topic, channel, message)` for each message of the file. Returns whether the recording
/// was cut off. Throws ConfigError naming file, topic and sample for what `use` throws.
template <class Use>
bool read_messages(const std::string& file, const Use& use) {
  mcap::Reader reader(file);
  mcap::Message message;
  std::map<std::string, std::size_t> numbers;
  while (reader.next(message)) {
    const mcap::Channel& channel = reader.channels().at(message.channel);
    const std::size_t number = numbers[channel.topic]++;
    try {
      use(channel, message);
    } catch (const ConfigError& error) {
      throw ConfigError(file + ": topic " + channel.topic + ", sample " + std::to_string(number) +
                        ": " + error.what());
    }
  }
  return reader.cut();
}

/// Returns topics with type, encoding and number of messages, the metadata, and whether the
/// recording was cut off.
py::tuple overview(py::handle file) {
  const std::string name = text(file, "file");
  std::map<std::string, std::size_t> counts;
  Topics topics;
  mcap::Metadata metadata;
  bool cut = false;
  {
    const Unlocked released;
    metadata = mcap::Reader(name).metadata();
    cut = read_messages(name, [&](const mcap::Channel& channel, const mcap::Message&) {
      ++counts[channel.topic];
      topics[channel.topic].type = channel.schema_name;
      topics[channel.topic].encoding = channel.encoding;
    });
  }
  py::dict listed;
  for (const auto& [topic, entry] : topics)
    listed[py::str(topic)] = py::make_tuple(entry.type, entry.encoding, counts[topic]);
  return py::make_tuple(listed, metadata, cut);
}

void measure_all(const std::string& file, const std::set<std::string>& wanted, Topics& topics) {
  read_messages(file, [&](const mcap::Channel& channel, const mcap::Message& message) {
    if (!wanted.contains(channel.topic)) return;
    Topic& topic = topics[channel.topic];
    if (!topic.table) {
      if (channel.encoding != "cdr" || channel.schema_encoding != "omgidl")
        throw ConfigError("messages are " + channel.encoding + " with schema " +
                          channel.schema_encoding + ", not cdr with omgidl");
      const idl::Schema schema = idl::Schema::parse(channel.schema);
      topic.type = channel.schema_name;
      topic.enumerations = schema.enumerations;
      topic.table = std::make_unique<idl::SampleTable>(schema, channel.schema_name);
    }
    if (topic.type != channel.schema_name) throw ConfigError("the topic has messages of two types");
    topic.table->measure(message.data);
    topic.times.push_back(message.time);
  });
}

void fill_all(const std::string& file, std::uint64_t max_bytes, Topics& topics) {
  for (auto& [name, topic] : topics) {
    try {
      topic.table->start_filling(max_bytes);
    } catch (const ConfigError& error) {
      throw ConfigError(file + ": topic " + name + ": " + error.what());
    }
  }
  read_messages(file, [&](const mcap::Channel& channel, const mcap::Message& message) {
    const auto topic = topics.find(channel.topic);
    if (topic != topics.end()) topic->second.table->fill(message.data);
  });
}

const char* numpy_type(idl::Kind kind) {
  switch (kind) {
    case idl::Kind::boolean:
      return "?";
    case idl::Kind::uint8:
      return "u1";
    case idl::Kind::int8:
      return "i1";
    case idl::Kind::int16:
      return "i2";
    case idl::Kind::uint16:
      return "u2";
    case idl::Kind::int32:
      return "i4";
    case idl::Kind::uint32:
    case idl::Kind::enumeration:
      return "u4";
    case idl::Kind::int64:
      return "i8";
    case idl::Kind::uint64:
      return "u8";
    case idl::Kind::float32:
      return "f4";
    default:
      return "f8";
  }
}

py::object column_array(const idl::Column& column) {
  if (column.kind != idl::Kind::text) {
    py::array out(py::dtype(numpy_type(column.kind)), column.shape);
    std::copy(column.numbers.begin(), column.numbers.end(),
              static_cast<std::uint8_t*>(out.mutable_data()));
    return out;
  }
  py::list texts;
  for (const std::string& value : column.texts)
    texts.append(py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(value.data(), static_cast<Py_ssize_t>(value.size()), "replace")));
  py::array flat = py::array::ensure(
      py::module_::import("numpy").attr("array")(texts, py::arg("dtype") = "object"));
  return flat.reshape(std::vector<py::ssize_t>(column.shape.begin(), column.shape.end()));
}

/// Returns for each wanted topic (type, times, columns, enumerations of columns).
py::dict read_tables(py::handle file, const std::vector<std::string>& wanted,
                     py::handle max_bytes) {
  const std::string name = text(file, "file");
  const auto limit = static_cast<std::uint64_t>(whole(max_bytes, "max_bytes", 1, 1LL << 50));
  Topics topics;
  {
    const Unlocked released;
    measure_all(name, {wanted.begin(), wanted.end()}, topics);
    fill_all(name, limit, topics);
  }
  py::dict out;
  for (auto& [topic, entry] : topics) {
    py::dict columns, enumerations;
    for (const idl::Column& column : entry.table->take_columns()) {
      columns[py::str(column.name)] = column_array(column);
      if (column.kind == idl::Kind::enumeration)
        enumerations[py::str(column.name)] = entry.enumerations.at(column.enumeration);
    }
    const py::array_t<std::int64_t> times(static_cast<py::ssize_t>(entry.times.size()),
                                          entry.times.data());
    out[py::str(topic)] = py::make_tuple(entry.type, times, columns, enumerations);
  }
  return out;
}

}  // namespace

PYBIND11_MODULE(_recording, m) {
  py::register_local_exception<ConfigError>(m, "FileError", PyExc_ValueError);
  py::register_local_exception<MissingError>(m, "MissingError", PyExc_FileNotFoundError);
  m.def("overview", &overview);
  m.def("read_tables", &read_tables);
}

}  // namespace handsel::python
