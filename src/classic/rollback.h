/* SPDX-License-Identifier: MIT */
/*
 * One group through one step: try, judge, keep or go back to the beginning of the attempt and halve
 * it.
 *
 * After a rejected attempt the next ones close in on the moment of contact by halving what is left
 * up to the failed end; after an impact the whole rest of the step is tried again. Bounded: when
 * halving has gone below what changes a time, the group has failed and says which bodies, when and
 * why.
 */
#ifndef RB_CLASSIC_ROLLBACK_H
#define RB_CLASSIC_ROLLBACK_H

#include "classic/stage_list.h"

/*
 * RB_ERR_PHYSICS, RB_ERR_MEMORY, or RB_ERR_INTERRUPT when the run is to stop; rows of the members
 * then hold the last accepted substep. pass->done_s == pass->dt_s on success.
 */
enum rb_status rb_rollback_run(struct rb_pass *pass, const struct rb_stage_list *plan,
                               struct rb_error *err);

#endif
