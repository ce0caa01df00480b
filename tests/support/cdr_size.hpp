// How large a message is on the wire.
#pragma once

#include <cstddef>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <gtest/gtest.h>

#include "common/wire/message_type.hpp"

namespace handsel::test {

/// A domain of this process alone, without a network: no port of the machine is needed, none can be taken.
inline dds_entity_t participant_without_network() {
  constexpr dds_domainid_t kDomain = 200;
  static const dds_entity_t domain =
      dds_create_domain(kDomain, "<CycloneDDS><Domain><General><Transport>none</Transport></General></Domain></CycloneDDS>");
  EXPECT_GT(domain, 0) << dds_strretcode(domain);
  return dds_create_participant(kDomain, nullptr, nullptr);
}

/// A sample of the IDL struct, written and read back through DDS: the bytes of its CDR form; 0 when that fails.
inline std::size_t cdr_size(const MessageType& type, const void* wire) {
  const dds_entity_t participant = participant_without_network();
  EXPECT_GT(participant, 0) << dds_strretcode(participant);
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  const auto* descriptor = static_cast<const dds_topic_descriptor_t*>(type.descriptor());
  const dds_entity_t topic = dds_create_topic(participant, descriptor, type.row().topic, qos, nullptr);
  const dds_entity_t reader = dds_create_reader(participant, topic, qos, nullptr);
  const dds_entity_t writer = dds_create_writer(participant, topic, qos, nullptr);
  dds_delete_qos(qos);
  EXPECT_EQ(dds_write(writer, wire), DDS_RETCODE_OK) << "a bound in the description is above the one of the IDL";
  ddsi_serdata* data = nullptr;
  dds_sample_info_t info;
  std::size_t size = 0;
  if (const int taken = dds_takecdr(reader, &data, 1, &info, DDS_ANY_STATE); taken == 1) {
    size = ddsi_serdata_size(data);
    ddsi_serdata_unref(data);
  } else {
    ADD_FAILURE() << "nothing was read back: " << taken;
  }
  dds_delete(participant);
  return size;
}

/// The same of a message.
template <class M>
std::size_t cdr_size(const M& message) {
  const auto wire = message_type<M>().new_wire();
  std::string why;
  EXPECT_TRUE(message_type<M>().to_wire(&message, 1, wire.get(), why)) << why;
  return cdr_size(message_type<M>(), wire.get());
}

}  // namespace handsel::test
