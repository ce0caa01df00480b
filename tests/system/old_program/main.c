/* Publishes people with the type of an older IDL, on the topic and with the QoS of the present one, until it is ended. */
#include <dds/dds.h>
#include <handsel/handsel.h>

#include "old_perception.h"

int main(void) {
  const dds_entity_t participant = handsel_participant("old_perception");
  dds_qos_t *qos = handsel_topic_qos("human_observation");
  if (participant < 0 || qos == NULL) return 3;
  const dds_entity_t topic =
      dds_create_topic(participant, &handsel_HumanObservation_desc, handsel_find_topic("human_observation")->name, NULL, NULL);
  const dds_entity_t writer = dds_create_writer(participant, topic, qos, NULL);
  dds_delete_qos(qos);
  if (writer < 0) return 3;
  handsel_HumanObservation seen = {.source = "old"};
  for (;;) {
    seen.stamp = dds_time();
    if (dds_write(writer, &seen) < 0) return 1;
    dds_sleepfor(DDS_MSECS(33));
  }
}
