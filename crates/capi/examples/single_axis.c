/* One axis over a simulated drive: power on, there and back, power off. Prints the axis scan by scan, every bit of it, when
 * it is asked to with any argument. */

#include "standstill_blocks.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

/* Ends the program with the library's own words if something is not as it should be. */
static void check(int32_t result, const char *what) {
    if (result != STANDSTILL_OK) {
        fprintf(stderr, "%s: %s\n", what, standstill_result_text(result));
        exit(1);
    }
}

static uint64_t bits(double value) {
    uint64_t out;
    memcpy(&out, &value, sizeof out);
    return out;
}

int main(int argc, char **argv) {
    (void)argv;
    struct standstill_runtime_config config = {sizeof config, 1, 16, 0, INT64_C(1000000)};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    /* malloc aligns to 16 bytes where pointers have 64; a host without a heap takes a static array instead. */
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");

    struct standstill_axis_setup setup;
    setup.size = sizeof setup;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    setup.velocity = 50.0;
    setup.acceleration = 1000.0;
    setup.jerk = 50000.0;
    setup.snap = 5000000.0;
    struct standstill_drive_setup drive;
    drive.size = sizeof drive;
    check(standstill_drive_defaults(&drive), "drive_defaults");
    int32_t axis = 0;
    check(standstill_axis_add(rt, &setup, &drive, &axis), "axis_add");

    /* The program: instances are keys, 0 until they are first called. */
    uint64_t power_key = 0, there_key = 0, back_key = 0;
    standstill_mc_power_in power = standstill_mc_power_in_default();
    standstill_mc_power_out powered = standstill_mc_power_out_default();
    standstill_mc_move_absolute_in there = standstill_mc_move_absolute_in_default();
    standstill_mc_move_absolute_in back = standstill_mc_move_absolute_in_default();
    standstill_mc_move_absolute_out gone = standstill_mc_move_absolute_out_default();
    standstill_mc_move_absolute_out come = standstill_mc_move_absolute_out_default();
    power.axis = there.axis = back.axis = axis;
    there.position = 4.0;
    there.velocity = 50.0;
    back.position = 0.0;
    back.velocity = 25.0;

    struct standstill_axis_status status;
    status.size = sizeof status;
    for (int64_t scan = 0; scan < 500; scan++) {
        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        power.enable = scan < 450;
        check(standstill_mc_power(rt, &power_key, &power, &powered), "MC_Power");
        there.execute = powered.status;
        check(standstill_mc_move_absolute(rt, &there_key, &there, &gone), "MC_MoveAbsolute");
        back.execute = gone.done;
        check(standstill_mc_move_absolute(rt, &back_key, &back, &come), "MC_MoveAbsolute");
        check(standstill_tick_end(rt), "tick_end");
        check(standstill_axis_read(rt, axis, &status), "axis_read");
        if (argc > 1) {
            printf("%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %d%d%d\n", bits(status.position),
                   bits(status.velocity), bits(status.acceleration), powered.status, gone.done, come.done);
        }
    }
    if (status.state != 0 || status.position != 0.0) {
        fprintf(stderr, "state %" PRId32 " at %g\n", status.state, status.position);
        return 1;
    }
    check(standstill_runtime_close(rt), "runtime_close");
    free(storage);
    puts("there and back, and off");
    return 0;
}
