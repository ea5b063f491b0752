/* SPDX-License-Identifier: MIT */
/*
 * Forces of fixed bodies on a cluster that is at rest or on parabolas, as rates for the ledger.
 * Contacts within the cluster do not change its momentum.
 */
#ifndef RB_LOCATED_REST_RATES_H
#define RB_LOCATED_REST_RATES_H

#include "located/slips.h"

/*
 * Adds a contact of the resolution, if one of its bodies is fixed; rest_speed: the other one is at
 * rest.
 */
void rb_rest_rates_contact(const struct rb_resolution *s, int k, bool rest_speed,
                           struct rb_account_rates *rates);

/* Adds fixed centres that attract a member at rest. */
void rb_rest_rates_centers(const struct rb_resolution *s, int member,
                           struct rb_account_rates *rates);

#endif
