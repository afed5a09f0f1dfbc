/* A flight recorder in production: it keeps the last 300 ticks and freezes 100 ticks after an axis went into ErrorStop,
 * here because its drive fails in the middle of a move. The dump is a trace as any other: `standstill explain`,
 * `report` and `compare` read it. With a file's name, NAME.csv, it is written there with its header beside it,
 * NAME.csv.meta.json; without one as JSON Lines to standard output. */

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

/* One text of the recorder, piece by piece: any buffer will do. */
static void dump(struct standstill_runtime *rt, int32_t form, FILE *to) {
    struct standstill_dump at = {sizeof at, form, 0, 0, 0};
    char piece[1024];
    size_t length = 0;
    do {
        check(standstill_recorder_read(rt, &at, piece, sizeof piece, &length), "recorder_read");
        if (fwrite(piece, 1, length, to) != length) {
            perror("dump");
            exit(1);
        }
    } while (length > 0);
}

static void dump_to(struct standstill_runtime *rt, int32_t form, const char *name, const char *ending) {
    char path[1024];
    FILE *to;
    snprintf(path, sizeof path, "%s%s", name, ending);
    to = fopen(path, "wb");
    if (to == NULL) {
        perror(path);
        exit(1);
    }
    dump(rt, form, to);
    fclose(to);
}

int main(int argc, char **argv) {
    struct standstill_runtime_config config = {sizeof config, 1, 4, 0, INT64_C(1000000)};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");

    struct standstill_axis_setup setup;
    setup.size = sizeof setup;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    setup.velocity = 50.0;
    setup.acceleration = 500.0;
    setup.jerk = 20000.0;
    struct standstill_drive_setup drive;
    drive.size = sizeof drive;
    check(standstill_drive_defaults(&drive), "drive_defaults");
    int32_t axis = 0;
    check(standstill_axis_add(rt, &setup, &drive, &axis), "axis_add");

    /* What is recorded has a name, and a key before the first tick. */
    struct standstill_recorded recorded[3];
    memset(recorded, 0, sizeof recorded);
    check(standstill_instance_make(rt, "MC_Power", &recorded[0].key), "instance_make");
    strcpy(recorded[0].name, "power");
    check(standstill_instance_make(rt, "MC_MoveAbsolute", &recorded[1].key), "instance_make");
    strcpy(recorded[1].name, "move");
    recorded[2].axis = axis;
    strcpy(recorded[2].name, "X");
    strcpy(recorded[2].unit, "mm");
    struct standstill_recorder_config keep = {sizeof keep, 300, 100, 64, 0, 0};
    check(standstill_recorder_size(rt, &keep, recorded, sizeof recorded[0], 3, &bytes), "recorder_size");
    void *memory = malloc(bytes);
    check(standstill_recorder_init(rt, memory, bytes, &keep, recorded, sizeof recorded[0], 3), "recorder_init");

    standstill_mc_power_in power = standstill_mc_power_in_default();
    standstill_mc_power_out powered = standstill_mc_power_out_default();
    standstill_mc_move_absolute_in move = standstill_mc_move_absolute_in_default();
    standstill_mc_move_absolute_out moved = standstill_mc_move_absolute_out_default();
    power.axis = move.axis = axis;
    power.enable = 1;
    move.position = 100.0;
    move.velocity = 99.0; /* above the limit: lowered, and recorded so */

    struct standstill_recorder_status status;
    status.size = sizeof status;
    status.state = 0;
    int64_t scan;
    for (scan = 0; status.state != 2 && scan < 10000; scan++) {
        if (scan == 700) {
            check(standstill_simulate(rt, axis, STANDSTILL_MISHAP_FAULT, 0x7500), "simulate");
        }
        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        check(standstill_mc_power(rt, &recorded[0].key, &power, &powered), "MC_Power");
        move.execute = powered.status;
        check(standstill_mc_move_absolute(rt, &recorded[1].key, &move, &moved), "MC_MoveAbsolute");
        check(standstill_tick_end(rt), "tick_end");
        check(standstill_recorder_state(rt, &status), "recorder_state");
    }
    if (argc > 1) {
        dump_to(rt, 1, argv[1], "");
        dump_to(rt, 2, argv[1], ".meta.json");
        printf("scans %" PRIu64 " to %" PRIu64 ", axis %" PRId32 " in scan %" PRIu64 "\n", status.first,
               status.first + status.scans - 1, status.axis, status.tripped_at);
    } else {
        dump(rt, 0, stdout);
    }
    check(standstill_recorder_end(rt), "recorder_end");
    free(memory);
    check(standstill_stop(rt), "stop");
    for (; standstill_runtime_close(rt) == STANDSTILL_NOT_OFF; scan++) {
        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        check(standstill_tick_end(rt), "tick_end");
    }
    free(storage);
    return 0;
}
