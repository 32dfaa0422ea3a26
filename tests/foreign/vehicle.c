/*
 * A light electric two-wheeler and its motor drive, as somebody else would deliver it: a Co-Simulation FMU
 * in C with names of its own, speeds in m/s, the pedal from 0 to 1 and the battery's power in kW.
 *
 * The equations are those of Dardanelli et al., "Speed and acceleration controllers for a light electric
 * two-wheeled vehicle", IEEE CDC-ECC 2011:
 *
 *     m dv/dt  = F - F_brake - m g (C_r cos(th) + sin(th)) - R(v)                                   (1)
 *     R(v)     = r_v v + 1/2 rho CxA v^2                                                            (2)
 *     tau F'   = pedal fade(v) min(F_max, 100 mu L(v)/(v - v_0)) - F                                (3)
 *     fade(v)  = 1 below the speed limit, 0 above it, linear in a band around it                    (4)
 *     P        = F v/eta + P_0                                                                      (5)
 *
 * L(v) is the road load of the vehicle that the drive was matched to, and v_0 makes the force map pass
 * through the published pole. The force is solved exactly for a command that is linear over the step, the
 * speed by Heun's rule. The vehicle never moves backward.
 *
 * Compile with -DFMI=2 or -DFMI=3; the two differ only in how an importer speaks to it. One step takes about
 * a tenth of a microsecond and allocates nothing.
 */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifndef FMI
#define FMI 2
#endif

/* ---- The model. Value references count through the variables in this order. ---- */

enum {
    PEDAL, BRAKE, SLOPE,                                                         /* inputs     */
    SPEED, ACCELERATION, FRONT_WHEEL, REAR_WHEEL, POWER, FORCE, DISTANCE,        /* outputs    */
    MASS, AIR_DENSITY, DRAG_AREA, VISCOUS, ROLLING, MAXIMUM_FORCE, LAG,          /* parameters */
    SPEED_LIMIT, SPEED_BAND, EFFICIENCY, AUXILIARY, FRONT_RADIUS, REAR_RADIUS, INITIAL_SPEED,
    VARIABLES
};

static const double STARTS[VARIABLES] = {
    0.0, 0.0, 0.0,                                  /* 1, N, rad                        */
    0.0, 0.0, 0.0, 0.0, 0.04, 0.0, 0.0,             /* m/s, m/s2, rad/s, rad/s, kW, N, m */
    200.0, 1.2, 0.60, 10.0, 0.014, 850.0, 0.005,    /* kg, kg/m3, m2, N.s/m, 1, N, s    */
    50.0 / 3.6, 1.0 / 3.6, 0.85, 40.0, 0.2, 0.2, 0.0 /* m/s, m/s, 1, W, m, m, m/s        */
};

static const double GRAVITY = 9.81;              /* m/s2                                                  */
static const double MATCHED_GAIN = 46.0 / 3.6;   /* 100 mu [m/s], published: 0.46 km/h per % of throttle  */
static const double MATCHED_POLE = 0.03;         /* Hz at MATCHED_SPEED, published                        */
static const double MATCHED_SPEED = 30.0 / 3.6;  /* m/s, published                                        */

typedef struct {
    double value[VARIABLES];
    double speed, force, distance;               /* the state: m/s, N, m                                  */
    double map_offset;                           /* v_0 of (3) [m/s]                                      */
    double decay, decay_step, decay_lag;         /* exp(-step/lag), and what it was computed for [s]      */
    int outputs_are_old;                         /* an input or the state changed since they were made    */
} Vehicle;

static double clipped(double x, double low, double high) { return fmin(fmax(x, low), high); }

static double matched_load(double v) { /* L(v) of (3): the vehicle of the default parameters */
    const double *p = STARTS;
    return p[MASS] * GRAVITY * p[ROLLING] + v * (p[VISCOUS] + 0.5 * p[AIR_DENSITY] * p[DRAG_AREA] * v);
}

static double command(const Vehicle *c, double v) { /* the force that (3) tends to */
    const double *p = c->value;
    double force = p[MAXIMUM_FORCE];
    if (v > c->map_offset)
        force = fmin(force, MATCHED_GAIN * matched_load(v) / (v - c->map_offset));
    force *= clipped((p[SPEED_LIMIT] + 0.5 * p[SPEED_BAND] - v) / p[SPEED_BAND], 0.0, 1.0); /* (4) */
    return clipped(p[PEDAL], 0.0, 1.0) * force;
}

static double resistance(const Vehicle *c, double v) { /* (2) */
    const double *p = c->value;
    return v * (p[VISCOUS] + 0.5 * p[AIR_DENSITY] * p[DRAG_AREA] * v);
}

static double held_forces(const Vehicle *c) { /* brake, rolling resistance and grade of (1) */
    const double *p = c->value;
    return fmax(0.0, p[BRAKE]) + p[MASS] * GRAVITY * (p[ROLLING] * cos(p[SLOPE]) + sin(p[SLOPE]));
}

static void initialize(Vehicle *c) {
    const double full = STARTS[MASS] * 2.0 * 3.14159265358979323846 * MATCHED_POLE * MATCHED_GAIN;
    c->map_offset = MATCHED_SPEED - MATCHED_GAIN * matched_load(MATCHED_SPEED) / full;
    c->speed = c->value[INITIAL_SPEED];
    c->force = c->distance = 0.0;
    c->outputs_are_old = 1;
}

static void advance(Vehicle *c, double step) {
    const double m = c->value[MASS], tau = c->value[LAG], hold = held_forces(c);
    const double v = c->speed, f = c->force;
    if (step != c->decay_step || tau != c->decay_lag) {
        c->decay = exp(-step / tau);
        c->decay_step = step;
        c->decay_lag = tau;
    }
    /* Predictor: command and resistance of the start, over the whole step. */
    const double c0 = command(c, v), r0 = resistance(c, v);
    double impulse = step * c0 + tau * (f - c0) * (1.0 - c->decay);
    double v1 = fmax(0.0, v + (impulse - step * (r0 + hold)) / m);
    /* Corrector: both change linearly to their values at the predicted speed. */
    const double c1 = command(c, v1), r1 = resistance(c, v1), ramp = tau * (c1 - c0) / step;
    const double f1 = c1 - ramp + (f - c0 + ramp) * c->decay;
    impulse = 0.5 * step * (c0 + c1) - tau * (f1 - f);
    v1 = v + (impulse - step * (0.5 * (r0 + r1) + hold)) / m;
    double moving = 1.0;
    if (v1 < 0.0) { /* it stops within the step and stays */
        moving = v / (v - v1);
        v1 = 0.0;
    }
    c->speed = v1;
    c->force = fmax(0.0, f1);
    c->distance += 0.5 * moving * step * (v + v1);
    c->outputs_are_old = 1;
}

static void make_outputs(Vehicle *c) {
    double *y = c->value, v = c->speed;
    const double a = (c->force - resistance(c, v) - held_forces(c)) / y[MASS];
    y[SPEED] = v;
    y[ACCELERATION] = v <= 0.0 && a < 0.0 ? 0.0 : a;
    y[FRONT_WHEEL] = v / y[FRONT_RADIUS];
    y[REAR_WHEEL] = v / y[REAR_RADIUS];
    y[POWER] = 1e-3 * (c->force * v / y[EFFICIENCY] + y[AUXILIARY]); /* (5) */
    y[FORCE] = c->force;
    y[DISTANCE] = c->distance;
    c->outputs_are_old = 0;
}

/* ---- What both versions of FMI need. ---- */

typedef enum { OK, WARNING, DISCARD, ERROR, FATAL } Status;

#define EXPORT __attribute__((visibility("default")))
#define UNUSED(x) ((void)(x))

static const char TOKEN[] = "{5f0d3c1e-2d0a-4c55-9e0e-7a3c52a1b9e4}";

static Vehicle *created(const char *token) {
    if (!token || strcmp(token, TOKEN) != 0)
        return NULL;
    Vehicle *c = calloc(1, sizeof *c);
    if (c) {
        memcpy(c->value, STARTS, sizeof STARTS);
        initialize(c);
    }
    return c;
}

static Status get(Vehicle *c, const uint32_t *references, size_t n, double *values) {
    if (c->outputs_are_old)
        make_outputs(c);
    for (size_t i = 0; i < n; i++) {
        if (references[i] >= VARIABLES)
            return ERROR;
        values[i] = c->value[references[i]];
    }
    return OK;
}

static Status set(Vehicle *c, const uint32_t *references, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        const uint32_t k = references[i];
        if (k >= VARIABLES || (k >= SPEED && k <= DISTANCE))
            return ERROR;
        c->value[k] = values[i];
    }
    c->outputs_are_old = 1;
    return OK;
}

static Status saved(const Vehicle *c, void **state) {
    if (!*state)
        *state = malloc(sizeof *c);
    if (!*state)
        return ERROR;
    memcpy(*state, c, sizeof *c);
    return OK;
}

static Status restored(Vehicle *c, const void *state) {
    memcpy(c, state, sizeof *c);
    return OK;
}

static Status released(void **state) {
    free(*state);
    *state = NULL;
    return OK;
}

static Status serialized(const void *state, char *bytes, size_t size) {
    if (size < sizeof(Vehicle))
        return ERROR;
    memcpy(bytes, state, sizeof(Vehicle));
    return OK;
}

static Status deserialized(const char *bytes, size_t size, void **state) {
    return size == sizeof(Vehicle) ? saved((const Vehicle *)(const void *)bytes, state) : ERROR;
}

#if FMI == 2
/* ---- FMI 2.0 Co-Simulation. ---- */

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT void *fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    UNUSED(name), UNUSED(resources), UNUSED(callbacks), UNUSED(visible), UNUSED(logging);
    return kind == 1 ? created(guid) : NULL;
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const *categories) {
    UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(categories);
    return OK;
}
EXPORT int fmi2SetupExperiment(void *c, int has_tolerance, double tolerance, double start, int has_stop,
                               double stop) {
    UNUSED(c), UNUSED(has_tolerance), UNUSED(tolerance), UNUSED(start), UNUSED(has_stop), UNUSED(stop);
    return OK;
}
EXPORT int fmi2EnterInitializationMode(void *c) { initialize(c); return OK; }
EXPORT int fmi2ExitInitializationMode(void *c) { initialize(c); return OK; }
EXPORT int fmi2Terminate(void *c) { UNUSED(c); return OK; }
EXPORT int fmi2Reset(void *c) {
    Vehicle *v = c;
    memcpy(v->value, STARTS, sizeof STARTS);
    initialize(v);
    return OK;
}
EXPORT int fmi2DoStep(void *c, double time, double step, int no_return) {
    UNUSED(time), UNUSED(no_return);
    if (!(step > 0.0))
        return ERROR;
    advance(c, step);
    return OK;
}
EXPORT int fmi2CancelStep(void *c) { UNUSED(c); return ERROR; }

EXPORT int fmi2GetReal(void *c, const uint32_t *r, size_t n, double *x) { return get(c, r, n, x); }
EXPORT int fmi2SetReal(void *c, const uint32_t *r, size_t n, const double *x) { return set(c, r, n, x); }
#define NO_VARIABLES(TYPE, CTYPE)                                                             \
    EXPORT int fmi2Get##TYPE(void *c, const uint32_t *r, size_t n, CTYPE *x) {                \
        UNUSED(c), UNUSED(r), UNUSED(x);                                                      \
        return n == 0 ? OK : ERROR;                                                           \
    }                                                                                         \
    EXPORT int fmi2Set##TYPE(void *c, const uint32_t *r, size_t n, const CTYPE *x) {          \
        UNUSED(c), UNUSED(r), UNUSED(x);                                                      \
        return n == 0 ? OK : ERROR;                                                           \
    }
NO_VARIABLES(Integer, int)
NO_VARIABLES(Boolean, int)
NO_VARIABLES(String, char *)

EXPORT int fmi2GetFMUstate(void *c, void **s) { return saved(c, s); }
EXPORT int fmi2SetFMUstate(void *c, void *s) { return restored(c, s); }
EXPORT int fmi2FreeFMUstate(void *c, void **s) { UNUSED(c); return released(s); }
EXPORT int fmi2SerializedFMUstateSize(void *c, void *s, size_t *n) {
    UNUSED(c), UNUSED(s);
    *n = sizeof(Vehicle);
    return OK;
}
EXPORT int fmi2SerializeFMUstate(void *c, void *s, char *b, size_t n) { UNUSED(c); return serialized(s, b, n); }
EXPORT int fmi2DeSerializeFMUstate(void *c, const char *b, size_t n, void **s) {
    UNUSED(c);
    return deserialized(b, n, s);
}

/* Asked for in a doStep that is still pending; this one never is. */
EXPORT int fmi2GetStatus(void *c, int kind, int *x) { UNUSED(c), UNUSED(kind), UNUSED(x); return DISCARD; }
EXPORT int fmi2GetRealStatus(void *c, int kind, double *x) {
    UNUSED(c), UNUSED(kind), UNUSED(x);
    return DISCARD;
}
EXPORT int fmi2GetIntegerStatus(void *c, int kind, int *x) {
    UNUSED(c), UNUSED(kind), UNUSED(x);
    return DISCARD;
}
EXPORT int fmi2GetBooleanStatus(void *c, int kind, int *x) {
    UNUSED(c), UNUSED(kind), UNUSED(x);
    return DISCARD;
}
EXPORT int fmi2GetStringStatus(void *c, int kind, const char **x) {
    UNUSED(c), UNUSED(kind), UNUSED(x);
    return DISCARD;
}
EXPORT int fmi2SetRealInputDerivatives(void *c, const uint32_t *r, size_t n, const int *o, const double *x) {
    UNUSED(c), UNUSED(r), UNUSED(n), UNUSED(o), UNUSED(x);
    return ERROR;
}
EXPORT int fmi2GetRealOutputDerivatives(void *c, const uint32_t *r, size_t n, const int *o, double *x) {
    UNUSED(c), UNUSED(r), UNUSED(n), UNUSED(o), UNUSED(x);
    return ERROR;
}
EXPORT int fmi2GetDirectionalDerivative(void *c, const uint32_t *u, size_t nu, const uint32_t *k, size_t nk,
                                        const double *dk, double *du) {
    UNUSED(c), UNUSED(u), UNUSED(nu), UNUSED(k), UNUSED(nk), UNUSED(dk), UNUSED(du);
    return ERROR;
}

#else
/* ---- FMI 3.0 Co-Simulation: what a unit of Float64 variables needs, and no function of the other types,
        of Model Exchange or of Scheduled Execution. ---- */

#include <stdbool.h>

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                         bool visible, bool logging, bool events, bool early,
                                         const uint32_t *intermediate, size_t n, void *environment,
                                         void *log, void *update) {
    UNUSED(name), UNUSED(resources), UNUSED(visible), UNUSED(logging), UNUSED(events), UNUSED(early);
    UNUSED(intermediate), UNUSED(n), UNUSED(environment), UNUSED(log), UNUSED(update);
    return created(token);
}
EXPORT void fmi3FreeInstance(void *c) { free(c); }
EXPORT int fmi3SetDebugLogging(void *c, bool on, size_t n, const char *const *categories) {
    UNUSED(c), UNUSED(on), UNUSED(n), UNUSED(categories);
    return OK;
}
EXPORT int fmi3EnterInitializationMode(void *c, bool has_tolerance, double tolerance, double start,
                                       bool has_stop, double stop) {
    UNUSED(has_tolerance), UNUSED(tolerance), UNUSED(start), UNUSED(has_stop), UNUSED(stop);
    initialize(c);
    return OK;
}
EXPORT int fmi3ExitInitializationMode(void *c) { initialize(c); return OK; }
EXPORT int fmi3Terminate(void *c) { UNUSED(c); return OK; }
EXPORT int fmi3Reset(void *c) {
    Vehicle *v = c;
    memcpy(v->value, STARTS, sizeof STARTS);
    initialize(v);
    return OK;
}
EXPORT int fmi3DoStep(void *c, double time, double step, bool no_return, bool *event, bool *terminate,
                      bool *early, double *last) {
    UNUSED(no_return);
    if (!(step > 0.0))
        return ERROR;
    advance(c, step);
    *event = *terminate = *early = false;
    *last = time + step;
    return OK;
}
EXPORT int fmi3GetFloat64(void *c, const uint32_t *r, size_t n, double *x, size_t nx) {
    return nx == n ? get(c, r, n, x) : ERROR;
}
EXPORT int fmi3SetFloat64(void *c, const uint32_t *r, size_t n, const double *x, size_t nx) {
    return nx == n ? set(c, r, n, x) : ERROR;
}
EXPORT int fmi3GetFMUState(void *c, void **s) { return saved(c, s); }
EXPORT int fmi3SetFMUState(void *c, void *s) { return restored(c, s); }
EXPORT int fmi3FreeFMUState(void *c, void **s) { UNUSED(c); return released(s); }
EXPORT int fmi3SerializedFMUStateSize(void *c, void *s, size_t *n) {
    UNUSED(c), UNUSED(s);
    *n = sizeof(Vehicle);
    return OK;
}
EXPORT int fmi3SerializeFMUState(void *c, void *s, uint8_t *b, size_t n) {
    UNUSED(c);
    return serialized(s, (char *)b, n);
}
EXPORT int fmi3DeserializeFMUState(void *c, const uint8_t *b, size_t n, void **s) {
    UNUSED(c);
    return deserialized((const char *)b, n, s);
}
#endif
