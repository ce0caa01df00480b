// SPDX-License-Identifier: Apache-2.0
#include "common/wire/schema.hpp"

#include <set>
#include <stdexcept>

namespace handsel {
namespace {

using Files = std::map<std::string, std::string_view>;

void append(const Files& files, const std::string& name, std::set<std::string>& done,
            std::string& out) {
  if (!done.insert(name).second) return;
  const auto file = files.find(name);
  if (file == files.end()) throw std::logic_error("IDL: no file " + name);
  std::string_view rest = file->second;
  while (!rest.empty()) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    if (line.starts_with("#include")) {
      const std::size_t begin = line.find('"') + 1;
      append(files, std::string(line.substr(begin, line.rfind('"') - begin)), done, out);
    } else if (!line.starts_with('#')) {
      out.append(line).push_back('\n');
    }
  }
}

}  // namespace

std::string idl_schema(const TopicRow& row) {
  const Files files = idl_files();
  const std::string definition = std::string("struct ") + row.type + " {";
  for (const auto& [name, text] : files) {
    if (text.find(definition) == std::string_view::npos) continue;
    std::string out;
    std::set<std::string> done;
    append(files, name, done, out);
    return out;
  }
  throw std::logic_error(std::string("IDL: no struct ") + row.type);
}

}  // namespace handsel
