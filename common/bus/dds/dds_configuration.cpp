// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/dds_configuration.hpp"

#include <dlfcn.h>
#include <strings.h>

#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <dds/version.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

using tinyxml2::XMLElement;

bool same(const char* a, const char* b) { return strcasecmp(a, b) == 0; }

template <class Visit>
void each_child(const XMLElement& parent, const char* name, Visit visit) {
  for (const XMLElement* child = parent.FirstChildElement(); child;
       child = child->NextSiblingElement())
    if (same(child->Name(), name)) visit(*child);
}

const char* attribute(const XMLElement& element, const char* name) {
  for (const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a; a = a->Next())
    if (same(a->Name(), name)) return a->Value();
  return nullptr;
}

std::string text_of(const XMLElement& element) {
  const std::string text = element.GetText() ? element.GetText() : "";
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == std::string::npos
             ? std::string()
             : text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::optional<std::uint64_t> bytes_of(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  constexpr double kMaxBytes = 1e15;  // [bytes]
  if (error != std::errc() || !(value >= 0 && value <= kMaxBytes)) return std::nullopt;
  std::string unit(end, text.data() + text.size());
  std::erase(unit, ' ');
  constexpr std::pair<const char*, double> kUnits[] = {
      {"", 1},         {"B", 1},         {"kB", 1024},    {"KiB", 1024},
      {"MB", 1 << 20}, {"MiB", 1 << 20}, {"GB", 1 << 30}, {"GiB", 1 << 30}};
  for (const auto& [name, factor] : kUnits)
    if (same(unit.c_str(), name))
      return static_cast<std::uint64_t>(std::min(value * factor, kMaxBytes));
  return std::nullopt;
}

class Configuration {
 public:
  Configuration(DdsConfiguration& out, std::uint32_t domain)
      : out_(out), domain_(std::to_string(domain)) {}

  void read(const std::string& item) {
    tinyxml2::XMLDocument document;
    if (item.front() == '<') {
      out_.source = "CYCLONEDDS_URI";
      document.Parse(item.c_str());
    } else {
      out_.source = item.rfind("file://", 0) == 0 ? item.substr(7) : item;
      if (!std::filesystem::is_regular_file(out_.source)) {
        out_.error = "the DDS configuration " + out_.source + " is not there";
        return;
      }
      document.LoadFile(out_.source.c_str());
    }
    if (document.Error()) {
      out_.error = "the DDS configuration in " + out_.source + " is no XML (line " +
                   std::to_string(document.ErrorLineNum()) + ")";
      return;
    }
    for (const XMLElement* root = document.FirstChildElement(); root;
         root = root->NextSiblingElement()) {
      if (same(root->Name(), "Domain")) read_domain(*root);
      each_child(*root, "Domain", [this](const XMLElement& domain) { read_domain(domain); });
    }
  }

 private:
  void read_domain(const XMLElement& domain) {
    const char* id = attribute(domain, "Id");
    if (id && !same(id, "any") && id != domain_) return;
    each_child(domain, "General", [this](const XMLElement& general) {
      each_child(general, "AllowMulticast", [this](const XMLElement& e) {
        out_.multicast = !same(text_of(e).c_str(), "false");
      });
      each_child(general, "NetworkInterfaceAddress",
                 [this](const XMLElement& e) { out_.interfaces = {text_of(e)}; });
      each_child(general, "Interfaces", [this](const XMLElement& all) {
        out_.interfaces.clear();
        each_child(all, "NetworkInterface", [this](const XMLElement& e) {
          for (const char* key : {"name", "address"})
            if (const char* value = attribute(e, key)) out_.interfaces.emplace_back(value);
        });
      });
    });
    each_child(domain, "Discovery", [this](const XMLElement& discovery) {
      each_child(discovery, "ParticipantIndex",
                 [this](const XMLElement& e) { out_.participant_index = text_of(e); });
      each_child(discovery, "MaxAutoParticipantIndex",
                 [this](const XMLElement& e) { e.QueryIntText(&out_.max_auto_index); });
      each_child(discovery, "Peers", [this](const XMLElement& peers) {
        each_child(peers, "Peer", [this](const XMLElement& e) {
          if (const char* address = attribute(e, "address")) out_.peers.emplace_back(address);
        });
      });
    });
    each_child(domain, "Internal", [this](const XMLElement& internal) {
      each_child(internal, "MaxSampleSize",
                 [this](const XMLElement& e) { out_.max_sample_size = bytes_of(text_of(e)); });
    });
  }

  DdsConfiguration& out_;
  std::string domain_;
};

}  // namespace

DdsConfiguration read_dds_configuration(const std::string& uri, std::uint32_t domain) {
  DdsConfiguration out;
  Configuration configuration(out, domain);
  for (std::size_t begin = 0; begin < uri.size() && out.error.empty();) {
    // A comma ends an item; inline XML ends with its last closing bracket and may contain commas.
    std::size_t end = uri.find(',', begin);
    if (uri[begin] == '<') {
      while (end != std::string::npos && uri[uri.find_last_not_of(" \t\r\n", end - 1)] != '>')
        end = uri.find(',', end + 1);
    }
    end = std::min(end, uri.size());
    if (end > begin) configuration.read(uri.substr(begin, end - begin));
    begin = end + 1;
  }
  return out;
}

namespace {

/// Collects what the transport logs during the lifetime of the object.
class Log {
 public:
  Log() { dds_set_log_sink(&Log::write, this); }
  ~Log() { dds_set_log_sink(nullptr, nullptr); }
  Log(const Log&) = delete;
  Log& operator=(const Log&) = delete;
  const std::string& text() const { return text_; }

 private:
  static void write(void* self, const dds_log_data_t* data) {
    static_cast<Log*>(self)->text_.append(data->message, data->size).append("\n");
  }
  std::string text_;
};

}  // namespace

int create_participant(std::uint32_t domain, const ::dds_qos* qos) {
  const char* uri = std::getenv("CYCLONEDDS_URI");
  if (const DdsConfiguration read = read_dds_configuration(uri != nullptr ? uri : "", domain);
      !read.error.empty()) {
    if (read.error.ends_with("is not there")) throw MissingError(read.error);
    throw ConfigError(read.error);
  }
  std::string logged;
  dds_entity_t participant = 0;
  {
    const Log log;
    participant = dds_create_participant(domain, qos, nullptr);
    logged = log.text();
  }
  const std::size_t about = logged.find("config: ");
  if (participant < 0 && about != std::string::npos) {
    std::string line = logged.substr(about + 8, logged.find('\n', about) - about - 8);
    throw ConfigError("the DDS configuration cannot be used: " + line + " (CYCLONEDDS_URI is " +
                      std::string(uri != nullptr ? uri : "") + ")");
  }
  std::fputs(logged.c_str(), stderr);
  return participant;
}

TransportLibrary transport_library() {
  TransportLibrary out;
  out.built_for = DDS_VERSION;
  Dl_info info{};
  void* symbol = dlsym(RTLD_DEFAULT, "dds_create_participant");
  std::error_code error;
  if (symbol && dladdr(symbol, &info) != 0 && info.dli_fname)
    out.file = std::filesystem::canonical(info.dli_fname, error);
  out.agrees = out.file.ends_with(DDS_VERSION);
  return out;
}

}  // namespace handsel
