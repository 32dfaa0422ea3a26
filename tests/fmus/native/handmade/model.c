/* handmade.py by hand: Handmade, with -DSAMPLED HandmadeSampled, with -DPLAIN HandmadePlain. conftest.py defines NAME, IDENTITY,
   TOKEN, ZERO_DIVISION and the lines of handmade.py that raise. */
#include "model.h"

#include <stdio.h>
#include <string.h>

enum { REVERSE = -1, NEUTRAL = 1, FORWARD = 2, QUEUE = 3 };

typedef struct {
    double gain, divisor;
    int64_t limit;
    bool active;
    int64_t mode;
    double share;
    int64_t word;
    bool part_known;
    double part;
} Parameters;

typedef struct {
    double speed;
#ifndef PLAIN
    double clock;
#endif
    int64_t steps;
    bool on;
    int64_t lever;
} Inputs;

typedef struct {
    double total;
    int64_t last, count;
    bool seen;
    double queue[QUEUE];
} State;

typedef struct {
    double total, direct;
    int64_t ticks;
    bool is_on;
    int64_t last;
    double oldest;
} Outputs;

static bool fail(model_failure *failure, const char *exception, const char *text, int line)
{
    failure->exception = exception;
    failure->file = "handmade.py";
    failure->line = line;
    snprintf(failure->text, sizeof failure->text, "%s", text);
    return false;
}

/* the cached property, computed at its first use */
static double part(Parameters *p)
{
    if (!p->part_known)
        p->part = p->gain * p->share / 100.0;
    p->part_known = true;
    return p->part;
}

static void forget(void *parameters, void *memory)
{
    (void)memory;
    ((Parameters *)parameters)->part_known = false;
}

static bool initial(void *parameters, const void *inputs, void *memory, void *state, model_failure *failure)
{
    Parameters *p = parameters;
    const Inputs *u = inputs;
    State x = {0.0, NEUTRAL, 0, false, {-1.0, -1.0, -1.0}};
#ifdef PLAIN
    const double clock = 0.0;
#else
    const double clock = u->clock;
#endif
    (void)memory;
    if (p->word == 1)
        return fail(failure, "RuntimeError", "100 % sure %s %n \xC3\xBC", LINE_OF_RUNTIME_ERROR);
    if (p->word == 2)
        return fail(failure, "ValueError", "", LINE_OF_VALUE_ERROR);
    x.total = u->speed + clock + part(p);
    *(State *)state = x;
    return true;
}

static bool step(void *parameters, const void *state, const void *inputs, double dt, void *memory, void *next,
                 model_failure *failure)
{
    Parameters *p = parameters;
    const State *x = state;
    const Inputs *u = inputs;
    State made = *x;
#ifdef PLAIN
    const double clock = 2.0;
#else
    const double clock = u->clock;
#endif
    (void)memory;
    if (p->divisor == 0.0)
        return fail(failure, "ZeroDivisionError", ZERO_DIVISION, LINE_OF_STEP);
    made.total = x->total + dt * (0.1 * u->speed + clock) / p->divisor;
    if (p->active && u->lever == p->mode)
        made.total = made.total * 1.1 + part(p);
    for (int k = 0; k < QUEUE; k++)
        made.queue[k] = u->steps < 0 || k == QUEUE - 1 ? made.total : x->queue[k + 1];
    made.last = u->lever;
    made.count = x->count + 1;
    made.seen = x->seen || u->on;
    *(State *)next = made;
    return true;
}

static bool outputs(void *parameters, const void *state, const void *inputs, void *memory, void *outputs,
                    model_failure *failure)
{
    const State *x = state;
    const Inputs *u = inputs;
    Outputs y;
    (void)parameters, (void)memory, (void)failure, (void)u;
    y.total = x->total;
#ifdef PLAIN
    y.direct = 0.5 * x->total;
    y.ticks = ((const Parameters *)parameters)->word == 3 ? 1000000000 * x->count : x->count;
    y.is_on = x->seen;
#else
    if (u->speed - 666.0 == 0.0)
        return fail(failure, "ZeroDivisionError", ZERO_DIVISION, LINE_OF_OUTPUTS);
    y.direct = x->total / (u->speed - 666.0) + u->clock;
    y.ticks = 1000000 * x->count + u->steps;
    y.is_on = u->on;
#endif
    y.last = x->last;
    y.oldest = x->queue[0];
    *(Outputs *)outputs = y;
    return true;
}

static bool notice(void *parameters, const void *state, const void *next, const void *inputs, void *memory,
                   char *text, size_t size, model_failure *failure)
{
    const Parameters *p = parameters;
    const State *after = next;
    (void)state, (void)memory, (void)failure;
    if (after->count < p->limit || ((const Inputs *)inputs)->on)
        return true;
    snprintf(text, size, "%d of %d steps, 100 %% of them", (int)(after->count / 3 * 3), (int)p->limit);
    return true;
}

static const double zero = 0.0, nine = 9.0, ten = 10.0, hundred = 100.0;
static const int32_t modes[] = {REVERSE, NEUTRAL, FORWARD};
#define MODES modes, 3, "-1 reverse, 1 neutral, 2 forward"
#define NO_MODES NULL, 0, NULL
#define NO_RANGE NULL, NULL, NULL, NULL
#define P(field) offsetof(Parameters, field)
#define U(field) offsetof(Inputs, field)
#define Y(field) offsetof(Outputs, field)

static const model_variable variables[] = {
    {"gain", "N/m", 'r', 'p', P(gain), 1.5, &zero, &ten, "0.0", "10.0", NO_MODES},
    {"divisor", "", 'r', 'p', P(divisor), 3.0, NO_RANGE, NO_MODES},
    {"limit", "", 'i', 'p', P(limit), 3.0, &zero, &nine, "0", "9", NO_MODES},
    {"active", "", 'b', 'p', P(active), 1.0, NO_RANGE, NO_MODES},
    {"mode", "", 'e', 'p', P(mode), FORWARD, NO_RANGE, MODES},
    {"share", "%", 'r', 'p', P(share), 50.0, NULL, &hundred, NULL, "100", NO_MODES},
    {"word", "", 'i', 'p', P(word), 0.0, &zero, NULL, "0", NULL, NO_MODES},
    {"speed", "km/h", 'r', 'i', U(speed), 0.0, NO_RANGE, NO_MODES},
#ifndef PLAIN
    {"clock", "s", 'r', 't', U(clock), 0.0, NO_RANGE, NO_MODES},
#endif
    {"steps", "", 'i', 'i', U(steps), 0.0, NO_RANGE, NO_MODES},
    {"on", "", 'b', 'i', U(on), 0.0, NO_RANGE, NO_MODES},
    {"lever", "", 'e', 'i', U(lever), NEUTRAL, NO_RANGE, MODES},
    {"total", "N/m", 'r', 'o', Y(total), 0.0, NO_RANGE, NO_MODES},
    {"direct", "", 'r', 'o', Y(direct), 0.0, NO_RANGE, NO_MODES},
    {"ticks", "", 'i', 'o', Y(ticks), 0.0, NO_RANGE, NO_MODES},
    {"is_on", "", 'b', 'o', Y(is_on), 0.0, NO_RANGE, NO_MODES},
    {"last", "", 'e', 'o', Y(last), NEUTRAL, NO_RANGE, MODES},
    {"oldest", "", 'r', 'o', Y(oldest), 0.0, NO_RANGE, NO_MODES},
};

#define X(field) offsetof(State, field)

static const model_field fields[] = {
    {'r', X(total), 1, sizeof(double), NULL, 0},
    {'e', X(last), 1, sizeof(int64_t), modes, 3},
    {'i', X(count), 1, sizeof(int64_t), NULL, 0},
    {'b', X(seen), 1, sizeof(bool), NULL, 0},
    {'r', X(queue), QUEUE, sizeof(double), NULL, 0},
};

const model_description model = {
    NAME,
    IDENTITY,
    TOKEN,
#ifdef SAMPLED
    true,
#else
    false,
#endif
#ifdef PLAIN
    false,
    false,
#else
    true,
    true,
#endif
    sizeof(Parameters),
    sizeof(Inputs),
    sizeof(State),
    sizeof(Outputs),
    0,
    variables,
    sizeof variables / sizeof *variables,
    fields,
    sizeof fields / sizeof *fields,
    initial,
    step,
    outputs,
    notice,
    forget,
};

#include "step.h"
