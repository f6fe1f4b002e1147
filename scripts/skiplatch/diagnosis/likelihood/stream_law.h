/* The laws of some touches of a stream, once the physics is changed. */
#ifndef DIAGNOSIS_STREAM_LAW_H
#define DIAGNOSIS_STREAM_LAW_H

#include "diagnosis/likelihood/physics.h"

#pragma GCC visibility push(default)

/*
 * Write the law of each touch of a member to laws[count], and its extras to
 * extras[extra_count][stride], stride >= count. 0, or -1 if there is no memory.
 *
 * The law is widened by the slack of the shift, as a share of its root mean square over the member.
 * A contact or a clock of another form than the one fitted moves the stamp, and what is counted
 * from the stamp by just as much the other way: touch by touch the stamp tells it, and only what it
 * leaves open widens the laws of position and report.
 */
int sim_stream_laws(const sim_touches_t *of, const sim_member_t *member, uint64_t stride,
                    sim_law_t *laws, sim_extra_t *extras);

#pragma GCC visibility pop

#endif
