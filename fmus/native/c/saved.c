/* Saved states of an instance (instance.h), and their form as bytes. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "instance.h"

/* The values of the records follow, in the order parameters, inputs, outputs, state. */
struct instance_snapshot {
    const model_description *of;
    double time, reached;
    instance_phase phase;
    bool stale;
};

enum { ALIGNMENT = 16, FLAG_BYTES = 2, NUMBER_BYTES = 8, STATE = TIME, BLOCKS = RECORDS };

static size_t block_size(int block)
{
    const size_t sizes[BLOCKS] = {model.parameters_size, model.inputs_size, model.outputs_size,
                                  model.state_size};
    return (sizes[block] + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

static size_t block_offset(int block)
{
    size_t offset = (sizeof(instance_snapshot) + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    for (int k = 0; k < block; k++)
        offset += block_size(k);
    return offset;
}

static unsigned char *block_of(instance_snapshot *saved, int block)
{
    return (unsigned char *)saved + block_offset(block);
}

static const unsigned char *const_block_of(const instance_snapshot *saved, int block)
{
    return (const unsigned char *)saved + block_offset(block);
}

static instance_snapshot *room(instance *m, instance_snapshot *old)
{
    instance_snapshot *saved = old ? old : calloc(1, block_offset(BLOCKS));
    if (!saved)
        instance_refuse(m, "there is no memory for a state");
    return saved;
}

instance_snapshot *instance_save(instance *m, instance_snapshot *old)
{
    instance_snapshot *saved = room(m, old);
    if (!saved)
        return NULL;
    saved->of = &model;
    saved->time = m->time;
    saved->reached = m->reached;
    saved->phase = m->phase == ENDED ? STEPPING : m->phase;
    saved->stale = m->stale;
    memcpy(block_of(saved, PARAMETERS), m->records[PARAMETERS], model.parameters_size);
    memcpy(block_of(saved, INPUTS), m->records[INPUTS], model.inputs_size);
    memcpy(block_of(saved, OUTPUTS), m->records[OUTPUTS], model.outputs_size);
    memcpy(block_of(saved, STATE), m->state, model.state_size);
    return saved;
}

static size_t size_of(char type)
{
    return type == 'b' ? sizeof(bool) : NUMBER_BYTES;
}

/* Take over the parameters. Where they are the same, what the model has derived from them stays known. */
static void restore_parameters(instance *m, const unsigned char *saved)
{
    unsigned char *now = m->records[PARAMETERS];
    for (size_t k = 0; k < model.variable_count; k++) {
        const model_variable *v = &model.variables[k];
        if (v->causality != 'p' || !memcmp(now + v->offset, saved + v->offset, size_of(v->type)))
            continue;
        memcpy(now + v->offset, saved + v->offset, size_of(v->type));
        m->derived = false;
    }
    if (m->derived)
        return;
    model.forget(now, m->memory);
    m->derived = true;
}

bool instance_restore(instance *m, const instance_snapshot *saved)
{
    if (!saved || saved->of != &model)
        return instance_refuse(m, "this is no state of this FMU");
    restore_parameters(m, const_block_of(saved, PARAMETERS));
    memcpy(m->records[INPUTS], const_block_of(saved, INPUTS), model.inputs_size);
    memcpy(m->records[OUTPUTS], const_block_of(saved, OUTPUTS), model.outputs_size);
    memcpy(m->state, const_block_of(saved, STATE), model.state_size);
    m->time = saved->time;
    m->reached = saved->reached;
    m->phase = saved->phase;
    m->stale = saved->stale;
    return true;
}

/* -- bytes ---------------------------------------------------------------------------------------- */

/* Goes through bytes, to write or to read them: one description of the form for both. */
typedef struct {
    unsigned char *to;         /* NULL when it reads */
    const unsigned char *from; /* NULL when it writes */
    size_t at;
    bool sound; /* what was read can be a state */
    bool idle;  /* the state was not computed: its record is not read before it is */
} stream;

static void byte(stream *s, unsigned char *value)
{
    if (s->to)
        s->to[s->at++] = *value;
    else
        *value = s->from[s->at++];
}

static void bits(stream *s, uint64_t *value)
{
    uint64_t read = 0;
    for (int k = 0; k < NUMBER_BYTES; k++) {
        unsigned char part = (unsigned char)(*value >> (8 * k));
        byte(s, &part);
        read |= (uint64_t)part << (8 * k);
    }
    *value = read;
}

static void real(stream *s, double *value)
{
    uint64_t pattern;
    memcpy(&pattern, value, sizeof pattern);
    bits(s, &pattern);
    memcpy(value, &pattern, sizeof pattern);
}

static void integer(stream *s, int64_t *value)
{
    uint64_t pattern;
    memcpy(&pattern, value, sizeof pattern);
    bits(s, &pattern);
    memcpy(value, &pattern, sizeof pattern);
}

static void truth(stream *s, bool *value)
{
    unsigned char pattern = *value;
    byte(s, &pattern);
    s->sound = s->sound && pattern <= 1;
    *value = pattern == 1;
}

static void item(stream *s, int64_t *value, const int32_t *items, size_t count)
{
    bool known = false;
    integer(s, value);
    for (size_t k = 0; k < count; k++)
        known = known || items[k] == *value;
    s->sound = s->sound && (known || s->idle);
}

static void number(stream *s, char type, unsigned char *at, const int32_t *items, size_t item_count)
{
    switch (type) {
    case 'r': real(s, (double *)(void *)at); break;
    case 'b': truth(s, (bool *)at); break;
    case 'e': item(s, (int64_t *)(void *)at, items, item_count); break;
    default:  integer(s, (int64_t *)(void *)at);
    }
}

/* The numbers of one field of the state. */
static void field(stream *s, const model_field *f, unsigned char *state)
{
    for (size_t k = 0; k < f->count; k++)
        number(s, f->type, state + f->offset + k * f->stride, f->items, f->item_count);
}

static void variables(stream *s, instance_snapshot *saved)
{
    for (size_t k = 0; k < model.variable_count; k++) {
        const model_variable *v = &model.variables[k];
        const int block = v->causality == 'p' ? PARAMETERS : v->causality == 'o' ? OUTPUTS : INPUTS;
        number(s, v->type, block_of(saved, block) + v->offset, v->items, v->item_count);
    }
}

/* All that a state consists of, behind its identity. */
static void content(stream *s, instance_snapshot *saved)
{
    unsigned char phase = (unsigned char)saved->phase;
    byte(s, &phase);
    s->sound = s->sound && phase <= STEPPING;
    saved->phase = phase <= STEPPING ? (instance_phase)phase : CREATED;
    truth(s, &saved->stale);
    real(s, &saved->time);
    real(s, &saved->reached);
    variables(s, saved);
    s->idle = saved->phase < STEPPING;
    for (size_t k = 0; k < model.state_field_count; k++)
        field(s, &model.state_fields[k], block_of(saved, STATE));
}

size_t instance_bytes_size(void)
{
    size_t size = strlen(model.identity) + 1 + FLAG_BYTES + 2 * NUMBER_BYTES;
    for (size_t k = 0; k < model.variable_count; k++)
        size += size_of(model.variables[k].type);
    for (size_t k = 0; k < model.state_field_count; k++)
        size += model.state_fields[k].count * size_of(model.state_fields[k].type);
    return size;
}

bool instance_to_bytes(instance *m, const instance_snapshot *saved, unsigned char *bytes, size_t size)
{
    const size_t stamp = strlen(model.identity);
    if (!saved || saved->of != &model)
        return instance_refuse(m, "this is no state of this FMU");
    if (size < instance_bytes_size())
        return instance_refuse(m, "a state needs %zu bytes, there is room for %zu", instance_bytes_size(),
                               size);
    memcpy(bytes, model.identity, stamp);
    bytes[stamp] = '\n';
    stream s = {bytes, NULL, stamp + 1, true, false};
    content(&s, (instance_snapshot *)saved); /* whose values are written to themselves */
    return true;
}

/* Refuse the bytes of another FMU: show its identity, as Python's repr() of the text in ASCII does. */
static bool foreign(instance *m, const unsigned char *bytes, size_t size)
{
    char shown[256];
    size_t length = 0, stamp = strlen(model.identity) + 1;
    bool single = false, twofold = false;
    if (size > stamp)
        size = stamp;
    for (size_t k = 0; k < size; k++) {
        if (bytes[k] == '\n')
            size = k;
        single = single || (k < size && bytes[k] == '\'');
        twofold = twofold || (k < size && bytes[k] == '"');
    }
    const char quote = single && !twofold ? '"' : '\'';
    for (size_t k = 0; k < size && length + 8 < sizeof shown; k++) {
        const unsigned char c = bytes[k];
        const char *named = c == '\t' ? "\\t" : c == '\r' ? "\\r" : c == '\\' ? "\\\\" : NULL;
        if (named)
            length += (size_t)sprintf(shown + length, "%s", named);
        else if (c == quote)
            length += (size_t)sprintf(shown + length, "\\%c", c);
        else if (c >= 0x80)
            length += (size_t)sprintf(shown + length, "\xEF\xBF\xBD"); /* U+FFFD: it is not ASCII */
        else
            length += (size_t)sprintf(shown + length, c < 0x20 || c == 0x7F ? "\\x%02x" : "%c", c);
    }
    shown[length] = '\0';
    return instance_refuse(m, "these bytes are a state of %c%s%c, this FMU is '%s'", quote, shown, quote,
                           model.identity);
}

bool instance_from_bytes(instance *m, const unsigned char *bytes, size_t size, instance_snapshot **saved)
{
    const size_t stamp = strlen(model.identity), whole = instance_bytes_size();
    if (size <= stamp || memcmp(bytes, model.identity, stamp) != 0 || bytes[stamp] != '\n')
        return foreign(m, bytes, size);
    if (size != whole)
        return instance_refuse(m, "these bytes are no whole state: they are %zu, a state has %zu", size,
                               whole);
    instance_snapshot *made = room(m, NULL);
    if (!made)
        return false;
    stream s = {NULL, bytes, stamp + 1, true, false};
    made->of = &model;
    content(&s, made);
    if (!s.sound) {
        free(made);
        return instance_refuse(m, "these bytes are a damaged state: a value in them cannot be one");
    }
    if (*saved) {
        memcpy(*saved, made, block_offset(BLOCKS));
        free(made);
    } else {
        *saved = made;
    }
    return true;
}

void instance_free_saved(instance_snapshot *saved)
{
    free(saved);
}
