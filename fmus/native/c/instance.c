/* One instance of the model (instance.h), but for its steps (step.h). What it does, and when, is what fmus/slave.py
   does in Python. */
#include "instance.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 16, NUMBER_TEXT = PY_REPR_SIZE };

/* -- texts ---------------------------------------------------------------------------------------- */

/* Cut off the part of a character of UTF-8 that stands at the end of a text that was cut. */
static void end_whole(char *text, size_t size)
{
    size_t end = strlen(text), start = end;
    if (end + 1 < size)
        return;
    while (start > 0 && ((unsigned char)text[start - 1] & 0xC0) == 0x80)
        start--;
    if (start == 0)
        return;
    const unsigned char first = (unsigned char)text[start - 1];
    const size_t length = first < 0x80 ? 1 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : 4;
    if (start - 1 + length > end)
        text[start - 1] = '\0';
}

/* Write a real by a format of Python: "" is str(). */
static const char *real_text(double value, const char *format, char *to)
{
    model_text text = model_begin(to, NUMBER_TEXT);
    model_put_real(&text, value, format);
    return to;
}

/* Append to the reason, printf's way. */
#if defined __GNUC__
__attribute__((format(printf, 2, 3), cold))
#endif
static void
add(instance *m, const char *format, ...)
{
    const size_t length = strlen(m->text);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(m->text + length, m->text_size - length, format, arguments);
    va_end(arguments);
    end_whole(m->text, m->text_size);
}

bool instance_refuse(instance *m, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(m->text, m->text_size, format, arguments);
    va_end(arguments);
    end_whole(m->text, m->text_size);
    return false;
}

bool instance_failed(instance *m)
{
    end_whole(m->failure.text, sizeof m->failure.text);
    return instance_refuse(m, "%s: %s (%s:%d)", m->failure.exception, m->failure.text, m->failure.file,
                           m->failure.line);
}

const char *instance_message(instance *m, const char *call, const char *text, bool percent_doubled)
{
    const int written = snprintf(m->line, m->line_size, "%s%s", call, call[0] ? ": " : "");
    size_t length = written > 0 ? (size_t)written : 0;
    for (const char *c = text; *c && length + 2 < m->line_size; c++) {
        if (*c == '%' && percent_doubled)
            m->line[length++] = '%';
        m->line[length++] = *c;
    }
    m->line[length] = '\0';
    return m->line;
}

const char *instance_step_message(instance *m, const char *call, double t, bool percent_doubled)
{
    char place[2 * NUMBER_TEXT], shown[NUMBER_TEXT];
    snprintf(place, sizeof place, "%.20s at t = %s s", call, real_text(t, "", shown));
    return instance_message(m, place, m->text, percent_doubled);
}

bool instance_not_now(instance *m)
{
    static const char *const now[] = {
        "the initialization mode has not been entered",
        "the initialization mode has not been left",
        "the initialization mode has been left",
        "it was terminated",
    };
    return instance_refuse(m, "%s", now[m->phase]);
}

/* -- creation ------------------------------------------------------------------------------------- */

static size_t aligned(size_t size)
{
    return (size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

/* Return the room that the longest reason needs: one of the model, or every parameter out of its range. */
static size_t longest_text(void)
{
    size_t all = 0;
    for (size_t k = 0; k < model.variable_count; k++) {
        const model_variable *v = &model.variables[k];
        const char *limits[] = {v->minimum_text, v->maximum_text};
        if (v->causality != 'p')
            continue;
        all += strlen(v->name) + 2 * strlen(v->unit) + 2 * NUMBER_TEXT + sizeof " =  is below its minimum ; ";
        for (size_t i = 0; i < 2; i++)
            all += limits[i] ? strlen(limits[i]) : 0;
    }
    return 2 * MODEL_TEXT + all;
}

static void fill_places(instance *m, instance_place *places, uint32_t *integers)
{
    m->count = (uint32_t)model.variable_count;
    for (size_t k = 0; k < model.variable_count; k++) {
        const model_variable *v = &model.variables[k];
        const uint8_t type = v->type == 'r'   ? REAL
                             : v->type == 'i' ? INTEGER
                             : v->type == 'b' ? BOOLEAN
                                              : ENUMERATION;
        places[k].offset = (uint32_t)v->offset;
        places[k].type = type;
        places[k].record = v->causality == 'p' ? PARAMETERS : v->causality == 'o' ? OUTPUTS : INPUTS;
        places[k].settable = v->causality == 'i' ? SETTABLE : v->causality == 'p' ? SETTABLE & ~IN_STEPPING : 0;
        if (v->causality == 'o' && v->type == 'i')
            integers[m->integer_count++] = (uint32_t)k;
        if (v->causality == 't')
            m->clock = instance_at(m, (uint32_t)k);
    }
}

/* Count the reals that lie one after the other, from each variable on. */
static void fill_runs(instance *m, instance_place *places)
{
    for (uint32_t k = m->count; k-- > 0;) {
        instance_place *const one = &places[k], *const next = one + 1;
        const bool more = k + 1 < m->count && next->run > 0 && next->run < LONGEST_RUN &&
                          next->record == one->record && next->settable == one->settable &&
                          next->offset == one->offset + sizeof(double);
        one->run = (uint8_t)(one->type != REAL ? 0 : more ? next->run + 1 : 1);
    }
}

/* Return the next part of the memory, and count it. */
static void *part(unsigned char *memory, size_t *used, size_t size)
{
    void *found = memory ? memory + *used : NULL;
    *used += aligned(size);
    return found;
}

/* Lay out one memory, or with NULL only count its bytes. */
static size_t lay_out(instance *m, unsigned char *memory, size_t own_size)
{
    size_t used = 0;
    const size_t count = model.variable_count + 1; /* and the time */
    part(memory, &used, sizeof *m);
    m->records[PARAMETERS] = part(memory, &used, model.parameters_size);
    m->records[INPUTS] = part(memory, &used, model.inputs_size);
    m->records[OUTPUTS] = part(memory, &used, model.outputs_size);
    m->next_outputs = part(memory, &used, model.outputs_size);
    m->state = part(memory, &used, model.state_size);
    m->next_state = part(memory, &used, model.state_size);
    m->memory = part(memory, &used, model.memory_size);
    m->places = part(memory, &used, count * sizeof *m->places);
    m->integers = part(memory, &used, count * sizeof *m->integers);
    m->own = part(memory, &used, own_size);
    m->sentence = part(memory, &used, MODEL_TEXT);
    m->text_size = longest_text();
    m->text = part(memory, &used, m->text_size);
    m->line_size = 2 * m->text_size + 256;
    m->line = part(memory, &used, m->line_size);
    return used;
}

instance *instance_new(const char *integer_word, bool with_time, size_t own_size)
{
    instance counting;
    unsigned char *memory = calloc(1, lay_out(&counting, NULL, own_size));
    if (!memory)
        return NULL;
    instance *m = (instance *)(void *)memory;
    instance_place *places;
    lay_out(m, memory, own_size);
    places = (instance_place *)m->places;
    m->records[TIME] = (unsigned char *)&m->reached;
    m->follows = model.feeds_through && !model.sampled;
    m->integer_word = integer_word;
    fill_places(m, places, (uint32_t *)m->integers);
    if (with_time && !m->clock) {
        places[m->count].type = REAL;
        places[m->count++].record = TIME;
    }
    fill_runs(m, places);
    instance_reset(m);
    return m;
}

void instance_free(instance *m)
{
    free(m);
}

void instance_reset(instance *m)
{
    memset(m->state, 0, model.state_size);
    for (uint32_t k = 0; k < model.variable_count; k++) {
        const double start = model.variables[k].start;
        switch (m->places[k].type) {
        case REAL:    instance_put_real(m, k, start); break;
        case BOOLEAN: instance_put_boolean(m, k, start != 0.0); break;
        default:      instance_put_integer(m, k, (int64_t)start);
        }
    }
    m->time = m->reached = 0.0;
    m->phase = CREATED;
    m->stale = true;
    m->derived = false;
    m->said_count = 0;
    m->notice = NULL;
}

/* -- time and steps ------------------------------------------------------------------------------- */

void instance_set_start(instance *m, double time)
{
    instance_set_time(m, time);
    m->reached = time;
    if (m->clock && m->phase < STEPPING)
        m->stale = true;
}

bool instance_integers_fit(instance *m)
{
    for (uint32_t k = 0; k < m->integer_count; k++) {
        const model_variable *v = &model.variables[m->integers[k]];
        const int64_t value = *(const int64_t *)(const void *)(m->next_outputs + v->offset);
        if (value < INT32_MIN || value > INT32_MAX)
            return instance_refuse(m, "output %s is %" PRId64 ", which is no %s", v->name, value,
                                   m->integer_word);
    }
    return true;
}

/* Write a parameter's value as Python shows it. */
static void value_text(const instance *m, uint32_t k, char *text)
{
    switch (m->places[k].type) {
    case REAL:    real_text(instance_real(m, k), "", text); break;
    case BOOLEAN: snprintf(text, NUMBER_TEXT, "%s", instance_boolean(m, k) ? "True" : "False"); break;
    default:      snprintf(text, NUMBER_TEXT, "%" PRId64, instance_integer(m, k));
    }
}

static double number(const instance *m, uint32_t k)
{
    switch (m->places[k].type) {
    case REAL:    return instance_real(m, k);
    case BOOLEAN: return instance_boolean(m, k);
    default:      return (double)instance_integer(m, k);
    }
}

/* Refuse parameters that are out of range, all in one text. */
static bool in_range(instance *m)
{
    char value[NUMBER_TEXT];
    m->text[0] = '\0';
    for (uint32_t k = 0; k < model.variable_count; k++) {
        const model_variable *v = &model.variables[k];
        const double x = number(m, k);
        const char *space = v->unit[0] ? " " : "", *joint = m->text[0] ? "; " : "";
        if (v->causality != 'p')
            continue;
        value_text(m, k, value);
        if (!isfinite(x))
            add(m, "%s%s = %s is not a finite number", joint, v->name, value);
        else if (v->minimum && x < *v->minimum)
            add(m, "%s%s = %s%s%s is below its minimum %s%s%s", joint, v->name, value, space, v->unit,
                v->minimum_text, space, v->unit);
        else if (v->maximum && x > *v->maximum)
            add(m, "%s%s = %s%s%s is above its maximum %s%s%s", joint, v->name, value, space, v->unit,
                v->maximum_text, space, v->unit);
    }
    return m->text[0] == '\0';
}

/* Compute the first state and its outputs from the current parameters and inputs. */
static bool initialize(instance *m)
{
    if (!in_range(m))
        return false;
    if (!m->derived)
        model.forget(m->records[PARAMETERS], m->memory);
    m->derived = true;
    if (!model.initial(m->records[PARAMETERS], m->records[INPUTS], m->memory, m->next_state, &m->failure))
        return instance_failed(m);
    if (!instance_show(m, m->next_state))
        return false;
    instance_keep_state(m);
    return true;
}

bool instance_refresh(instance *m)
{
    return m->phase < STEPPING ? initialize(m) : instance_show(m, m->state);
}

bool instance_start(instance *m)
{
    if (!initialize(m))
        return false;
    m->phase = STEPPING;
    return true;
}

/* Return true for a sentence that was not told before, as long as there is room to remember it. */
static bool is_new(instance *m, const char *sentence)
{
    uint64_t hash = UINT64_C(14695981039346656037); /* FNV-1a, of eight characters at once; high bits go down too */
    size_t left = strlen(sentence);
    for (uint64_t characters; left >= sizeof characters; left -= sizeof characters) {
        memcpy(&characters, sentence, sizeof characters);
        hash = (hash ^ characters) * UINT64_C(1099511628211);
        hash ^= hash >> 32;
        sentence += sizeof characters;
    }
    for (; left > 0; left--)
        hash = (hash ^ (unsigned char)*sentence++) * UINT64_C(1099511628211);
    for (size_t k = 0; k < m->said_count; k++)
        if (m->said[k] == hash)
            return false;
    if (m->said_count == SAID_SENTENCES)
        return false;
    m->said[m->said_count++] = hash;
    return true;
}

/* Make the model's sentence a notice. */
MODEL_SELDOM MODEL_APART void tell_first(instance *m, double time)
{
    char shown[NUMBER_TEXT];
    real_text(time, ".9g", shown);
    end_whole(m->sentence, MODEL_TEXT);
    instance_refuse(m, "first at t = %s s: %s", shown, m->sentence);
    if (m->said_count == SAID_SENTENCES)
        add(m, " (the last of %d different notices: no other one is told)", SAID_SENTENCES);
    m->notice = m->text;
}

void instance_tell(instance *m, double time)
{
    if (is_new(m, m->sentence))
        tell_first(m, time);
}

bool instance_no_step(instance *m, double dt)
{
    char shown[NUMBER_TEXT];
    if (m->phase < STEPPING)
        return instance_refuse(m, "the initialization mode has not been left");
    if (m->phase == ENDED)
        return instance_refuse(m, "it was terminated");
    return instance_refuse(m, "the step is %s s: it must be finite and longer than 0",
                           real_text(dt, "", shown));
}

/* -- references ----------------------------------------------------------------------------------- */

static bool is_known(const instance *m, instance_kind kind, uint32_t reference)
{
    return reference < m->count && (m->places[reference].type & kind.types);
}

bool instance_unknown(instance *m, instance_kind kind, const uint32_t *references, size_t count)
{
    const char *joint = "";
    int64_t last = -1;
    instance_refuse(m, "there is no %s variable with value reference ", kind.word);
    for (;;) { /* each unknown one once, in order */
        int64_t next = INT64_MAX;
        for (size_t k = 0; k < count; k++)
            if (!is_known(m, kind, references[k]) && references[k] > last && references[k] < next)
                next = references[k];
        if (next == INT64_MAX)
            return false;
        if (strlen(m->text) + NUMBER_TEXT > m->text_size) {
            add(m, ", ...");
            return false;
        }
        add(m, "%s%" PRId64, joint, next);
        joint = ", ";
        last = next;
    }
}

bool instance_not_settable(instance *m, instance_kind kind, const uint32_t *references, size_t count)
{
    uint32_t first = UINT32_MAX;
    for (size_t k = 0; k < count; k++) {
        if (!is_known(m, kind, references[k]))
            return instance_unknown(m, kind, references, count);
        if (!instance_can_set_one(m, kind, references[k]) && references[k] < first)
            first = references[k];
    }
    const bool is_time = first == model.variable_count;
    const char *name = is_time ? "the time" : model.variables[first].name;
    if (!is_time && model.variables[first].causality == 'p')
        return instance_refuse(m, "%s is a fixed parameter: it cannot be set after the initialization", name);
    return instance_refuse(m, "%s is neither parameter nor input: it cannot be set", name);
}

bool instance_has_item(instance *m, uint32_t reference, int64_t value)
{
    if (reference >= m->count || m->places[reference].type != ENUMERATION)
        return true;
    const model_variable *v = &model.variables[reference];
    for (size_t k = 0; k < v->item_count; k++)
        if (v->items[k] == value)
            return true;
    return instance_refuse(m, "%s = %" PRId64 " is no item of its enumeration (%s)", v->name, value,
                           v->items_text);
}
