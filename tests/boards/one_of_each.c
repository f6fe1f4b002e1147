/*
 * One of each structure that a caller of the firmware owns, named after its folder: what the
 * modules take of RAM. Measured by `make size`, linked into nothing.
 */
#include "cycle/touch_cycle.h"
#include "inject/inject_guard.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "report/latch_report.h"
#include "report/latch_stream.h"

extern skip_input_t   input_skip;
extern plc_task_t     input_plc;
extern latch_report_t report_sender;
extern latch_stream_t report_receiver;
extern touch_cycle_t  cycle_touch;
extern inject_guard_t inject_guard;

skip_input_t   input_skip;
plc_task_t     input_plc;
latch_report_t report_sender;
latch_stream_t report_receiver;
touch_cycle_t  cycle_touch;
inject_guard_t inject_guard;
