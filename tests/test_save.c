/* SPDX-License-Identifier: MIT */
/* src/method/save.c, src/located/freeze.c, src/base/pack.c */
#include "world/joint_state.h"
#include "jointed.h"
#include "sanitized.h"

#include <stdio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/field_list.h"
#include "base/memory.h"
#include "base/pack.h"
#include "flow/frame.h"
#include "force/drag.h"
#include "located/located.h"
#include "method/save.h"

static const rb_vec3 up = {0, 0, 1};
static const rb_vec3 none = {0, 0, 0};

typedef void lay_out(struct lab *lab);

/* ---- scenes ---- */

static void box(struct lab *lab, double half)
{
	for (int axis = 0; axis < 3; axis++)
		for (int side = -1; side <= 1; side += 2) {
			rb_vec3 normal = {axis == 0, axis == 1, axis == 2};

			normal = rb_vec3_scale(side, normal);
			lab_plane(lab, rb_vec3_scale(-half, normal), normal);
		}
}

/* A fixed number in [-1, 1) for each k: golden ratio. */
static double share(int k)
{
	return 2 * fmod(0.5 + 0.6180339887498949 * k, 1) - 1;
}

/* On their own clocks, in cells of three levels. */
static void gas(struct lab *lab)
{
	lab_open_located(lab, 1.5, 8);
	lab_surface(lab, 0.1, 0.9);
	box(lab, 1);
	for (int k = 0; k < 64; k++)
		lab_sphere(lab,
		           k % 16 == 0  ? 0.15
		           : k % 5 == 0 ? 0.06
		                        : 0.02,
		           1,
		           (rb_vec3){-0.75 + 0.5 * (k % 4), -0.75 + 0.5 * (k / 4 % 4),
		                     -0.75 + 0.5 * (k / 16)},
		           (rb_vec3){share(k), share(3 * k + 1), share(7 * k + 2)});
}

/* Contacts that last, on parabolas and under the integrator. */
static void stack(struct lab *lab)
{
	lab_open_located(lab, 0.9, 10);
	lab_surface(lab, 0.4, 0.3);
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_rectangle(lab, none, up, 3, 2);
	for (int k = 0; k < 3; k++)
		lab_sphere(lab, 0.1, 1, (rb_vec3){0.001 * k, 0, 0.1 + 0.2 * k}, none);
	lab_sphere(lab, 0.1, 1, (rb_vec3){-1, 0.01, 0.1}, (rb_vec3){2, 0, 0});
	lab_sphere(lab, 0.1, 1, (rb_vec3){1, 0.2, 0.4}, (rb_vec3){1, 0, 0});
}

static void drop(struct lab *lab, enum rb_rollback_kind rollback)
{
	lab_open(lab, 0.8, 16);
	lab->scene.world.method = RB_METHOD_CLASSIC;
	lab->scene.world.rollback = rollback;
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(lab, 0.4, 0.5);
	lab_plane(lab, none, up);
	for (int k = 0; k < 24; k++)
		lab_sphere(lab, 0.1, 1,
		           (rb_vec3){0.205 * (k % 4) + 0.002 * k, 0.205 * (k / 4 % 2),
		                     0.15 + 0.25 * (k / 8)},
		           (rb_vec3){0.3 * share(k), 0.3 * share(k + 9), 0});
}

static void classic(struct lab *lab)
{
	drop(lab, RB_ROLLBACK_SELECTIVE);
}

static void classic_global(struct lab *lab)
{
	drop(lab, RB_ROLLBACK_GLOBAL);
}

static void stepped(struct lab *lab)
{
	drop(lab, RB_ROLLBACK_SELECTIVE);
	lab->scene.world.method = RB_METHOD_STEPPED;
}

/* A stack that stands, one box that slides and tips, one that tumbles: several points a pair, under the integrator. */
static void boxes(struct lab *lab)
{
	lab_open_located(lab, 0.9, 10);
	lab_surface(lab, 0.4, 0.2);
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_plane(lab, none, up);
	for (int k = 0; k < 4; k++) {
		struct rb_body_def def = rb_body_def_default();

		def.call = "box";
		def.shape.kind = RB_SHAPE_BOX;
		def.shape.size[0] = def.shape.size[1] = 0.5;
		def.shape.size[2] = k == 2 ? 0.8 : 0.4;
		def.mass = 1;
		def.position = (rb_vec3){k < 2 ? 0 : 2.0 * k, 0.03 * k, k == 1 ? 0.6 : 0.2};
		if (k >= 2) {
			def.position.z = k == 2 ? 0.4 : 0.7;
			def.velocity = (rb_vec3){2, 0.3, 0};
			def.angular_velocity = (rb_vec3){0, k == 2 ? 0 : 4, 0.5};
		}
		lab_add(lab, &def);
	}
}

/* Too dense to locate: from frame 18 on steps have taken over, and arcs are those of before. */
static void dense(struct lab *lab)
{
	lab_open(lab, 0.45, 60);
	lab->scene.world.time_step_s = 0.01;
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(lab, 0.5, 0.1);
	lab_plane(lab, none, up);
	for (int k = 0; k < 40; k++)
		lab_sphere(lab, 0.05, 1,
		           (rb_vec3){0.102 * (k % 3) + 0.0001 * k, 0.102 * (k / 3 % 3),
		                     0.06 + 0.11 * (k / 9)},
		           none);
}

/* A table of three boxes. */
static void table(struct lab *lab, rb_vec3 position, rb_vec3 velocity, rb_vec3 spin)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "union";
	def.shape.kind = RB_SHAPE_UNION;
	def.shape.solid = lab_table_solid(lab);
	def.mass = 1;
	def.position = position;
	def.velocity = velocity;
	def.angular_velocity = spin;
	lab_add(lab, &def);
}

static void tables(struct lab *lab)
{
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_surface(lab, 0.4, 0.1);
	lab_plane(lab, none, up);
	table(lab, (rb_vec3){0, 0, 0.3}, (rb_vec3){1, 0.1, 0}, (rb_vec3){0, 0, 0.5});
	table(lab, (rb_vec3){3, 0, 0.3}, none, none);
	table(lab, (rb_vec3){3.02, 0.01, 0.9}, none, none);
	table(lab, (rb_vec3){0, 3, 0.5}, (rb_vec3){0, 0, -1}, (rb_vec3){0.3, 0.2, 0});
}

/* Pairs of bodies with several parts: one stands, one stands on it, one slides and turns, one falls. */
static void tables_located(struct lab *lab)
{
	lab_open_located(lab, 0.4, 20);
	tables(lab);
}

static void tables_stepped(struct lab *lab)
{
	lab_open(lab, 0.4, 20);
	lab->scene.world.method = RB_METHOD_STEPPED;
	lab->scene.world.tolerance_m = 1e-7; /* so close that overlaps are closed */
	tables(lab);
}

/* Spheres that roll, slip and spin over the rim of a shelf. */
static void rims(struct lab *lab)
{
	lab_open_located(lab, 0.6, 30);
	lab_surface(lab, 0.3, 0.2);
	lab->scene.world.gravity = (rb_vec3){0, 0, -9.81};
	lab_rectangle(lab, none, up, 1, 1);
	for (int k = 0; k < 4; k++)
		lab_sphere(lab, 0.1, 1, (rb_vec3){0.47, -0.4 + 0.25 * k, 0.1},
		           (rb_vec3){0.15 + 0.1 * k, 0.05 * k, 0});
}

/* Linear drag: bodies that fly slow down in closed form. */
static void slowing(struct lab *lab)
{
	const struct rb_drag_def drag = {.linear = 0.5};

	lab_open_located(lab, 0.9, 10);
	lab_surface(lab, 0, 0.9);
	lab_plane(lab, none, up);
	for (int k = 0; k < 3; k++)
		lab_sphere(lab, 0.1, 1, (rb_vec3){0.5 * k, 0, 0.5}, (rb_vec3){0.1 * k, 0.5, -3});
	assert_int_equal(rb_scene_add_drag(&lab->scene, &drag, &lab->error), RB_OK);
}

static lay_out *const recipes[] = {gas,     stack,           boxes,          dense,
                                   classic, stepped,         classic_global, tables_located,
                                   rims,    tables_stepped,  jointed_chain,  jointed_wheels,
                                   slowing, jointed_follower};
enum { RECIPE_COUNT = sizeof recipes / sizeof *recipes };

/* ---- running ---- */

/* Made by a recipe, sealed for so many threads. */
static void make(struct lab *lab, lay_out *recipe, int threads)
{
	recipe(lab);
	const struct rb_world_options options = {
		.threads = threads, .keep_events = true, .keep_contacts = true};
	const struct rb_world_hooks hooks = {.follow = jointed_follow};

	lab_seal_with(lab, &options, &hooks);
}

static void next_frame(struct lab *lab, struct rb_frame *frame)
{
	if (rb_world_step_frame(lab->world, &lab->error) != RB_OK)
		fail_msg("%s", lab->error.text);
	assert_int_equal(rb_world_fill_frame(lab->world, frame, &lab->error), RB_OK);
}

/* At frame `until`, filled. */
static void run_to(struct lab *lab, uint64_t until)
{
	struct rb_frame frame = {0};

	if (rb_world_frame(lab->world) == 0)
		assert_int_equal(rb_world_fill_frame(lab->world, &frame, &lab->error), RB_OK);
	while (rb_world_frame(lab->world) < until)
		next_frame(lab, &frame);
	rb_frame_release(&frame);
}

static struct rb_pack saved_at(lay_out *recipe, uint64_t frame)
{
	struct rb_pack pack = {0};
	struct lab lab;

	make(&lab, recipe, 1);
	run_to(&lab, frame);
	assert_int_equal(rb_world_pack(lab.world, &pack, &lab.error), RB_OK);
	lab_close(&lab);
	return pack;
}

static struct rb_pack reading(const struct rb_pack *saved, size_t size)
{
	return (struct rb_pack){.loading = true, .bytes = saved->bytes, .size = size};
}

/* ---- tests ---- */

static void a_world_that_is_restored_goes_on_in_the_same_bits(void **state)
{
	(void)state;
	for (int r = 0; r < RECIPE_COUNT; r++) {
		struct lab whole;

		make(&whole, recipes[r], 2);
		const uint64_t last = rb_world_frame_count(whole.world) - 1;
		run_to(&whole, last);
		const struct rb_frame_numbers totals = rb_world_totals(whole.world);
		for (uint64_t k = 0; k <= last; k += 2) {
			struct rb_pack saved = saved_at(recipes[r], k);
			struct rb_pack pack = reading(&saved, saved.size);
			struct lab lab;

			make(&lab, recipes[r], 1 + (int)k % 3);
			if (rb_world_pack(lab.world, &pack, &lab.error) != RB_OK)
				fail_msg("recipe %d, frame %d: %s", r, (int)k, lab.error.text);
			assert_int_equal(pack.at, pack.size);
			run_to(&lab, last);
			if (rb_world_hash(lab.world) != rb_world_hash(whole.world))
				fail_msg("recipe %d comes to other bits from frame %d", r, (int)k);
			assert_int_equal(rb_world_totals(lab.world).collisions, totals.collisions);
			assert_int_equal(rb_world_totals(lab.world).substeps, totals.substeps);
			lab_close(&lab);
			rb_pack_release(&saved);
		}
		lab_close(&whole);
	}
}

/* ---- random scenes ---- */

enum { SCENES = tried(12, 4, 4), SCENE_FRAMES = 7 };

static double draw(uint64_t *seed, double low, double high)
{
	*seed = *seed * 6364136223846793005u + 1442695040888963407u;
	return low + (high - low) * (double)(*seed >> 11) * 0x1p-53;
}

static rb_vec3 draw_vector(uint64_t *seed, double size)
{
	const double x = draw(seed, -size, size), y = draw(seed, -size, size);

	return (rb_vec3){x, y, draw(seed, -size, size)};
}

/*
 * Two to nine bodies that fall, slide, roll, bounce and pile up; for the classic method only
 * spheres.
 */
static void random_scene(struct lab *lab, uint64_t seed, enum rb_method_kind method)
{
	uint64_t at = seed * 977 + 5;
	const bool round = method == RB_METHOD_CLASSIC || seed % 3 == 0;

	lab_open(lab, 0.7, (SCENE_FRAMES - 1) / 0.7);
	lab->scene.world.method = method;
	lab->scene.world.gravity = (rb_vec3){draw(&at, -2, 2), 0, -9.81};
	lab_surface(lab, seed % 4 == 1 ? 0 : draw(&at, 0, 0.8), draw(&at, 0, 0.9));
	lab_plane(lab, none, up);
	const int count = 2 + (int)draw(&at, 0, 8);
	for (int k = 0; k < count; k++) {
		struct rb_body_def def = rb_body_def_default();

		def.call = "body";
		def.shape.kind = round || k % 2 == 0 ? RB_SHAPE_SPHERE : RB_SHAPE_BOX;
		if (def.shape.kind == RB_SHAPE_SPHERE)
			def.shape.radius = draw(&at, 0.1, 0.2);
		for (int axis = 0; axis < 3 && def.shape.kind == RB_SHAPE_BOX; axis++)
			def.shape.size[axis] = draw(&at, 0.15, 0.3);
		def.mass = draw(&at, 0.5, 2);
		def.position = (rb_vec3){0.45 * (k % 2) + draw(&at, 0, 0.02), 0.45 * (k / 2 % 2),
		                         k < 4 && def.shape.kind == RB_SHAPE_SPHERE
		                                 ? def.shape.radius
		                                 : 0.3 + 0.45 * (k / 4)};
		def.velocity = draw_vector(&at, 0.7);
		if (k < 4 && def.velocity.z < 0)
			def.velocity.z = 0;
		def.angular_velocity = draw_vector(&at, 3);
		lab_add(lab, &def);
	}
	lab_seal_with(lab,
	              &(struct rb_world_options){.threads = 1 + (int)(seed % 2),
	                                         .keep_events = true,
	                                         .keep_contacts = seed % 2 == 0},
	              NULL);
}

/*
 * What no list has, and decides the future, would be that of a fresh world. Whoever adds a field
 * and declares it derived though it is not meets this.
 */
static void any_world_goes_on_from_any_frame_in_the_same_bits(void **state)
{
	static const enum rb_method_kind methods[] = {RB_METHOD_AUTO, RB_METHOD_CLASSIC,
	                                              RB_METHOD_LOCATED, RB_METHOD_STEPPED};

	(void)state;
	for (uint64_t run = 0; run < 4 * SCENES; run++) {
		const enum rb_method_kind method = methods[run % 4];
		const uint64_t seed = run / 4;
		struct rb_pack saved[SCENE_FRAMES] = {{0}};
		struct lab whole;

		random_scene(&whole, seed, method);
		const uint64_t last = rb_world_frame_count(whole.world) - 1;
		assert_true(last < SCENE_FRAMES);
		for (uint64_t k = 0; k <= last; k++) {
			run_to(&whole, k);
			assert_int_equal(rb_world_pack(whole.world, &saved[k], &whole.error),
			                 RB_OK);
		}
		for (uint64_t k = 0; k < last; k++) {
			struct rb_pack pack = reading(&saved[k], saved[k].size), end = {0};
			struct lab lab;

			random_scene(&lab, seed, method);
			if (rb_world_pack(lab.world, &pack, &lab.error) != RB_OK)
				fail_msg("scene %d, method %d, frame %d: %s", (int)seed,
				         (int)method, (int)k, lab.error.text);
			run_to(&lab, last);
			/* more than the state's hash: all that would be saved again */
			assert_int_equal(rb_world_pack(lab.world, &end, &lab.error), RB_OK);
			if (rb_world_hash(lab.world) != rb_world_hash(whole.world) ||
			    end.size != saved[last].size ||
			    memcmp(end.bytes, saved[last].bytes, end.size) != 0)
				fail_msg("scene %d, method %d goes on otherwise from frame %d",
				         (int)seed, (int)method, (int)k);
			lab_close(&lab);
			rb_pack_release(&end);
		}
		for (uint64_t k = 0; k <= last; k++)
			rb_pack_release(&saved[k]);
		lab_close(&whole);
	}
}

/* ---- every field ---- */

enum { LISTS_MAX = 32, ATTEMPT_S = 60 };

/* The lists that a world is loaded by, and the field of one of them that is lost in loading. */
struct loss {
	const struct rb_fields *list[LISTS_MAX];
	int list_count;
	const struct rb_field *lost;
	bool changed; /* it was not zero anyway */
};

static void see_list(void *user, const struct rb_fields *fields, void *objects, size_t count)
{
	struct loss *const loss = user;
	int k = 0;

	(void)objects;
	(void)count;
	while (k < loss->list_count && loss->list[k] != fields)
		k++;
	assert_true(k < LISTS_MAX);
	loss->list[k] = fields;
	if (k == loss->list_count)
		loss->list_count++;
}

static void lose_field(void *user, const struct rb_fields *fields, void *objects, size_t count)
{
	struct loss *const loss = user;

	if (loss->lost < fields->row || loss->lost >= fields->row + fields->count)
		return;
	for (size_t k = 0; k < count; k++) {
		unsigned char *const at = (unsigned char *)objects + k * fields->size +
		                          loss->lost->offset;
		for (size_t i = 0; i < loss->lost->size; i++) {
			loss->changed |= at[i] != 0;
			at[i] = 0;
		}
	}
}

/*
 * In a process of its own, because a world without one of its numbers may do anything: whether it
 * comes to the same end, all that would be saved of which is compared.
 */
static bool ends_the_same(lay_out *recipe, const struct rb_pack *from, const struct rb_pack *end,
                          const struct rb_field *lost)
{
	struct loss loss = {.lost = lost};
	struct rb_pack pack = reading(from, from->size), again = {0};
	const struct rlimit no_core = {0, 0};
	struct rb_frame frame = {0};
	struct lab lab;
	int status;

	fflush(NULL);
	const pid_t child = fork();
	assert_true(child >= 0);
	if (child > 0) {
		assert_int_equal(waitpid(child, &status, 0), child);
		return WIFEXITED(status) && WEXITSTATUS(status) == 0;
	}
	(void)!freopen("/dev/null", "w", stderr);
	(void)setrlimit(RLIMIT_CORE, &no_core);
	alarm(ATTEMPT_S);
	make(&lab, recipe, 1);
	pack.loaded = lose_field;
	pack.loaded_user = &loss;
	if (rb_world_pack(lab.world, &pack, &lab.error) != RB_OK)
		_exit(1);
	if (!loss.changed)
		_exit(0);
	while (rb_world_frame(lab.world) + 1 < rb_world_frame_count(lab.world))
		if (rb_world_step_frame(lab.world, &lab.error) != RB_OK ||
		    rb_world_fill_frame(lab.world, &frame, &lab.error) != RB_OK)
			_exit(1);
	if (rb_world_pack(lab.world, &again, &lab.error) != RB_OK)
		_exit(1);
	_exit(again.size == end->size && memcmp(again.bytes, end->bytes, end->size) == 0 ? 0 : 1);
}

enum { FIELDS_MAX = 256 };

/* Fields whose loss nobody has noticed yet. */
struct unnoticed {
	const struct rb_field *field[FIELDS_MAX];
	int count;
	int exempt_count;
};

/*
 * Fields that no recipe shows to matter, and why they are saved
 * nevertheless.
 */
struct exempt {
	const struct rb_fields *(*list)(void);
	const char *field, *why;
};
static const struct exempt exempt[] = {
	{rb_counts_fields, "slip_m", "counts: only reported; no recipe has any"},
	{rb_counts_fields, "plastic_ends", "the same"},
	{rb_counts_fields, "crowded_impacts", "the same: groups of more than 200 contacts"},
	{rb_counts_fields, "crowded_energy_j", "the same"},
	{rb_world_fields, "has_held", "recipes have no callbacks that push"},
	{rb_world_fields, "moved_by_hand", "recipes have no callbacks that set positions"},
	{rb_contact_fields, "point", "contacts: reported to callbacks before the next step"},
	{rb_contact_fields, "normal", "the same"},
	{rb_contact_fields, "gap", "the same"},
	{rb_contact_fields, "parts",
         "names by which another method finds forces: test_change_of_method"},
	{rb_contact_fields, "key", "the same"},
	{rb_located_fields, "now_s", "later than every anchor: rb_world_validate compares them"},
	{rb_located_fields, "stuck_count",
         "decides only when a world fails, by events at one moment"},
	{rb_located_fields, "from_s",
         "decides how many steps follow where they take over again: no recipe goes so far"},
	{rb_located_fields, "crowd",
         "decides when steps take over, at a bound that no recipe meets closely"},
	{rb_located_fields, "products", "the same"},
	{rb_located_fields, "switch_next", "no recipe has forces that begin or end"},
	{rb_entries_fields, "row", "no recipe has entries of the ledger that wait"},
	{rb_entries_fields, "causes", "the same"},
	{rb_ledger_fields, "start_potential",
         "reported: the ledger's potential energy starts from it"},
	{rb_piece_fields, "rest", "no recipe saves a body between two forms of its motion"},
	{rb_next_fields, "unfinished", "a sample of a motion that ends with the frame"},
	{rb_cluster_fields, "has_jumped", "no recipe jams (Painleve)"},
	{rb_cluster_fields, "hits", "no piece of a recipe ends so after a frame"},
	{rb_cluster_fields, "crept",
         "decides only when joints that lock have failed: test_located_joints"},
	{rb_held_fields, "merged", "no recipe's accumulation of impacts ends at a frame"},
	{rb_bounces_fields, "at_s",
         "decides only when an end of bounces is reported: test_bounces"},
	{rb_bounces_fields, "due_s", "the same"},
	{rb_bounces_fields, "limit_s", "the same"},
	{rb_bounces_fields, "error_s", "the same"},
	{rb_bounces_fields, "partner", "the same"},
	{rb_held_fields, "common", "no recipe has several points that creep one way"},
	{rb_held_fields, "half", "no recipe has a rim within a piece"},
	{rb_held_fields, "on_rim", "the same"},
	{rb_held_fields, "straight", "no recipe's slip keeps its direction to rounding"},
	{rb_held_fields, "creeps", "no recipe has so slow a slip"},
	{rb_held_fields, "ending", "no recipe's slip ends at a frame"},
	{rb_joint_state_fields, "motor_angle",
         "only callbacks set one: tests/cli/joint-handles.sh"},
	{rb_joint_state_fields, "speed", "pieces are shorter than half of a turn"},
	{rb_joint_state_fields, "released", "only callbacks do that: tests/cli/joint-handles.sh"},
	{rb_joint_state_fields, "was_set",
         "the ledger alone depends on it: tests/cli/scene-joints.sh"},
};
enum { EXEMPT_COUNT = sizeof exempt / sizeof *exempt };

static const struct exempt *exemption(const struct rb_fields *fields, const struct rb_field *row)
{
	for (int i = 0; i < EXEMPT_COUNT; i++)
		if (exempt[i].list() == fields && strcmp(exempt[i].field, row->name) == 0)
			return &exempt[i];
	return NULL;
}

/* The fields of a list that are saved; those that are exempt are counted only. */
static void add_fields(struct unnoticed *unnoticed, const struct rb_fields *fields)
{
	for (const struct rb_field *row = fields->row; row < fields->row + fields->count; row++) {
		if (row->kind == RB_FIELD_DERIVED)
			continue;
		if (exemption(fields, row)) {
			unnoticed->exempt_count++;
			continue;
		}
		assert_true(unnoticed->count < FIELDS_MAX);
		unnoticed->field[unnoticed->count++] = row;
	}
}

/* Every frame of a recipe, saved: `saved` as many as it has. */
static int save_all(lay_out *recipe, struct rb_pack *saved, int most)
{
	struct lab lab;

	make(&lab, recipe, 1);
	const int count = (int)rb_world_frame_count(lab.world);
	assert_true(count <= most);
	for (int k = 0; k < count; k++) {
		run_to(&lab, (uint64_t)k);
		assert_int_equal(rb_world_pack(lab.world, &saved[k], &lab.error), RB_OK);
	}
	lab_close(&lab);
	return count;
}

/*
 * Saves every frame of every recipe, and loads it with one field lost, until the loss of each field
 * was noticed once. Whoever lists a field adds a recipe in which it matters, or exempts it.
 */
static void a_world_that_lacks_any_saved_field_ends_otherwise(void **state)
{
	enum { FRAMES_MAX = 64 };
	static struct unnoticed unnoticed;
	struct loss seen = {.list_count = 0};
	int known = 0;

	(void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
	skip(); /* thousands of runs, which touch no memory that the other tests do not */
#endif
	for (int r = 0; r < RECIPE_COUNT; r++) {
		struct rb_pack saved[FRAMES_MAX] = {{0}};
		const int count = save_all(recipes[r], saved, FRAMES_MAX);

		for (int k = count - 2; k >= 0; k--) {
			struct rb_pack pack = reading(&saved[k], saved[k].size);
			struct lab lab;

			make(&lab, recipes[r], 1);
			pack.loaded = see_list;
			pack.loaded_user = &seen;
			assert_int_equal(rb_world_pack(lab.world, &pack, &lab.error), RB_OK);
			lab_close(&lab);
			for (; known < seen.list_count; known++)
				add_fields(&unnoticed, seen.list[known]);
			for (int i = unnoticed.count - 1; i >= 0; i--)
				if (!ends_the_same(recipes[r], &saved[k], &saved[count - 1],
				                   unnoticed.field[i]))
					unnoticed.field[i] = unnoticed.field[--unnoticed.count];
		}
		for (int k = 0; k < count; k++)
			rb_pack_release(&saved[k]);
	}
	for (int i = 0; i < unnoticed.count; i++)
		print_error("nothing depends on '%s'\n", unnoticed.field[i]->name);
	assert_int_equal(unnoticed.count, 0);
	/* each of them is still listed, and saved */
	assert_int_equal(unnoticed.exempt_count, EXEMPT_COUNT);
}

static void what_is_saved_again_is_the_same_bytes(void **state)
{
	(void)state;
	for (int r = 0; r < RECIPE_COUNT; r++) {
		struct rb_pack saved = saved_at(recipes[r], 5), again = {0};
		struct rb_pack pack = reading(&saved, saved.size);
		struct lab lab;

		make(&lab, recipes[r], 1);
		assert_int_equal(rb_world_pack(lab.world, &pack, &lab.error), RB_OK);
		assert_int_equal(rb_world_pack(lab.world, &again, &lab.error), RB_OK);
		assert_int_equal(again.size, saved.size);
		assert_memory_equal(again.bytes, saved.bytes, saved.size);
		lab_close(&lab);
		rb_pack_release(&again);
		rb_pack_release(&saved);
	}
}

static void bytes_that_end_too_early_are_refused(void **state)
{
	(void)state;
	for (int r = 0; r < RECIPE_COUNT; r++) {
		struct rb_pack saved = saved_at(recipes[r], 5);

		for (size_t size = 0; size < saved.size; size += 1 + size / 40) {
			struct rb_pack pack = reading(&saved, size);
			struct lab lab;

			make(&lab, recipes[r], 1);
			assert_int_equal(rb_world_pack(lab.world, &pack, &lab.error), RB_ERR_INPUT);
			lab_close(&lab);
		}
		rb_pack_release(&saved);
	}
}

static void bytes_that_have_changed_are_refused_or_other_numbers(void **state)
{
	static const unsigned char masks[] = {0x01, 0x80, 0xff};

	(void)state;
	for (int r = 0; r < RECIPE_COUNT; r++) {
		struct rb_pack saved = saved_at(recipes[r], 5);
		int refused = 0;

		for (size_t at = 0; at < saved.size; at += 1 + saved.size / 300) {
			const unsigned char kept = saved.bytes[at];
			struct rb_pack pack = reading(&saved, saved.size);
			struct lab lab;

			saved.bytes[at] = kept ^ masks[at % 3];
			make(&lab, recipes[r], 1);
			refused += rb_world_pack(lab.world, &pack, &lab.error) != RB_OK;
			lab_close(&lab);
			saved.bytes[at] = kept;
		}
		assert_true(refused > 0);
		rb_pack_release(&saved);
	}
}

static void the_state_of_another_scene_is_refused(void **state)
{
	struct rb_pack saved = saved_at(stack, 3), pack = reading(&saved, saved.size);
	struct lab lab;

	(void)state;
	make(&lab, gas, 1);
	assert_int_equal(rb_world_pack(lab.world, &pack, &lab.error), RB_ERR_INPUT);
	assert_non_null(strstr(lab.error.text, "another scene"));
	lab_close(&lab);
	rb_pack_release(&saved);
}

static void loading_without_memory_is_an_error_and_leaks_nothing(void **state)
{
	struct rb_pack saved = saved_at(stack, 8);
	bool went_well = false;

	(void)state;
	for (uint64_t k = 1; !went_well; k++) {
		struct rb_pack pack = reading(&saved, saved.size);
		struct lab lab;

		make(&lab, stack, 1);
		rb_memory_fail_at(k);
		const enum rb_status status = rb_world_pack(lab.world, &pack, &lab.error);
		rb_memory_fail_at(0);
		went_well = status == RB_OK;
		if (!went_well)
			assert_int_equal(status, RB_ERR_MEMORY);
		lab_close(&lab);
	}
	rb_pack_release(&saved);
}

static void numbers_come_back_and_those_out_of_range_do_not(void **state)
{
	struct rb_pack pack = {0};
	int number = 7;
	bool yes = true;
	double values[2] = {0.1, (double)NAN};
	size_t count = 3;

	(void)state;
	rb_pack_int(&pack, &number, 0, 10);
	rb_pack_bool(&pack, &yes);
	rb_pack_doubles(&pack, values, 2);
	rb_pack_count(&pack, &count, 5, 0);
	struct rb_pack back = reading(&pack, pack.size);
	number = 0;
	yes = false;
	values[0] = 0;
	rb_pack_int(&back, &number, 0, 10);
	rb_pack_bool(&back, &yes);
	assert_int_equal(number, 7);
	assert_true(yes);
	rb_pack_times(&back, values, 2);
	assert_true(back.failed);
	/* what follows a failure is zero */
	rb_pack_count(&back, &count, 5, 0);
	assert_int_equal(count, 0);
	struct rb_pack narrow = reading(&pack, pack.size);
	rb_pack_int(&narrow, &number, 0, 6);
	assert_true(narrow.failed);
	assert_int_equal(rb_pack_status(&narrow, "it", NULL), RB_ERR_INPUT);
	rb_pack_release(&pack);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_come_back_and_those_out_of_range_do_not),
		cmocka_unit_test(a_world_that_is_restored_goes_on_in_the_same_bits),
		cmocka_unit_test(any_world_goes_on_from_any_frame_in_the_same_bits),
		cmocka_unit_test(a_world_that_lacks_any_saved_field_ends_otherwise),
		cmocka_unit_test(what_is_saved_again_is_the_same_bytes),
		cmocka_unit_test(bytes_that_end_too_early_are_refused),
		cmocka_unit_test(bytes_that_have_changed_are_refused_or_other_numbers),
		cmocka_unit_test(the_state_of_another_scene_is_refused),
		cmocka_unit_test(loading_without_memory_is_an_error_and_leaks_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
