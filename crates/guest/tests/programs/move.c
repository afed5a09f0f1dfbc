/* What move.wat does, in C. */
#include "standstill_guest.h"

static uint64_t power_key, move_key;
static standstill_mc_power_in power_in;
static standstill_mc_power_out power_out;
static standstill_mc_move_absolute_in move_in;
static standstill_mc_move_absolute_out move_out;

uint8_t go, done;
double target = 10;

__attribute__((export_name("plc_init"))) void plc_init(void) {
    power_in.size = sizeof power_in;
    power_in.axis = 1;
    power_in.enable = power_in.enable_positive = power_in.enable_negative = 1;
    power_out.size = sizeof power_out;
    move_in.size = sizeof move_in;
    move_in.axis = 1;
    move_in.velocity = 50;
    move_out.size = sizeof move_out;
}

__attribute__((export_name("plc_scan"))) void plc_scan(int32_t tick, int64_t now_ns) {
    (void)tick;
    (void)now_ns;
    standstill_mc_power(&power_key, &power_in, &power_out);
    move_in.execute = go && power_out.status;
    move_in.position = target;
    standstill_mc_move_absolute(&move_key, &move_in, &move_out);
    done = move_out.done;
}
