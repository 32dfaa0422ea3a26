/* What a generated model.c and instance.c know of each other. Neither knows FMI, and instance.c no model. */
#ifndef EVCOSIM_MODEL_H
#define EVCOSIM_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "failure.h"

#if defined(__GNUC__)
/* A function of a step is computed where it is called, so that no record is copied for the call; what a step
   finds known already is not. */
#define MODEL_IN_PLACE static inline __attribute__((always_inline))
#define MODEL_APART static __attribute__((noinline))
#else
#define MODEL_IN_PLACE static inline
#define MODEL_APART static
#endif

/* One variable that FMI sees; its value reference is its place in the table. */
typedef struct {
    const char *name;
    const char *unit;
    char type;      /* 'r' Real, 'i' Integer, 'b' Boolean, 'e' Enumeration */
    char causality; /* 'p' parameter, 'i' input, 't' independent (the time), 'o' output */
    size_t offset;  /* in the struct of its causality; reals are double, the others int64_t, truth values bool */
    double start;
    const double *minimum, *maximum; /* NULL where there is none */
    const char *minimum_text, *maximum_text; /* as Python shows them */
    const int32_t *items;            /* values of an enumeration */
    size_t item_count;
    const char *items_text; /* "0 known_speed, 1 estimated_speed" */
} model_variable;

/* `count` numbers of a state that is saved, each `stride` bytes after the one before it: a field, an array, or
   one field of each record in an array. */
typedef struct {
    char type; /* 'r' double, 'i' int64_t, 'b' bool, 'e' item of an enumeration, an int64_t */
    size_t offset;
    size_t count, stride;
    const int32_t *items; /* values of an enumeration */
    size_t item_count;
} model_field;

/* A model: sizes of its records, its variables, its functions. A function returns false where it fails, and
   leaves `failure`. `memory` is what its remembered calls keep. */
typedef struct {
    const char *name;
    const char *identity; /* of the FMU: a saved state belongs to it */
    const char *token;    /* guid or instantiationToken of its description */
    bool sampled, feeds_through, timed;
    size_t parameters_size, inputs_size, state_size, outputs_size, memory_size;
    const model_variable *variables;
    size_t variable_count;
    const model_field *state_fields;
    size_t state_field_count;
    bool (*initial)(void *p, const void *u, void *memory, void *x, model_failure *failure);
    bool (*step)(void *p, const void *x, const void *u, double dt, void *memory, void *next,
               model_failure *failure);
    bool (*outputs)(void *p, const void *x, const void *u, void *memory, void *y, model_failure *failure);
    /* NULL where the model has none; `text` is "" where there is nothing to say */
    bool (*notice)(void *p, const void *x, const void *next, const void *u, void *memory, char *text,
                 size_t size, model_failure *failure);
    /* the parameters have changed: nothing that was derived from them is known any more */
    void (*forget)(void *p, void *memory);
} model_description;

extern const model_description model;

#endif
