// SPDX-License-Identifier: Apache-2.0
// A fixture that runs the same bus test over DDS and in virtual time.
#pragma once

#include <unistd.h>

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "common/bus/dds/dds_bus.hpp"
#include "common/bus/local_bus.hpp"

namespace handsel::test {

class Stage {
 public:
  virtual ~Stage() = default;
  virtual Bus& add(const std::string& component) = 0;
  /// Lets everybody run until `done` holds; false when `limit` [s] is over first.
  virtual bool until(const std::function<bool()>& done, double limit = 5.0) = 0;
  virtual void kill(const std::string& component) = 0;
  virtual void pause(const std::string& component) = 0;
  virtual void resume(const std::string& component) = 0;
  /// Lets everybody run for a while [s] of the bus's time.
  void pass(double seconds) {
    until([] { return false; }, seconds);
  }
};

class LocalStage final : public Stage {
 public:
  Bus& add(const std::string& component) override { return network_.add(component); }
  bool until(const std::function<bool()>& done, double limit = 5.0) override {
    return network_.run_until(done, network_.now() + from_seconds(limit));
  }
  void kill(const std::string& component) override { network_.kill(component); }
  void pause(const std::string& component) override { network_.pause(component); }
  void resume(const std::string& component) override { network_.resume(component); }

 private:
  LocalNetwork network_{7};
};

class DdsStage final : public Stage {
 public:
  DdsStage() {
    setenv("CYCLONEDDS_URI", "file://" HANDSEL_SOURCE_DIR "/deploy/dds/loopback.xml", 0);
  }
  Bus& add(const std::string& component) override {
    auto& bus = buses_[component];
    bus = std::make_unique<DdsBus>(DdsBusSettings{
        .component = component, .domain = 100 + static_cast<std::uint32_t>(getpid()) % 100});
    bus->set_ready();
    return *bus;
  }
  bool until(const std::function<bool()>& done, double limit = 5.0) override {
    const TimePoint end = buses_.begin()->second->now() + from_seconds(limit);
    while (!done()) {
      for (auto& [name, bus] : buses_)
        if (!paused_.contains(name))
          bus->run_until([] { return false; }, std::chrono::milliseconds(1));
      if (buses_.begin()->second->now() > end) return done();
    }
    return true;
  }
  void kill(const std::string& component) override { buses_.erase(component); }
  void pause(const std::string& component) override { paused_.insert(component); }
  void resume(const std::string& component) override { paused_.erase(component); }

 private:
  std::map<std::string, std::unique_ptr<DdsBus>> buses_;
  std::set<std::string> paused_;
};

}  // namespace handsel::test
