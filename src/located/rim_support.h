/* SPDX-License-Identifier: MIT */
/*
 * For located/resolve_contacts: eccentric loads on flat ends of cylinders. Four points of a rim
 * represent how it lies (located/convex_contact), but a load between two of them may be carried by
 * the rim beyond the line through both, about which the end would rotate and penetrate.
 */
#ifndef RB_LOCATED_RIM_SUPPORT_H
#define RB_LOCATED_RIM_SUPPORT_H

#include "located/slips.h"

/*
 * Calls rb_slips_solve; repeats it, with the point of a rim that would penetrate added, as long as
 * there is one.
 */
bool rb_rim_support_solve(struct rb_resolution *s);

#endif
