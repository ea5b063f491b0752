/* SPDX-License-Identifier: MIT */
/*
 * Rounds of simultaneous impacts (Newton's law of restitution at each contact, solved together by
 * projected Gauss-Seidel), until none of the touching pairs approaches. After each simultaneous
 * round with friction the change of kinetic energy, sum of J . (u + u') / 2, is tested; a round
 * that gains energy is undone and its impacts are done one after the other, each of which
 * dissipates. Clusters that do not end (an inelastic collapse) are stopped without restitution
 * after a bounded number of rounds.
 */
#include "classic/impact.h"

#include <float.h>
#include <string.h>

#include "base/error.h"
#include "classic/contact.h"
#include "classic/classic_ledger.h"

/* A touching pair during the rounds. */
struct approaching {
	struct rb_link link;
	int touch; /* index into pass->touch */
	/* m/s, <= 0: the part of the normal velocity that this substep's forces made */
	double unforced;
	/* m/s, >= 0: an approach that the forces could have made within one whole step */
	double forced;
	bool impact;     /* it is an impact in this round */
	rb_vec3 before;  /* relative velocity at the beginning of the round */
	double approach; /* m/s at its first impact of this moment; 0: none yet */
	rb_vec3 impulse; /* N s on b, so far */
};

struct contacts {
	struct rb_pass *pass;
	/* m/s: what iteration may leave, a share of the largest approach of the first round */
	double residue;
	struct approaching *row;
	int count;
	struct rb_impulse_row *solver; /* [count] */
	int *active;                   /* [count] */
	int active_count;
};

enum {
	SWEEPS = 200, /* sweeps of one round's solve */
	/* an impact passes through a row of n bodies in n rounds */
	ROUNDS = 64,
	ROUNDS_PER_CONTACT = 8
};

/* Share of the largest approach that iteration may leave; below it there is no impact. */
static const double residue_share = 1e-10;

/* True if some pair is within its touching band. */
static bool any_touching(const struct rb_pass *pass)
{
	for (int k = 0; k < pass->touch_count; k++)
		if (pass->now[k].gap <= pass->touch[k].band)
			return true;
	return false;
}

/* Collects the touching pairs and what their approach owes to forces; false if there are none. */
static bool gather(struct rb_pass *pass, struct contacts *all, bool after_substep)
{
	struct rb_world *world = pass->world;

	*all = (struct contacts){.pass = pass};
	all->row = rb_pass_take(pass, pass->arena, pass->touch_count, sizeof *all->row);
	all->solver = rb_pass_take(pass, pass->arena, pass->touch_count, sizeof *all->solver);
	all->active = rb_pass_take(pass, pass->arena, pass->touch_count, sizeof *all->active);
	if (pass->out_of_memory)
		return false;
	for (int k = 0; k < pass->touch_count; k++) {
		const struct rb_touch *touch = &pass->touch[k];
		struct approaching m = {.touch = k};

		if (!(pass->now[k].gap <= touch->band))
			continue;
		m.link = rb_link_of(world, &world->state, touch, &pass->now[k]);
		const double normal = rb_vec3_dot(rb_link_velocity(world, &world->state, &m.link),
		                                  m.link.normal);
		/*
		 * of a lasting contact all that its reaction left; of others what the forces have
		 * added
		 */
		if (touch->lasting)
			m.unforced = fmin(normal, 0);
		else if (after_substep)
			m.unforced = fmin(
				normal - rb_vec3_dot(rb_link_velocity(world, &world->mark, &m.link),
			                             m.link.normal),
				0);
		if (after_substep && rb_contact_crowded(pass, touch))
			m.forced = fmax(rb_contact_forced(pass, &m.link),
			                touch->normal_force * m.link.normal_inverse_mass *
			                        pass->dt_s);
		if (!after_substep &&
		    pass->start_s > 0) /* what the iteration of the step before has left */
			m.forced = rb_contact_tolerance(pass);
		all->row[all->count++] = m;
	}
	return all->count > 0;
}

/* Lists the pairs whose approach is an impact in this round. */
static void find_active(struct contacts *all, int round)
{
	struct rb_world *world = all->pass->world;
	double largest = 0;

	all->active_count = 0;
	for (int k = 0; k < all->count; k++) {
		struct approaching *m = &all->row[k];
		const double noise = fmax(rb_link_noise(world, &m->link), all->residue);

		m->before = rb_link_velocity(world, &world->state, &m->link);
		const double normal = rb_vec3_dot(m->before, m->link.normal);
		m->impact = normal - m->unforced < -noise && -normal > fmax(m->forced, noise);
		if (m->impact)
			all->active[all->active_count++] = k;
		if (round == 0)
			largest = fmax(largest, -normal);
	}
	if (round == 0)
		all->residue = residue_share * largest;
	RB_ASSERT_COSTLY(all->active_count <= all->count);
}

/* Normal velocity wanted after the impact, m/s. */
static double wanted(const struct approaching *m)
{
	const double normal = rb_vec3_dot(m->before, m->link.normal);

	/* never more than the whole approach, also where forces drew the bodies apart */
	return m->link.restitution * fmax(0, fmin(-(normal - m->unforced), -normal));
}

/* Total impulse of a row on b, N s. */
static rb_vec3 row_impulse(const struct rb_impulse_row *row)
{
	return rb_vec3_add_scaled(row->tangent, row->normal, row->link.normal);
}

/*
 * Solves all impacts of the round together; true if kinetic energy did not rise. False leaves the
 * velocities as they were.
 */
static bool solve_together(struct contacts *all)
{
	struct rb_world *world = all->pass->world;
	double scale = 0, work = 0, moved = 0;
	bool safe = true;

	for (int n = 0; n < all->active_count; n++) {
		const struct approaching *m = &all->row[all->active[n]];

		all->solver[n] = (struct rb_impulse_row){.link = m->link,
		                                         .target_velocity = wanted(m)};
		scale = fmax(scale, rb_vec3_max_abs(m->before));
		safe = safe && (m->link.central || !(m->link.friction > 0));
	}
	/* with friction off the centre, a simultaneous solution may gain energy (Kane 1984) */
	if (!safe)
		return false;
	rb_impulse_rows_solve(world, all->solver, all->active_count, SWEEPS,
	                      16 * DBL_EPSILON * scale);
	for (int n = 0; n < all->active_count; n++) {
		const struct approaching *m = &all->row[all->active[n]];
		const rb_vec3 after = rb_link_velocity(world, &world->state, &m->link);
		const rb_vec3 impulse = row_impulse(&all->solver[n]);

		work += 0.5 * rb_vec3_dot(impulse, rb_vec3_add(m->before, after));
		moved += rb_vec3_length(impulse) * rb_vec3_length(m->before);
	}
	if (work <= 1024 * DBL_EPSILON * moved) {
		for (int n = 0; n < all->active_count; n++) {
			const struct approaching *m = &all->row[all->active[n]];

			rb_classic_ledger_impact(all->pass, &m->link, row_impulse(&all->solver[n]),
			                         m->before);
		}
		return true;
	}
	for (int n = 0; n < all->active_count; n++)
		rb_link_apply(world, &all->solver[n].link,
		              rb_vec3_neg(row_impulse(&all->solver[n])));
	return false;
}

/* One after the other in order of pairs: a single impact never raises kinetic energy. */
static void solve_one_by_one(struct contacts *all)
{
	struct rb_world *world = all->pass->world;

	for (int n = 0; n < all->active_count; n++) {
		struct approaching *m = &all->row[all->active[n]];
		struct rb_impulse_row *row = &all->solver[n];

		m->before = rb_link_velocity(world, &world->state, &m->link);
		const double normal = rb_vec3_dot(m->before, m->link.normal);
		*row = (struct rb_impulse_row){.link = m->link};
		if (!(normal < -rb_link_noise(world, &m->link)))
			continue;
		const rb_vec3 impulse = rb_link_impact(&m->link, m->before, wanted(m));
		row->normal = rb_vec3_dot(impulse, m->link.normal);
		row->tangent = rb_vec3_add_scaled(impulse, -row->normal, m->link.normal);
		rb_link_apply(world, &m->link, impulse);
		rb_classic_ledger_impact(all->pass, &m->link, impulse, m->before);
	}
}

/* One round, and what it adds to each pair's event. */
static void run_round(struct contacts *all)
{
	if (all->active_count == 1 || !solve_together(all))
		solve_one_by_one(all);
	for (int n = 0; n < all->active_count; n++) {
		struct approaching *m = &all->row[all->active[n]];

		if (!(all->solver[n].normal > 0))
			continue;
		if (m->approach == 0)
			m->approach = m->unforced - rb_vec3_dot(m->before, m->link.normal);
		m->impulse = rb_vec3_add(m->impulse, row_impulse(&all->solver[n]));
		m->unforced = 0;
	}
}

/*
 * Stops what still approaches, all touching pairs at once and without restitution; those that
 * needed an impulse become lasting contacts. True if any did.
 */
static bool stop_the_rest(struct contacts *all)
{
	struct rb_world *world = all->pass->world;
	bool any = false;

	for (int k = 0; k < all->count; k++) {
		const struct rb_link *link = &all->row[k].link;
		const double normal = rb_vec3_dot(rb_link_velocity(world, &world->state, link),
		                                  link->normal);
		const bool approaches = normal < -rb_link_noise(world, link);

		/* a lasting contact that was not hit is left to the next substep's reaction */
		any = any || (approaches && !(all->pass->touch[all->row[k].touch].lasting &&
		                              normal >= all->row[k].unforced));
		all->solver[k] = (struct rb_impulse_row){.link = *link};
		all->row[k].before = rb_link_velocity(world, &world->state, link);
	}
	if (!any)
		return false;
	rb_impulse_rows_solve(world, all->solver, all->count, SWEEPS,
	                      rb_contact_tolerance(all->pass));
	for (int k = 0; k < all->count; k++) {
		rb_classic_ledger_impact(all->pass, &all->row[k].link, row_impulse(&all->solver[k]),
		                         all->row[k].before);
		if (all->solver[k].normal > 0)
			all->pass->touch[all->row[k].touch].lasting = true;
	}
	return true;
}

/* Appends an event to the pass; arrays grow by doubling within the arena. */
static void keep_event(struct rb_pass *pass, const struct approaching *m)
{
	if (pass->event_count == pass->event_capacity) {
		const int capacity = pass->event_capacity > 0 ? 2 * pass->event_capacity : 16;
		struct rb_event *const grown = rb_pass_take(pass, pass->kept, capacity,
		                                            sizeof *grown);

		if (!grown)
			return;
		if (pass->event_count > 0)
			memcpy(grown, pass->event, (size_t)pass->event_count * sizeof *grown);
		pass->event = grown;
		pass->event_capacity = capacity;
	}
	pass->event[pass->event_count++] = (struct rb_event){
		.time_s = pass->start_s + pass->done_s,
		.kind = RB_EVENT_COLLISION,
		.a = m->link.a,
		.b = m->link.b,
		.point = pass->now[m->touch].point,
		.normal = m->link.normal,
		.impulse = m->impulse,
		.approach_speed = m->approach,
	};
	RB_ASSERT_COSTLY(pass->event_count <= pass->event_capacity);
}

/* Multiplications of a contact in a round beside its solution, about. */
enum { ROUND_WORK = 256 };

bool rb_impact_resolve(struct rb_pass *pass, bool after_substep)
{
	const rb_arena_mark here = rb_arena_here(pass->arena);
	struct contacts all;
	int impacts = 0;

	if (!any_touching(pass) || !gather(pass, &all, after_substep))
		return false;
	const int rounds = ROUNDS + ROUNDS_PER_CONTACT * all.count;
	int round = 0;
	for (find_active(&all, 0);
	     all.active_count > 0 && round < rounds &&
	     !rb_interrupt_after(&pass->world->interrupt, ROUND_WORK * (uint64_t)all.count);
	     find_active(&all, ++round))
		run_round(&all);
	pass->counts.plastic_ends += all.active_count > 0;
	const bool stopped = stop_the_rest(&all);
	for (int k = 0; k < all.count; k++) {
		if (!(all.row[k].approach > 0))
			continue;
		impacts++;
		if (pass->world->options.keep_events || pass->world->hooks.collision)
			keep_event(pass, &all.row[k]);
	}
	rb_arena_back(pass->arena, here);
	pass->counts.collisions += (uint64_t)impacts;
	return impacts > 0 || stopped;
}
