/* What STruC++ makes of prog.st, with the variables and functions of program.c: for host.c, and for guest.scan.json. */

#include "prog.hpp"

#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name)
#endif

extern "C" {

uint8_t Start, Stop;
int16_t State, Parts, Aborts;
uint8_t FeedBusy, FeedDone, FeedAborted;
uint8_t PlaceBusy, PlaceDone, PlaceAborted;

void plc_init(void);
void plc_scan(int32_t tick, int64_t now_ns);
}

namespace strucpp {

#if !STRUCPP_HAS_EXCEPTIONS
/* An index outside its array, where it cannot be thrown: a guest traps, which ends the program and is told. */
[[noreturn]] void iec_runtime_fault(IecFault, const char *) noexcept {
    __builtin_trap();
}
#endif

/* A VAR_GLOBAL is a member of the configuration up to 0.5 and a variable of the namespace since 0.6: from in here both have
   the same name. */
struct Plc : Configuration_CONFIG0 {
    void scan() {
        START.write(Start != 0);
        STOP.write(Stop != 0);
        CELL.run();
        State = STATE.read();
        Parts = PARTS.read();
        Aborts = ABORTS.read();
        FeedBusy = FEEDBUSY.read();
        FeedDone = FEEDDONE.read();
        FeedAborted = FEEDABORTED.read();
        PlaceBusy = PLACEBUSY.read();
        PlaceDone = PLACEDONE.read();
        PlaceAborted = PLACEABORTED.read();
    }
};

} // namespace strucpp

static strucpp::Plc plc;

EXPORT(plc_init) void plc_init(void) {}

EXPORT(plc_scan) void plc_scan(int32_t tick, int64_t now_ns) {
    (void)tick;
    strucpp::__CURRENT_TIME_NS = now_ns;
    plc.scan();
}
