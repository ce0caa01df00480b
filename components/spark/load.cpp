// SPDX-License-Identifier: Apache-2.0
#include "components/spark/load.hpp"

#include <algorithm>
#include <set>
#include <string>

#include "common/config/people.hpp"
#include "common/config/resources.hpp"
#include "common/config/settings_text.hpp"
#include "components/spark/quotas.hpp"

namespace handsel::spark {

settings::SparkSettings load_settings(const std::filesystem::path& folder) {
  SettingsText text;
  auto settings = settings::read_spark_settings(folder / "spark.txtpb", &text);
  if (settings.max_period < std::max(settings.human_period, settings.publish_period))
    text.refuse("max_period", "must be at least human_period and publish_period");
  double inner = 0.0;
  for (const double limit : {settings.contact_zone, settings.danger_zone, settings.interaction_zone,
                             settings.social_zone}) {
    if (!(limit > inner))
      text.refuse("contact_zone", "the zones must grow: contact, danger, interaction, social");
    inner = limit;
  }
  std::set<std::string> clocks;
  for (const settings::SourceClock& clock : settings.clocks)
    if (clock.source.empty() || !clocks.insert(clock.source).second)
      text.refuse("clocks", "each needs a source of its own, not \"" + clock.source + "\"");
  check_quotas(settings, text);
  settings.people = load_people(folder).people;
  return settings;
}

}  // namespace handsel::spark
