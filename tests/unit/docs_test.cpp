// SPDX-License-Identifier: Apache-2.0
// Everything that the documents name exists.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = HANDSEL_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::set<std::string> matches(const std::string& text, const std::string& pattern) {
  std::set<std::string> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it)
    found.insert((*it)[1]);
  return found;
}

TEST(Docs, every_library_the_build_asks_for_has_its_reason) {
  const std::string reasons = text_of(kRoot / "docs/dependencies.md");
  std::string asked = text_of(kRoot / "CMakeLists.txt") + text_of(kRoot / "tests/CMakeLists.txt");
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "components")) {
    if (entry.path().filename() == "CMakeLists.txt") asked += text_of(entry.path());
  }
  const auto libraries = matches(asked, R"(find_package\((\w+))");
  ASSERT_GE(libraries.size(), 10u);
  for (const std::string& library : libraries)
    EXPECT_THAT(reasons, testing::ContainsRegex("`" + library + "`"));
}

TEST(Docs, every_package_of_the_set_up_has_its_reason) {
  const std::string setup = text_of(kRoot / "deploy/setup.sh");
  const std::string reasons = text_of(kRoot / "docs/dependencies.md");
  int count = 0;
  for (const std::string& name : matches(setup, R"(\n(\w*packages)=")")) {
    const std::size_t begin = setup.find('"', setup.find("\n" + name + "=")) + 1;
    std::istringstream packages(setup.substr(begin, setup.find('"', begin) - begin));
    for (std::string package; packages >> package; ++count)
      EXPECT_NE(reasons.find(package), std::string::npos) << package;
  }
  EXPECT_GT(count, 10);
}

TEST(Docs, files_that_are_linked_exist) {
  std::set<fs::path> documents{kRoot / "README.md"};
  for (const auto& entry : fs::directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() == ".md") documents.insert(entry.path());
  }
  for (const fs::path& document : documents) {
    for (const std::string& link : matches(text_of(document), R"(\]\(([^)#:]+)\))"))
      EXPECT_TRUE(fs::exists(document.parent_path() / link)) << document << " links " << link;
  }
}

TEST(Docs, every_component_says_what_it_reads_and_writes) {
  for (const auto& entry : fs::directory_iterator(kRoot / "components")) {
    if (!entry.is_directory()) continue;
    EXPECT_TRUE(fs::exists(entry.path() / "README.md")) << entry.path();
  }
}

TEST(Docs, the_project_speaks_of_itself_only) {
  const std::regex unfinished(R"(\b(TO)DO\b|\b(FIX)ME\b|\bX{3}\b)");
  for (const char* folder : {"common", "components", "sim", "deploy", "tests", "idl", "docs"}) {
    if (!fs::exists(kRoot / folder)) continue;
    for (fs::recursive_directory_iterator at(kRoot / folder), end; at != end; ++at) {
      const fs::directory_entry& entry = *at;
      if (entry.path().filename() == "node_modules")
        at.disable_recursion_pending();  // third-party code
      const std::set<std::string> read{".hpp", ".cpp",   ".md", ".proto", ".txtpb", ".idl",
                                       ".txt", ".cmake", ".sh", ".story", ".js"};
      if (!entry.is_regular_file() || !read.count(entry.path().extension())) continue;
      EXPECT_FALSE(std::regex_search(text_of(entry.path()), unfinished))
          << entry.path() << " is unfinished";
    }
  }
}

}  // namespace
