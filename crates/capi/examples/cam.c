/* A cam: its rows are in the program, a store in memory of the host takes the copy that MC_CamTableSelect checks and makes. The
 * slave goes up 100 and back over 360 of its master, three times. Prints both axes tick by tick, every bit of them, when it is
 * asked to with any argument. */

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
    const int64_t cycle = 1000000;
    struct standstill_runtime_config config = {sizeof config, 2, 8, 0, cycle};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");

    /* Room for four cams, of 64 pieces in all. */
    check(standstill_cams_size(4, 64, &bytes), "cams_size");
    void *cams = malloc(bytes);
    check(standstill_cams_init(rt, cams, bytes, 4, 64), "cams_init");

    struct standstill_axis_setup setup;
    struct standstill_drive_setup drive;
    int32_t master = 0, slave = 0;
    setup.size = sizeof setup;
    drive.size = sizeof drive;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    check(standstill_drive_defaults(&drive), "drive_defaults");
    setup.start_powered = 1;
    setup.velocity = 200.0;
    setup.acceleration = 1000.0;
    setup.jerk = 2e4;
    setup.snap = 1e6;
    check(standstill_axis_add(rt, &setup, &drive, &master), "axis_add");
    setup.velocity = 400.0;
    setup.acceleration = 5000.0;
    setup.jerk = 1e5;
    setup.snap = 5e6;
    check(standstill_axis_add(rt, &setup, &drive, &slave), "axis_add");

    const int32_t rest = 4; /* mcCamRest7 */
    const struct standstill_mc_cam_ref rows[] = {
        {0.0, 0.0, 0.0, 0.0, 0.0, rest, {0}},
        {180.0, 100.0, 0.0, 0.0, 0.0, rest, {0}},
        {360.0, 0.0, 0.0, 0.0, 0.0, rest, {0}},
    };
    uint64_t key[3] = {0};
    standstill_mc_cam_table_select_in select = standstill_mc_cam_table_select_in_default();
    standstill_mc_cam_table_select_out selected = standstill_mc_cam_table_select_out_default();
    standstill_mc_cam_in_in cam = standstill_mc_cam_in_in_default();
    standstill_mc_cam_in_out on_cam = standstill_mc_cam_in_out_default();
    standstill_mc_move_velocity_in run = standstill_mc_move_velocity_in_default();
    standstill_mc_move_velocity_out running = standstill_mc_move_velocity_out_default();
    select.master = cam.master = run.axis = master;
    select.slave = cam.slave = slave;
    select.cam_table = rows;
    select.cam_table_count = 3;
    select.periodic = 1;
    run.velocity = 200.0;

    struct standstill_axis_status of_master, of_slave;
    of_master.size = of_slave.size = sizeof of_slave;
    int ends = 0;
    for (int64_t scan = 0; scan < 5600; scan++) {
        check(standstill_tick_begin(rt, scan * cycle), "tick_begin");
        select.execute = scan >= 1;
        check(standstill_mc_cam_table_select(rt, &key[0], &select, &selected), "MC_CamTableSelect");
        cam.cam_table_id = selected.cam_table_id;
        cam.execute = run.execute = scan >= 10;
        check(standstill_mc_cam_in(rt, &key[1], &cam, &on_cam), "MC_CamIn");
        check(standstill_mc_move_velocity(rt, &key[2], &run, &running), "MC_MoveVelocity");
        check(standstill_tick_end(rt), "tick_end");
        check(standstill_axis_read(rt, master, &of_master), "axis_read");
        check(standstill_axis_read(rt, slave, &of_slave), "axis_read");
        ends += on_cam.end_of_profile;
        if (argc > 1) {
            printf("%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %d%d%d\n", bits(of_master.position),
                   bits(of_slave.position), bits(of_slave.velocity), bits(selected.max_master_velocity),
                   selected.done, on_cam.in_sync, on_cam.end_of_profile);
        }
    }
    printf("error %d, the master may go up to %.1f, %d periods\n", selected.error_id, selected.max_master_velocity, ends);
    check(standstill_stop(rt), "stop");
    for (int64_t scan = 5600; standstill_runtime_close(rt) == STANDSTILL_NOT_OFF && scan < 7000; scan++) {
        check(standstill_tick_begin(rt, scan * cycle), "tick_begin");
        check(standstill_tick_end(rt), "tick_end");
    }
    free(cams);
    free(storage);
    return 0;
}
