/* SPDX-License-Identifier: MIT */
/* src/flow/framing.c: a camera without a place of its own sees all that moves */
#include "worlds.h"

#include "flow/frame.h"
#include "flow/framing.h"
#include "math/quat.h"
#include "math/random.h"

static double uniform(uint64_t series, uint64_t k, double low, double high)
{
	return low + (high - low) * rb_random_unit(series, 0, k);
}

static void seal(struct lab *lab)
{
	if (rb_model_create(&lab->model, &lab->scene, NULL, &lab->error) != RB_OK)
		fail_msg("model: %s", lab->error.text);
}

/* A frame in which the bodies stand where the model has them at the start. */
static void open_frame(const struct lab *lab, struct rb_frame *frame)
{
	struct rb_error err;

	assert_ok(rb_frame_init(frame, lab->model, RB_FIELD_POSITION, &err));
	for (int i = 0; i < lab->model->body_count; i++)
		rb_vec3_to(frame->position + 3 * i, lab->model->position[i]);
}

/*
 * How far from the middle of the picture, in halves of it, the corner is that lies farthest out: of
 * boxes with half edge r about the points.
 */
static double farthest(const struct rb_camera_def *camera, const rb_vec3 *points, const double *r,
                       int count)
{
	const rb_vec3 target = camera->look_at.value;
	const rb_vec3 line = rb_vec3_sub(target, camera->position.value);
	const rb_vec3 ahead = rb_vec3_scale(1 / rb_vec3_length(line), line);
	rb_vec3 right = rb_vec3_cross(ahead, camera->up.value);
	right = rb_vec3_scale(1 / rb_vec3_length(right), right);
	const rb_vec3 up = rb_vec3_cross(right, ahead);
	const double aspect = (double)camera->size_px[0] / camera->size_px[1];
	double most = 0;

	for (int i = 0; i < count; i++)
		for (int k = 0; k < 8; k++) {
			const rb_vec3 corner = {points[i].x + (k & 1 ? r[i] : -r[i]),
			                        points[i].y + (k & 2 ? r[i] : -r[i]),
			                        points[i].z + (k & 4 ? r[i] : -r[i])};
			const rb_vec3 arm = rb_vec3_sub(corner, camera->position.value);
			const double depth = rb_vec3_dot(arm, ahead);
			const double half = camera->orthographic ? 0.5 * camera->height
			                                         : depth * tan(0.5 * camera->fov);

			if (!camera->orthographic && depth <= 0)
				return (double)INFINITY;
			most = fmax(most, fabs(rb_vec3_dot(arm, up)) / half);
			most = fmax(most, fabs(rb_vec3_dot(arm, right)) / (half * aspect));
		}
	return most;
}

/* All of it is in the picture with a tenth to spare, and at that tenth something stands. */
static void every_body_is_in_the_picture_and_fills_it(void **state)
{
	enum { COUNT = 6 };

	(void)state;
	for (uint64_t k = 0; k < 60; k++) {
		struct rb_camera_def camera = rb_camera_def_default();
		struct rb_framing framing;
		struct rb_error err;
		rb_vec3 points[COUNT];
		double r[COUNT];
		char text[80];
		struct lab lab;

		lab_open(&lab, 1, 10);
		rb_vec3 low = {1e9, 1e9, 1e9}, high = {-1e9, -1e9, -1e9};
		for (int i = 0; i < COUNT; i++) {
			const uint64_t at = 10 * k + (uint64_t)i;

			points[i] = (rb_vec3){uniform(1, at, -20, 20), uniform(2, at, -5, 30),
			                      uniform(3, at, 0, 9)};
			r[i] = uniform(4, at, 0.1, 2);
			lab_sphere(&lab, r[i], 1, points[i], (rb_vec3){0, 0, 0});
			low = (rb_vec3){fmin(low.x, points[i].x - r[i]),
			                fmin(low.y, points[i].y - r[i]),
			                fmin(low.z, points[i].z - r[i])};
			high = (rb_vec3){fmax(high.x, points[i].x + r[i]),
			                 fmax(high.y, points[i].y + r[i]),
			                 fmax(high.z, points[i].z + r[i])};
		}
		seal(&lab);
		camera.framed = true;
		camera.orthographic = k % 2;
		camera.fov = uniform(5, k, 0.2, 2);
		camera.size_px[0] = k % 3 ? 1280 : 300;
		camera.size_px[1] = 720;
		assert_ok(rb_framing_init(&framing, lab.model, &err));
		assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
		assert_string_equal(text, "");
		assert_int_equal(camera.position.source, RB_CAMERA_FIXED);
		/* what it looks at is the middle of all boxes */
		assert_vector(camera.look_at.value, rb_vec3_scale(0.5, rb_vec3_add(low, high)),
		              1e-13);
		const double most = farthest(&camera, points, r, COUNT);
		assert_true(most <= 0.9 + 1e-12);
		/* the corners of the box round all of them reach that far, not a hair less */
		rb_vec3 corners[8];
		const double none[8] = {0};
		for (int c = 0; c < 8; c++)
			corners[c] = (rb_vec3){c & 1 ? high.x : low.x, c & 2 ? high.y : low.y,
			                       c & 4 ? high.z : low.z};
		assert_near(farthest(&camera, corners, none, 8), 0.9, 1e-12);
		rb_framing_release(&framing);
		rb_framing_release(&framing);
		lab_close(&lab);
	}
}

/* Wherever they get over the time that is shown. */
static void what_moves_is_seen_wherever_it_gets(void **state)
{
	struct rb_camera_def camera = rb_camera_def_default();
	struct rb_framing framing;
	struct rb_frame frame;
	struct rb_error err;
	rb_vec3 points[4];
	const double r[4] = {0.5, 0.5, 0.5, 0.5};
	char text[80];
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	lab_sphere(&lab, 0.5, 1, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	lab_sphere(&lab, 0.5, 1, (rb_vec3){3, 0, 0}, (rb_vec3){0, 0, 0});
	seal(&lab);
	open_frame(&lab, &frame);
	assert_ok(rb_framing_init(&framing, lab.model, &err));
	assert_false(rb_framing_see(&framing, &frame)); /* where it began */
	points[0] = (rb_vec3){0, 0, 0};
	points[1] = (rb_vec3){3, 0, 0};
	points[2] = (rb_vec3){-4, 7, 1};
	points[3] = (rb_vec3){0, 0, 25};
	for (int k = 2; k < 4; k++) {
		rb_vec3_to(frame.position, points[k]);
		assert_true(rb_framing_see(&framing, &frame));
		assert_false(rb_framing_see(&framing, &frame));
	}
	/* a place that is none is not looked for */
	frame.position[0] = (double)NAN;
	frame.position[3] = (double)INFINITY;
	assert_false(rb_framing_see(&framing, &frame));
	rb_vec3_to(frame.position, points[0]);
	rb_vec3_to(frame.position + 3, points[1]);
	assert_false(rb_framing_see(&framing, &frame)); /* it is back */
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
	assert_true(farthest(&camera, points, r, 4) <= 0.9 + 1e-12);
	rb_framing_release(&framing);
	rb_frame_release(&frame);
	lab_close(&lab);
}

/* Corners too, but of ground on which everything stands. */
static void planes_that_move_are_seen_unless_they_are_the_ground(void **state)
{
	static const double sizes[3] = {1, 3, 100}; /* of the plane: m */
	char text[80];

	(void)state;
	for (int k = 0; k < 6; k++) {
		const bool alone = k < 3;
		const double size = sizes[k % 3];
		struct rb_camera_def camera = rb_camera_def_default();
		const double h = 0.5 * size; /* its edges lie along the world's axes */
		const rb_vec3 points[5] = {
			{h, h, 0}, {-h, h, 0}, {h, -h, 0}, {-h, -h, 0}, {0, 0, 3}};
		const double radii[5] = {0, 0, 0, 0, 0.5};
		struct rb_framing framing;
		struct rb_error err;
		struct lab lab;

		lab_open(&lab, 1, 10);
		const int plane = lab_rectangle(&lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1}, size,
		                                size);
		if (!alone)
			lab_sphere(&lab, 0.5, 1, points[4], (rb_vec3){0, 0, 0});
		lab.scene.bodies[plane].is_static = false;
		lab.scene.bodies[plane].motion = 0;
		seal(&lab);
		assert_ok(rb_framing_init(&framing, lab.model, &err));
		assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
		const double most = farthest(&camera, points, radii, alone ? 4 : 5);
		assert_true(most <= 0.9 + 1e-12 || (!alone && size > 50));
		if (alone)
			assert_near(most, 0.9, 1e-12); /* and fill it */
		if (!alone && size > 50)
			assert_true(rb_vec3_length(camera.position.value) < 20);
		rb_framing_release(&framing);
		lab_close(&lab);
	}
}

/* What has gone for kilometres would make all others dots; three are named, others counted. */
static void who_flies_off_for_ever_is_left_out_and_told(void **state)
{
	struct rb_camera_def camera = rb_camera_def_default();
	struct rb_framing framing;
	struct rb_frame frame;
	struct rb_error err;
	char text[80], small[12];
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (int i = 0; i < 8; i++) {
		struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){2.0 * i, 0, 0},
		                                        (rb_vec3){0, 0, 0});
		def.name = i == 3 ? "runaway" : NULL;
		lab_add(&lab, &def);
	}
	seal(&lab);
	open_frame(&lab, &frame);
	assert_ok(rb_framing_init(&framing, lab.model, &err));
	for (int far = 1; far < 1000; far *= 3) {
		for (int i = 3; i < 8; i++)
			frame.position[3 * i + 2] = 20.0 * far * (i - 2);
		assert_true(rb_framing_see(&framing, &frame));
	}
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 5);
	assert_string_equal(text, "'runaway', #4, #5 and 2 more");
	/* those that stay fill the picture: from x = 0 to x = 4 */
	assert_true(rb_vec3_length(rb_vec3_sub(camera.position.value, camera.look_at.value)) < 20);
	assert_int_equal(rb_framing_aim(&framing, &camera, small, sizeof small), 5);
	assert_string_equal(small, "'runaway', ");
	/* one that turns back has not left */
	for (int i = 3; i < 8; i++)
		frame.position[3 * i + 2] -= 1;
	(void)rb_framing_see(&framing, &frame);
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
	assert_true(rb_vec3_length(rb_vec3_sub(camera.position.value, camera.look_at.value)) >
	            1000);
	rb_framing_release(&framing);
	rb_frame_release(&frame);
	lab_close(&lab);
}

/* Beads of a row that is longer than pixels show: to leave some out would make none larger. */
static void who_moves_among_what_stays_is_in_the_picture(void **state)
{
	struct rb_camera_def camera = rb_camera_def_default();
	struct rb_framing framing;
	struct rb_frame frame;
	struct rb_error err;
	char text[80];
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (int i = 0; i < 8; i++) {
		struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){1000.0 * i, 0, 0},
		                                        (rb_vec3){0, 0, 0});
		lab_add(&lab, &def);
	}
	seal(&lab);
	open_frame(&lab, &frame);
	assert_ok(rb_framing_init(&framing, lab.model, &err));
	for (int k = 0; k < 4; k++) {
		frame.position[3 * 5] += 10;    /* away from the middle of all */
		frame.position[3 * 7] += 100;   /* beyond what stays, by a little */
		frame.position[3 * 4 + 2] += 5; /* across to the row */
		assert_true(rb_framing_see(&framing, &frame));
	}
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
	rb_framing_release(&framing);
	rb_frame_release(&frame);
	lab_close(&lab);
}

static void a_point_that_is_looked_at_stays_in_the_middle(void **state)
{
	struct rb_camera_def camera = rb_camera_def_default();
	struct rb_framing framing;
	struct rb_error err;
	const rb_vec3 points[2] = {{0, 0, 0}, {10, 0, 0}};
	const double r[2] = {1, 1};
	char text[80];
	struct lab lab;

	(void)state;
	lab_open(&lab, 1, 10);
	for (int i = 0; i < 2; i++)
		lab_sphere(&lab, 1, 1, points[i], (rb_vec3){0, 0, 0});
	seal(&lab);
	assert_ok(rb_framing_init(&framing, lab.model, &err));
	camera.aimed = true;
	camera.look_at.value = (rb_vec3){0, 0, 3};
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
	assert_vector(camera.look_at.value, ((rb_vec3){0, 0, 3}), 0);
	assert_true(farthest(&camera, points, r, 2) <= 0.9 + 1e-12);
	/* a height that is given is kept */
	camera.orthographic = true;
	camera.height = 3;
	(void)rb_framing_aim(&framing, &camera, text, sizeof text);
	assert_true(camera.height == 3);
	rb_framing_release(&framing);
	lab_close(&lab);
}

static void there_is_a_picture_of_next_to_nothing(void **state)
{
	struct rb_camera_def camera = rb_camera_def_default();
	struct rb_framing framing;
	struct rb_error err;
	struct lab lab;
	char text[80];

	(void)state;
	/* one body, which nobody sees */
	lab_open(&lab, 1, 10);
	struct rb_body_def def = lab_sphere_def(0.5, 1, (rb_vec3){7, 0, 0}, (rb_vec3){0, 0, 0});
	def.visible = false;
	lab_add(&lab, &def);
	seal(&lab);
	assert_ok(rb_framing_init(&framing, lab.model, &err));
	camera.orthographic = true;
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
	assert_true(isfinite(camera.position.value.x) && camera.height > 0);
	assert_true(rb_vec3_length(rb_vec3_sub(camera.position.value, camera.look_at.value)) > 0);
	rb_memory_fail_at(1);
	camera.height = (double)NAN;
	assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
	rb_memory_fail_at(0);
	assert_true(camera.height > 0);
	rb_framing_release(&framing);
	rb_memory_fail_at(1);
	const enum rb_status status = rb_framing_init(&framing, lab.model, &err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	rb_framing_release(&framing);
	lab_close(&lab);
}

/* A ball on a rod: the picture has room for the place where the rod hangs. */
static void where_joints_hang_on_the_world_is_in_the_picture(void **state)
{
	(void)state;
	for (int visible = 0; visible < 2; visible++) {
		const rb_vec3 points[2] = {{0, 0, 0}, {0, 0, 3}};
		const double r[2] = {0.1, 0};
		struct rb_joint_def def = rb_joint_def_default();
		struct rb_camera_def camera = rb_camera_def_default();
		struct rb_framing framing;
		struct rb_frame frame;
		struct rb_error err;
		struct lab lab;
		char text[160];

		lab_open(&lab, 1, 10);
		def.kind = RB_JOINT_ROD;
		def.a = lab_sphere(&lab, 0.1, 1, points[0], (rb_vec3){0, 0, 0});
		def.at_b = points[1];
		def.visible = visible;
		assert_ok(rb_scene_add_joint(&lab.scene, &def, NULL, &err));
		seal(&lab);
		open_frame(&lab, &frame);
		assert_ok(rb_framing_init(&framing, lab.model, &err));
		(void)rb_framing_see(&framing, &frame);
		camera.framed = true;
		assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
		assert_int_equal(farthest(&camera, points, r, 2) <= 0.9 + 1e-9, visible);
		rb_frame_release(&frame);
		rb_framing_release(&framing);
		lab_close(&lab);
	}
}

/* A hull's origin may be at a corner, a union's anywhere: its picture is that of its shape. */
static void where_the_origin_of_a_shape_is_does_not_matter(void **state)
{
	static const rb_vec3 wedge[6] = {{-1, -1, -1}, {1, -1, -1}, {-1, -1, 1},
	                                 {-1, 1, -1},  {1, 1, -1},  {-1, 1, 1}};
	rb_vec3 from = {0, 0, 0};

	(void)state;
	for (int k = 0; k < 4; k++) {
		const int off = k % 2, turns = k / 2;
		const rb_vec3 origin = {off * 5.0, off * -2.0, off * 3.0};
		const rb_quat turn = rb_quat_from_turn((rb_vec3){0.3, 1, -0.4});
		struct rb_camera_def camera = rb_camera_def_default();
		struct rb_body_def def = rb_body_def_default();
		struct rb_framing framing;
		struct rb_frame frame;
		struct rb_error err;
		rb_vec3 points[6];
		struct lab lab;
		char text[80];

		lab_open(&lab, 1, 10);
		for (int i = 0; i < 6; i++)
			points[i] = rb_vec3_add(wedge[i], origin);
		def.shape = (struct rb_shape){.kind = RB_SHAPE_HULL};
		def.angular_velocity.x = turns;
		assert_ok(rb_scene_add_hull(&lab.scene, points, 6, &def.shape.solid, &err));
		def.mass = 1;
		def.orientation = turn;
		def.position = rb_vec3_sub((rb_vec3){1, 2, 3}, rb_quat_rotate(turn, origin));
		def.filters = true;
		lab_add(&lab, &def);
		seal(&lab);
		assert_ok(rb_frame_init(&frame, lab.model, RB_FIELD_DEFAULT, &err));
		rb_vec3_to(frame.position, lab.model->position[0]);
		assert_true((frame.orientation != NULL) == (turns == 1));
		if (turns)
			rb_quat_to(frame.orientation, turn);
		assert_ok(rb_framing_init(&framing, lab.model, &err));
		(void)rb_framing_see(&framing, &frame);
		camera.framed = true;
		assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
		if (off)
			assert_vector(camera.position.value, from, 1e-12);
		from = camera.position.value;
		if (turns) { /* where it is not recorded how they are turned they are, somehow */
			double reach = 0;

			for (int i = 0; i < 6; i++)
				reach = fmax(reach, rb_vec3_length(points[i]));
			const struct rb_frame bare = {.body_count = 1, .position = frame.position};
			(void)rb_framing_see(&framing, &bare);
			assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
			assert_true(farthest(&camera, &def.position, &reach, 1) <= 0.9 + 1e-12);
		}
		rb_frame_release(&frame);
		rb_framing_release(&framing);
		lab_close(&lab);
	}
}

/* A ball on a spring: so has what holds the other end. */
static void where_springs_hang_is_in_the_picture(void **state)
{
	(void)state;
	for (int swapped = 0; swapped < 2; swapped++) {
		const rb_vec3 points[2] = {{0, 0, 0}, {0.2, 0, 3}};
		const double r[2] = {0.1, 0};
		struct rb_spring_def def = rb_spring_def_default();
		struct rb_camera_def camera = rb_camera_def_default();
		struct rb_framing framing;
		struct rb_error err;
		struct lab lab;
		char text[160];

		lab_open(&lab, 1, 10);
		const int ball = lab_sphere(&lab, 0.1, 1, points[0], (rb_vec3){0, 0, 0});
		struct rb_body_def hook = lab_sphere_def(0.05, 1, (rb_vec3){0, 0, 3},
		                                         (rb_vec3){0, 0, 0});
		hook.is_static = true;
		hook.mass = (double)NAN;
		const int top = lab_add(&lab, &hook);
		def.a = swapped ? top : ball;
		def.b = swapped ? ball : top;
		*(swapped ? &def.at_a : &def.at_b) = (rb_vec3){0.2, 0, 0};
		def.stiffness = 1;
		assert_ok(rb_scene_add_spring(&lab.scene, &def, &err));
		seal(&lab);
		assert_ok(rb_framing_init(&framing, lab.model, &err));
		camera.framed = true;
		assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
		assert_true(farthest(&camera, points, r, 2) <= 0.9 + 1e-9);
		rb_framing_release(&framing);
		lab_close(&lab);
	}
}

/* A ladder is long, not as wide as it is long: the box round its corners fills the picture, however it is turned. */
static void what_is_long_and_thin_fills_the_picture(void **state)
{
	const rb_vec3 size = {0.4, 0.05, 6};

	(void)state;
	for (uint64_t k = 0; k < 24; k++) {
		const int kind = (int)(k % 3); /* a box, a hull, a union of the box */
		const rb_vec3 at = {1, 2, 3};
		rb_quat turn = rb_quat_from_turn((rb_vec3){
			uniform(1, k, -2, 2), uniform(2, k, -2, 2), uniform(3, k, -2, 2)});
		struct rb_camera_def camera = rb_camera_def_default();
		struct rb_body_def def = rb_body_def_default();
		struct rb_framing framing;
		struct rb_error err;
		rb_vec3 points[8], low = {1e9, 1e9, 1e9}, high = {-1e9, -1e9, -1e9};
		const double none[8] = {0};
		struct lab lab;
		char text[80];

		lab_open(&lab, 1, 10);
		def.shape = (struct rb_shape){.kind = RB_SHAPE_BOX,
		                              .size = {size.x, size.y, size.z}};
		for (int c = 0; c < 8; c++)
			points[c] = (rb_vec3){(c & 1 ? 0.5 : -0.5) * size.x,
			                      (c & 2 ? 0.5 : -0.5) * size.y,
			                      (c & 4 ? 0.5 : -0.5) * size.z};
		if (kind == 1) {
			def.shape = (struct rb_shape){.kind = RB_SHAPE_HULL};
			assert_ok(rb_scene_add_hull(&lab.scene, points, 8, &def.shape.solid, &err));
		} else if (kind == 2) {
			const struct rb_solid_part part = {def.shape, {0, 0, 0}, {1, 0, 0, 0}, 1};
			def.shape = (struct rb_shape){.kind = RB_SHAPE_UNION};
			assert_ok(rb_scene_add_union(&lab.scene, &part, 1, &def.shape.solid, &err));
		}
		def.mass = 1;
		def.orientation = turn;
		def.position = at;
		def.filters = true;
		lab_add(&lab, &def);
		seal(&lab);
		for (int c = 0; c < 8; c++) {
			const rb_vec3 v = rb_vec3_add(at, rb_quat_rotate(turn, points[c]));
			low = (rb_vec3){fmin(low.x, v.x), fmin(low.y, v.y), fmin(low.z, v.z)};
			high = (rb_vec3){fmax(high.x, v.x), fmax(high.y, v.y), fmax(high.z, v.z)};
		}
		for (int c = 0; c < 8; c++)
			points[c] = (rb_vec3){c & 1 ? high.x : low.x, c & 2 ? high.y : low.y,
			                      c & 4 ? high.z : low.z};
		camera.framed = true;
		assert_ok(rb_framing_init(&framing, lab.model, &err));
		assert_int_equal(rb_framing_aim(&framing, &camera, text, sizeof text), 0);
		assert_near(farthest(&camera, points, none, 8), 0.9, 1e-12);
		rb_framing_release(&framing);
		lab_close(&lab);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(where_joints_hang_on_the_world_is_in_the_picture),
		cmocka_unit_test(where_springs_hang_is_in_the_picture),
		cmocka_unit_test(what_is_long_and_thin_fills_the_picture),
		cmocka_unit_test(where_the_origin_of_a_shape_is_does_not_matter),
		cmocka_unit_test(every_body_is_in_the_picture_and_fills_it),
		cmocka_unit_test(what_moves_is_seen_wherever_it_gets),
		cmocka_unit_test(planes_that_move_are_seen_unless_they_are_the_ground),
		cmocka_unit_test(who_flies_off_for_ever_is_left_out_and_told),
		cmocka_unit_test(who_moves_among_what_stays_is_in_the_picture),
		cmocka_unit_test(a_point_that_is_looked_at_stays_in_the_middle),
		cmocka_unit_test(there_is_a_picture_of_next_to_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
