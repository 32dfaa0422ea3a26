/* A light electric vehicle in C, FMI 2.0 (-DFMI=2) or 3.0 Co-Simulation: the equations of evcosim's Scooter in
   other names and units. Speed in m/s, pedal 0..1, the brake as a force that is negative when it brakes.

   One thing that a user of such an FMU may meet: -DBACKWARD full throttle at pedal 0, -DIN_KMH v in km/h, -DSTIFF steps
   of more than 6 ms do not converge, -DSTATE=1 saves its state, -DSTATE=2 says so and does not go back to it.

   A step that goes beyond the stop time that it was told is an Error; with -DNEEDS_STOP so is an experiment without one.

   value references: 0 pedal [1], 1 F_brake [N], 2 slope [rad], 10 v [m/s], 11 a [m/s2], 12 P [W], 13 s [m],
   20 m_total [kg] */

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>

#define EXPORT __attribute__((visibility("default")))
#if FMI == 3
#define F(name) fmi3##name
#define EXTRA , size_t m
#else
#define F(name) fmi2##name
#define EXTRA
#endif

enum { PEDAL, BRAKE, SLOPE, V = 10, A, P, S, MASS = 20, COUNT = 32 };
typedef struct { double x[COUNT], force, stop; } Vehicle;

static const double G = 9.81, ROLLING = 0.014, VISCOUS = 10.0, TAU = 0.005, EFFICIENCY = 0.85, AUXILIARY = 40.0;
static const double DRAG = 0.5 * 1.2 * 0.60, KMH = 3.6, MOST = 850.0, PI = 3.14159265358979323846;

static double resistance(double v) { return v * (VISCOUS + DRAG * v); }

static double largest(double v) {
    double gain = 0.46 / KMH, v0 = 30.0 / KMH, mass = 200.0;
    double level = mass * G * ROLLING + resistance(v0);
    double offset = v0 - 100.0 * gain * level / (100.0 * mass * 2.0 * PI * 0.03 * gain);
    double force = MOST;
    if (v > offset) force = fmin(force, 100.0 * gain * (mass * G * ROLLING + v * (VISCOUS + DRAG * v)) / (v - offset));
    double fade = (50.5 / KMH - v) * KMH;
    return fade < 1.0 ? force * fmax(0.0, fade) : force;
}

static double held(Vehicle *c) {
    double th = c->x[SLOPE];
    return fmax(0.0, -c->x[BRAKE]) + c->x[MASS] * G * (ROLLING * cos(th) + sin(th));
}

static void show(Vehicle *c) {
    double v = c->x[V], a = (c->force - resistance(v) - held(c)) / c->x[MASS];
    c->x[A] = v <= 0.0 && a < 0.0 ? 0.0 : a;
    c->x[P] = c->force * v / EFFICIENCY + AUXILIARY;
}

#ifdef IN_KMH
static const double SHOWN = 3.6;
#else
static const double SHOWN = 1.0;
#endif

#ifdef STIFF
/* Euler's rule for a force that follows within 3 ms */
static int advance(Vehicle *c, double h) {
    double u = fmin(1.0, fmax(0.0, c->x[PEDAL])), v = c->x[V], f = c->force;
    c->force += h / 0.003 * (u * largest(v) - f);
    c->x[V] = fmax(0.0, v + h * (f - resistance(v) - held(c)) / c->x[MASS]);
    c->x[S] += h * v;
    show(c);
    return 0;
}
#else
/* the midpoint rule with 10 substeps: another integration than evcosim's own */
static int advance(Vehicle *c, double h) {
    double u = fmin(1.0, fmax(0.0, c->x[PEDAL])), dt = h / 10.0, m = c->x[MASS];
#ifdef BACKWARD
    u = 1.0 - u;
#endif
    for (int i = 0; i < 10; i++) {
        double v = c->x[V], f = c->force;
        double vm = fmax(0.0, v + 0.5 * dt * (f - resistance(v) - held(c)) / m);
        double fm = f + (u * largest(v) - f) * (1.0 - exp(-0.5 * dt / TAU));
        double vn = fmax(0.0, v + dt * (fm - resistance(vm) - held(c)) / m);
        c->force = f + (u * largest(vm) - f) * (1.0 - exp(-dt / TAU));
        c->x[S] += 0.5 * dt * (v + vn);
        c->x[V] = vn;
    }
    show(c);
    return 0;
}
#endif

static Vehicle *make(void) {
    Vehicle *c = calloc(1, sizeof(Vehicle));
    if (c) c->x[MASS] = 200.0, show(c);
    return c;
}

static int setup(Vehicle *c, int defined, double stop) {
    c->stop = defined ? stop : INFINITY;
#ifdef NEEDS_STOP
    if (!defined) return 3;
#endif
    return 0;
}
static int late(Vehicle *c, double end) { return end > c->stop; }

static int get(Vehicle *c, const unsigned *r, size_t n, double *x) {
    show(c);
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return 3;
        x[i] = r[i] == V ? SHOWN * c->x[V] : c->x[r[i]];
    }
    return 0;
}
static int set(Vehicle *c, const unsigned *r, size_t n, const double *x) {
    for (size_t i = 0; i < n; i++) {
        if (r[i] >= COUNT) return 3;
        c->x[r[i]] = x[i];
    }
    return 0;
}

#if FMI == 3
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible,
                                         bool logging, bool events, bool early, const unsigned *r, size_t n,
                                         void *environment, void *log, void *update) { return make(); }
EXPORT int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *x, size_t m) { return get(c, r, n, x); }
EXPORT int fmi3SetFloat64(void *c, const unsigned *r, size_t n, const double *x, size_t m) { return set(c, r, n, x); }
EXPORT int fmi3EnterInitializationMode(void *c, bool td, double t, double start, bool sd, double stop) { return setup(c, sd, stop); }
EXPORT int fmi3DoStep(void *c, double t, double h, bool s, bool *event, bool *terminate, bool *early, double *last) {
    *event = *terminate = *early = false;
    *last = t + h;
    return late(c, t + h) ? 3 : advance(c, h);
}
#else
EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) { return make(); }
EXPORT int fmi2GetReal(void *c, const unsigned *r, size_t n, double *x) { return get(c, r, n, x); }
EXPORT int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *x) { return set(c, r, n, x); }
EXPORT int fmi2SetupExperiment(void *c, int td, double t, double start, int sd, double stop) { return setup(c, sd, stop); }
EXPORT int fmi2EnterInitializationMode(void *c) { return 0; }
EXPORT int fmi2DoStep(void *c, double t, double h, int s) { return late(c, t + h) ? 3 : advance(c, h); }
#endif
#ifdef STATE
#if FMI == 3
#define STATES(verb) fmi3##verb##FMUState
#else
#define STATES(verb) fmi2##verb##FMUstate
#endif
EXPORT int STATES(Get)(void *c, void **state) {
    if (!*state) *state = malloc(sizeof(Vehicle));
    *(Vehicle *)*state = *(Vehicle *)c;
    return 0;
}
EXPORT int STATES(Set)(void *c, void *state) {
    if (STATE == 1) *(Vehicle *)c = *(Vehicle *)state;
    return 0;
}
EXPORT int STATES(Free)(void *c, void **state) { return free(*state), *state = NULL, 0; }
#endif
EXPORT int F(ExitInitializationMode)(void *c) { return 0; }
EXPORT int F(Terminate)(void *c) { return 0; }
EXPORT void F(FreeInstance)(void *c) { free(c); }
