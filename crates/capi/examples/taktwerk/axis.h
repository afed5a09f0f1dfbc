/* One axis of standstill as a model of taktwerk, in the shape its importer reads without guessing. */
#ifndef AXIS_H
#define AXIS_H

typedef struct {
    double enable;   /* 1: switch the axis on; 0: stop it and switch it off */
    double execute;  /* 1: a rising edge gives the command */
    double target;   /* mm: where to */
    double speed;    /* mm/s: how fast */
} axis_inputs;

typedef struct {
    double position; /* mm: published set-point */
    double velocity; /* mm/s: of the set-point */
    double state;    /* number of the axis state, 0 is Disabled */
    double powered;  /* 1: Status of MC_Power */
    double busy;     /* 1: Busy of MC_MoveAbsolute */
    double done;     /* 1: Done of MC_MoveAbsolute */
    double error_id; /* ErrorID of MC_MoveAbsolute */
} axis_outputs;

int axis_init(void **handle, double step_size);
int axis_step(void *handle, double time, const axis_inputs *in, axis_outputs *out);
int axis_terminate(void *handle);

#endif
