// SPDX-License-Identifier: Apache-2.0
/* For programs outside Handsel's build, in C: the topics, their QoS and a participant of the
 * domain. After `cmake --install`:
 *
 *   find_package(handsel REQUIRED)
 *   target_link_libraries(my_perception handsel::idl)
 *
 *   #include <handsel/handsel.h>
 *   #include <handsel/idl/perception.h>
 *
 *   dds_entity_t participant = handsel_participant("my_perception");
 *   dds_entity_t writer = handsel_writer(participant, "human_observation");
 *   dds_write(writer, &observation);
 *
 * A topic is named by its type ("HumanObservation"), its name on the wire
 * ("handsel/human_observation") or that without the prefix. Functions that return an entity return
 * a negative DDS return code on failure, after one sentence on stderr. */
#ifndef HANDSEL_H
#define HANDSEL_H

#include <stddef.h>

#include <dds/dds.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#define HANDSEL_EXPORT __attribute__((visibility("default")))
#else
#define HANDSEL_EXPORT
#endif

/* One topic of the system. */
typedef struct handsel_topic {
  const char* type;    /* struct of module handsel, without the prefix handsel_ */
  const char* name;    /* on the wire */
  double rate;         /* nominal [Hz]; 0: on change or on demand */
  double deadline;     /* longest time between samples [s]; 0: none */
  size_t largest;      /* bound of the serialised sample [bytes] */
  const char* writers; /* components, separated by spaces */
  const char* readers; /* components, separated by spaces */
  const dds_topic_descriptor_t* descriptor;
} handsel_topic;

/* Returns all topics; `count` receives their number. */
HANDSEL_EXPORT const handsel_topic* handsel_topics(size_t* count);
/* Returns the topic; NULL when there is no such topic. */
HANDSEL_EXPORT const handsel_topic* handsel_find_topic(const char* topic);
/* Returns the QoS of Handsel's own writers and readers of the topic; an endpoint with another QoS
 * may not be matched. To be freed with dds_delete_qos(); NULL when there is no such topic. */
HANDSEL_EXPORT dds_qos_t* handsel_topic_qos(const char* topic);

/* Enters the domain HANDSEL_DOMAIN (else 0) as Handsel's processes do: CYCLONEDDS_URI when it is
 * set, else the hosts of HANDSEL_PEERS, else this machine only. `component`: the name of this
 * program. A topic with one writer is accepted from the components of its column `writers` only: a
 * program that replaces one needs the same name, e.g. "driver". */
HANDSEL_EXPORT dds_entity_t handsel_participant(const char* component);
/* Returns a writer with handsel_topic_qos(). */
HANDSEL_EXPORT dds_entity_t handsel_writer(dds_entity_t participant, const char* topic);
/* Returns a reader that never blocks a writer: it keeps the newest samples only. */
HANDSEL_EXPORT dds_entity_t handsel_reader(dds_entity_t participant, const char* topic);

#ifdef __cplusplus
}
#endif
#endif
