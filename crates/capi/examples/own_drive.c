/* A drive of the host's own: it counts increments, takes ten ticks to switch on, and follows its set-point one tick late.
 * In tick 300 it reports a fault; the axis stops, is reset and moves on. */

#include "standstill_blocks.h"
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void check(int32_t result, const char *what) {
    if (result != STANDSTILL_OK) {
        fprintf(stderr, "%s: %s\n", what, standstill_result_text(result));
        exit(1);
    }
}

/* What a bus would carry. */
struct servo {
    int64_t position;
    int waited, enabled, faulty;
};

static void servo_write(struct servo *servo, const struct standstill_command *command) {
    switch (command->request) {
    case 1: /* operation enabled */
        if (!servo->faulty && !servo->enabled) {
            servo->enabled = ++servo->waited > 10;
        }
        break;
    case 3: /* fault reset */
        servo->faulty = 0;
        servo->enabled = servo->waited = 0;
        break;
    default:
        servo->enabled = servo->waited = 0;
    }
    if (servo->enabled) {
        servo->position = command->increments;
    }
}

int main(void) {
    struct standstill_runtime_config config = {sizeof config, 1, 4, 0, INT64_C(1000000)};
    struct standstill_runtime *rt = NULL;
    size_t bytes = 0;
    check(standstill_runtime_size(&config, &bytes), "runtime_size");
    void *storage = malloc(bytes);
    check(standstill_runtime_init(STANDSTILL_ABI_VERSION, storage, bytes, &config, &rt), "runtime_init");

    struct standstill_axis_setup setup;
    setup.size = sizeof setup;
    check(standstill_axis_defaults(&setup), "axis_defaults");
    setup.velocity = 100.0;
    setup.acceleration = 2000.0;
    setup.jerk = 100000.0;
    setup.scaling_increments = 1000; /* to a unit */
    struct standstill_drive_setup drive;
    drive.size = sizeof drive;
    check(standstill_drive_defaults(&drive), "drive_defaults");
    drive.kind = 0; /* ours */
    int32_t axis = 0;
    check(standstill_axis_add(rt, &setup, &drive, &axis), "axis_add");

    struct servo servo = {0, 0, 0, 0};
    struct standstill_feedback feedback;
    memset(&feedback, 0, sizeof feedback);
    feedback.size = sizeof feedback;
    struct standstill_command command;
    memset(&command, 0, sizeof command);
    command.size = sizeof command;

    uint64_t power_key = 0, move_key = 0, reset_key = 0;
    standstill_mc_power_in power = standstill_mc_power_in_default();
    standstill_mc_power_out powered = standstill_mc_power_out_default();
    standstill_mc_move_velocity_in move = standstill_mc_move_velocity_in_default();
    standstill_mc_move_velocity_out moving = standstill_mc_move_velocity_out_default();
    standstill_mc_reset_in reset = standstill_mc_reset_in_default();
    standstill_mc_reset_out was_reset = standstill_mc_reset_out_default();
    power.axis = move.axis = reset.axis = axis;
    power.enable = 1;
    move.velocity = 40.0;

    int faults = 0, ran_again = 0;
    for (int64_t scan = 0; scan < 800; scan++) {
        if (scan == 300) {
            servo.faulty = 1;
            servo.enabled = 0;
        }
        feedback.enabled = (uint8_t)servo.enabled;
        feedback.voltage = 1;
        feedback.fault = (uint8_t)servo.faulty;
        feedback.fault_code = servo.faulty ? 0x2310 : 0;
        feedback.increments = servo.position;
        check(standstill_feedback_write(rt, axis, &feedback), "feedback_write");

        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        check(standstill_mc_power(rt, &power_key, &power, &powered), "MC_Power");
        reset.execute = scan >= 400 && scan < 500;
        check(standstill_mc_reset(rt, &reset_key, &reset, &was_reset), "MC_Reset");
        move.execute = powered.status && !reset.execute;
        check(standstill_mc_move_velocity(rt, &move_key, &move, &moving), "MC_MoveVelocity");
        check(standstill_tick_end(rt), "tick_end");

        check(standstill_command_read(rt, axis, &command), "command_read");
        servo_write(&servo, &command);
        faults += moving.error && scan < 400;
        ran_again |= moving.in_velocity && scan > 500;
    }
    if (faults == 0 || !ran_again) {
        fprintf(stderr, "faults %d, ran again %d\n", faults, ran_again);
        return 1;
    }

    /* Never leave while the axis moves: stop, and tick until it is off. */
    check(standstill_stop(rt), "stop");
    for (int64_t scan = 800; standstill_runtime_close(rt) == STANDSTILL_NOT_OFF; scan++) {
        feedback.enabled = (uint8_t)servo.enabled;
        feedback.increments = servo.position;
        check(standstill_feedback_write(rt, axis, &feedback), "feedback_write");
        check(standstill_tick_begin(rt, scan * 1000000), "tick_begin");
        check(standstill_tick_end(rt), "tick_end");
        check(standstill_command_read(rt, axis, &command), "command_read");
        servo_write(&servo, &command);
        if (scan > 2000) {
            fputs("the axis does not switch off\n", stderr);
            return 1;
        }
    }
    free(storage);
    puts("a fault, a reset, and off");
    return 0;
}
