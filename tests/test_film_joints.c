/* SPDX-License-Identifier: MIT */
/* src/film/joint_shapes.c and its neighbours: joints in pictures. */
#include "studio.h"

#include "film/joint_shapes.h"

/* Two balls that stand still, and a joint of that kind between them, in blue. */
static struct rb_joint_def *open_pair(struct studio *studio, enum rb_joint_kind kind)
{
	struct rb_joint_def def = rb_joint_def_default();

	studio_open(studio);
	studio_ball(studio, 0.2, (rb_vec3){-1, 0, 1}, red);
	studio_ball(studio, 0.2, (rb_vec3){1, 0, 1}, green);
	def.kind = (int)kind;
	def.a = 0;
	def.b = 1;
	if (kind != RB_JOINT_ROD && kind != RB_JOINT_ROPE)
		def.at = (rb_vec3){0, 0, 1};
	if (kind == RB_JOINT_HINGE)
		def.axis = (rb_vec3){1, 0, 0.01};
	def.radius_m = 0.1;
	rb_vec3_to(def.color, blue);
	assert_int_equal(rb_scene_add_joint(&studio->lab.scene, &def, NULL, &studio->err), RB_OK);
	return &studio->lab.scene.joints[0];
}

static void a_rod_is_a_bar_between_its_ends(void **state)
{
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_ROD);
	studio_seal(&studio);
	studio_draw(&studio);
	for (int k = -7; k <= 7; k++)
		assert_true(is_blue(pixel_of(&studio, (rb_vec3){0.1 * k, 0, 1})));
	assert_false(is_blue(pixel_of(&studio, (rb_vec3){0, 0, 1.25})));
	assert_false(is_blue(pixel_of(&studio, (rb_vec3){0, 0, 0.75})));
	studio_close(&studio);
}

static void a_joint_that_is_not_visible_is_not_drawn(void **state)
{
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_ROD)->visible = false;
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_sky(pixel_of(&studio, (rb_vec3){0, 0, 1})));
	studio_close(&studio);
}

static void a_released_joint_is_not_drawn(void **state)
{
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_ROD);
	studio_seal(&studio);
	studio.frame.position[3] = 1.4;
	studio_draw(&studio);
	assert_true(is_sky(pixel_of(&studio, (rb_vec3){0, 0, 1})));
	studio.frame.position[3] = 1;
	studio_draw(&studio);
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){0, 0, 1})));
	studio_close(&studio);
}

static void a_hinge_is_a_pin_along_its_axis(void **state)
{
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_HINGE);
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){0.4, 0, 1})));
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){-0.4, 0, 1})));
	assert_false(is_blue(pixel_of(&studio, (rb_vec3){0, 0, 1.3})));
	studio_close(&studio);
}

static void a_ball_joint_is_a_ball(void **state)
{
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_BALL)->radius_m = 0.3;
	studio_seal(&studio);
	studio_draw(&studio);
	for (int k = 0; k < 8; k++) {
		const double angle = k * acos(-1) / 4, c = cos(angle), s = sin(angle);

		/* its highlight is white */
		assert_false(is_sky(pixel_of(&studio, (rb_vec3){0.24 * c, 0, 1 + 0.24 * s})));
		assert_false(is_blue(pixel_of(&studio, (rb_vec3){0.4 * c, 0, 1 + 0.4 * s})));
	}
	studio_close(&studio);
}

/* From a point that is fixed to a to b's, in one line of pieces, however far it is stretched. */
static void a_slider_on_a_spring_is_a_coil(void **state)
{
	struct rb_joint_piece piece[RB_JOINT_PIECES_MAX];
	struct rb_joint_def *def;
	struct studio studio;
	double first[2];

	(void)state;
	def = open_pair(&studio, RB_JOINT_SLIDER);
	def->axis = (rb_vec3){1, 0, 0};
	def->stiffness = 10;
	def->radius_m = 0.02;
	studio_seal(&studio);
	assert_int_equal(rb_joint_piece_count(studio.lab.model, 0), RB_COIL_PIECES);
	for (int n = 0; n < 2; n++) {
		const double way = 0.3 * n;
		rb_vec3 end = {0};

		studio.frame.position[3] = 1 + way;
		assert_true(rb_joint_pieces(studio.lab.model, &studio.frame, 0, piece));
		for (int k = 0; k < RB_COIL_PIECES; k++) {
			const rb_vec3 half = rb_quat_rotate(piece[k].pose.orientation,
			                                    (rb_vec3){0, 0, 0.5 * piece[k].length});
			const rb_vec3 from = rb_vec3_sub(piece[k].pose.position, half);

			if (k > 0)
				assert_true(rb_vec3_length(rb_vec3_sub(from, end)) < 1e-12);
			else
				first[n] = from.x;
			end = rb_vec3_add(piece[k].pose.position, half);
		}
		/* the middle of its last turn is at b's point, 20 radii from its first at rest */
		assert_near(end.x, way, 1e-12);
		assert_near(hypot(end.y, end.z - 1), 2.5 * 0.02, 1e-12);
	}
	assert_near(first[0], -20 * 0.02, 1e-12);
	assert_near(first[1], first[0], 1e-12);
	studio_close(&studio);
}

static void wire_models_show_rods_as_lines(void **state)
{
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_ROD);
	studio.camera.wireframe = true;
	studio_seal(&studio);
	studio_draw(&studio);
	const uint8_t *line = pixel_of(&studio, (rb_vec3){0, 0, 1});
	const uint8_t *beside = pixel_of(&studio, (rb_vec3){0, 0, 1.3});
	assert_true(brightness(line) < brightness(beside) - 60);
	studio_close(&studio);
}

static void arrows_show_what_joints_exert(void **state)
{
	double value[1] = {0}, force[3] = {0, 0, 20}, torque[3] = {0, 0, 0};
	struct studio studio;

	(void)state;
	open_pair(&studio, RB_JOINT_ROD);
	studio.camera.vectors = RB_VECTORS_JOINT;
	studio_seal(&studio);
	const uint64_t without = studio_hash(&studio);
	studio.frame.joint_count = 1;
	studio.frame.joint_value = studio.frame.joint_speed = value;
	studio.frame.joint_force = force;
	studio.frame.joint_torque = torque;
	assert_true(studio_hash(&studio) != without);
	force[2] = 0;
	studio.frame.joint_value = studio.frame.joint_speed = NULL;
	studio.frame.joint_force = studio.frame.joint_torque = NULL;
	assert_true(studio_hash(&studio) == without);
	studio_close(&studio);
}

/* Half as long again as its ends are apart it hangs below both, and its middle is not between them. */
static void a_slack_rope_sags(void **state)
{
	struct studio studio;

	(void)state;
	struct rb_joint_def *def = open_pair(&studio, RB_JOINT_ROPE);
	def->length_m = 2.6;
	def->radius_m = 0.06;
	studio.lab.scene.world.method = RB_METHOD_STEPPED; /* the one that has ropes */
	studio_seal(&studio);
	studio_draw(&studio);
	assert_true(is_sky(pixel_of(&studio, (rb_vec3){0, 0, 1})));
	int blue_below = 0;
	for (int k = 1; k < 40; k++)
		blue_below += is_blue(pixel_of(&studio, (rb_vec3){0, 0, 1 - 0.02 * k}));
	assert_in_range(blue_below, 2, 12);
	/* taut it is a line */
	studio.frame.position[0] = -1.3;
	studio.frame.position[3] = 1.3;
	studio_draw(&studio);
	assert_true(is_blue(pixel_of(&studio, (rb_vec3){0, 0, 1})));
	studio_close(&studio);
}

/* A spring between two balls, unless neither is to be seen. */
static void springs_are_seen_where_an_end_is(void **state)
{
	int dark[3] = {0};

	(void)state;
	for (int unseen = 0; unseen < 3; unseen++) {
		struct studio studio;
		const double paper[3] = {1, 1, 1};

		studio_open(&studio);
		memcpy(studio.camera.background, paper, sizeof paper);
		struct rb_spring_def def = rb_spring_def_default();
		int *const end[2] = {&def.a, &def.b};
		for (int k = 0; k < 2; k++) {
			struct rb_body_def ball = lab_sphere_def(0.3, 1, (rb_vec3){4 * k - 2, 0, 1},
			                                         (rb_vec3){0, 0, 0});
			rb_vec3_to(ball.color, red);
			ball.visible = unseen <= k;
			*end[k] = lab_add(&studio.lab, &ball);
		}
		def.stiffness = 1;
		assert_int_equal(rb_scene_add_spring(&studio.lab.scene, &def, &studio.err), RB_OK);
		studio_seal(&studio);
		studio_draw(&studio);
		/* columns between the balls in which something was drawn */
		for (int x = WIDTH / 2 - 20; x < WIDTH / 2 + 20; x++) {
			bool any = false;
			for (int y = 0; y < HEIGHT; y++)
				any |= brightness(pixel_at(&studio, x, y)) < 600;
			dark[unseen] += any;
		}
		studio_close(&studio);
	}
	assert_int_equal(dark[0], 40);
	assert_int_equal(dark[1], 40);
	assert_int_equal(dark[2], 0);
}

/* Rows in which a spring between two balls is seen, of `count` springs in the same place. */
static int rows_of_springs(int count)
{
	const double paper[3] = {1, 1, 1};
	struct rb_spring_def def = rb_spring_def_default();
	struct studio studio;
	int *const end[2] = {&def.a, &def.b};
	int rows = 0;

	studio_open(&studio);
	memcpy(studio.camera.background, paper, sizeof paper);
	for (int k = 0; k < 2; k++) {
		struct rb_body_def ball = lab_sphere_def(0.3, 1, (rb_vec3){4 * k - 2, 0, 1},
		                                         (rb_vec3){0, 0, 0});
		*end[k] = lab_add(&studio.lab, &ball);
	}
	def.stiffness = 1;
	for (int k = 0; k < count; k++)
		assert_int_equal(rb_scene_add_spring(&studio.lab.scene, &def, &studio.err), RB_OK);
	studio_seal(&studio);
	studio_draw(&studio);
	for (int y = 0; y < HEIGHT; y++) {
		bool any = false;
		for (int x = WIDTH / 2 - 10; x < WIDTH / 2 + 10; x++)
			any |= brightness(pixel_at(&studio, x, y)) < 600;
		rows += any;
	}
	studio_close(&studio);
	return rows;
}

static void very_many_springs_are_lines(void **state)
{
	(void)state;
	const int coil = rows_of_springs(64), line = rows_of_springs(65);

	assert_true(line > 0 && coil >= line + 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(springs_are_seen_where_an_end_is),
		cmocka_unit_test(very_many_springs_are_lines),
		cmocka_unit_test(a_rod_is_a_bar_between_its_ends),
		cmocka_unit_test(a_joint_that_is_not_visible_is_not_drawn),
		cmocka_unit_test(a_released_joint_is_not_drawn),
		cmocka_unit_test(a_hinge_is_a_pin_along_its_axis),
		cmocka_unit_test(a_ball_joint_is_a_ball),
		cmocka_unit_test(a_slider_on_a_spring_is_a_coil),
		cmocka_unit_test(wire_models_show_rods_as_lines),
		cmocka_unit_test(arrows_show_what_joints_exert),
		cmocka_unit_test(a_slack_rope_sags),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
