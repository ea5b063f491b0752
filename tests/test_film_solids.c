/* SPDX-License-Identifier: MIT */
/* src/film/solid_shapes.c and its rooms: boxes, capsules, cylinders, hulls and unions in pictures. */
#include "film/solid_shapes.h"

#include "film/mesh.h"
#include "math/quat.h"
#include "studio.h"

static const double paper[3] = {1, 1, 1};
static const rb_vec3 octahedron[6] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                      {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};

static struct rb_shape shape_of(struct studio *studio, enum rb_shape_kind kind)
{
	struct rb_shape shape = {.kind = kind, .radius = 0.4, .size = {1.2, 0.5, 0.9}};

	if (kind == RB_SHAPE_BOX)
		shape.radius = 0;
	else
		shape.size[0] = shape.size[1] = 0;
	if (kind == RB_SHAPE_HULL) {
		shape = (struct rb_shape){.kind = kind};
		assert_int_equal(rb_scene_add_hull(&studio->lab.scene, octahedron, 6, &shape.solid,
		                                   &studio->err),
		                 RB_OK);
	}
	return shape;
}

static struct rb_body_def solid_def(struct rb_shape shape, rb_vec3 position, rb_vec3 turn)
{
	struct rb_body_def def = rb_body_def_default();

	def.call = "box";
	def.shape = shape;
	def.mass = 1;
	def.position = position;
	def.orientation = rb_quat_from_turn(turn);
	def.angular_velocity = (rb_vec3){1, 0, 0}; /* so that frames have orientations */
	def.filters = true;
	rb_vec3_to(def.color, red);
	return def;
}

static int studio_solid(struct studio *studio, enum rb_shape_kind kind, rb_vec3 position,
                        rb_vec3 turn)
{
	const struct rb_body_def def = solid_def(shape_of(studio, kind), position, turn);

	return lab_add(&studio->lab, &def);
}

/* Is a point in object coordinates within a shape that is larger all round by `more`? */
static bool contains(const struct rb_shape *shape, rb_vec3 p, double more)
{
	const double half = 0.5 * shape->size[2];

	switch (shape->kind) {
	case RB_SHAPE_BOX:
		return fabs(p.x) < 0.5 * shape->size[0] + more &&
		       fabs(p.y) < 0.5 * shape->size[1] + more && fabs(p.z) < half + more;
	case RB_SHAPE_CAPSULE:
		p.z = fabs(p.z) < half ? 0 : fabs(p.z) - half;
		return rb_vec3_length(p) < shape->radius + more;
	case RB_SHAPE_CYLINDER:
		return hypot(p.x, p.y) < shape->radius + more && fabs(p.z) < half + more;
	default: /* the octahedron */
		return fabs(p.x) + fabs(p.y) + fabs(p.z) < 1 + more * sqrt(3);
	}
}

/* Does the ray of a pixel meet it? Tried at a thousand places. */
static bool meets(const struct rb_view *view, const struct rb_body_def *def, int x, int y,
                  double more)
{
	const double across = view->left_slope +
	                      (x + 0.5) / WIDTH * (view->right_slope - view->left_slope);
	const double upright = view->top_slope +
	                       (y + 0.5) / HEIGHT * (view->bottom_slope - view->top_slope);
	const rb_vec3 way = rb_vec3_sub(
		rb_vec3_add_scaled(rb_vec3_scale(across, view->right), upright, view->up),
		view->back);

	for (int k = 0; k < 1000; k++) {
		const rb_vec3 at = rb_vec3_add_scaled(view->eye, 2 + 0.003 * k, way);
		const rb_vec3 p = rb_quat_rotate_back(def->orientation,
		                                      rb_vec3_sub(at, def->position));
		if (contains(&def->shape, p, more))
			return true;
	}
	return false;
}

static void silhouettes_are_those_of_the_shapes(void **state)
{
	static const rb_vec3 turns[3] = {{0, 0, 0}, {0.7, -0.4, 1.1}, {-1.3, 0.2, 2.4}};

	(void)state;
	for (int kind = RB_SHAPE_BOX; kind <= RB_SHAPE_HULL; kind++)
		for (int t = 0; t < 3; t++) {
			struct studio studio;
			struct rb_view view;
			int inside = 0, outside = 0;
			studio_open(&studio);
			studio.camera.position.value = (rb_vec3){0, -3.5, 1.5};
			memcpy(studio.camera.background, paper, sizeof paper);
			const struct rb_body_def def = solid_def(
				shape_of(&studio, (enum rb_shape_kind)kind), (rb_vec3){0.3, 0, 1},
				turns[t]);
			lab_add(&studio.lab, &def);
			studio_seal(&studio);
			studio_draw(&studio);
			assert_int_equal(rb_view_make(&view, studio.lab.model, &studio.camera,
			                              &studio.frame, NULL, NULL),
			                 RB_OK);
			/* A pixel here is about 0.025 m; edges are soft. */
			for (int y = 0; y < HEIGHT; y++)
				for (int x = 0; x < WIDTH; x++) {
					const uint8_t *p = pixel_at(&studio, x, y);
					if (p[1] < 200) {
						assert_true(meets(&view, &def, x, y, 0.03));
						inside++;
					} else if (brightness(p) == 3 * 255) {
						assert_false(meets(&view, &def, x, y, -0.03));
						outside++;
					}
				}
			assert_true(inside > 400 && inside + outside > WIDTH * HEIGHT - 500);
			studio_close(&studio);
		}
}

static void use_light(struct studio *studio, rb_vec3 towards)
{
	studio->camera.light_count = 1;
	studio->camera.lights[0] = (struct rb_light_def){
		.position = towards, .kind = RB_LIGHT_SUN, .color = {1, 1, 1}, .intensity = 0.7};
}

static void faces_are_as_bright_as_they_look_to_the_light(void **state)
{
	/* The middles of the upper, the left and the front side, all seen. */
	static const rb_vec3 middle[3] = {{0, 0, 0.5}, {-0.5, 0, 0}, {0, -0.5, 0}};
	static const rb_vec3 light[3] = {{-0.5, -0.1, 1}, {-1, -0.5, 0.1}, {-0.1, -1, 0.5}};
	static const int order[3][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}};

	(void)state;
	for (int k = 0; k < 3; k++) {
		struct studio studio;
		int found[3];
		studio_open(&studio);
		studio.camera.position.value = (rb_vec3){-3, -3, 3};
		studio.camera.look_at.value = (rb_vec3){0, 0, 0};
		use_light(&studio, light[k]);
		struct rb_shape cube = {.kind = RB_SHAPE_BOX, .size = {1, 1, 1}};
		const struct rb_body_def def = solid_def(cube, (rb_vec3){0}, (rb_vec3){0});
		lab_add(&studio.lab, &def);
		studio.lab.scene.materials[0].shininess = 0;
		studio_seal(&studio);
		studio_draw(&studio);
		for (int f = 0; f < 3; f++)
			found[f] = brightness(pixel_of(&studio, middle[f]));
		for (int f = 0; f < 2; f++)
			assert_true(found[order[k][f]] > found[order[k][f + 1]] + 10);
		studio_close(&studio);
	}
}

/* What is alone is not in the shadow of anything, be it as thin as a foil. */
static void what_is_convex_throws_no_shadow_on_itself(void **state)
{
	(void)state;
	for (int kind = RB_SHAPE_BOX; kind <= RB_SHAPE_UNION; kind++) {
		static uint8_t before[4 * WIDTH * HEIGHT];
		int differ = 0, seen = 0;
		for (int shadows = 0; shadows < 2; shadows++) {
			struct studio studio;
			studio_open(&studio);
			studio.camera.position.value = (rb_vec3){0, -3.5, 1.5};
			studio.camera.shadows = shadows;
			memcpy(studio.camera.background, paper, sizeof paper);
			use_light(&studio, (rb_vec3){-0.5, -0.6, 1});
			struct rb_body_def def = solid_def(
				shape_of(&studio, kind == RB_SHAPE_UNION
			                                  ? RB_SHAPE_BOX
			                                  : (enum rb_shape_kind)kind),
				(rb_vec3){0, 0, 1}, (rb_vec3){0.5, 0.3, 0.2});
			if (kind == RB_SHAPE_UNION) /* a foil */
				def.shape.size[2] = 1e-6;
			lab_add(&studio.lab, &def);
			studio_seal(&studio);
			studio_draw(&studio);
			for (int k = 0; k < WIDTH * HEIGHT && shadows; k++) {
				const int one = before[4 * k], other = studio.picture.rgba[4 * k];
				differ += abs(one - other) > 6;
				seen += before[4 * k + 1] < 200;
			}
			memcpy(before, studio.picture.rgba, sizeof before);
			studio_close(&studio);
		}
		assert_true(seen > 300);
		assert_in_range(differ, 0, seen / 200);
	}
}

static void a_solid_throws_the_shadow_of_its_outline_on_a_plane(void **state)
{
	struct studio studio;

	(void)state;
	for (int kind = RB_SHAPE_BOX; kind <= RB_SHAPE_HULL; kind++) {
		studio_open(&studio);
		use_light(&studio, (rb_vec3){0, 0, 1});
		lab_plane(&studio.lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
		/* Lying: along x 1.2 or 1.7 or 2 long, along y 0.5 to 2. */
		const rb_vec3 turn = {0, kind == RB_SHAPE_CAPSULE ? 0.5 * acos(-1) : 0, 0};
		studio_solid(&studio, (enum rb_shape_kind)kind, (rb_vec3){0, 0, 2.5}, turn);
		studio_seal(&studio);
		studio_draw(&studio);
		const double half_x = kind == RB_SHAPE_BOX       ? 0.6
		                      : kind == RB_SHAPE_CAPSULE ? 0.85
		                      : kind == RB_SHAPE_HULL    ? 1
		                                                 : 0.4;
		const int lit = brightness(pixel_of(&studio, (rb_vec3){half_x + 0.2, 0, 0}));
		for (int side = -1; side <= 1; side += 2) {
			const rb_vec3 in = {side * (half_x - 0.1), 0, 0};
			const rb_vec3 out = {side * (half_x + 0.1), 0, 0};
			assert_true(brightness(pixel_of(&studio, in)) < lit - 60);
			assert_true(brightness(pixel_of(&studio, out)) > lit - 20);
		}
		studio_close(&studio);
	}
}

/* Points of the side that is turned to the camera keep their colours when they turn with the body. */
static void patterns_turn_with_solids(void **state)
{
	static const char *const textures[] = {"checker", "stripes", "beachball"};

	(void)state;
	for (int kind = RB_SHAPE_BOX; kind <= RB_SHAPE_HULL; kind++)
		for (int k = 0; k < 3; k++) {
			struct studio studio;
			bool was[19 * 19];
			int same = 0, reds = 0, all = 0, still = 0;
			studio_open(&studio);
			studio.camera.position.value = (rb_vec3){0, -4, 0};
			studio.camera.look_at.value = (rb_vec3){0, 0, 0};
			studio.camera.fov = 0.6;
			const int id = studio_solid(&studio, (enum rb_shape_kind)kind,
			                            (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
			studio.lab.scene.bodies[id].texture = textures[k];
			studio.lab.scene.materials[0].shininess = 0;
			studio_seal(&studio);
			for (int turned = 0; turned < 2; turned++) {
				const rb_quat turn = rb_quat_from_turn(
					(rb_vec3){0, -0.6 * turned, 0});
				rb_quat_to(studio.frame.orientation, turn);
				studio_draw(&studio);
				for (int n = 0; n < 19 * 19; n++) {
					const double reach = kind == RB_SHAPE_BOX    ? 0.55
					                     : kind == RB_SHAPE_HULL ? 0.4
					                                             : 0.36;
					rb_vec3 p = {reach * (n % 19 - 9) / 9, -0.25,
					             0.4 * (n / 19 - 9) / 9};
					if (kind == RB_SHAPE_HULL)
						p.y = fabs(p.x) + fabs(p.z) - 1;
					else if (kind != RB_SHAPE_BOX)
						p.y = -sqrt(0.16 - p.x * p.x);
					const bool here = is_red(pixel_of(&studio, p));
					const bool there = is_red(
						pixel_of(&studio, rb_quat_rotate(turn, p)));
					if (turned) {
						same += there == was[n];
						still += here == was[n];
						all++;
					} else {
						was[n] = here;
						reds += here;
					}
				}
			}
			assert_true(reds > all / 8 && reds < all - all / 8);
			/* Others lie on an edge of the pattern. */
			assert_true(same > all * 6 / 7);
			assert_true(still < same - all / 8);
			studio_close(&studio);
		}
}

static void a_union_looks_like_its_parts(void **state)
{
	static const enum rb_shape_kind kinds[5] = {RB_SHAPE_SPHERE, RB_SHAPE_BOX, RB_SHAPE_CAPSULE,
	                                            RB_SHAPE_CYLINDER, RB_SHAPE_HULL};
	const rb_vec3 place = {0.1, 0.2, 1}, turn = {0.4, -0.3, 0.8};
	static uint8_t whole[4 * WIDTH * HEIGHT];

	(void)state;
	for (int apart = 0; apart < 2; apart++) {
		struct studio studio;
		struct rb_solid_part parts[5];
		studio_open(&studio);
		lab_plane(&studio.lab, (rb_vec3){0, 0, -1}, (rb_vec3){0, 0, 1});
		for (int k = 0; k < 5; k++)
			parts[k] = (struct rb_solid_part){
				.shape = shape_of(&studio, kinds[k]),
				.position = {0.6 * (k - 2), 0.2 * k, 0.3 * (k % 3)},
				.orientation = rb_quat_from_turn((rb_vec3){0.3 * k, 0.2, -k}),
				.share = 1};
		struct rb_shape shape = {.kind = RB_SHAPE_UNION};
		assert_int_equal(
			rb_scene_add_union(&studio.lab.scene, parts, 5, &shape.solid, &studio.err),
			RB_OK);
		struct rb_body_def def = solid_def(shape, place, turn);
		def.texture = "checker";
		if (!apart)
			lab_add(&studio.lab, &def);
		for (int k = 0; k < 5 && apart; k++) {
			struct rb_body_def part = def;
			part.shape = parts[k].shape;
			part.position = rb_vec3_add(
				place, rb_quat_rotate(def.orientation, parts[k].position));
			part.orientation = rb_quat_multiply(def.orientation, parts[k].orientation);
			lab_add(&studio.lab, &part);
		}
		studio_seal(&studio);
		studio_draw(&studio);
		int reds = 0;
		for (int k = 0; k < 4 * WIDTH * HEIGHT && apart; k++) {
			assert_near(whole[k], studio.picture.rgba[k], 3);
			reds += k % 4 == 0 && is_red(&whole[k]);
		}
		assert_true(!apart || reds > 200);
		memcpy(whole, studio.picture.rgba, sizeof whole);
		studio_close(&studio);
	}
}

static void a_ball_in_a_box_sticks_out_as_far_as_it_does(void **state)
{
	struct studio studio;

	(void)state;
	studio_open(&studio);
	studio.camera.position.value = (rb_vec3){0, -6, 0};
	studio.camera.look_at.value = (rb_vec3){0, 0, 0};
	studio.lab.scene.materials[0].shininess = 0;
	studio_ball(&studio, 1, (rb_vec3){0, 0, 0}, green);
	struct rb_shape shape = {.kind = RB_SHAPE_BOX, .size = {3, 1.6, 3}};
	const struct rb_body_def def = solid_def(shape, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 0});
	lab_add(&studio.lab, &def);
	studio.lab.scene.bodies[0].filters = true;
	studio_seal(&studio);
	studio_draw(&studio);
	/* A front at y = -0.8 cuts a sphere of 1 m in a circle of 0.6 m. */
	for (int k = 0; k < 12; k++) {
		const double x = cos(0.5 * k), z = sin(0.5 * k);
		assert_true(is_green(pixel_of(&studio, (rb_vec3){0.5 * x, -0.8, 0.5 * z})));
		assert_true(is_red(pixel_of(&studio, (rb_vec3){0.7 * x, -0.8, 0.7 * z})));
	}
	studio_close(&studio);
}

static void millimetres_and_kilometres_look_the_same(void **state)
{
	static const double scale[3] = {1, 1e-3, 1e3};
	static uint8_t first[4 * WIDTH * HEIGHT];

	(void)state;
	for (int s = 0; s < 3; s++) {
		struct studio studio;
		const rb_vec3 away = rb_vec3_scale(1e6 * scale[s] * (s > 0), (rb_vec3){1, -2, 0});
		studio_open(&studio);
		studio.camera.position.value = rb_vec3_add(
			away, rb_vec3_scale(scale[s], (rb_vec3){0, -8, 2}));
		studio.camera.look_at.value = rb_vec3_add(
			away, rb_vec3_scale(scale[s], (rb_vec3){0, 0, 1}));
		for (int k = RB_SHAPE_BOX; k <= RB_SHAPE_CYLINDER; k++) {
			struct rb_shape shape = shape_of(&studio, (enum rb_shape_kind)k);
			shape.radius *= scale[s];
			for (int a = 0; a < 3; a++)
				shape.size[a] *= scale[s];
			const rb_vec3 place = {1.5 * (k - RB_SHAPE_CAPSULE), 0, 1};
			struct rb_body_def def = solid_def(
				shape, rb_vec3_add(away, rb_vec3_scale(scale[s], place)),
				(rb_vec3){1, k, 2});
			def.texture = "checker";
			lab_add(&studio.lab, &def);
		}
		studio_seal(&studio);
		studio_draw(&studio);
		int differ = 0;
		for (int k = 0; k < 4 * WIDTH * HEIGHT && s > 0; k++)
			differ += abs(first[k] - studio.picture.rgba[k]) > 12;
		assert_in_range(differ, 0, 40);
		if (s == 0)
			memcpy(first, studio.picture.rgba, sizeof first);
		studio_close(&studio);
	}
}

static void a_camera_may_be_next_to_a_solid_but_not_within(void **state)
{
	(void)state;
	for (int kind = RB_SHAPE_BOX; kind <= RB_SHAPE_HULL; kind++)
		for (int within = 0; within < 2; within++) {
			struct studio studio;
			const double front = kind == RB_SHAPE_BOX    ? -0.25
			                     : kind == RB_SHAPE_HULL ? -1
			                                             : -0.4;
			studio_open(&studio);
			studio.camera.position.value = (rb_vec3){0, front - 1e-4, 0.0};
			if (within)
				studio.camera.position.value.y = front + 1e-4;
			studio.camera.look_at.value = (rb_vec3){0, 5, 0};
			studio_solid(&studio, (enum rb_shape_kind)kind, (rb_vec3){0, 0, 0},
			             (rb_vec3){0, 0, 0});
			studio_seal(&studio);
			if (!within) {
				studio_draw(&studio);
				assert_true(is_red(pixel_at(&studio, WIDTH / 2, HEIGHT / 2)));
			} else {
				assert_int_equal(rb_painter_draw(studio.painter, &studio.frame,
				                                 NULL, NULL, &studio.picture,
				                                 &studio.err),
				                 RB_ERR_SCENE);
				assert_non_null(strstr(studio.err.text, "is inside body '#0'"));
			}
			studio_close(&studio);
		}
}

static void wires_run_along_edges_and_outlines(void **state)
{
	/* On an edge or an outline, seen from the front. */
	static const rb_vec3 on[4] = {
		{0.6, -0.25, 0.1}, {0.4, 0, 0.1}, {0.4, 0, 0.1}, {0.5, -0.5, 0}};

	(void)state;
	for (int kind = RB_SHAPE_BOX; kind <= RB_SHAPE_HULL; kind++) {
		struct studio studio;
		studio_open(&studio);
		studio.camera.wireframe = true;
		memcpy(studio.camera.background, paper, sizeof paper);
		studio.camera.position.value = (rb_vec3){0, -40, 0};
		studio.camera.look_at.value = (rb_vec3){0, 0, 0};
		studio.camera.fov = 0.07;
		studio_solid(&studio, (enum rb_shape_kind)kind, (rb_vec3){0, 0, 0},
		             (rb_vec3){0, 0, 0});
		studio_seal(&studio);
		studio_draw(&studio);
		for (int side = -1; side <= 1; side += 2) {
			const rb_vec3 at = on[kind - RB_SHAPE_BOX];
			assert_true(pixel_of(&studio, (rb_vec3){side * at.x, at.y, at.z})[1] < 150);
			const rb_vec3 off = {side * (at.x + 0.1), at.y, at.z + 0.1};
			assert_int_equal(pixel_of(&studio, off)[1], 255);
			assert_int_equal(pixel_of(&studio, (rb_vec3){side * 0.2, -0.3, 0.1})[1],
			                 255);
		}
		studio_close(&studio);
	}
}

/* By the divergence theorem; a triangle that is turned round would count against it. */
static double volume_of(const struct rb_mesh *mesh, struct rb_mesh_range range, double shift)
{
	double sum = 0;

	for (int k = 0; k < range.count; k += 3) {
		rb_vec3 p[3];
		for (int c = 0; c < 3; c++) {
			const struct rb_mesh_vertex *v =
				&mesh->vertices[mesh->indices[range.first + (size_t)(k + c)]];
			p[c] = (rb_vec3){(double)v->unit[0], (double)v->unit[1],
			                 (double)v->unit[2] + shift * (double)v->unit[3]};
		}
		sum += rb_vec3_dot(p[0], rb_vec3_cross(p[1], p[2])) / 6;
	}
	return sum;
}

static void meshes_are_closed_and_look_outwards(void **state)
{
	struct studio studio;
	struct rb_mesh mesh = {0};
	struct rb_mesh_range range;
	const double pi = acos(-1);

	(void)state;
	studio_open(&studio);
	const struct rb_shape box = shape_of(&studio, RB_SHAPE_BOX);
	const struct rb_shape hull = shape_of(&studio, RB_SHAPE_HULL);
	const struct rb_scene *scene = &studio.lab.scene;
	assert_int_equal(rb_mesh_add_faces(&mesh, scene, &box, &range, NULL), RB_OK);
	assert_near(volume_of(&mesh, range, 0), 8, 1e-6);
	assert_int_equal(rb_mesh_add_faces(&mesh, scene, &hull, &range, NULL), RB_OK);
	assert_near(volume_of(&mesh, range, 0), 4.0 / 3, 1e-6);
	for (int sides = 12; sides <= 64; sides += 52) {
		const double off = 60.0 / (sides * sides);
		assert_int_equal(rb_mesh_add_round(&mesh, RB_FORM_CYLINDER, sides, &range, NULL),
		                 RB_OK);
		assert_near(volume_of(&mesh, range, 0), 2 * pi, 1e-5);
		assert_int_equal(rb_mesh_add_round(&mesh, RB_FORM_CAPSULE, sides, &range, NULL),
		                 RB_OK);
		assert_near(volume_of(&mesh, range, 2), 4 * pi / 3 + 4 * pi, off);
	}
	rb_mesh_release(&mesh);
	studio_close(&studio);
}

enum { CLIPS = 5, WAYS = 4 };

/* A triangle that stands upright and looks at the camera. */
static void add_terrain(struct studio *studio, rb_vec3 at)
{
	static const rb_vec3 corner[3] = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
	static const int triangle[1][3] = {{0, 1, 2}};
	const struct rb_terrain_def terrain = {
		.vertices = corner, .corners = triangle, .vertex_count = 3, .count = 1};
	struct rb_shape shape = {.kind = RB_SHAPE_TERRAIN};

	assert_int_equal(
		rb_scene_add_terrain(&studio->lab.scene, &terrain, &shape.solid, &studio->err),
		RB_OK);
	struct rb_body_def def = solid_def(shape, at, (rb_vec3){0, 0, 0});
	def.call = "terrain";
	def.mass = (double)NAN;
	def.angular_velocity = (rb_vec3){0, 0, 0};
	def.is_static = true;
	lab_add(&studio->lab, &def);
}

/* Where the row of all shapes has that one: SHAPES_APART m from the next along x. */
#define SHAPES_APART 2.2
static double place_of(int kind)
{
	return SHAPES_APART * (kind - 0.5 * (RB_SHAPE_KIND_COUNT - 1));
}

static void add_every_shape(struct studio *studio)
{
	for (int kind = 0; kind < RB_SHAPE_KIND_COUNT; kind++) {
		const rb_vec3 at = {place_of(kind), 0, 0};
		if (kind == RB_SHAPE_PLANE) { /* below all */
			lab_plane(&studio->lab, (rb_vec3){0, 0, -2}, (rb_vec3){0, 0, 1});
		} else if (kind == RB_SHAPE_RECTANGLE) {
			lab_rectangle(&studio->lab, at, (rb_vec3){0, -1, 0}, 1, 1);
		} else if (kind == RB_SHAPE_TERRAIN) {
			add_terrain(studio, at);
		} else if (kind == RB_SHAPE_UNION) {
			struct rb_solid_part part = {.shape = shape_of(studio, RB_SHAPE_BOX),
			                             .orientation = rb_quat_identity,
			                             .share = 1};
			struct rb_shape shape = {.kind = RB_SHAPE_UNION};
			assert_int_equal(rb_scene_add_union(&studio->lab.scene, &part, 1,
			                                    &shape.solid, &studio->err),
			                 RB_OK);
			const struct rb_body_def def = solid_def(shape, at, (rb_vec3){0, 0, 0});
			lab_add(&studio->lab, &def);
		} else {
			studio_solid(studio, (enum rb_shape_kind)kind, at, (rb_vec3){0, 0, 0});
		}
	}
}

static void clip(struct rb_camera_def *camera, int kind, bool frustum)
{
	const double near = 5, far = 50, slope = 0.4;

	if (kind & 1)
		camera->near = near;
	if (kind & 2)
		camera->far = far;
	if (!frustum)
		return;
	camera->has_frustum = true;
	/* of an orthographic picture as large as the other one is where the shapes are */
	const double half = slope * (camera->orthographic ? 30 : near);
	const double edges[6] = {-half, half, -half, half, near, far};
	memcpy(camera->frustum, edges, sizeof edges);
}

/* Something of each is drawn, by both styles, both projections, cut off near or far or not, from one sample to many. */
static void every_style_projection_clip_and_number_of_samples_draws_every_shape(void **state)
{
	static const int samples[WAYS] = {1, 2, 4, 16};

	(void)state;
	for (int way = 0; way < 4 * CLIPS * WAYS; way++) {
		struct studio studio;
		studio_open(&studio);
		studio.camera.wireframe = way % 2 == 1;
		studio.camera.samples = samples[way / (2 * CLIPS) % WAYS];
		studio.camera.orthographic = way >= 2 * CLIPS * WAYS;
		studio.camera.height = 20;
		clip(&studio.camera, way / 2 % CLIPS, way / 2 % CLIPS == CLIPS - 1);
		memcpy(studio.camera.background, paper, sizeof paper);
		studio.camera.position.value = (rb_vec3){0, -30, 1};
		studio.camera.look_at.value = (rb_vec3){0, 0, 0};
		add_every_shape(&studio);
		studio_seal(&studio);
		studio_draw(&studio);
		for (int kind = 0; kind < RB_SHAPE_KIND_COUNT; kind++) {
			const rb_vec3 at = {place_of(kind), 0, kind == RB_SHAPE_PLANE ? -2 : 0};
			int drawn = 0;
			for (int k = 0; k < 21 * 21; k++) {
				const rb_vec3 near_it = {at.x + 0.1 * (k % 21 - 10), at.y,
				                         at.z + 0.1 * (k / 21 - 10)};
				drawn += pixel_of(&studio, near_it)[1] < 250;
			}
			assert_true(drawn > 0);
		}
		studio_close(&studio);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(meshes_are_closed_and_look_outwards),
		cmocka_unit_test(silhouettes_are_those_of_the_shapes),
		cmocka_unit_test(faces_are_as_bright_as_they_look_to_the_light),
		cmocka_unit_test(what_is_convex_throws_no_shadow_on_itself),
		cmocka_unit_test(a_solid_throws_the_shadow_of_its_outline_on_a_plane),
		cmocka_unit_test(patterns_turn_with_solids),
		cmocka_unit_test(a_union_looks_like_its_parts),
		cmocka_unit_test(a_ball_in_a_box_sticks_out_as_far_as_it_does),
		cmocka_unit_test(millimetres_and_kilometres_look_the_same),
		cmocka_unit_test(a_camera_may_be_next_to_a_solid_but_not_within),
		cmocka_unit_test(wires_run_along_edges_and_outlines),
		cmocka_unit_test(
			every_style_projection_clip_and_number_of_samples_draws_every_shape),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
