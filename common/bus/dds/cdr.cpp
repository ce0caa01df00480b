// SPDX-License-Identifier: Apache-2.0
#include "common/bus/dds/cdr.hpp"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>

#include <map>

#include "common/base/errors.hpp"

namespace handsel {
namespace {

/// Domain above those that a system may have. Without a network it needs no port, so it is free.
constexpr dds_domainid_t kOwn = 231;
constexpr const char* kNoNetwork =
    "<CycloneDDS><Domain><General><Transport>none</Transport></General></Domain></CycloneDDS>";

dds_entity_t need(dds_entity_t entity, const char* what) {
  if (entity < 0)
    throw MissingError(std::string("DDS makes no ") + what +
                       " without a network: " + dds_strretcode(entity));
  return entity;
}

}  // namespace

struct CdrCodec::Impl {
  dds_entity_t domain{}, participant{};
  std::map<const MessageType*, ddsi_serdata*>
      samples;  ///< one sample per type, which gives its serialization type

  ~Impl() {
    for (const auto& [type, sample] : samples) ddsi_serdata_unref(sample);
    if (domain > 0) dds_delete(domain);
  }

  /// Returns the serialization type, which the transport reveals only through a sample.
  const ddsi_sertype* sertype(const MessageType& type) {
    ddsi_serdata*& sample = samples[&type];
    if (sample) return sample->type;
    const auto* description = static_cast<const dds_topic_descriptor_t*>(type.descriptor());
    const std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)> qos(dds_create_qos(),
                                                                    &dds_delete_qos);
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    const dds_entity_t topic = need(
        dds_create_topic(participant, description, type.row().topic, qos.get(), nullptr), "topic");
    const dds_entity_t reader =
        need(dds_create_reader(participant, topic, qos.get(), nullptr), "reader");
    const dds_entity_t writer =
        need(dds_create_writer(participant, topic, qos.get(), nullptr), "writer");
    const auto wire = type.new_wire();
    type.fill(wire.get(), false);
    dds_sample_info_t info{};
    if (dds_write(writer, wire.get()) != DDS_RETCODE_OK ||
        dds_takecdr(reader, &sample, 1, &info, DDS_ANY_STATE) != 1)
      throw MissingError(std::string("DDS does not pass on a ") + type.row().type +
                         " without a network");
    return sample->type;
  }
};

CdrCodec::CdrCodec() : impl_(std::make_unique<Impl>()) {
  impl_->domain = need(dds_create_domain(kOwn, kNoNetwork), "domain");
  impl_->participant = need(dds_create_participant(kOwn, nullptr, nullptr), "participant");
}

CdrCodec::~CdrCodec() = default;

std::vector<std::uint8_t> CdrCodec::encode(const MessageType& type, const void* wire) {
  std::vector<std::uint8_t> out;
  ddsi_serdata* data = ddsi_serdata_from_sample(impl_->sertype(type), SDK_DATA, wire);
  if (!data) return out;
  out.resize(ddsi_serdata_size(data));
  ddsi_serdata_to_ser(data, 0, out.size(), out.data());
  ddsi_serdata_unref(data);
  return out;
}

bool CdrCodec::decode(const MessageType& type, const std::vector<std::uint8_t>& cdr, void* wire) {
  constexpr std::size_t kEncapsulation = 4;
  if (cdr.size() <= kEncapsulation) return false;
  ddsrt_iovec_t bytes{};
  bytes.iov_base = const_cast<std::uint8_t*>(cdr.data());  // read only
  bytes.iov_len = cdr.size();
  ddsi_serdata* data =
      ddsi_serdata_from_ser_iov(impl_->sertype(type), SDK_DATA, 1, &bytes, cdr.size());
  if (!data) return false;
  const bool whole = ddsi_serdata_to_sample(data, wire, nullptr, nullptr);
  ddsi_serdata_unref(data);
  return whole;
}

}  // namespace handsel
