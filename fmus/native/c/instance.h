/* One instance of the model: its values, its initialization, its steps, its saved states. It knows no FMI,
   and it allocates at its creation and for a saved state alone.

   A function that returns bool returns false where it refuses or fails; `text` is the reason then, in the
   words of the FMU that runs the same model in Python. */
#ifndef EVCOSIM_INSTANCE_H
#define EVCOSIM_INSTANCE_H

#include "model.h"

enum { REAL = 1, INTEGER = 2, BOOLEAN = 4, ENUMERATION = 8 };
enum { SAID_SENTENCES = 256 }; /* different notices that an instance tells */

/* A type as the functions of the outer interface name it: a word, and what they access by it. */
typedef struct {
    const char *word;
    unsigned types; /* of REAL, INTEGER, ... */
} instance_kind;

typedef enum { CREATED, INITIALIZING, STEPPING, ENDED } instance_phase;

/* The place of a variable's value. */
typedef struct {
    uint32_t offset;
    uint8_t type;     /* REAL, INTEGER, ... */
    uint8_t record;   /* index of `records` */
    uint8_t settable; /* in these phases: bits as IN_CREATED ... */
    uint8_t run;      /* so many variables from this one on are reals, one after the other, all settable alike */
} instance_place;

enum { LONGEST_RUN = 255 };

enum { PARAMETERS, INPUTS, OUTPUTS, TIME, RECORDS };

typedef struct {
    unsigned char *records[RECORDS]; /* the parameters, the inputs with the time, the outputs, `reached` */
    const instance_place *places;
    uint32_t count; /* of variables */
    bool stale;     /* the outputs (and before the start the state) do not belong to the inputs */
    bool follows;   /* outputs feed through and follow a changed input between steps */
    bool derived;   /* what the model keeps belongs to these parameters */
    instance_phase phase;
    double time;    /* what the model sees as the time */
    double reached; /* the end of the last step that was done, before it the start */
    unsigned char *state, *next_state, *next_outputs, *memory;
    const uint32_t *integers; /* the outputs that the outer interface holds in 32 bits */
    uint32_t integer_count;
    const char *integer_word; /* and its word for their type */
    double *clock;            /* the time among the inputs, NULL where there is none */
    char *text;               /* why the last call failed */
    size_t text_size;
    char *sentence;     /* MODEL_TEXT bytes, for the model's notice */
    const char *notice; /* what the last step has to tell, else NULL */
    uint64_t said[SAID_SENTENCES];
    size_t said_count;
    void *own;  /* memory of the outer interface, */
    char *line; /* and its room for a message */
    size_t line_size;
    model_failure failure;
} instance;

typedef struct instance_snapshot instance_snapshot;

/* Create an instance, with `own_size` bytes for the outer interface, whose word for a whole number of 32 bits
   is `integer_word`. Where the interface has a variable for the time, and the model none, its reference is the
   one after the model's. NULL where there is no memory. */
instance *instance_new(const char *integer_word, bool with_time, size_t own_size);
void instance_free(instance *m);

enum { /* phases in which a function of the outer interface may be called */
       IN_CREATED = 1 << CREATED,
       IN_INITIALIZING = 1 << INITIALIZING,
       IN_STEPPING = 1 << STEPPING,
       IN_ENDED = 1 << ENDED,
       KNOWN = IN_INITIALIZING | IN_STEPPING | IN_ENDED,     /* values can be read */
       SETTABLE = IN_CREATED | IN_INITIALIZING | IN_STEPPING /* and set */
};

/* Refuse a call unless the instance is in one of these phases. */
MODEL_SELDOM bool instance_not_now(instance *m);
static inline bool instance_is(instance *m, int phases)
{
    return (phases & 1 << m->phase) != 0 || instance_not_now(m);
}

/* Put `call: text` together, or `text` where `call` is empty, and return it. */
const char *instance_message(instance *m, const char *call, const char *text, bool percent_doubled);

/* Go back to the start values. */
void instance_reset(instance *m);

/* Give the model its start time. */
void instance_set_start(instance *m, double time);

/* Check the parameters, compute the first state and its outputs, and fix the parameters. */
bool instance_start(instance *m);

/* Advance from t by dt. A step that fails leaves state and outputs as they were. (step.h) */
bool instance_step(instance *m, double t, double dt);

/* Compute the outputs of a state, and keep them if all is well. (step.h) */
bool instance_show(instance *m, const unsigned char *state);

/* What a step seldom does: make the model's failure the reason, make its sentence a notice, once; refuse a step, since
   it is not the time for it or it has no length; refuse an output that does not fit 32 bits. */
MODEL_SELDOM bool instance_failed(instance *m);
void instance_tell(instance *m, double time);
MODEL_SELDOM bool instance_no_step(instance *m, double dt);
bool instance_integers_fit(instance *m);

/* Put together why the step at t failed: `call at t = ... s: ...` */
const char *instance_step_message(instance *m, const char *call, double t, bool percent_doubled);

/* Compute the outputs (before the start also the state) anew where they are stale. */
bool instance_refresh(instance *m);

static inline void instance_set_time(instance *m, double time)
{
    m->time = time;
    if (m->clock)
        *m->clock = time;
}

/* Make the next state the state. */
static inline void instance_keep_state(instance *m)
{
    unsigned char *const made = m->next_state;
    m->next_state = m->state;
    m->state = made;
}

static inline bool instance_ready(instance *m)
{
    return !m->stale || instance_refresh(m);
}

/* -- values: check the references, then read or write each, then say that something was set ------- */

MODEL_SELDOM bool instance_unknown(instance *m, instance_kind kind, const uint32_t *references, size_t count);
MODEL_SELDOM bool instance_not_settable(instance *m, instance_kind kind, const uint32_t *references,
                                        size_t count);

/* Return true where all references are of variables of the kind. */
static inline bool instance_has(instance *m, instance_kind kind, const uint32_t *references, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (references[k] >= m->count || !(m->places[references[k]].type & kind.types))
            return instance_unknown(m, kind, references, count);
    return true;
}

static inline bool instance_can_set_one(const instance *m, instance_kind kind, uint32_t reference)
{
    if (reference >= m->count)
        return false;
    const instance_place place = m->places[reference];
    return (place.type & kind.types) != 0 && (place.settable >> m->phase & 1) != 0;
}

/* Return true where all references are of variables of the kind that can be set now. */
static inline bool instance_can_set(instance *m, instance_kind kind, const uint32_t *references, size_t count)
{
    for (size_t k = 0; k < count; k++)
        if (!instance_can_set_one(m, kind, references[k]))
            return instance_not_settable(m, kind, references, count);
    return true;
}

/* Return true unless the value is no item of the enumeration of the variable; the reference may be any. */
bool instance_has_item(instance *m, uint32_t reference, int64_t value);

static inline void *instance_at(const instance *m, uint32_t reference)
{
    const instance_place place = m->places[reference];
    return m->records[place.record] + place.offset;
}

static inline double instance_real(const instance *m, uint32_t reference)
{
    return *(const double *)instance_at(m, reference);
}

static inline int64_t instance_integer(const instance *m, uint32_t reference)
{
    return *(const int64_t *)instance_at(m, reference);
}

static inline bool instance_boolean(const instance *m, uint32_t reference)
{
    return *(const bool *)instance_at(m, reference);
}

static inline void instance_put_real(instance *m, uint32_t reference, double value)
{
    *(double *)instance_at(m, reference) = value;
}

static inline void instance_put_integer(instance *m, uint32_t reference, int64_t value)
{
    *(int64_t *)instance_at(m, reference) = value;
}

static inline void instance_put_boolean(instance *m, uint32_t reference, bool value)
{
    *(bool *)instance_at(m, reference) = value;
}

/* Read reals that are current, those of references that follow each other as the run of numbers that they are.
   False for all others, which may be right too. */
static inline bool instance_get_run(const instance *m, const uint32_t *references, size_t count, double *values)
{
    if (m->stale || !(KNOWN >> m->phase & 1))
        return false;
    for (size_t k = 0; k < count;) {
        uint32_t next = references[k];
        if (next >= m->count || m->places[next].run == 0)
            return false;
        const double *at = instance_at(m, next);
        const size_t run = m->places[next].run, end = run < count - k ? k + run : count;
        do
            values[k++] = *at++;
        while (k < end && references[k] == ++next);
    }
    return true;
}

/* Write reals of one such run between steps. False for all others, which may be right too. */
static inline bool instance_set_run(instance *m, const uint32_t *references, size_t count, const double *values)
{
    const uint32_t first = count > 0 ? references[0] : UINT32_MAX;
    if (m->phase != STEPPING || first >= m->count || count > m->places[first].run ||
        !(m->places[first].settable & IN_STEPPING))
        return false;
    for (size_t k = 1; k < count; k++)
        if (references[k] != first + k)
            return false;
    double *const run = instance_at(m, first);
    for (size_t k = 0; k < count; k++)
        run[k] = values[k];
    m->stale |= m->follows;
    return true;
}

/* Something was set: what depends on it is stale. */
static inline void instance_was_set(instance *m)
{
    if (m->phase < STEPPING) {
        m->stale = true;
        m->derived = false;
    } else if (m->follows) {
        m->stale = true;
    }
}

/* -- saved states --------------------------------------------------------------------------------- */

/* Save the state, in `old` where that is not NULL. NULL where there is no memory. */
instance_snapshot *instance_save(instance *m, instance_snapshot *old);
bool instance_restore(instance *m, const instance_snapshot *saved);

/* The form as bytes: the identity of the FMU and a line end, then each value, little-endian, without gaps:
   equal bytes for equal states, on every machine. */
size_t instance_bytes_size(void);
bool instance_to_bytes(instance *m, const instance_snapshot *saved, unsigned char *bytes, size_t size);

/* Make a saved state of bytes, in `*saved` where that is not NULL. */
bool instance_from_bytes(instance *m, const unsigned char *bytes, size_t size, instance_snapshot **saved);
void instance_free_saved(instance_snapshot *saved);

/* Refuse with a reason, printf's way; returns false. */
#if defined __GNUC__
__attribute__((format(printf, 2, 3), cold))
#endif
bool instance_refuse(instance *m, const char *format, ...);

#endif
