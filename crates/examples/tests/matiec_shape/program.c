/* prog.st by hand, in the shape in which matiec has a program: instances are structures, variables have flags, VAR_IN_OUT is
 * copied in and out, variables of VAR_GLOBAL are symbols. The blocks are those of the shim, which the test puts into blocks.c. */

#include "iec_types_all.h"
#include "blocks.c"

extern TIME __CURRENT_TIME;

#define GLOBAL(type, name)         \
    __IEC_##type##_t CONFIG0__##name; \
    type *__GET_GLOBAL_##name(void);  \
    type *__GET_GLOBAL_##name(void) { return &CONFIG0__##name.value; }
GLOBAL(BOOL, START)
GLOBAL(BOOL, STOP)
GLOBAL(INT, STATE)
GLOBAL(INT, PARTS)
GLOBAL(INT, ABORTS)
GLOBAL(BOOL, FEEDBUSY)
GLOBAL(BOOL, FEEDDONE)
GLOBAL(BOOL, FEEDABORTED)
GLOBAL(BOOL, PLACEBUSY)
GLOBAL(BOOL, PLACEDONE)
GLOBAL(BOOL, PLACEABORTED)
#define G(name) CONFIG0__##name.value

static AXIS_REF feeder, placer;
static STANDSTILL_R_TRIG start_edge;
static MC_POWER power_feeder, power_placer;
static STANDSTILL_TON settle;
static MC_MOVEABSOLUTE feed, place, back_feeder, back_placer;
static MC_STOP stop_feeder, stop_placer;
static MC_READSTATUS feeder_status, placer_status;

#define CALL(block, name, of) (name.AXIS.value = of, block##_body__(&name), of = name.AXIS.value)
#define MOVE(name, of, when, to, speed)        \
    (name.EXECUTE.value = G(STATE) == when, name.POSITION.value = to, name.VELOCITY.value = speed, \
     CALL(MC_MOVEABSOLUTE, name, of))

unsigned long greatest_tick_count__ = 3;
void config_init__(void);
void config_run__(unsigned long tick);

void config_init__(void) {
    power_feeder.ENABLEPOSITIVE.value = power_feeder.ENABLENEGATIVE.value = 1;
    power_placer.ENABLEPOSITIVE.value = power_placer.ENABLENEGATIVE.value = 1;
    /* What is forced keeps its value, and is no reason not to call the block. */
    feed.RESULT.value = -77;
    feed.RESULT.flags = 2;
}

void config_run__(unsigned long tick) {
    if (tick >= greatest_tick_count__) return;
    feeder.NUMBER = 1;
    placer.NUMBER = 2;
    start_edge.CLK.value = G(START);
    STANDSTILL_R_TRIG_body__(&start_edge);
    power_feeder.ENABLE.value = power_placer.ENABLE.value = 1;
    CALL(MC_POWER, power_feeder, feeder);
    CALL(MC_POWER, power_placer, placer);

    int16_t state = G(STATE);
    if (state == 0) {
        if (start_edge.Q.value && !G(STOP) && power_feeder.STATUS.value && power_placer.STATUS.value) G(STATE) = 10;
    } else if (state == 10) {
        if (feed.COMMANDABORTED.value) G(STATE) = 90;
        else if (feed.DONE.value) G(STATE) = 20;
    } else if (state == 20) {
        if (G(STOP)) G(STATE) = 90;
        else if (settle.Q.value) G(STATE) = 30;
    } else if (state == 30) {
        if (place.COMMANDABORTED.value) G(STATE) = 90;
        else if (place.DONE.value) G(PARTS)++, G(STATE) = 40;
    } else if (state == 40) {
        if (back_feeder.COMMANDABORTED.value || back_placer.COMMANDABORTED.value) G(STATE) = 90;
        else if (back_feeder.DONE.value && back_placer.DONE.value) G(STATE) = 0;
    } else if (!G(STOP) && feeder_status.STANDSTILL.value && placer_status.STANDSTILL.value) {
        G(ABORTS)++, G(STATE) = 40;
    }

    settle.IN.value = G(STATE) == 20;
    settle.PT.value = (TIME){0, 50000000};
    STANDSTILL_TON_body__(&settle);
    MOVE(feed, feeder, 10, 40.0, 200.0);
    MOVE(place, placer, 30, 25.0, 100.0);
    MOVE(back_feeder, feeder, 40, 0.0, 200.0);
    MOVE(back_placer, placer, 40, 0.0, 100.0);
    stop_feeder.EXECUTE.value = stop_placer.EXECUTE.value = G(STOP);
    CALL(MC_STOP, stop_feeder, feeder);
    CALL(MC_STOP, stop_placer, placer);
    feeder_status.ENABLE.value = placer_status.ENABLE.value = 1;
    CALL(MC_READSTATUS, feeder_status, feeder);
    CALL(MC_READSTATUS, placer_status, placer);

    G(FEEDBUSY) = feed.BUSY.value;
    G(FEEDDONE) = feed.DONE.value;
    G(FEEDABORTED) = feed.COMMANDABORTED.value;
    G(PLACEBUSY) = place.BUSY.value;
    G(PLACEDONE) = place.DONE.value;
    G(PLACEABORTED) = place.COMMANDABORTED.value;
    /* The clock of matiec's own timers is that of the scan. */
    if (settle.ET.value.tv_nsec > 0 && __CURRENT_TIME.tv_sec == 0 && __CURRENT_TIME.tv_nsec == 0) G(STATE) = -1;
}
