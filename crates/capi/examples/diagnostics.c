/* Reads the diagnostic ring: what was planned, what was clamped, what was refused and why. */

#include "standstill_blocks.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void check(int32_t result, const char *what) {
    if (result != STANDSTILL_OK) {
        fprintf(stderr, "%s: %s\n", what, standstill_result_text(result));
        exit(1);
    }
}

int main(void) {
    struct standstill_runtime_config config = {sizeof config, 1, 4, 0, INT64_C(1000000)};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");

    struct standstill_axis_setup setup;
    setup.size = sizeof setup;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    struct standstill_drive_setup drive;
    drive.size = sizeof drive;
    check(standstill_drive_defaults(&drive), "drive_defaults");
    setup.acceleration = 100.0;
    setup.start_powered = 1;
    int32_t axis = 0;

    /* The velocity was forgotten. */
    if (standstill_axis_add(rt, &setup, &drive, &axis) != STANDSTILL_BAD_CONFIG) {
        return 1;
    }
    struct standstill_config_fault fault;
    fault.size = sizeof fault;
    check(standstill_config_error(rt, &fault), "config_error");
    printf("refused: %s is %g\n", fault.key, fault.value);
    setup.velocity = 10.0;
    check(standstill_axis_add(rt, &setup, &drive, &axis), "axis_add");

    uint64_t key = 0, next = 0;
    standstill_mc_move_relative_in move = standstill_mc_move_relative_in_default();
    standstill_mc_move_relative_out moved = standstill_mc_move_relative_out_default();
    move.axis = axis;
    move.distance = 1.0;
    move.velocity = 99.0; /* above the limit of the axis: clamped */
    for (int64_t scan = 0; scan < 900; scan++) {
        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        move.execute = scan != 400;
        if (scan == 400) {
            move.velocity = -1.0; /* refused when Execute rises again */
        }
        check(standstill_mc_move_relative(rt, &key, &move, &moved), "MC_MoveRelative");
        check(standstill_tick_end(rt), "tick_end");

        struct standstill_record records[4];
        uint32_t copied = 0;
        check(standstill_log_read(rt, &next, records, sizeof records[0], 4, &copied), "log_read");
        for (uint32_t i = 0; i < copied; i++) {
            const struct standstill_record *r = &records[i];
            printf("%" PRIu64 " scan %" PRIu64 " axis %" PRId32 " instance %" PRIu32 " event %" PRId32
                   " error %" PRIu32 " count %" PRIu64 " %s %g %g\n",
                   r->number, r->scan, r->axis, r->instance, r->event, r->error_id, r->count, r->name, r->value,
                   r->limit);
        }
    }
    check(standstill_stop(rt), "stop");
    for (int64_t scan = 900; standstill_runtime_close(rt) == STANDSTILL_NOT_OFF && scan < 1000; scan++) {
        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        check(standstill_tick_end(rt), "tick_end");
    }
    free(storage);
    return 0;
}
