/* SPDX-License-Identifier: MIT */
/*
 * Records of a step that is kept: contacts with their forces, and impacts in order of time and ids.
 */
#ifndef RB_STEPPED_CONTACT_RECORDS_H
#define RB_STEPPED_CONTACT_RECORDS_H

#include "stepped/stepped_state.h"

/*
 * Adds the impacts of a cohort's step that ended at `time` to those reported: pairs that were not
 * among the contacts before. Bodies with a mark in `skip` (may be NULL) are left out.
 */
RB_CHECKED enum rb_status rb_record_impacts(struct rb_world *world, struct rb_cohort *cohort,
                                            double time_s, const struct rb_contacts *before,
                                            const unsigned char *skip, struct rb_error *err);
/*
 * Adds the contacts of a cohort's step to `to`, which is then unsorted: of each chosen point, those
 * with an impulse, the part not reported as an impact. Sleeping bodies belong to the cohort of all:
 * their contacts are those of the world.
 */
RB_CHECKED enum rb_status rb_record_contacts(struct rb_world *world, const struct rb_cohort *cohort,
                                             double h_s, const unsigned char *skip,
                                             struct rb_contacts *to, struct rb_error *err);
/* Keeps only contacts of bodies that are marked, in their order. */
void rb_record_keep(const struct rb_world *world, struct rb_contacts *contacts,
                    const unsigned char *of_body);
/*
 * The same where the cohort of all makes a whole step: the contacts become those of the world, in
 * order, without a second list. The first function chooses points and reserves space, which can
 * fail; the second cannot.
 */
RB_CHECKED enum rb_status rb_record_space(struct rb_world *world, struct rb_cohort *cohort,
                                          struct rb_error *err);
void rb_record_in_place(struct rb_world *world, const struct rb_cohort *cohort, double h_s);
/*
 * Chooses these points, and takes space for their contacts and `more` in the arena, as those of the
 * last step are read meanwhile. Never to be released.
 */
RB_CHECKED enum rb_status rb_record_scratch(struct rb_world *world, struct rb_cohort *cohort,
                                            size_t more, struct rb_contacts *scratch,
                                            struct rb_error *err);
/*
 * Adds to `to` the impulses that contacts have transmitted in impacts within the step, as mean
 * forces.
 */
RB_CHECKED enum rb_status rb_record_transmitted(const struct rb_cohort *cohort, double h_s,
                                                const unsigned char *skip, struct rb_contacts *to,
                                                struct rb_error *err);
/* Adds a part of a step to its means: its contacts, and impulses transmitted in it. */
RB_CHECKED enum rb_status rb_record_part(const struct rb_cohort *cohort,
                                         const struct rb_contacts *contacts, double h_s,
                                         struct rb_contacts *scratch, struct rb_mean_forces *means,
                                         struct rb_error *err);
/* Reserves `count` more events of the world; false: no memory. */
bool rb_record_reserve(struct rb_world *world, size_t count);
/* Makes the reported events, for which there is room, the world's, and informs callbacks. */
RB_CHECKED enum rb_status rb_record_all(struct rb_world *world, struct rb_error *err);

#endif
