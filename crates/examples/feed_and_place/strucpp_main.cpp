/* What STruC++ makes of prog.st, with the variables and functions of program.c: for host.c, and for guest.scan.json. */

#include "prog.hpp"

#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name)
#endif

namespace {

/* A VAR_GLOBAL is a wrapped value, which newer releases put into one structure more. */
template <class Global> auto inside(Global &global, int) -> decltype((global.value)) {
    return global.value;
}
template <class Global> Global &inside(Global &global, long) {
    return global;
}

strucpp::Configuration_CONFIG0 plc;

} // namespace

extern "C" {

uint8_t Start, Stop;
int16_t State, Parts, Aborts;
uint8_t FeedBusy, FeedDone, FeedAborted;
uint8_t PlaceBusy, PlaceDone, PlaceAborted;

void plc_init(void);
void plc_scan(int32_t tick, int64_t now_ns);

EXPORT(plc_init) void plc_init(void) {}

EXPORT(plc_scan) void plc_scan(int32_t tick, int64_t now_ns) {
    (void)tick;
    strucpp::__CURRENT_TIME_NS = now_ns;
    inside(plc.START, 0).set(Start != 0);
    inside(plc.STOP, 0).set(Stop != 0);
    plc.CELL.run();
    State = inside(plc.STATE, 0).get();
    Parts = inside(plc.PARTS, 0).get();
    Aborts = inside(plc.ABORTS, 0).get();
    FeedBusy = inside(plc.FEEDBUSY, 0).get();
    FeedDone = inside(plc.FEEDDONE, 0).get();
    FeedAborted = inside(plc.FEEDABORTED, 0).get();
    PlaceBusy = inside(plc.PLACEBUSY, 0).get();
    PlaceDone = inside(plc.PLACEDONE, 0).get();
    PlaceAborted = inside(plc.PLACEABORTED, 0).get();
}
}
