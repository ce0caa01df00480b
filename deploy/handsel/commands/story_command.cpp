// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "common/config/search_path.hpp"
#include "deploy/handsel/commands/commands.hpp"
#include "deploy/handsel/story/story_runner.hpp"
#include "deploy/handsel/system/system_options.hpp"

namespace handsel {

void add_story_command(CLI::App& app, int& exit_code) {
  struct Options {
    StoryOptions story;
    std::vector<std::string> files;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "story", "performs story files (start, task, disturb, kill, expect) with real processes");
  add_domain_option(*command, options->story.domain);
  add_overlay_options(*command);
  command->add_option("--seed", options->story.seed, "seed instead of the story's");
  command->add_option("files", options->files, "stories: names or files")->required();
  command->callback([options, &exit_code] {
    catch_interrupts();
    std::vector<Story> stories;
    for (const std::string& file : options->files)
      stories.push_back(read_story(find_file(FileKind::story, file)));
    for (Story& story : stories) {
      const std::string name = story.name;
      const bool came_true = StoryRunner(std::move(story), options->story).run();
      std::printf("%s  %s\n", came_true ? "true" : "failed", name.c_str());
      std::fflush(stdout);
      if (!came_true) exit_code = 1;
    }
  });
}

}  // namespace handsel
