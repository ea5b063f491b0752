/* SPDX-License-Identifier: MIT */
/*
 * For located/resolve_contacts: flat ends of cylinders that lean. Four quarters of a rim say how it
 * lies (located/convex_contact), but a load between two of them may be carried by the rim beyond
 * the line through both, about which the end would turn and sink in.
 */
#ifndef RB_LOCATED_RIM_SUPPORT_H
#define RB_LOCATED_RIM_SUPPORT_H

#include "located/slips.h"

/*
 * rb_slips_solve, and again as often as it finds forces that would press in a rim, with the point
 * of it that they do.
 */
bool rb_rim_support_solve(struct rb_resolution *s);

#endif
