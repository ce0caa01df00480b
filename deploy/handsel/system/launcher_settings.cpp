// SPDX-License-Identifier: Apache-2.0
#include "deploy/handsel/system/launcher_settings.hpp"

#include "common/config/settings/launcher.hpp"
#include "common/config/settings_text.hpp"

namespace handsel {

LauncherSettings load_launcher_settings(const std::filesystem::path& file) {
  SettingsText text;
  const settings::LauncherSettings in = settings::read_launcher_settings(file, &text);
  if (in.max_backoff < in.first_backoff)
    text.refuse("max_backoff", "must be at least first_backoff");
  LauncherSettings out;
  out.liveness.hung_after = from_seconds(in.hung_after);
  out.liveness.silent_job_after = from_seconds(in.silent_job_after);
  out.liveness.start_timeout = from_seconds(in.start_timeout);
  out.backoff.first = from_seconds(in.first_backoff);
  out.backoff.max_wait = from_seconds(in.max_backoff);
  out.backoff.stable_after = from_seconds(in.stable_after);
  return out;
}

}  // namespace handsel
