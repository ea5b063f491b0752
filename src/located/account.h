/* SPDX-License-Identifier: MIT */
/*
 * Ledger entries of the located method between events: work and momentum of forces on bodies in
 * flight and on clusters, from the time up to which they have been entered. All are integrals in
 * closed form, or polynomials that came with the cluster's piece, so no force is evaluated. Without
 * a ledger each call returns at once. Simulator's thread.
 */
#ifndef RB_LOCATED_ACCOUNT_H
#define RB_LOCATED_ACCOUNT_H

#include "located/located.h"

/*
 * Enters the forces on a body on a parabola up to `t`. Call before its arc, or a force on it,
 * changes.
 */
void rb_account_arc(struct rb_located *l, int i, double t);

/*
 * The same for a cluster: forces of its contacts and, if it is integrated, all forces on its
 * members.
 */
void rb_account_cluster(struct rb_located *l, int cluster, double t);

/* All bodies and clusters. */
void rb_account_all(struct rb_located *l, double t);

/* Starts the account at the state at `t`. */
void rb_account_begin(struct rb_located *l, double t);

/* The entries that rb_account_all would make. */
struct rb_entries rb_account_open(const struct rb_located *l, double t);

/* Reserves memory for a cluster's integrals; false: no memory. */
bool rb_account_reserve(struct rb_located *l, struct rb_cluster *c);

void rb_account_pack(struct rb_located *l, struct rb_pack *pack);

#endif
