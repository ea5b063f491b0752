/* SPDX-License-Identifier: MIT */
/*
 * What a step that is kept leaves: contacts with their forces, and impacts in order of time and
 * ids.
 */
#ifndef RB_STEPPED_CONTACT_RECORDS_H
#define RB_STEPPED_CONTACT_RECORDS_H

#include "stepped/stepped_state.h"

/*
 * Adds the impacts of a cohort's step that ended at `time` to those told: pairs that were not among
 * the contacts before. Bodies with a mark in `skip` (may be NULL) are left out.
 */
RB_CHECKED enum rb_status rb_record_impacts(struct rb_world *world, struct rb_cohort *cohort,
                                            double time_s, const struct rb_contacts *before,
                                            const unsigned char *skip, struct rb_error *err);
/*
 * Adds the contacts of a cohort's step to `to`, which is then no longer in order: of each point
 * that bears something, which are those chosen, what has not been told as an impact. To the cohort
 * of all belongs what stands: its contacts are those of the world.
 */
RB_CHECKED enum rb_status rb_record_contacts(struct rb_world *world, const struct rb_cohort *cohort,
                                             double h_s, const unsigned char *skip,
                                             struct rb_contacts *to, struct rb_error *err);
/* Keeps only contacts of bodies that are marked, in their order. */
void rb_record_keep(const struct rb_world *world, struct rb_contacts *contacts,
                    const unsigned char *of_body);
/*
 * The same where the cohort of all makes a whole step: the contacts become those of the world, in
 * order, without another list beside them. First the points are chosen and space is taken, which
 * can fail; the second cannot.
 */
RB_CHECKED enum rb_status rb_record_space(struct rb_world *world, struct rb_cohort *cohort,
                                          struct rb_error *err);
void rb_record_in_place(struct rb_world *world, const struct rb_cohort *cohort, double h_s);
/*
 * Chooses these points, and takes space for their contacts, and `more`, in the arena: those of the
 * step before are read meanwhile. Never to be released.
 */
RB_CHECKED enum rb_status rb_record_scratch(struct rb_world *world, struct rb_cohort *cohort,
                                            size_t more, struct rb_contacts *scratch,
                                            struct rb_error *err);
/* Adds to `to` what its contacts have passed on in impacts within the step, as mean forces. */
RB_CHECKED enum rb_status rb_record_passed(const struct rb_cohort *cohort, double h_s,
                                           const unsigned char *skip, struct rb_contacts *to,
                                           struct rb_error *err);
/*
 * Adds a part of a step to its means: the contacts that it has left, and what has been passed on in
 * it.
 */
RB_CHECKED enum rb_status rb_record_part(const struct rb_cohort *cohort,
                                         const struct rb_contacts *contacts, double h_s,
                                         struct rb_contacts *scratch, struct rb_mean_forces *means,
                                         struct rb_error *err);
/* Room among the world's events for so many more; false: no memory. */
bool rb_record_reserve(struct rb_world *world, size_t count);
/* Those told, for which there is room, become the world's events, and callbacks hear of them. */
RB_CHECKED enum rb_status rb_record_all(struct rb_world *world, struct rb_error *err);

#endif
