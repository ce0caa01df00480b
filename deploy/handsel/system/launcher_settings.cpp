#include "deploy/handsel/system/launcher_settings.hpp"

#include "common/base/errors.hpp"
#include "common/config/resources.hpp"
#include "common/config/schema/launcher.pb.h"

namespace handsel {

LauncherSettings load_launcher_settings(const std::filesystem::path& file) {
  config::LauncherSettings in;
  load_text_proto(file, in);
  const auto within = [&](double value, const std::string& key, double low, double high) {
    if (value >= low && value <= high) return from_seconds(value);
    throw ConfigError(locate(file, key + ":") + ": " + key + " is " + std::to_string(value) + " s, must be in [" + std::to_string(low) +
                      ", " + std::to_string(high) + "]");
  };
  LauncherSettings out;
  out.liveness.hung_after = within(in.hung_after(), "hung_after", 0.5, 60.0);
  out.liveness.silent_job_after = within(in.silent_job_after(), "silent_job_after", 3.0, 600.0);
  out.liveness.start_timeout = within(in.start_patience(), "start_patience", 2.0, 600.0);
  out.backoff.first = within(in.first_backoff(), "first_backoff", 0.01, 10.0);
  out.backoff.max_wait = within(in.longest_backoff(), "longest_backoff", in.first_backoff(), 600.0);
  out.backoff.stable_after = within(in.stable_after(), "stable_after", 1.0, 3600.0);
  return out;
}

}  // namespace handsel
