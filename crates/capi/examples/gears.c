/* Axes that follow axes: S is in gear with M, W follows both, S is shifted in motion and let go. Five commands are refused, and
 * nothing moves for them. Prints the axes tick by tick, every bit of them, when it is asked to with any argument. */

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

static int32_t add(struct standstill_runtime *rt, double velocity, double acceleration, double jerk, double snap) {
    struct standstill_axis_setup setup;
    struct standstill_drive_setup drive;
    int32_t axis = 0;
    setup.size = sizeof setup;
    drive.size = sizeof drive;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    check(standstill_drive_defaults(&drive), "drive_defaults");
    setup.start_powered = 1;
    setup.velocity = velocity;
    setup.acceleration = acceleration;
    setup.jerk = jerk;
    setup.snap = snap;
    check(standstill_axis_add(rt, &setup, &drive, &axis), "axis_add");
    return axis;
}

/* One MC_GearIn: what it is called with, and what it shows. */
struct gear {
    uint64_t key;
    standstill_mc_gear_in_in in;
    standstill_mc_gear_in_out out;
};

static struct gear gear(int32_t master, int32_t slave, int16_t numerator, uint16_t denominator) {
    struct gear made;
    made.key = 0;
    made.in = standstill_mc_gear_in_in_default();
    made.out = standstill_mc_gear_in_out_default();
    made.in.master = master;
    made.in.slave = slave;
    made.in.ratio_numerator = numerator;
    made.in.ratio_denominator = denominator;
    return made;
}

static void call(struct standstill_runtime *rt, struct gear *gear, int execute) {
    gear->in.execute = execute != 0;
    check(standstill_mc_gear_in(rt, &gear->key, &gear->in, &gear->out), "MC_GearIn");
}

int main(int argc, char **argv) {
    (void)argv;
    const int64_t cycle = 1000000;
    struct standstill_runtime_config config = {sizeof config, 3, 12, 0, cycle};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");
    const int32_t m = add(rt, 200.0, 1000.0, 2e4, 1e6);
    const int32_t s = add(rt, 400.0, 5000.0, 1e5, 5e6);
    const int32_t w = add(rt, 400.0, 5000.0, 1e5, 5e6);

    struct gear self = gear(s, s, 1, 1);
    struct gear zero = gear(m, s, 1, 0);
    struct gear nobody = gear(m, 9, 1, 1);
    struct gear stranger = gear(9, s, 1, 1);
    struct gear geared = gear(m, s, 3, 7);
    struct gear ring = gear(w, m, 1, 1);
    uint64_t key[5] = {0};
    standstill_mc_combine_axes_in both = standstill_mc_combine_axes_in_default();
    standstill_mc_combine_axes_out combined = standstill_mc_combine_axes_out_default();
    standstill_mc_move_velocity_in run = standstill_mc_move_velocity_in_default();
    standstill_mc_move_velocity_out running = standstill_mc_move_velocity_out_default();
    standstill_mc_phasing_relative_in shift = standstill_mc_phasing_relative_in_default();
    standstill_mc_phasing_relative_out shifted = standstill_mc_phasing_relative_out_default();
    standstill_mc_gear_out_in out = standstill_mc_gear_out_in_default();
    standstill_mc_gear_out_out let_go = standstill_mc_gear_out_out_default();
    standstill_mc_halt_in rest = standstill_mc_halt_in_default();
    standstill_mc_halt_out resting = standstill_mc_halt_out_default();
    both.master1 = m;
    both.master2 = s;
    both.slave = w;
    both.combine_mode = STANDSTILL_MC_SUB_AXES;
    both.gear_ratio_numerator_m1 = 2;
    both.gear_ratio_denominator_m1 = 3;
    run.axis = rest.axis = shift.master = m;
    run.velocity = 100.0;
    shift.slave = out.slave = s;
    shift.phase_shift = 7.0;
    shift.velocity = 60.0;

    struct standstill_axis_status of_m, of_s, of_w;
    of_m.size = of_s.size = of_w.size = sizeof of_m;
    for (int64_t scan = 0; scan < 1400; scan++) {
        check(standstill_tick_begin(rt, scan * cycle), "tick_begin");
        call(rt, &self, scan >= 5);
        call(rt, &zero, scan >= 5);
        call(rt, &nobody, scan >= 5);
        call(rt, &stranger, scan >= 5);
        call(rt, &geared, scan >= 10);
        both.execute = scan >= 10;
        check(standstill_mc_combine_axes(rt, &key[0], &both, &combined), "MC_CombineAxes");
        call(rt, &ring, scan >= 15);
        run.execute = scan >= 20;
        check(standstill_mc_move_velocity(rt, &key[1], &run, &running), "MC_MoveVelocity");
        shift.execute = scan >= 400;
        check(standstill_mc_phasing_relative(rt, &key[2], &shift, &shifted), "MC_PhasingRelative");
        out.execute = scan >= 800;
        check(standstill_mc_gear_out(rt, &key[3], &out, &let_go), "MC_GearOut");
        rest.execute = scan >= 1000;
        check(standstill_mc_halt(rt, &key[4], &rest, &resting), "MC_Halt");
        check(standstill_tick_end(rt), "tick_end");
        check(standstill_axis_read(rt, m, &of_m), "axis_read");
        check(standstill_axis_read(rt, s, &of_s), "axis_read");
        check(standstill_axis_read(rt, w, &of_w), "axis_read");
        if (argc > 1) {
            printf("%016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %016" PRIx64 " %d%d%d%d%d\n",
                   bits(of_m.position), bits(of_s.position), bits(of_w.position), bits(of_w.velocity),
                   bits(shifted.covered_phase_shift), geared.out.in_gear, combined.in_sync, shifted.done, let_go.done,
                   geared.out.command_aborted);
        }
    }
    printf("self %d, zero %d, nobody %d, stranger %d, ring %d\n", self.out.error_id, zero.out.error_id,
           nobody.out.error_id, stranger.out.error_id, ring.out.error_id);
    check(standstill_stop(rt), "stop");
    for (int64_t scan = 1400; standstill_runtime_close(rt) == STANDSTILL_NOT_OFF && scan < 3000; scan++) {
        check(standstill_tick_begin(rt, scan * cycle), "tick_begin");
        check(standstill_tick_end(rt), "tick_end");
    }
    free(storage);
    return 0;
}
