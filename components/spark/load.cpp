#include "components/spark/load.hpp"

#include <algorithm>
#include <set>
#include <string>

#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "components/spark/quotas.hpp"

namespace handsel::spark {

config::SparkSettings load_settings(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "spark.txtpb";
  config::SparkSettings settings;
  load_text_proto(file, settings);
  if (settings.publish_period() <= 0 || settings.human_period() <= 0)
    throw ConfigError("spark.txtpb: publish_period and human_period must be > 0");
  if (!(settings.news_period() > 0) ||
      settings.max_period() < std::max(settings.human_period(), settings.publish_period()))
    throw ConfigError(
        "spark.txtpb: news_period must be > 0 and max_period not below human_period and "
        "publish_period");
  if (!(settings.max_view_age() > 0)) throw ConfigError("spark.txtpb: max_view_age must be > 0");
  std::set<std::string> clocks;
  for (const config::SourceClock& clock : settings.clocks())
    if (clock.source().empty() || !clocks.insert(clock.source()).second)
      throw ConfigError(locate(file, "clocks") +
                        ": each of clocks needs a source of its own, not \"" + clock.source() +
                        "\"");
  check_quotas(settings, file);
  *settings.mutable_people() = load_people(folder).people();
  return settings;
}

config::Scenario load_scenario(const std::filesystem::path& file) {
  config::Scenario scenario;
  if (!file.empty()) load_text_proto(file, scenario);
  return scenario;
}

}  // namespace handsel::spark
