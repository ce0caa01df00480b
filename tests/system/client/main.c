// SPDX-License-Identifier: Apache-2.0
/* A program outside the build: opens both ends of every topic, then publishes a person until its
 * input ends. */
#include <poll.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <handsel/handsel.h>
#include <handsel/idl/perception.h>

int main(void) {
  size_t count = 0;
  const handsel_topic* topics = handsel_topics(&count);
  const dds_entity_t participant = handsel_participant("client");
  if (participant < 0) return 3;
  dds_entity_t writer = 0;
  for (size_t i = 0; i < count; ++i) {
    const dds_entity_t ours = handsel_writer(participant, topics[i].name);
    dds_qos_t* qos = handsel_topic_qos(topics[i].type);
    const dds_entity_t reader = handsel_reader(participant, topics[i].name);
    if (ours < 0 || reader < 0 || qos == NULL) return 1;
    dds_delete_qos(qos);
    if (handsel_find_topic("human_observation") == &topics[i]) writer = ours;
  }
  if (handsel_find_topic("nonsense") != NULL || handsel_topic_qos("nonsense") != NULL ||
      access(PERCEPTION_IDL, R_OK) != 0)
    return 1;
  printf("%zu topics\n", count);
  fflush(stdout);

  struct handsel_ObservedJoint head = {
      .name = "head", .position = {2.0, 0.5, 1.7}, .confidence = 1.0};
  struct handsel_ObservedPerson person = {.body = "b1"};
  person.joints._buffer = &head;
  person.joints._length = person.joints._maximum = 1;
  handsel_HumanObservation seen = {.source = "outside"};
  seen.coverage.low = (struct handsel_Vector3){-5, -5, 0};
  seen.coverage.high = (struct handsel_Vector3){5, 5, 3};
  seen.people._buffer = &person;
  seen.people._length = seen.people._maximum = 1;
  struct pollfd input = {.fd = STDIN_FILENO, .events = POLLIN};
  while (poll(&input, 1, 30) == 0) {
    seen.stamp = dds_time();
    if (dds_write(writer, &seen) < 0) return 1;
  }
  return 0;
}
