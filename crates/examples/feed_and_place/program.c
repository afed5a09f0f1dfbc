/* prog.st in C: one source for a host that links the library (host.c) and for a guest in WebAssembly (guest.scan.json). */

#ifdef __wasm__
#include "standstill_guest.h"
#define EXPORT(name) __attribute__((export_name(#name)))
/* A guest has one runtime, that of its host. */
#define RUNTIME
#else
#include "standstill_blocks.h"
#define EXPORT(name)
#define RUNTIME standstill_default,
extern struct standstill_runtime *standstill_default;
#endif

#define FEEDER 1
#define PLACER 2
#define MS INT64_C(1000000)

void plc_init(void);
void plc_scan(int32_t tick, int64_t now_ns);

/* What others see: buttons and lamps. */
uint8_t Start, Stop;
int16_t State, Parts, Aborts;
uint8_t FeedBusy, FeedDone, FeedAborted;
uint8_t PlaceBusy, PlaceDone, PlaceAborted;

/* A block instance is a key that begins as 0, its inputs and its outputs. */
#define INSTANCE(block, name)               \
    static struct {                         \
        uint64_t key;                       \
        standstill_##block##_in in;         \
        standstill_##block##_out out;       \
    } name
#define MAKE(block, name) (name.in = standstill_##block##_in_default(), name.out = standstill_##block##_out_default())
#define CALL(block, name) ((void)standstill_##block(RUNTIME &name.key, &name.in, &name.out))

INSTANCE(r_trig, start_edge);
INSTANCE(mc_power, power_feeder);
INSTANCE(mc_power, power_placer);
INSTANCE(ton, settle);
INSTANCE(mc_move_absolute, feed);
INSTANCE(mc_move_absolute, place);
INSTANCE(mc_move_absolute, back_feeder);
INSTANCE(mc_move_absolute, back_placer);
INSTANCE(mc_stop, stop_feeder);
INSTANCE(mc_stop, stop_placer);
INSTANCE(mc_read_status, feeder_status);
INSTANCE(mc_read_status, placer_status);

/* Pins that never change are set once. */
EXPORT(plc_init) void plc_init(void) {
    MAKE(r_trig, start_edge);
    MAKE(mc_power, power_feeder);
    MAKE(mc_power, power_placer);
    MAKE(ton, settle);
    MAKE(mc_move_absolute, feed);
    MAKE(mc_move_absolute, place);
    MAKE(mc_move_absolute, back_feeder);
    MAKE(mc_move_absolute, back_placer);
    MAKE(mc_stop, stop_feeder);
    MAKE(mc_stop, stop_placer);
    MAKE(mc_read_status, feeder_status);
    MAKE(mc_read_status, placer_status);
    power_feeder.in.axis = feed.in.axis = back_feeder.in.axis = stop_feeder.in.axis = feeder_status.in.axis = FEEDER;
    power_placer.in.axis = place.in.axis = back_placer.in.axis = stop_placer.in.axis = placer_status.in.axis = PLACER;
    power_feeder.in.enable = power_placer.in.enable = 1;
    feeder_status.in.enable = placer_status.in.enable = 1;
    settle.in.pt = 50 * MS;
    feed.in.position = 40.0;
    place.in.position = 25.0;
    feed.in.velocity = back_feeder.in.velocity = 200.0;
    place.in.velocity = back_placer.in.velocity = 100.0;
}

EXPORT(plc_scan) void plc_scan(int32_t tick, int64_t now_ns) {
    (void)tick;
    (void)now_ns;
    start_edge.in.clk = Start;
    CALL(r_trig, start_edge);
    CALL(mc_power, power_feeder);
    CALL(mc_power, power_placer);

    switch (State) {
    case 0:
        if (start_edge.out.q && !Stop && power_feeder.out.status && power_placer.out.status) State = 10;
        break;
    case 10:
        if (feed.out.command_aborted) State = 90;
        else if (feed.out.done) State = 20;
        break;
    case 20:
        if (Stop) State = 90;
        else if (settle.out.q) State = 30;
        break;
    case 30:
        if (place.out.command_aborted) State = 90;
        else if (place.out.done) Parts++, State = 40;
        break;
    case 40:
        if (back_feeder.out.command_aborted || back_placer.out.command_aborted) State = 90;
        else if (back_feeder.out.done && back_placer.out.done) State = 0;
        break;
    case 90:
        if (!Stop && feeder_status.out.standstill && placer_status.out.standstill) Aborts++, State = 40;
        break;
    }

    settle.in.input = State == 20;
    feed.in.execute = State == 10;
    place.in.execute = State == 30;
    back_feeder.in.execute = back_placer.in.execute = State == 40;
    stop_feeder.in.execute = stop_placer.in.execute = Stop;
    CALL(ton, settle);
    CALL(mc_move_absolute, feed);
    CALL(mc_move_absolute, place);
    CALL(mc_move_absolute, back_feeder);
    CALL(mc_move_absolute, back_placer);
    CALL(mc_stop, stop_feeder);
    CALL(mc_stop, stop_placer);
    CALL(mc_read_status, feeder_status);
    CALL(mc_read_status, placer_status);

    FeedBusy = feed.out.busy;
    FeedDone = feed.out.done;
    FeedAborted = feed.out.command_aborted;
    PlaceBusy = place.out.busy;
    PlaceDone = place.out.done;
    PlaceAborted = place.out.command_aborted;
}
