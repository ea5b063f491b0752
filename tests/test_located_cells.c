/* SPDX-License-Identifier: MIT */
/* src/located: cells of bodies that move on pieces: nobody is missed, and few are looked at. */
#include "worlds.h"

#include "located/located.h"
#include "located/event_set.h"
#include "world/world.h"

static const rb_vec3 origin = {0, 0, 0};
static const double floor_rate = 3, floor_size = 0.2;

enum kind { DRAG, SPRINGS, ECCENTRIC, RISING_FLOOR, DRIVEN_SPHERE, KIND_END };
static const char *const name[] = {"drag", "springs", "eccentric", "a floor that is shaken",
                                   "a sphere that is driven"};

static enum rb_status shake(void *user, int id, double t, struct rb_driven_pose *pose,
                            struct rb_error *err)
{
	const enum kind *const kind = user;
	const double lag = *kind == DRIVEN_SPHERE ? floor_rate * t : 0;

	(void)id, (void)err;
	pose->position = (rb_vec3){lag, 0, floor_size * sin(floor_rate * t)};
	pose->velocity = (rb_vec3){*kind == DRIVEN_SPHERE ? floor_rate : 0, 0,
	                           floor_size * floor_rate * cos(floor_rate * t)};
	pose->angular_velocity = origin;
	pose->has_velocity = pose->has_angular_velocity = true;
	return RB_OK;
}

/* A fixed number in [0, 1) for each k: golden ratio. */
static double share(int k)
{
	return fmod(0.5 + 0.6180339887498949 * k, 1);
}

static int add_driven(struct lab *lab, enum kind kind)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = kind == RISING_FLOOR ? "plane" : "sphere";
	def.shape.kind = kind == RISING_FLOOR ? RB_SHAPE_PLANE : RB_SHAPE_SPHERE;
	def.shape.radius = kind == RISING_FLOOR ? 0 : 0.5;
	def.motion = 0;
	def.motion_gives_velocity = def.motion_gives_angular_velocity = true;
	def.velocity = (rb_vec3){kind == DRIVEN_SPHERE ? floor_rate : 0, 0,
	                         floor_size * floor_rate};
	return lab_add(lab, &def);
}

/* side^3 spheres on a grid of edge 1, in a box 1 m above and beside whatever is driven. */
static void open_gas(struct lab *lab, enum kind *kind, int side, double duration)
{
	const struct rb_world_options options = {.threads = 1};
	struct rb_world_hooks hooks = {.user = kind, .motion = shake};

	lab_open_located(lab, duration, 4);
	lab_surface(lab, 0, 1);
	for (int k = 0; k < 6; k++) {
		const double sign = k % 2 ? -1 : 1;
		const rb_vec3 n = {k / 2 == 0 ? sign : 0, k / 2 == 1 ? sign : 0,
		                   k / 2 == 2 ? sign : 0};
		const double far = side + 1;

		lab_plane(lab, k % 2 ? (rb_vec3){far, far, far} : (rb_vec3){-1, -1, -1}, n);
	}
	if (*kind == RISING_FLOOR || *kind == DRIVEN_SPHERE)
		add_driven(lab, *kind);
	for (int k = 0; k < side * side * side; k++) {
		struct rb_body_def def = lab_sphere_def(
			0.3, 1,
			(rb_vec3){k % side + 0.5, k / side % side + 0.5, k / side / side + 1},
			(rb_vec3){6 * share(3 * k) - 3, 6 * share(5 * k + 1) - 3,
		                  6 * share(7 * k + 2) - 3});

		if (*kind == ECCENTRIC)
			def.center_of_mass = (rb_vec3){0.05, 0, 0};
		const int id = lab_add(lab, &def);
		struct rb_spring_def spring = {.a = id - 1,
		                               .b = id,
		                               .stiffness = 4,
		                               .at_a = {(double)NAN, 0, 0},
		                               .at_b = {(double)NAN, 0, 0}};

		if (*kind == SPRINGS && k % 8 == 1)
			assert_int_equal(rb_scene_add_spring(&lab->scene, &spring, &lab->error),
			                 RB_OK);
	}
	if (*kind == DRAG) {
		const struct rb_drag_def drag = {.linear = 0.125};

		assert_int_equal(rb_scene_add_drag(&lab->scene, &drag, &lab->error), RB_OK);
	}
	lab_seal_with(lab, &options, &hooks);
}

static double apart(const struct lab *one, const struct lab *other)
{
	double most = 0;

	for (int i = 0; i < one->model->body_count; i++) {
		const int id = one->model->id_of[i];

		most = fmax(most, rb_vec3_length(rb_vec3_sub(rb_world_position(one->world, id),
		                                             rb_world_position(other->world, id))));
	}
	return most;
}

/* By rounding at most: a touch is looked for from where it is seen. Each collision multiplies that. */
static void cells_change_nothing(void **state)
{
	(void)state;
	for (enum kind kind = DRAG; kind < KIND_END; kind++) {
		struct lab with, without;

		open_gas(&with, &kind, 4, 1);
		open_gas(&without, &kind, 4, 1);
		assert_non_null(with.world->located->cells);
		rb_cells_destroy(without.world->located->cells);
		without.world->located->cells = NULL;
		lab_run(&with);
		lab_run(&without);
		const uint64_t found = rb_world_totals(with.world).collisions;

		if (found != rb_world_totals(without.world).collisions || found < 32 ||
		    !(apart(&with, &without) <= 1e-11))
			fail_msg("%s: %d collisions, not %d; %g m apart", name[kind], (int)found,
			         (int)rb_world_totals(without.world).collisions,
			         apart(&with, &without));
		lab_close(&with);
		lab_close(&without);
	}
}

/* A cell holds half a body or more, and 27 are looked at, whatever moves and however many there are. */
static void few_are_looked_at(void **state)
{
	(void)state;
	for (enum kind kind = DRAG; kind < KIND_END; kind++) {
		struct lab lab;
		int most = 0, sum = 0;

		open_gas(&lab, &kind, 8, 0.25);
		lab_step(&lab);
		struct rb_located *const l = lab.world->located;
		for (int i = 0; i < l->n; i++) {
			const int near = rb_event_set_near(l, i);

			sum += near;
			most = near > most && !rb_located_driven(l, i) ? near : most;
		}
		if (!(sum < 40 * l->n) || most > 80)
			fail_msg("%s: %d of %d are near on average, %d most", name[kind],
			         sum / l->n, l->n, most);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cells_change_nothing),
		cmocka_unit_test(few_are_looked_at),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
