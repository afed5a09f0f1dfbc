/* One axis of standstill as a model of taktwerk: MC_Power and MC_MoveAbsolute over a simulated drive, a step of the engine
 * is a scan. */

#include "axis.h"
#include "standstill_blocks.h"
#include <math.h>
#include <stdlib.h>

struct model {
    void *storage;
    struct standstill_runtime *rt;
    int64_t cycle_ns;
    int64_t scan;
    int32_t axis;
    uint64_t power_key;
    uint64_t move_key;
    standstill_mc_power_in power;
    standstill_mc_move_absolute_in move;
};

/* The engine's step in seconds becomes whole nanoseconds; the runtime counts scans, so nothing drifts. */
int axis_init(void **handle, double step_size) {
    if (!(step_size > 0.0 && step_size < 10.0)) {
        return STANDSTILL_BAD_CONFIG;
    }
    struct model *model = (struct model *)calloc(1, sizeof *model);
    if (model == NULL) {
        return STANDSTILL_STORAGE;
    }
    model->cycle_ns = (int64_t)llround(step_size * 1e9);
    struct standstill_runtime_config config = {sizeof config, 1, 16, 0, model->cycle_ns};
    size_t bytes = 0;
    int32_t result = standstill_runtime_size(&config, &bytes);
    if (result == STANDSTILL_OK) {
        model->storage = malloc(bytes);
        result = standstill_runtime_init(STANDSTILL_ABI_VERSION, model->storage, bytes, &config, &model->rt);
    }
    struct standstill_axis_setup setup;
    struct standstill_drive_setup drive;
    setup.size = sizeof setup;
    drive.size = sizeof drive;
    if (result == STANDSTILL_OK) {
        result = standstill_axis_defaults(&setup);
    }
    if (result == STANDSTILL_OK) {
        result = standstill_drive_defaults(&drive);
    }
    if (result == STANDSTILL_OK) {
        setup.velocity = 100.0;
        setup.acceleration = 1000.0;
        setup.jerk = 20000.0;
        result = standstill_axis_add(model->rt, &setup, &drive, &model->axis);
    }
    if (result != STANDSTILL_OK) {
        free(model->storage);
        free(model);
        return result;
    }
    model->power = standstill_mc_power_in_default();
    model->move = standstill_mc_move_absolute_in_default();
    model->power.axis = model->move.axis = model->axis;
    *handle = model;
    return 0;
}

int axis_step(void *handle, double time, const axis_inputs *in, axis_outputs *out) {
    struct model *model = (struct model *)handle;
    (void)time;
    int32_t result = standstill_tick_begin(model->rt, model->scan * model->cycle_ns);
    if (result != STANDSTILL_OK) {
        return result;
    }
    standstill_mc_power_out powered = standstill_mc_power_out_default();
    standstill_mc_move_absolute_out moved = standstill_mc_move_absolute_out_default();
    model->power.enable = in->enable != 0.0;
    result = standstill_mc_power(model->rt, &model->power_key, &model->power, &powered);
    if (result == STANDSTILL_OK) {
        model->move.execute = in->execute != 0.0;
        model->move.position = in->target;
        model->move.velocity = in->speed;
        result = standstill_mc_move_absolute(model->rt, &model->move_key, &model->move, &moved);
    }
    /* A tick that began ends in any case: the axis must go on, or stop. */
    int32_t ended = standstill_tick_end(model->rt);
    model->scan++;
    if (result != STANDSTILL_OK || ended != STANDSTILL_OK) {
        return result != STANDSTILL_OK ? result : ended;
    }
    struct standstill_axis_status status;
    status.size = sizeof status;
    result = standstill_axis_read(model->rt, model->axis, &status);
    if (result != STANDSTILL_OK) {
        return result;
    }
    out->position = status.position;
    out->velocity = status.velocity;
    out->state = status.state;
    out->powered = powered.status;
    out->busy = moved.busy;
    out->done = moved.done;
    out->error_id = moved.error_id;
    return 0;
}

/* The drive is simulated, so the axis may stop here, without the engine's clock. With a real drive the host stops the axis
 * before it ends the engine: nobody paces these ticks. */
int axis_terminate(void *handle) {
    struct model *model = (struct model *)handle;
    if (model == NULL) {
        return 0;
    }
    int32_t result = standstill_stop(model->rt);
    for (int64_t tick = 0; result == STANDSTILL_OK && tick < 100000; tick++) {
        result = standstill_runtime_close(model->rt);
        if (result != STANDSTILL_NOT_OFF) {
            break;
        }
        result = standstill_tick_begin(model->rt, model->scan * model->cycle_ns);
        if (result == STANDSTILL_OK) {
            result = standstill_tick_end(model->rt);
        }
        model->scan++;
    }
    free(model->storage);
    free(model);
    return result;
}
