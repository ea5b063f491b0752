/* SPDX-License-Identifier: MIT */
/*
 * The ledger of the located method between events: what acts on bodies in flight and on clusters,
 * from the moment up to which it has been entered. All of it is integrals in closed form, or
 * polynomials that came with the cluster's piece, so nothing is evaluated for it. Where the ledger
 * is not kept, each call returns at once.
 */
#ifndef RB_LOCATED_ACCOUNT_H
#define RB_LOCATED_ACCOUNT_H

#include "located/located.h"

/*
 * Enters what has acted on a body on a parabola up to `t`. Before its arc, or a force on it,
 * changes.
 */
void rb_account_arc(struct rb_located *l, int i, double t);

/*
 * The same of a cluster: forces of its contacts, and, where it is integrated, all forces on its
 * members.
 */
void rb_account_cluster(struct rb_located *l, int cluster, double t);

/* All bodies and clusters. */
void rb_account_all(struct rb_located *l, double t);

/* From here on there is nothing to enter: the state at `t` is a beginning. */
void rb_account_begin(struct rb_located *l, double t);

/* What rb_account_all would enter. */
struct rb_entries rb_account_open(const struct rb_located *l, double t);

/* Room for a cluster's integrals; false: no memory. */
bool rb_account_reserve(struct rb_located *l, struct rb_cluster *c);

void rb_account_pack(struct rb_located *l, struct rb_pack *pack);

#endif
