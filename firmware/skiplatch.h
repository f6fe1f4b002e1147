/*
 * All of the core in one include: what latches a touch, reports it and runs a probing cycle. The
 * version stands here and nowhere else; docs/PACKAGES.md says what it promises.
 */
#ifndef SKIPLATCH_H
#define SKIPLATCH_H

#include "cycle/overtravel.h"
#include "cycle/touch_cycle.h"
#include "hal_axis.h"
#include "hal_bus.h"
#include "hal_clock.h"
#include "hal_critical.h"
#include "hal_edge.h"
#include "hal_edge_events.h"
#include "hal_error.h"
#include "input/latch.h"
#include "input/latch_record.h"
#include "input/plc_task.h"
#include "input/skip_input.h"
#include "input/ticks.h"
#include "report/latch_crc.h"
#include "report/latch_frame.h"
#include "report/latch_report.h"
#include "report/latch_stream.h"

#define SKIPLATCH_VERSION "0.2.0"

#endif
