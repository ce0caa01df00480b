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
  if (settings.trunk_sudden_acceleration < settings.trunk_acceleration)
    text.refuse("trunk_sudden_acceleration", "must be at least trunk_acceleration");
  if (settings.joint_sudden_acceleration < settings.joint_acceleration)
    text.refuse("joint_sudden_acceleration", "must be at least joint_acceleration");
  std::set<std::string> clocks;
  for (const settings::SourceClock& clock : settings.clocks)
    if (clock.source.empty() || !clocks.insert(clock.source).second)
      text.refuse("clocks", "each needs a source of its own, not \"" + clock.source + "\"");
  check_quotas(settings, text);
  settings.people = load_people(folder).people;
  return settings;
}

}  // namespace handsel::spark
