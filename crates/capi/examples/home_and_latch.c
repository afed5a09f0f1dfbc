/* Simulated drives with all they can have. X homes by a home switch, starting behind it, so it turns round at the limit
 * switch; Y is a CiA 402 drive that homes by itself. Then both move on, a probe latches each of them between two ticks,
 * and a gate goes up at a digital input of X. Prints the axes tick by tick, every bit of them, when it is asked to with
 * any argument. */

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
    const int64_t cycle = 2000000;
    struct standstill_runtime_config config = {sizeof config, 2, 8, 0, cycle};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");

    struct standstill_axis_setup setup;
    struct standstill_drive_setup drive;
    int32_t x = 0, y = 0;
    setup.size = sizeof setup;
    drive.size = sizeof drive;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    setup.velocity = 100.0;
    setup.acceleration = 2000.0;
    setup.jerk = 50000.0;
    setup.start_powered = 1;
    setup.position = 30.0;
    setup.homing = 1; /* absolute switch: upwards, by its rising edge */
    setup.homing_velocity = 50.0;
    setup.homing_creep = 10.0;
    check(standstill_drive_defaults(&drive), "drive_defaults");
    drive.home_switch = 1;
    drive.home_switch_from = 20.0;
    drive.home_switch_to = 25.0;
    drive.limit_switches = 1;
    drive.limit_switch_negative = -60.0;
    drive.limit_switch_positive = 40.0;
    check(standstill_axis_add(rt, &setup, &drive, &x), "axis_add");

    setup.position = 0.0;
    setup.scaling_increments = 1000; /* to a unit */
    setup.homing = 5;                /* by the drive */
    setup.homing_velocity = setup.homing_creep = 0.0;
    drive.kind = 2; /* CiA 402 */
    drive.homing_velocity = 40.0;
    drive.homing_direction = 1; /* downwards */
    drive.home_switch_from = -30.0;
    drive.home_switch_to = -20.0;
    drive.limit_switch_positive = 60.0;
    check(standstill_axis_add(rt, &setup, &drive, &y), "axis_add");

    uint64_t key[7] = {0};
    standstill_mc_home_in home_x = standstill_mc_home_in_default(), home_y = home_x;
    standstill_mc_home_out x_home = standstill_mc_home_out_default(), y_home = x_home;
    standstill_mc_touch_probe_in probe_x = standstill_mc_touch_probe_in_default(), probe_y = probe_x;
    standstill_mc_touch_probe_out x_probe = standstill_mc_touch_probe_out_default(), y_probe = x_probe;
    standstill_mc_move_absolute_in move_x = standstill_mc_move_absolute_in_default(), move_y = move_x;
    standstill_mc_move_absolute_out moved = standstill_mc_move_absolute_out_default();
    standstill_mc_read_digital_input_in gate = standstill_mc_read_digital_input_in_default();
    standstill_mc_read_digital_input_out open = standstill_mc_read_digital_input_out_default();
    home_x.axis = probe_x.axis = move_x.axis = gate.input = x;
    home_y.axis = probe_y.axis = move_y.axis = y;
    home_x.position = 100.0;
    probe_x.trigger_input = 0; /* mcProbe1Rising */
    probe_y.trigger_input = 3; /* mcProbe2Falling */
    move_x.position = 60.0;
    move_x.velocity = 100.0;
    move_y.position = 30.0;
    move_y.velocity = 50.0;
    gate.input_number = 3;
    gate.enable = 1;

    struct standstill_axis_status at_x, at_y;
    at_x.size = at_y.size = sizeof at_x;
    for (int64_t scan = 0; scan < 800; scan++) {
        /* What happens around the machine, before the drives are read. */
        if (scan == 350) {
            check(standstill_simulate_probe(rt, y, 2, 1.0, 1), "simulate_probe");
        } else if (scan == 400) {
            check(standstill_simulate_probe(rt, y, 2, 0.5, 0), "simulate_probe");
        } else if (scan == 600) {
            check(standstill_simulate_probe(rt, x, 1, 0.25, 1), "simulate_probe");
        } else if (scan == 650) {
            check(standstill_simulate_input(rt, x, 3, 1), "simulate_input");
        }
        check(standstill_tick_begin(rt, scan * cycle), "tick_begin");
        home_x.execute = home_y.execute = scan >= 5;
        check(standstill_mc_home(rt, &key[0], &home_x, &x_home), "MC_Home");
        check(standstill_mc_home(rt, &key[1], &home_y, &y_home), "MC_Home");
        probe_x.execute = move_x.execute = x_home.done;
        probe_y.execute = move_y.execute = y_home.done;
        check(standstill_mc_touch_probe(rt, &key[2], &probe_x, &x_probe), "MC_TouchProbe");
        check(standstill_mc_touch_probe(rt, &key[3], &probe_y, &y_probe), "MC_TouchProbe");
        check(standstill_mc_move_absolute(rt, &key[4], &move_x, &moved), "MC_MoveAbsolute");
        check(standstill_mc_move_absolute(rt, &key[5], &move_y, &moved), "MC_MoveAbsolute");
        check(standstill_mc_read_digital_input(rt, &key[6], &gate, &open), "MC_ReadDigitalInput");
        check(standstill_tick_end(rt), "tick_end");
        check(standstill_axis_read(rt, x, &at_x), "axis_read");
        check(standstill_axis_read(rt, y, &at_y), "axis_read");
        if (argc > 1) {
            printf("%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64
                   " %d%d%d%d%d\n",
                   bits(at_x.position), bits(at_x.velocity), bits(at_y.position), bits(at_y.actual_position),
                   bits(x_probe.recorded_position), bits(y_probe.recorded_position), x_home.done, y_home.done,
                   x_probe.done, y_probe.done, open.value);
        }
    }
    printf("homed %d%d, latched X at %.4f and Y at %.4f, gate %d\n", x_home.done, y_home.done,
           x_probe.recorded_position, y_probe.recorded_position, open.value);
    check(standstill_stop(rt), "stop");
    for (int64_t scan = 800; standstill_runtime_close(rt) == STANDSTILL_NOT_OFF && scan < 900; scan++) {
        check(standstill_tick_begin(rt, scan * cycle), "tick_begin");
        check(standstill_tick_end(rt), "tick_end");
    }
    free(storage);
    return 0;
}
