/* A host in C for feed and place: sets up the cell, presses the buttons, and prints every scan to the bit.
 *
 * The program is program.c, or with MATIEC defined prog.st as matiec translates it: both have plc_init and plc_scan. */

#include "standstill_blocks.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define SCANS 5700
#define CYCLE_NS INT64_C(1000000)

struct standstill_runtime *standstill_default;

void plc_init(void);
void plc_scan(int32_t tick, int64_t now_ns);

#ifdef MATIEC
/* What stands in VAR_GLOBAL is reached by a function that gives its address. */
#define VARIABLE(type, name, Name, NAME)    \
    extern type *__GET_GLOBAL_##NAME(void); \
    static type *name(void) { return __GET_GLOBAL_##NAME(); }
#else
#define VARIABLE(type, name, Name, NAME) \
    extern type Name;                    \
    static type *name(void) { return &Name; }
#endif
VARIABLE(uint8_t, start, Start, START)
VARIABLE(uint8_t, stop, Stop, STOP)
VARIABLE(int16_t, state, State, STATE)
VARIABLE(int16_t, parts, Parts, PARTS)
VARIABLE(int16_t, aborts, Aborts, ABORTS)
VARIABLE(uint8_t, feed_busy, FeedBusy, FEEDBUSY)
VARIABLE(uint8_t, feed_done, FeedDone, FEEDDONE)
VARIABLE(uint8_t, feed_aborted, FeedAborted, FEEDABORTED)
VARIABLE(uint8_t, place_busy, PlaceBusy, PLACEBUSY)
VARIABLE(uint8_t, place_done, PlaceDone, PLACEDONE)
VARIABLE(uint8_t, place_aborted, PlaceAborted, PLACEABORTED)

static const struct {
    int64_t scan;
    uint8_t *(*button)(void);
    uint8_t pressed;
} PRESSES[] = {
    {20, start, 1},   {40, start, 0},   {1400, start, 1}, {1440, start, 0}, {1900, stop, 1},  {2000, stop, 0},
    {2600, start, 1}, {2610, start, 0}, {2700, stop, 1},  {2710, stop, 0},  {3300, start, 1}, {3680, stop, 1},
    {3700, stop, 0},  {3800, start, 0}, {4200, start, 1}, {4210, start, 0},
};

/* Ends the program with the library's own words if something is not as it should be. */
static void check(int32_t result, const char *what) {
    if (result != STANDSTILL_OK) {
        fprintf(stderr, "%s: %s\n", what, standstill_result_text(result));
        exit(1);
    }
}

static void add_axis(double velocity, double acceleration, double jerk, double snap) {
    struct standstill_axis_setup setup;
    struct standstill_drive_setup drive;
    int32_t number;
    setup.size = sizeof setup;
    drive.size = sizeof drive;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    check(standstill_drive_defaults(&drive), "drive_defaults");
    setup.velocity = velocity;
    setup.acceleration = acceleration;
    setup.jerk = jerk;
    setup.snap = snap;
    check(standstill_axis_add(standstill_default, &setup, &drive, &number), "axis_add");
}

static void print_bits(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    printf("%016" PRIx64 " ", bits);
}

int main(void) {
    struct standstill_runtime_config config = {sizeof config, 2, 16, 0, CYCLE_NS};
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &standstill_default), "runtime_init");
    add_axis(200.0, 2000.0, 50000.0, 2000000.0); /* the feeder is axis 1 */
    add_axis(100.0, 1000.0, 20000.0, 1000000.0); /* the placer is axis 2 */
    plc_init();

    size_t next = 0;
    for (int64_t scan = 0; scan < SCANS; scan++) {
        for (; next < sizeof PRESSES / sizeof *PRESSES && PRESSES[next].scan == scan; next++) {
            *PRESSES[next].button() = PRESSES[next].pressed;
        }
        check(standstill_tick_begin(standstill_default, scan * CYCLE_NS), "tick_begin");
        plc_scan((int32_t)scan, scan * CYCLE_NS);
        /* The state as it is when the program has run, before the axes move on. */
        struct standstill_axis_status axes[2];
        int32_t states[2];
        for (int i = 0; i < 2; i++) {
            axes[i].size = sizeof axes[i];
            check(standstill_axis_read(standstill_default, i + 1, &axes[i]), "axis_read");
            states[i] = axes[i].state;
        }
        check(standstill_tick_end(standstill_default), "tick_end");
        for (int i = 0; i < 2; i++) {
            check(standstill_axis_read(standstill_default, i + 1, &axes[i]), "axis_read");
            printf("%" PRId32 " ", states[i]);
            print_bits(axes[i].position);
            print_bits(axes[i].velocity);
            print_bits(axes[i].acceleration);
            print_bits(axes[i].jerk);
            print_bits(axes[i].snap);
            print_bits(axes[i].actual_position);
        }
        printf("%d %d %d %d %d %d %d %d %d\n", *state(), *parts(), *aborts(), *feed_busy(), *feed_done(),
               *feed_aborted(), *place_busy(), *place_done(), *place_aborted());
    }
    return 0;
}
