/* FMI {{ fmi }}.0 co-simulation of the identified model (ball_beam.c).
 * The beam's motion is known at communication points only. A step goes on from the last of them with a beam whose
 * acceleration changes as it did before; when the motion at the step's end is known, the step is made again with it. So
 * what the beam did wrong within a step does not stay in the ball's run. */
#include "ball_beam.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

enum { OK = 0, FAULT = 3 };
{% if fmi == 2 %}
typedef void (*logger_t)(void *environment, const char *name, int status, const char *category, const char *text, ...);
{% else %}
typedef void (*logger_t)(void *environment, int status, const char *category, const char *text);
{% endif %}

enum { TIME, ANGLE, RATE, ANGULAR, START_POSITION, START_VELOCITY, PHASE, POSITION, BALL_POSITION, BALL_VELOCITY, COUNT };

typedef struct {
  double value[COUNT];
  bb_state base, ahead; /* at the last communication point, and one step further */
  bb_beam last;         /* beam at the point before */
  double last_time, *time, *seen;
  size_t n, room;
  int begun;
  logger_t logger; /* of the importer; NULL for none */
  void *environment;
} model_t;

static void blank(model_t *m) {
  memset(m->value, 0, sizeof m->value);
  m->n = 0, m->begun = 0;
}

static int refuse(model_t *m, const char *text) {
{% if fmi == 2 %}
  if (m->logger) m->logger(m->environment, "ball_beam", FAULT, "logStatusError", "%s", text);
{% else %}
  if (m->logger) m->logger(m->environment, FAULT, "logStatusError", text);
{% endif %}
  return FAULT;
}

static model_t *make(const char *token, logger_t logger, void *environment) {
  if (!token || strcmp(token, "{{ token }}") != 0) return NULL;
  model_t *m = calloc(1, sizeof *m);
  if (m) blank(m), m->logger = logger, m->environment = environment;
  return m;
}

static void discard(model_t *m) {
  if (m) free(m->time), free(m->seen), free(m);
}

static int keep(model_t *m, size_t at, const bb_state *x) {
  if (at >= m->room) {
    size_t room = m->room ? 2 * m->room : 1024;
    double *time = realloc(m->time, room * sizeof *time), *seen;
    if (!time) return FAULT;
    m->time = time;
    seen = realloc(m->seen, room * sizeof *seen);
    if (!seen) return FAULT;
    m->seen = seen, m->room = room;
  }
  m->time[at] = x->time, m->seen[at] = bb_recorded(x);
  m->n = at + 1;
  return OK;
}

static int step(model_t *m, double time, double h) {
  bb_beam now = {m->value[ANGLE], m->value[RATE], m->value[ANGULAR]}, then;
  double jerk = 0.0;
  if (!(h > 0.0)) return FAULT;
  if (!m->begun) {
    bb_start(&m->base, time, m->value[START_POSITION], m->value[START_VELOCITY], now, m->value[PHASE]);
    m->begun = 1;
    if (keep(m, 0, &m->base)) return FAULT;
  } else if (time > m->base.time) {
    m->last = m->base.beam, m->last_time = m->base.time;
    if (bb_step(&m->base, time, now)) return FAULT;
    m->begun = 2;
    if (keep(m, m->n - 1, &m->base)) return FAULT;
  } else if (time < m->base.time) {
    return FAULT; /* it cannot go back */
  } else {
    m->n--; /* the step is made again, perhaps with another size */
  }
  if (m->begun == 2) jerk = (now.angular - m->last.angular) / (time - m->last_time);
  then.angular = now.angular + jerk * h;
  then.rate = now.rate + h * (now.angular + 0.5 * jerk * h);
  then.angle = now.angle + h * (now.rate + h * (0.5 * now.angular + jerk * h / 6.0));
  m->ahead = m->base;
  if (bb_step(&m->ahead, time + h, then)) return FAULT;
  return keep(m, m->n, &m->ahead);
}

static int get(model_t *m, unsigned vr, double *value) {
  bb_state first;
  const bb_state *x = &m->ahead;
  if (vr >= COUNT) return FAULT;
  if (vr < POSITION) {
    *value = vr == TIME && m->begun ? m->ahead.time : m->value[vr];
    return OK;
  }
  if (!m->begun) {
    bb_beam beam = {m->value[ANGLE], m->value[RATE], m->value[ANGULAR]};
    bb_start(&first, m->value[TIME], m->value[START_POSITION], m->value[START_VELOCITY], beam, m->value[PHASE]);
    x = &first;
  }
  if (vr == BALL_POSITION) *value = x->s;
  else if (vr == BALL_VELOCITY) *value = x->v;
  else if (m->begun && bb_delay() > 0.0) *value = bb_at(m->time, m->seen, m->n, x->time - bb_delay());
  else *value = bb_recorded(x); /* what an angle that is late would need lies in the future */
  return OK;
}

static int set(model_t *m, unsigned vr, double value) {
  if (vr < ANGLE || vr > PHASE) return FAULT;
  if (!isfinite(value)) return refuse(m, "an input or a start is no finite number");
  m->value[vr] = value;
  return OK;
}

{% if fmi == 2 %}
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const names[]) { (void)c, (void)on, (void)n, (void)names; return OK; }
typedef struct { /* fmi2CallbackFunctions */
  logger_t logger;
  void *(*allocate)(size_t n, size_t size);
  void (*release)(void *memory);
  void (*finished)(void *environment, int status);
  void *environment;
} callbacks_t;
EXPORT void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *place, const void *callbacks, int visible, int logging) {
  (void)name, (void)place, (void)visible, (void)logging;
  const callbacks_t *told = callbacks;
  return kind == 1 ? make(guid, told ? told->logger : NULL, told ? told->environment : NULL) : NULL;
}
EXPORT void fmi2FreeInstance(void *c) { discard(c); }
EXPORT int fmi2SetupExperiment(void *c, int defined, double tolerance, double start, int stops, double stop) {
  (void)defined, (void)tolerance, (void)stops, (void)stop;
  ((model_t *)c)->value[TIME] = start;
  return OK;
}
EXPORT int fmi2EnterInitializationMode(void *c) { (void)c; return OK; }
EXPORT int fmi2ExitInitializationMode(void *c) { (void)c; return OK; }
EXPORT int fmi2Terminate(void *c) { (void)c; return OK; }
EXPORT int fmi2Reset(void *c) { blank(c); return OK; }
EXPORT int fmi2GetReal(void *c, const unsigned vr[], size_t n, double value[]) {
  for (size_t i = 0; i < n; i++) if (get(c, vr[i], &value[i])) return FAULT;
  return OK;
}
EXPORT int fmi2SetReal(void *c, const unsigned vr[], size_t n, const double value[]) {
  for (size_t i = 0; i < n; i++) if (set(c, vr[i], value[i])) return FAULT;
  return OK;
}
#define NONE(name, type) EXPORT int name(void *c, const unsigned vr[], size_t n, type value[]) { (void)c, (void)vr, (void)value; return n ? FAULT : OK; }
NONE(fmi2GetInteger, int)
NONE(fmi2GetBoolean, int)
NONE(fmi2GetString, const char *)
NONE(fmi2SetInteger, const int)
NONE(fmi2SetBoolean, const int)
NONE(fmi2SetString, const char *const)
EXPORT int fmi2DoStep(void *c, double time, double h, int no_return) { (void)no_return; return step(c, time, h); }
EXPORT int fmi2CancelStep(void *c) { (void)c; return FAULT; }
#define STATUS(name, type) EXPORT int name(void *c, int kind, type *value) { (void)c, (void)kind, (void)value; return FAULT; }
STATUS(fmi2GetStatus, int)
STATUS(fmi2GetRealStatus, double)
STATUS(fmi2GetIntegerStatus, int)
STATUS(fmi2GetBooleanStatus, int)
STATUS(fmi2GetStringStatus, const char *)
EXPORT int fmi2GetFMUstate(void *c, void **state) { (void)c, (void)state; return FAULT; }
EXPORT int fmi2SetFMUstate(void *c, void *state) { (void)c, (void)state; return FAULT; }
EXPORT int fmi2FreeFMUstate(void *c, void **state) { (void)c, (void)state; return FAULT; }
EXPORT int fmi2SerializedFMUstateSize(void *c, void *state, size_t *n) { (void)c, (void)state, (void)n; return FAULT; }
EXPORT int fmi2SerializeFMUstate(void *c, void *state, char bytes[], size_t n) { (void)c, (void)state, (void)bytes, (void)n; return FAULT; }
EXPORT int fmi2DeSerializeFMUstate(void *c, const char bytes[], size_t n, void **state) { (void)c, (void)bytes, (void)n, (void)state; return FAULT; }
EXPORT int fmi2GetDirectionalDerivative(void *c, const unsigned unknown[], size_t nu, const unsigned known[], size_t nk, const double d[], double out[]) {
  (void)c, (void)unknown, (void)nu, (void)known, (void)nk, (void)d, (void)out;
  return FAULT;
}
EXPORT int fmi2SetRealInputDerivatives(void *c, const unsigned vr[], size_t n, const int order[], const double value[]) {
  (void)c, (void)vr, (void)n, (void)order, (void)value;
  return FAULT;
}
EXPORT int fmi2GetRealOutputDerivatives(void *c, const unsigned vr[], size_t n, const int order[], double value[]) {
  (void)c, (void)vr, (void)n, (void)order, (void)value;
  return FAULT;
}
{% else %}
#include <stdbool.h>
#include <stdint.h>

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT int fmi3SetDebugLogging(void *c, bool on, size_t n, const char *const names[]) { (void)c, (void)on, (void)n, (void)names; return OK; }
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *place, bool visible, bool logging, bool events, bool early, const unsigned required[], size_t n, void *environment, logger_t log, void *update) {
  (void)name, (void)place, (void)visible, (void)logging, (void)events, (void)early, (void)required, (void)n, (void)update;
  return make(token, log, environment);
}
EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *place, bool visible, bool logging, void *environment, void *log) {
  (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)environment, (void)log;
  return NULL;
}
EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *place, bool visible, bool logging, void *environment, void *log, void *clock, void *lock, void *unlock) {
  (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)environment, (void)log, (void)clock, (void)lock, (void)unlock;
  return NULL;
}
EXPORT void fmi3FreeInstance(void *c) { discard(c); }
EXPORT int fmi3EnterInitializationMode(void *c, bool defined, double tolerance, double start, bool stops, double stop) {
  (void)defined, (void)tolerance, (void)stops, (void)stop;
  ((model_t *)c)->value[TIME] = start;
  return OK;
}
EXPORT int fmi3ExitInitializationMode(void *c) { (void)c; return OK; }
EXPORT int fmi3EnterEventMode(void *c) { (void)c; return FAULT; }
EXPORT int fmi3EnterStepMode(void *c) { (void)c; return FAULT; }
EXPORT int fmi3EnterConfigurationMode(void *c) { (void)c; return FAULT; }
EXPORT int fmi3ExitConfigurationMode(void *c) { (void)c; return FAULT; }
EXPORT int fmi3Terminate(void *c) { (void)c; return OK; }
EXPORT int fmi3Reset(void *c) { blank(c); return OK; }
EXPORT int fmi3GetFloat64(void *c, const unsigned vr[], size_t n, double value[], size_t m) {
  if (m != n) return FAULT;
  for (size_t i = 0; i < n; i++) if (get(c, vr[i], &value[i])) return FAULT;
  return OK;
}
EXPORT int fmi3SetFloat64(void *c, const unsigned vr[], size_t n, const double value[], size_t m) {
  if (m != n) return FAULT;
  for (size_t i = 0; i < n; i++) if (set(c, vr[i], value[i])) return FAULT;
  return OK;
}
#define NONE(kind, type) \
  EXPORT int fmi3Get##kind(void *c, const unsigned vr[], size_t n, type value[], size_t m) { (void)c, (void)vr, (void)value, (void)m; return n ? FAULT : OK; } \
  EXPORT int fmi3Set##kind(void *c, const unsigned vr[], size_t n, const type value[], size_t m) { (void)c, (void)vr, (void)value, (void)m; return n ? FAULT : OK; }
NONE(Float32, float)
NONE(Int8, int8_t)
NONE(UInt8, uint8_t)
NONE(Int16, int16_t)
NONE(UInt16, uint16_t)
NONE(Int32, int32_t)
NONE(UInt32, uint32_t)
NONE(Int64, int64_t)
NONE(UInt64, uint64_t)
NONE(Boolean, bool)
typedef const char *text_t;
NONE(String, text_t)
typedef const unsigned char *bytes_t;
EXPORT int fmi3GetBinary(void *c, const unsigned vr[], size_t n, size_t sizes[], bytes_t value[], size_t m) { (void)c, (void)vr, (void)sizes, (void)value, (void)m; return n ? FAULT : OK; }
EXPORT int fmi3SetBinary(void *c, const unsigned vr[], size_t n, const size_t sizes[], const bytes_t value[], size_t m) { (void)c, (void)vr, (void)sizes, (void)value, (void)m; return n ? FAULT : OK; }
EXPORT int fmi3GetClock(void *c, const unsigned vr[], size_t n, bool value[]) { (void)c, (void)vr, (void)value; return n ? FAULT : OK; }
EXPORT int fmi3SetClock(void *c, const unsigned vr[], size_t n, const bool value[]) { (void)c, (void)vr, (void)value; return n ? FAULT : OK; }
EXPORT int fmi3DoStep(void *c, double time, double h, bool no_return, bool *event, bool *ends, bool *early, double *last) {
  (void)no_return;
  *event = *ends = *early = false;
  int status = step(c, time, h);
  *last = status == OK ? time + h : time;
  return status;
}
/* Not supported; modelDescription.xml says so, and no importer calls them. */
#define ABSENT(name) EXPORT int fmi3##name(void) { return FAULT; }
ABSENT(GetNumberOfVariableDependencies)
ABSENT(GetVariableDependencies)
ABSENT(GetFMUState)
ABSENT(SetFMUState)
ABSENT(FreeFMUState)
ABSENT(SerializedFMUStateSize)
ABSENT(SerializeFMUState)
ABSENT(DeserializeFMUState)
ABSENT(GetDirectionalDerivative)
ABSENT(GetAdjointDerivative)
ABSENT(GetIntervalDecimal)
ABSENT(GetIntervalFraction)
ABSENT(GetShiftDecimal)
ABSENT(GetShiftFraction)
ABSENT(SetIntervalDecimal)
ABSENT(SetIntervalFraction)
ABSENT(SetShiftDecimal)
ABSENT(SetShiftFraction)
ABSENT(EvaluateDiscreteStates)
ABSENT(UpdateDiscreteStates)
ABSENT(EnterContinuousTimeMode)
ABSENT(CompletedIntegratorStep)
ABSENT(SetTime)
ABSENT(SetContinuousStates)
ABSENT(GetContinuousStateDerivatives)
ABSENT(GetEventIndicators)
ABSENT(GetContinuousStates)
ABSENT(GetNominalsOfContinuousStates)
ABSENT(GetNumberOfEventIndicators)
ABSENT(GetNumberOfContinuousStates)
ABSENT(GetOutputDerivatives)
ABSENT(ActivateModelPartition)
{% endif %}
