/* A host in C, as a program: reads `MEASURE CALLS` from standard input, makes so many calls, and prints the nanoseconds
 * that one took. Every call is what a program does in a scan: it writes inputs, calls, and looks at the outputs.
 * Compiled and driven by main.rs. */

#define _POSIX_C_SOURCE 199309L
#include "standstill_blocks.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static void check(int32_t result, const char *what) {
    if (result != STANDSTILL_OK) {
        fprintf(stderr, "%s: %s\n", what, standstill_result_text(result));
        exit(1);
    }
}

static void expect(int good, const char *what) {
    if (!good) {
        fprintf(stderr, "%s: the outputs are not those of the measure\n", what);
        exit(2);
    }
}

static double now_ns(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec * 1e9 + (double)time.tv_nsec;
}

/* The limits of the axis, as main.rs gives them. */
static double velocity, acceleration, jerk, snap, target;

/* A powered axis with a tick open. */
static struct standstill_runtime *begin(void) {
    struct standstill_runtime_config config = {sizeof config, 1, 16, 0, INT64_C(1000000)};
    struct standstill_runtime *rt = NULL;
    struct standstill_axis_setup setup;
    struct standstill_drive_setup drive;
    size_t bytes = 0;
    int32_t axis = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, malloc(bytes), bytes, &config, &rt), "runtime_init");
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
    check(standstill_tick_begin(rt, 0), "tick_begin");
    return rt;
}

/* A measure: a block, the inputs that are always the same, the one that may change, and what the outputs are. By a
 * host that makes all of its inputs anew in every scan, with memset or with the function of the header, and by one that
 * writes what may change, as the examples do. */
#define LOOP(name, block, anew, same, change, good)                                                                  \
    static double name(long calls) {                                                                                 \
        static struct standstill_runtime *rt;                                                                        \
        static uint64_t key, number;                                                                                 \
        static standstill_##block##_in in;                                                                           \
        static standstill_##block##_out out;                                                                         \
        double start;                                                                                                \
        long call;                                                                                                   \
        if (rt == NULL) {                                                                                            \
            rt = begin();                                                                                            \
            out = standstill_##block##_out_default();                                                                \
            in.size = sizeof in;                                                                                     \
            same;                                                                                                    \
        }                                                                                                            \
        start = now_ns();                                                                                            \
        for (call = 0; call < calls; call++) {                                                                       \
            number++;                                                                                                \
            if (anew == 1) {                                                                                         \
                memset(&in, 0, sizeof in);                                                                           \
                in.size = sizeof in;                                                                                 \
                same;                                                                                                \
            } else if (anew == 2) {                                                                                  \
                in = standstill_##block##_in_default();                                                              \
                same;                                                                                                \
            }                                                                                                        \
            change;                                                                                                  \
            check(standstill_##block(rt, &key, &in, &out), #block);                                                  \
            expect(good, #name);                                                                                     \
        }                                                                                                            \
        return (now_ns() - start) / (double)calls;                                                                   \
    }

#define MEASURE(name, block, same, change, good)                                                                     \
    LOOP(name, block, 1, same, change, good)                                                                         \
    LOOP(name##_default, block, 2, same, change, good)                                                               \
    LOOP(name##_kept, block, 0, same, change, good)

#define MOVE (in.axis = 1, in.position = target, in.velocity = velocity)
MEASURE(move, mc_move_absolute, MOVE, in.execute = 1, out.active && !out.error)
MEASURE(command, mc_move_absolute, MOVE, in.execute = number % 2 == 0, !out.error)
MEASURE(turn, mc_move_velocity, (in.axis = 1, in.velocity = velocity), in.execute = 1, out.active && !out.error)
MEASURE(power, mc_power, (in.axis = 1, in.enable_positive = in.enable_negative = 1), in.enable = 1,
        out.status && !out.error)
MEASURE(status, mc_read_status, in.axis = 1, in.enable = 1, out.valid && !out.error)
MEASURE(timer, ton, in.pt = INT64_C(1000000000), in.input = 1, !out.q)

#define NAMES(name) {#name, name}, {#name "_default", name##_default}, {#name "_kept", name##_kept}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        double (*run)(long);
    } measures[] = {NAMES(move), NAMES(command), NAMES(turn), NAMES(power), NAMES(status), NAMES(timer)};
    char name[24];
    long calls;
    if (argc != 6) {
        fputs("host VELOCITY ACCELERATION JERK SNAP TARGET\n", stderr);
        return 1;
    }
    velocity = atof(argv[1]);
    acceleration = atof(argv[2]);
    jerk = atof(argv[3]);
    snap = atof(argv[4]);
    target = atof(argv[5]);
    while (scanf("%23s %ld", name, &calls) == 2) {
        size_t at;
        for (at = 0; at < sizeof measures / sizeof *measures && strcmp(measures[at].name, name) != 0; at++) {
        }
        expect(at < sizeof measures / sizeof *measures, name);
        printf("%.4f\n", measures[at].run(calls));
        fflush(stdout);
    }
    return 0;
}
