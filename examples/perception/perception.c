// SPDX-License-Identifier: Apache-2.0
/* Publishes a recorded person, and objects, as a perception process of your own would:
 * HumanObservation and ObjectObservation at the rate of a sensor, with the time of each
 * measurement. Replace body_at() and read_objects() with your tracker. See README.md. */
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <handsel/handsel.h>
#include <handsel/idl/attention.h>
#include <handsel/idl/perception.h>

enum { MAX_JOINTS = 64, MAX_OBJECTS = 16, MAX_LINE = 8192 };

struct recording {
  size_t joints, rows;
  char names[MAX_JOINTS][33];
  double* values; /* rows of 1 + 3 x joints: time [s], then x y z [m] of each joint, in "world" */
};

struct options {
  double rate;   /* [Hz] */
  double repeat; /* from this time of the recording on it is played again and again [s]; < 0: it is
                    played once */
  const char *source, *body, *person_file, *object_file;
};

/* How often samples are wanted now. */
struct wish {
  double people, objects; /* [Hz]; 0: as often as this sensor measures */
  dds_time_t until;       /* end of the request; then 0 again */
};

static volatile sig_atomic_t stopped = 0;

static const char usage[] =
    "perception [--rate HZ] [--repeat S] [--source NAME] [--body ID] PERSON.csv [OBJECTS.csv]";

static void on_signal(int number) {
  (void)number;
  stopped = 1;
}

static void give_up(const char* what, const char* detail) {
  fprintf(stderr, "perception: %s: %s\n", what, detail);
  exit(2);
}

/* A CSV: `time,<joint>.x,<joint>.y,<joint>.z,...`, then numbers; the joints have their names of
 * REP-155. */
static struct recording read_person(const char* file) {
  static char line[MAX_LINE];
  struct recording r = {0};
  size_t room = 0;
  FILE* in = fopen(file, "r");
  if (!in || !fgets(line, sizeof line, in)) give_up(file, "cannot be read");
  strtok(line, ",\r\n");
  for (char* name = strtok(NULL, ",\r\n"); name; name = strtok(NULL, ",\r\n")) {
    char* dot = strrchr(name, '.');
    if (!dot || r.joints == MAX_JOINTS || dot - name > 32)
      give_up(file, "the columns must be time, <joint>.x, <joint>.y, <joint>.z, ...");
    if (strcmp(dot, ".z") != 0) continue;
    *dot = '\0';
    strcpy(r.names[r.joints++], name);
  }
  const size_t width = 1 + 3 * r.joints;
  while (fgets(line, sizeof line, in)) {
    if (r.rows == room) {
      room = room ? 2 * room : 256;
      r.values = realloc(r.values, room * width * sizeof *r.values);
      if (!r.values) give_up(file, "is too large");
    }
    char* at = line;
    for (size_t i = 0; i < width; ++i) {
      char* end;
      r.values[r.rows * width + i] = strtod(at, &end);
      if (end == at) give_up(file, "a row has too few numbers");
      at = *end == ',' ? end + 1 : end;
    }
    ++r.rows;
  }
  fclose(in);
  if (r.joints == 0 || r.rows < 2) give_up(file, "needs at least one joint and two rows");
  return r;
}

/* A CSV: `id,model,x,y,z,qx,qy,qz,qw`, one resting object a line; `model` names a description the
 * robot's side has. */
static void read_objects(const char* file, handsel_ObjectObservation* out) {
  char line[512];
  FILE* in = fopen(file, "r");
  if (!in || !fgets(line, sizeof line, in)) give_up(file, "cannot be read");
  while (fgets(line, sizeof line, in) && out->objects._length < MAX_OBJECTS) {
    handsel_ObservedObject* o = &out->objects._buffer[out->objects._length++];
    handsel_Vector3* p = &o->T_world_object.position;
    handsel_Quaternion* q = &o->T_world_object.orientation;
    const int found = sscanf(line, "%64[^,],%64[^,],%lf,%lf,%lf,%lf,%lf,%lf,%lf", o->id, o->model,
                             &p->x, &p->y, &p->z, &q->x, &q->y, &q->z, &q->w);
    if (found != 9) give_up(file, "a line must be id,model,x,y,z,qx,qy,qz,qw");
    o->confidence = 1;
  }
  fclose(in);
}

/* The body at time t of the recording, linear between rows. */
static void body_at(const struct recording* r, double t, handsel_ObservedPerson* out) {
  const size_t width = 1 + 3 * r->joints;
  size_t row = 0;
  while (row + 2 < r->rows && r->values[(row + 1) * width] <= t) ++row;
  const double *a = &r->values[row * width], *b = a + width;
  const double part = fmin(1, fmax(0, (t - a[0]) / (b[0] - a[0])));
  out->joints._length = (uint32_t)r->joints;
  for (size_t i = 0; i < r->joints; ++i) {
    handsel_ObservedJoint* joint = &out->joints._buffer[i];
    const double *from = &a[1 + 3 * i], *to = &b[1 + 3 * i];
    strcpy(joint->name, r->names[i]);
    joint->position.x = from[0] + part * (to[0] - from[0]);
    joint->position.y = from[1] + part * (to[1] - from[1]);
    joint->position.z = from[2] + part * (to[2] - from[2]);
    joint->confidence = 0.9;
  }
}

static const handsel_Vector3* joint_of(const handsel_ObservedPerson* person, const char* name) {
  for (uint32_t i = 0; i < person->joints._length; ++i)
    if (strcmp(person->joints._buffer[i].name, name) == 0)
      return &person->joints._buffer[i].position;
  return NULL;
}

/* No eye tracker here: who faces somewhere is taken to look there, a little down. A tracker without
 * gaze leaves has_gaze false. */
static void guess_gaze(handsel_ObservedPerson* person) {
  const handsel_Vector3 *left = joint_of(person, "l_shoulder"),
                        *right = joint_of(person, "r_shoulder"), *head = joint_of(person, "head");
  person->has_gaze = left && right && head;
  if (!person->has_gaze) return;
  const handsel_Vector3 ahead = {left->y - right->y, right->x - left->x,
                                 -0.35 * hypot(left->x - right->x, left->y - right->y)};
  const double norm = sqrt(ahead.x * ahead.x + ahead.y * ahead.y + ahead.z * ahead.z);
  person->has_gaze = norm > 0.05;
  if (!person->has_gaze) return;
  person->gaze_origin = *head;
  person->gaze_direction = (handsel_Vector3){ahead.x / norm, ahead.y / norm, ahead.z / norm};
}

/* What attention requests of this source: fewer samples while nobody is near saves the robot's
 * side work. A sensor may ignore requests. */
static void take_requests(dds_entity_t reader, const char* source, struct wish* wish) {
  void* samples[4] = {NULL};
  dds_sample_info_t infos[4];
  const int count = dds_take(reader, samples, infos, 4, 4);
  for (int i = 0; i < count; ++i) {
    const handsel_SensorRequest* request = samples[i];
    if (!infos[i].valid_data) continue;
    if (request->source[0] != '\0' && strcmp(request->source, source) != 0) continue;
    wish->people = request->people_rate;
    wish->objects =
        request->objects_rate > 0 ? fmax(request->objects_rate, request->region_rate) : 0;
    wish->until = dds_time() + DDS_MSECS(500);
  }
  if (count > 0) dds_return_loan(reader, samples, count);
  if (dds_time() > wish->until) wish->people = wish->objects = 0;
}

/* Whether a sample is due at the wanted rate, never below 10 Hz: the guard needs that many. */
static bool is_due(dds_time_t* last, double wanted, double own_rate) {
  const double rate = wanted > 0 ? fmin(own_rate, fmax(wanted, 10)) : own_rate;
  const dds_time_t now = dds_time();
  if ((double)(now - *last) * 1e-9 < 1 / rate - 0.5 / own_rate) return false;
  *last = now;
  return true;
}

static struct options parse(int argc, char** argv) {
  struct options o = {30, -1, "body_tracker", "visitor", NULL, NULL};
  for (int i = 1; i < argc; ++i) {
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (argv[i][0] != '-') {
      *(o.person_file ? &o.object_file : &o.person_file) = argv[i];
      continue;
    }
    if (strcmp(argv[i], "--rate") == 0)
      o.rate = strtod(value, NULL);
    else if (strcmp(argv[i], "--repeat") == 0)
      o.repeat = strtod(value, NULL);
    else if (strcmp(argv[i], "--source") == 0)
      o.source = value;
    else if (strcmp(argv[i], "--body") == 0)
      o.body = value;
    else
      give_up(argv[i], usage);
    ++i;
  }
  if (!o.person_file || !(o.rate > 0 && o.rate <= 1000) || strlen(o.source) > 64 ||
      strlen(o.body) > 64)
    give_up("usage", usage);
  return o;
}

int main(int argc, char** argv) {
  const struct options o = parse(argc, argv);
  const struct recording person = read_person(o.person_file);
  signal(SIGINT, on_signal);
  signal(SIGTERM, on_signal);

  /* The domain is HANDSEL_DOMAIN's; topics, types and QoS are those of the system (docs:
   * handsel/handsel.h). */
  const dds_entity_t participant = handsel_participant("perception");
  const dds_entity_t humans = handsel_writer(participant, "human_observation");
  const dds_entity_t objects =
      o.object_file ? handsel_writer(participant, "object_observation") : 0;
  const dds_entity_t requests = handsel_reader(participant, "sensor_request");
  if (participant < 0 || humans < 0 || objects < 0 || requests < 0) return 3;

  /* What this sensor looks at: only inside it does "nobody there" mean anything. It must hold the
   * robot's reach. */
  handsel_HumanObservation seen = {.coverage = {{-4, -4, -0.1}, {4, 4, 2.5}}};
  handsel_ObservedJoint joints[MAX_JOINTS];
  handsel_ObservedPerson body = {.joints = {MAX_JOINTS, 0, joints, false}};
  strcpy(seen.source, o.source);
  strcpy(body.body, o.body); /* the same as long as the tracker does not lose the body */
  seen.people._maximum = seen.people._length = 1;
  seen.people._buffer = &body;

  handsel_ObjectObservation things;
  memset(&things, 0, sizeof things);
  handsel_ObservedObject object_list[MAX_OBJECTS];
  memset(object_list, 0, sizeof object_list);
  strcpy(things.source, o.source);
  things.objects._maximum = MAX_OBJECTS;
  things.objects._buffer = object_list;
  if (o.object_file) read_objects(o.object_file, &things);

  const size_t width = 1 + 3 * person.joints;
  const double begin = person.values[0], end = person.values[(person.rows - 1) * width];
  const dds_duration_t period = (dds_duration_t)(1e9 / o.rate);
  dds_time_t next = dds_time(), last_people = 0, last_objects = 0;
  struct wish wish = {0, 0, 0};
  double t = begin;
  fprintf(stderr, "perception: publishing %s %g times a second\n", o.person_file, o.rate);
  while (!stopped && t <= end) {
    body_at(&person, t, &body);
    guess_gaze(&body);
    /* when it was measured: a camera's time of exposure, not the time of sending */
    seen.stamp = things.stamp = dds_time();
    take_requests(requests, o.source, &wish);
    if (is_due(&last_people, wish.people, o.rate)) dds_write(humans, &seen);
    if (objects && is_due(&last_objects, wish.objects, o.rate)) dds_write(objects, &things);

    t += 1 / o.rate;
    if (t > end && o.repeat >= 0) t = fmax(begin, o.repeat);
    next += period;
    const dds_duration_t rest = next - dds_time();
    if (rest > 0) dds_sleepfor(rest);
  }
  dds_delete(participant);
  free(person.values);
  return 0;
}
