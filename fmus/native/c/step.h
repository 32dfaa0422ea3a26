/* A step of an instance. It ends the model's own file, model.c, where a compiler knows the functions that `model`
   names, and makes one function of them and of this. */
#ifndef EVCOSIM_STEP_H
#define EVCOSIM_STEP_H

#include <math.h>

#include "instance.h"

MODEL_IN_PLACE bool instance_shown(instance *m, const unsigned char *state)
{
    unsigned char *const made = m->next_outputs;
    if (!model.outputs(m->records[PARAMETERS], state, m->records[INPUTS], m->memory, made, &m->failure))
        return instance_failed(m);
    if (m->integer_count && !instance_integers_fit(m))
        return false;
    m->next_outputs = m->records[OUTPUTS];
    m->records[OUTPUTS] = made;
    m->stale = false;
    return true;
}

bool instance_show(instance *m, const unsigned char *state)
{
    return instance_shown(m, state);
}

bool instance_step(instance *m, double t, double dt)
{
    unsigned char *const p = m->records[PARAMETERS], *const u = m->records[INPUTS];
    m->notice = NULL;
    if (m->phase != STEPPING || !(0.0 < dt && dt < INFINITY))
        return instance_no_step(m, dt);
    if (m->clock)
        instance_set_time(m, t);
    if (!model.step(p, m->state, u, dt, m->memory, m->next_state, &m->failure))
        return instance_failed(m);
    m->sentence[0] = '\0';
    if (model.notice &&
        !model.notice(p, m->state, m->next_state, u, m->memory, m->sentence, MODEL_TEXT, &m->failure))
        return instance_failed(m);
    if (m->clock && m->follows)
        instance_set_time(m, t + dt);
    if (!instance_shown(m, m->next_state))
        return false;
    instance_keep_state(m);
    m->reached = t + dt;
    if (m->sentence[0])
        instance_tell(m, t + dt);
    return true;
}

#endif
