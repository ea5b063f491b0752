/* SPDX-License-Identifier: MIT */
/*
 * Lines are instanced ribbons that the vertex shader widens across the line of sight, antialiased
 * by alpha; OpenGL's own wide lines are not in the core profile. Wire models draw the outline,
 * where lines of sight are tangent, and hidden edges fainter. Arrows have one scale for all
 * pictures of a film, so that lengths compare.
 */
#include "film/lines.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "film/arrows.h"
#include "film/glsl.h"
#include "film/joint_shapes.h"
#include "flow/joint_view.h"
#include "force/spring.h"
#include "math/quat.h"
#include "model/center.h"
#include "model/shape.h"

/* One ribbon, as the vertex shader reads it. */
struct stroke {
	float from[3], width; /* view coordinates; pixels */
	float to[3], head;    /* pixels; 0: none */
	float from_paint[4], to_paint[4];
};

struct list {
	struct stroke *row; /* owned */
	size_t count, capacity;
};

enum { LINE, ARROW, PROGRAM_COUNT };

struct rb_lines {
	struct rb_bodies_setup setup;
	struct rb_arrow_scales scales; /* the same in all pictures, at any `speed` of the film */
	struct list list[PROGRAM_COUNT];
	GLuint program[PROGRAM_COUNT], array, buffer;
};

static const double TRAIL_PX = 2.2, DOT_PX = 6, SPECK_PX = 4, WIRE_PX = 1.8, ARROW_PX = 3.2,
		    HEAD_PX = 13;
/* Widths are for this height of the picture; others scale with it. */
static const double USUAL_HEIGHT_PX = 720;

static const float spring_colour[3] = {0.08F, 0.08F, 0.09F}; /* linear light */

/* ---- set-up ---- */

/* Program for lines or arrows. */
static enum rb_status make_program(struct rb_lines *lines, int kind, struct rb_error *err)
{
	const struct rb_camera_def *camera = lines->setup.camera;
	const bool parallel = camera->orthographic && !camera->has_frustum;
	char defines[200];

	/*
	 * A parallel view's near and far are ours: lines beyond them are clamped unless the camera
	 * set them.
	 */
	snprintf(defines, sizeof defines,
	         "#define RIM %s\n#define JOINT %s\n#define KEPT(far) clamp(far, %s, %s)\n",
	         kind == ARROW ? "1.3" : "0.0", kind == ARROW ? "0.0" : "0.3",
	         parallel && isnan(camera->far) ? "-mix(depth.z, depth.w, 0.999)" : "-3e38",
	         parallel && isnan(camera->near) ? "-mix(depth.z, depth.w, 0.001)" : "3e38");
	const struct rb_glsl_parts parts = {
		.name = "line",
		.defines = defines,
		.vertex = {rb_shader_scene, rb_shader_line_vertex},
		.fragment = {rb_shader_scene, rb_shader_line_fragment},
	};
	const enum rb_status status = rb_glsl_program(&lines->program[kind], &parts, err);
	if (status != RB_OK)
		return status;
	const GLuint program = lines->program[kind];
	glUseProgram(program);
	glUniformBlockBinding(program, glGetUniformBlockIndex(program, "Scene"), 0);
	glUniform2f(rb_glsl_place(program, "size"), (float)lines->setup.camera->size_px[0],
	            (float)lines->setup.camera->size_px[1]);
	return RB_OK;
}

enum rb_status rb_lines_create(struct rb_lines **lines_out, const struct rb_bodies_setup *setup,
                               struct rb_error *err)
{
	enum rb_status status = RB_OK;

	*lines_out = NULL;
	struct rb_lines *lines = rb_memory_take(1, sizeof *lines);
	if (!lines)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw lines: out of memory");
	lines->setup = *setup;
	lines->scales = rb_arrow_scales_of(setup);
	glGenVertexArrays(1, &lines->array);
	glGenBuffers(1, &lines->buffer);
	for (int kind = 0; kind < PROGRAM_COUNT && status == RB_OK; kind++)
		status = make_program(lines, kind, err);
	if (status == RB_OK)
		status = rb_canvas_check("prepare lines", err);
	if (status != RB_OK) {
		rb_lines_destroy(lines);
		return status;
	}
	*lines_out = lines;
	return RB_OK;
}

void rb_lines_destroy(struct rb_lines *lines)
{
	if (!lines)
		return;
	for (int kind = 0; kind < PROGRAM_COUNT; kind++)
		rb_memory_free(lines->list[kind].row);
	rb_memory_free(lines);
}

/* ---- gathering ---- */

struct pen {
	struct list *list;
	double width_px, head_px;
	const float *colour;
	bool failed; /* memory is out */
};

static void put(float to[3], rb_vec3 from)
{
	to[0] = (float)from.x;
	to[1] = (float)from.y;
	to[2] = (float)from.z;
}

/* Appends a ribbon in view coordinates; after a failure of memory nothing is appended. */
static void stroke(struct pen *pen, rb_vec3 from, rb_vec3 to, double from_alpha, double to_alpha)
{
	struct list *list = pen->list;

	if (pen->failed ||
	    !rb_memory_reserve(&list->row, &list->capacity, list->count + 1, sizeof *list->row)) {
		pen->failed = true;
		return;
	}
	struct stroke *row = &list->row[list->count++];
	put(row->from, from);
	put(row->to, to);
	row->width = (float)pen->width_px;
	row->head = (float)pen->head_px;
	memcpy(row->from_paint, pen->colour, 3 * sizeof(float));
	memcpy(row->to_paint, pen->colour, 3 * sizeof(float));
	row->from_paint[3] = (float)from_alpha;
	row->to_paint[3] = (float)to_alpha;
}

/* Width in px for this picture. */
static double thickness(const struct rb_lines *lines, double px)
{
	return px * fmax(0.75, lines->setup.camera->size_px[1] / USUAL_HEIGHT_PX);
}

/*
 * Where a body is too small to be seen (planets on their orbits), a dot, as wide as it is long. It
 * is nearer than the body by three times its half: the ground beneath would hide its lower part.
 */
static void add_dot(struct pen *pen, const struct rb_view *view, rb_vec3 at, double radius,
                    double dot_px)
{
	const double half = 0.5 * dot_px * rb_view_pixel_at(view, -at.z), trail_px = pen->width_px;
	const rb_vec3 side = {half, 0, 0};

	if (!(radius < half) || (!view->parallel && at.z >= 0))
		return;
	if (view->parallel)
		at.z += 3 * half;
	else
		at = rb_vec3_scale(1 - fmin(0.5, 3 * half / -at.z), at);
	pen->width_px = dot_px;
	stroke(pen, rb_vec3_sub(at, side), rb_vec3_add(at, side), 1, 1);
	pen->width_px = trail_px;
}

/* Trails fade from old to new and end at the body. */
static void add_trails(struct rb_lines *lines, struct pen *pen, const struct rb_frame *frame,
                       const struct rb_view *view, const struct rb_trails *trails)
{
	const struct rb_model *model = lines->setup.model;

	pen->width_px = thickness(lines, TRAIL_PX);
	for (int p = 0; p < trails->path_count; p++) {
		const int index = trails->index[p];
		const double(*point)[3] = (const double(*)[3])trails->points[p];
		int count = trails->point_count;
		/* a picture between two frames: the later frame's point is there already */
		while (count > 0 && trails->time_s[count - 1] > frame->time_s)
			count--;
		if (count == 0)
			continue;
		pen->colour = lines->setup.looks->of[index].colour;
		const double start = trails->time_s[0], span = frame->time_s - start;
		rb_vec3 before = rb_view_point(view, rb_vec3_from(point[0]));
		double alpha_before = span > 0 ? 0.08 : 1;
		for (int k = 1; k <= count; k++) {
			const bool last = k == count;
			rb_vec3 here = {0, 0, 0};
			if (last) {
				const rb_pose pose = rb_view_pose(model, frame,
				                                  model->id_of[index]);
				here = rb_model_center(model, index, pose.position,
				                       pose.orientation);
			} else {
				here = rb_vec3_from(point[k]);
			}
			here = rb_view_point(view, here);
			const double time = last ? frame->time_s : trails->time_s[k];
			const double age = span > 0 ? (time - start) / span : 1;
			const double alpha = 0.08 + 0.87 * age;
			stroke(pen, before, here, alpha_before, alpha);
			before = here;
			alpha_before = alpha;
		}
		add_dot(pen, view, before, rb_model_reach(model, index), thickness(lines, DOT_PX));
	}
}

/*
 * A camera that has no place of its own stands as far away as all motion needs: a stone that falls
 * from a tower would not be seen. Not among many bodies, which dots would cover.
 */
static bool has_specks(const struct rb_bodies_setup *setup)
{
	return setup->camera->framed && setup->model->body_count <= RB_CAMERA_TRAILS_MAX;
}

/* A dot where a body is too small to be seen. */
static void add_speck(struct rb_lines *lines, struct pen *pen, const struct rb_frame *frame,
                      const struct rb_view *view, int index)
{
	const struct rb_model *model = lines->setup.model;

	if (!lines->setup.looks->of[index].visible ||
	    rb_shape_type(&model->shape[index])->form == RB_FORM_SURFACE)
		return;
	const rb_pose pose = rb_view_pose(model, frame, model->id_of[index]);
	const rb_vec3 at = index < model->body_count
	                           ? rb_model_center(model, index, pose.position, pose.orientation)
	                           : pose.position;
	pen->colour = lines->setup.looks->of[index].colour;
	add_dot(pen, view, rb_view_point(view, at), rb_model_reach(model, index),
	        thickness(lines, SPECK_PX));
}

/* Dots where bodies that move, or that a label points to, are too small to be seen. */
static void add_specks(struct rb_lines *lines, struct pen *pen, const struct rb_frame *frame,
                       const struct rb_view *view)
{
	const struct rb_model *model = lines->setup.model;
	const struct rb_camera_def *camera = lines->setup.camera;

	for (int i = 0; i < model->body_count && has_specks(&lines->setup); i++)
		add_speck(lines, pen, frame, view, i);
	for (int k = 0; k < camera->label_count; k++)
		add_speck(lines, pen, frame, view, model->index_of[camera->labels[k].body]);
}

/* A coil between two points. */
static void add_coil(struct pen *pen, const struct rb_view *view, rb_vec3 from, rb_vec3 to,
                     double width)
{
	const rb_vec3 span = rb_vec3_sub(to, from), way = rb_vec3_unit(span, (rb_vec3){0, 0, 1});
	const rb_vec3 x = rb_vec3_across(way), y = rb_vec3_cross(way, x);
	rb_vec3 last = from;

	for (int k = 1; k < RB_COIL_POINTS; k++) {
		const rb_vec3 point = rb_coil_point(k);
		rb_vec3 here = rb_vec3_add_scaled(from, point.z, span);

		here = rb_vec3_add_scaled(here, width * point.x, x);
		here = rb_vec3_add_scaled(here, width * point.y, y);
		stroke(pen, rb_view_point(view, last), rb_view_point(view, here), 1, 1);
		last = here;
	}
}

/* Springs of which an end is visible: coils, where there are very many lines. */
static void add_springs(struct rb_lines *lines, struct pen *pen, const struct rb_frame *frame,
                        const struct rb_view *view)
{
	const struct rb_model *model = lines->setup.model;
	const int count = rb_scene_element_count(model->scene, &rb_force_spring);
	rb_vec3 end[2];

	pen->width_px = thickness(lines, WIRE_PX);
	for (int k = 0; k < count; k++) {
		const struct rb_spring_def *spring = rb_scene_spring(model->scene, k);
		float own[3];

		for (int c = 0; c < 3; c++)
			own[c] = (float)rb_look_linear(spring->color[c]);
		pen->colour = isnan(spring->color[0]) ? spring_colour : own;
		if (!rb_spring_ends(model, frame, k, end))
			continue;
		if (count <= RB_COILS_MAX)
			add_coil(pen, view, end[0], end[1],
			         rb_spring_radius(model, k, lines->setup.looks->size_m));
		else
			stroke(pen, rb_view_point(view, end[0]), rb_view_point(view, end[1]), 1, 1);
	}
}

/* What rb_arrows_each is given to: one arrow. */
struct quiver {
	struct pen pen;
	const struct rb_view *view;
};

static void add_arrow(void *user, rb_vec3 from, rb_vec3 to, const double colour[3])
{
	struct quiver *const quiver = user;
	float paint[3];

	for (int k = 0; k < 3; k++)
		paint[k] = (float)rb_look_linear(colour[k]);
	quiver->pen.colour = paint;
	stroke(&quiver->pen, rb_view_point(quiver->view, from), rb_view_point(quiver->view, to), 1,
	       1);
}

/* Joints of a wire model: the middle lines of their pieces. */
static void add_joints(struct rb_lines *lines, struct pen *pen, const struct rb_frame *frame,
                       const struct rb_view *view)
{
	const struct rb_model *model = lines->setup.model;
	struct rb_joint_piece piece[RB_JOINT_PIECES_MAX];

	pen->width_px = thickness(lines, WIRE_PX);
	for (int k = 0; k < model->scene->joint_count; k++) {
		const int count = rb_joint_piece_count(model, k);

		pen->colour =
			lines->setup.looks->of[model->body_count + model->static_count + k].colour;
		if (!rb_joint_pieces(model, frame, k, piece))
			continue;
		for (int p = 0; p < count; p++) {
			const rb_vec3 half = rb_quat_rotate(piece[p].pose.orientation,
			                                    (rb_vec3){0, 0, 0.5 * piece[p].length});
			const rb_vec3 middle = piece[p].pose.position;

			stroke(pen, rb_view_point(view, rb_vec3_sub(middle, half)),
			       rb_view_point(view, rb_vec3_add(middle, half)), 1, 1);
		}
	}
}

/* ---- wire models ---- */

struct wire {
	struct pen *pen;
	const struct rb_view *view;
	rb_vec3 centre; /* view coordinates */
	bool in_front;  /* no part of it is faint */
};

/* Part of a circle: number of strokes, begin and end in turns. */
struct span {
	int count;
	double from, to;
};

/* Arc about `at` through at + x and at + y; strokes behind the body's centre are faint. */
static void arc(struct wire *wire, rb_vec3 at, rb_vec3 x, rb_vec3 y, struct span span)
{
	rb_vec3 before = at;

	for (int k = 0; k <= span.count; k++) {
		const double turns = span.from + (span.to - span.from) * k / span.count;
		const double angle = 2 * acos(-1) * turns;
		const rb_vec3 here = rb_vec3_add_scaled(rb_vec3_add_scaled(at, cos(angle), x),
		                                        sin(angle), y);
		const rb_vec3 half = rb_vec3_scale(0.5, rb_vec3_add(before, here));
		const bool behind = !wire->in_front && rb_vec3_dot(rb_vec3_sub(half, wire->centre),
		                                                   rb_view_way(wire->view, half)) >
		                                               1e-6 * rb_vec3_dot(x, x);
		if (k > 0)
			stroke(wire->pen, before, here, behind ? 0.28 : 1, behind ? 0.28 : 1);
		before = here;
	}
}

/* A whole circle. */
static void circle(struct wire *wire, rb_vec3 at, rb_vec3 x, rb_vec3 y, int count)
{
	arc(wire, at, x, y, (struct span){count, 0, 1});
}

/* Strokes for a circle of that size: their sagitta is below a pixel. */
static int strokes_for(const struct rb_view *view, rb_vec3 centre, double radius)
{
	const double px = radius / rb_view_pixel_at(view, rb_vec3_length(centre));

	return (int)fmin(64, fmax(8, 6 * sqrt(px)));
}

/* Three great circles and the outline. */
static void add_sphere(struct pen *pen, const struct rb_view *view, rb_pose pose, double radius)
{
	struct wire wire = {pen, view, rb_view_point(view, pose.position), false};
	const double lean = rb_view_lean(view, wire.centre, radius);
	const int count = strokes_for(view, wire.centre, radius);
	const rb_mat3 turn = rb_view_turn(view, pose.orientation);
	rb_vec3 axis[3];

	for (int k = 0; k < 3; k++)
		axis[k] = rb_vec3_scale(radius,
		                        (rb_vec3){turn.m[0][k], turn.m[1][k], turn.m[2][k]});
	for (int k = 0; k < 3; k++)
		circle(&wire, wire.centre, axis[k], axis[(k + 1) % 3], count);
	/* outline: the circle where lines of sight are tangent */
	const rb_vec3 to = rb_view_way(view, wire.centre), way = rb_vec3_unit(to, to);
	const rb_vec3 across = rb_vec3_across(way);
	const double reach = radius * sqrt(fmax(0, 1 - lean * lean));
	const rb_vec3 ring = rb_vec3_add_scaled(wire.centre, -radius * lean, way);
	wire.in_front = true;
	circle(&wire, ring, rb_vec3_scale(reach, across),
	       rb_vec3_scale(reach, rb_vec3_cross(way, across)), count);
}

/* Border of a rectangle. */
static void add_rectangle(struct pen *pen, const struct rb_view *view, rb_pose pose,
                          const double size[2])
{
	static const double corner[5][2] = {
		{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}};
	rb_vec3 at[5];

	for (int k = 0; k < 5; k++) {
		const rb_vec3 local = {corner[k][0] * size[0], corner[k][1] * size[1], 0};
		at[k] = rb_view_point(
			view, rb_vec3_add(pose.position, rb_quat_rotate(pose.orientation, local)));
	}
	for (int k = 0; k < 4; k++)
		stroke(pen, at[k], at[k + 1], 1, 1);
}

/* All edges faintly, those of visible faces over them. */
static void add_edges(struct pen *pen, const struct rb_view *view, rb_pose pose,
                      const struct rb_solid_part *part, const struct rb_solid *solid)
{
	const double *s = part->shape.size;
	const bool is_box = rb_shape_type(&part->shape)->form == RB_FORM_BOX;
	const rb_vec3 scale = is_box ? (rb_vec3){0.5 * s[0], 0.5 * s[1], 0.5 * s[2]}
	                             : (rb_vec3){1, 1, 1};
	const rb_mat3 turn = rb_view_turn(view, pose.orientation);
	const rb_vec3 origin = rb_view_point(view, pose.position);
#define CORNER(k)                                                                          \
	rb_vec3_add(origin, rb_mat3_apply(&turn, (rb_vec3){scale.x * solid->vertices[k].x, \
	                                                   scale.y * solid->vertices[k].y, \
	                                                   scale.z * solid->vertices[k].z}))

	for (int k = 0; k < solid->edge_count; k++)
		stroke(pen, CORNER(solid->edges[k][0]), CORNER(solid->edges[k][1]), 0.28, 0.28);
	for (int f = 0; f < solid->face_count; f++) {
		const int *loop = solid->loops + solid->face_first[f];
		const int count = solid->face_first[f + 1] - solid->face_first[f];
		const rb_vec3 n = rb_mat3_apply(&turn, rb_part_normal(solid, f));
		for (int k = 0; k < count && rb_vec3_dot(n, rb_view_way(view, CORNER(loop[0]))) < 0;
		     k++)
			stroke(pen, CORNER(loop[k]), CORNER(loop[(k + 1) % count]), 1, 1);
	}
#undef CORNER
}

/* End of a capsule: two half circles and the visible part of its outline. */
static void add_end(struct wire *wire, const rb_vec3 axis[3], rb_vec3 at, double radius, int count)
{
	const double lean = rb_view_lean(wire->view, at, radius);
	const rb_vec3 to = rb_view_way(wire->view, at), way = rb_vec3_unit(to, to);
	const rb_vec3 side = rb_vec3_across(way);
	const rb_vec3 up = rb_vec3_cross(way, side);
	const rb_vec3 ring = rb_vec3_add_scaled(at, -radius * lean, way);
	const double reach = radius * sqrt(fmax(0, 1 - lean * lean));

	wire->centre = at;
	wire->in_front = false;
	for (int k = 0; k < 2; k++)
		arc(wire, at, rb_vec3_scale(radius, axis[k]), rb_vec3_scale(radius, axis[2]),
		    (struct span){count, 0, 0.5});
	wire->in_front = true;
	/* the part of the tangent circle beyond the end of the straight part */
	const double a = rb_vec3_dot(side, axis[2]), b = rb_vec3_dot(up, axis[2]);
	const double off = -radius * lean * rb_vec3_dot(way, axis[2]), most = reach * hypot(a, b);
	if (off <= -most)
		return;
	const double half = off >= most ? 0.5 : acos(-off / most) / (2 * acos(-1));
	const double middle = atan2(b, a) / (2 * acos(-1));
	arc(wire, ring, rb_vec3_scale(reach, side), rb_vec3_scale(reach, up),
	    (struct span){count, middle - half, middle + half});
}

/* Capsules and cylinders. */
static void add_round(struct pen *pen, const struct rb_view *view, rb_pose pose,
                      const struct rb_shape *shape)
{
	const rb_vec3 middle = rb_view_point(view, pose.position);
	const rb_mat3 turn = rb_view_turn(view, pose.orientation);
	const enum rb_shape_form form = rb_shape_type(shape)->form;
	const double r = shape->radius;
	const int count = strokes_for(view, middle, r);
	struct wire wire = {pen, view, middle, false};
	rb_vec3 axis[3], end[2];

	for (int k = 0; k < 3; k++)
		axis[k] = (rb_vec3){turn.m[0][k], turn.m[1][k], turn.m[2][k]};
	for (int k = 0; k < 2; k++) {
		end[k] = rb_vec3_add_scaled(middle, 0.5 * shape->size[2], axis[2]);
		/* the circle of a visible flat end is in front */
		wire.in_front = form == RB_FORM_CYLINDER &&
		                rb_vec3_dot(rb_view_way(view, end[k]), axis[2]) < 0;
		wire.centre = end[k];
		circle(&wire, end[k], rb_vec3_scale(r, axis[0]), rb_vec3_scale(r, axis[1]), count);
		if (form == RB_FORM_CAPSULE)
			add_end(&wire, axis, end[k], r, count);
		axis[1] = rb_vec3_neg(axis[1]);
		axis[2] = rb_vec3_neg(axis[2]);
	}
	/* silhouette lines, where planes through the eye are tangent to the mantle */
	const rb_vec3 away = rb_vec3_neg(rb_vec3_reject(rb_view_way(view, middle), axis[2]));
	const double distance = rb_vec3_length(away);
	const double lean = view->parallel ? 0 : r / distance;
	if (!(lean < 1) || !(distance > 0))
		return;
	const rb_vec3 x = rb_vec3_scale(1 / distance, away), y = rb_vec3_cross(axis[2], x);
	for (int k = -1; k <= 1; k += 2) {
		const rb_vec3 side = rb_vec3_add_scaled(rb_vec3_scale(r * lean, x),
		                                        k * r * sqrt(1 - lean * lean), y);
		stroke(pen, rb_vec3_add(end[0], side), rb_vec3_add(end[1], side), 1, 1);
	}
}

/* Wire model of one part. */
static void add_part(struct pen *pen, const struct rb_scene *scene, const struct rb_view *view,
                     rb_pose body, const struct rb_solid_part *part)
{
	const rb_pose pose = rb_view_part(body, part);
	const struct rb_solid *solid = rb_part_faces(scene, &part->shape);

	/* strokes that cross the eye's plane would be inverted: bodies there are left out */
	if (!view->parallel &&
	    rb_view_point(view, pose.position).z > rb_part_size(scene, &part->shape).reach)
		return;
	if (rb_shape_type(&part->shape)->form == RB_FORM_BALL)
		add_sphere(pen, view, pose, part->shape.radius);
	else if (solid)
		add_edges(pen, view, pose, part, solid);
	else
		add_round(pen, view, pose, &part->shape);
}

/* Wire models of all visible bodies. */
static void add_wires(struct rb_lines *lines, struct pen *pen, const struct rb_frame *frame,
                      const struct rb_view *view)
{
	const struct rb_model *model = lines->setup.model;

	pen->width_px = thickness(lines, WIRE_PX);
	for (int i = 0; i < model->body_count + model->static_count; i++) {
		const struct rb_shape *shape = &model->shape[i];
		const rb_pose pose = rb_view_pose(model, frame, model->id_of[i]);
		if (!lines->setup.looks->of[i].visible)
			continue;
		pen->colour = lines->setup.looks->of[i].colour;
		if (shape->kind == RB_SHAPE_RECTANGLE)
			add_rectangle(pen, view, pose, shape->size);
		if (shape->kind == RB_SHAPE_RECTANGLE || shape->kind == RB_SHAPE_PLANE)
			continue;
		struct rb_solid_part own;
		int count;
		const struct rb_solid_part *parts = rb_parts_of(model->scene, shape, &own, &count);
		for (int p = 0; p < count; p++)
			add_part(pen, model->scene, view, pose, &parts[p]);
	}
}

/* ---- drawing ---- */

/* Uploads and draws one list. */
static void draw_list(const struct rb_lines *lines, int kind)
{
	static const size_t places[4] = {offsetof(struct stroke, from), offsetof(struct stroke, to),
	                                 offsetof(struct stroke, from_paint),
	                                 offsetof(struct stroke, to_paint)};
	const struct list *list = &lines->list[kind];

	if (list->count == 0)
		return;
	glBindVertexArray(lines->array);
	glBindBuffer(GL_ARRAY_BUFFER, lines->buffer);
	glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(list->count * sizeof *list->row), list->row,
	             GL_STREAM_DRAW);
	for (GLuint k = 0; k < 4; k++) {
		glEnableVertexAttribArray(k);
		glVertexAttribDivisor(k, 1);
		glVertexAttribPointer(k, 4, GL_FLOAT, GL_FALSE, sizeof *list->row,
		                      (const void *)places[k]);
	}
	glUseProgram(lines->program[kind]);
	glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, (GLsizei)list->count);
}

bool rb_lines_needed(const struct rb_bodies_setup *setup)
{
	const struct rb_camera_def *const camera = setup->camera;

	return camera->wireframe || camera->vectors || camera->trail_count > 0 ||
	       camera->label_count > 0 || has_specks(setup) ||
	       rb_scene_element_count(setup->model->scene, &rb_force_spring) > 0;
}

enum rb_status rb_lines_draw(struct rb_lines *lines, const struct rb_frame *frame,
                             const struct rb_view *view, const struct rb_trails *trails,
                             struct rb_error *err)
{
	const struct rb_camera_def *camera = lines->setup.camera;
	struct pen pen = {.list = &lines->list[LINE]};
	struct quiver quiver = {{.list = &lines->list[ARROW],
	                         .width_px = thickness(lines, ARROW_PX),
	                         .head_px = thickness(lines, HEAD_PX)},
	                        view};

	for (int kind = 0; kind < PROGRAM_COUNT; kind++)
		lines->list[kind].count = 0;
	if (camera->wireframe) {
		add_wires(lines, &pen, frame, view);
		add_joints(lines, &pen, frame, view);
	}
	add_springs(lines, &pen, frame, view);
	if (trails)
		add_trails(lines, &pen, frame, view, trails);
	add_specks(lines, &pen, frame, view);
	rb_arrows_each(&lines->setup, &lines->scales, frame, add_arrow, &quiver);
	if (pen.failed || quiver.pen.failed)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot draw lines: out of memory");
	draw_list(lines, LINE);
	/* arrows begin inside of bodies: drawn over everything */
	glDisable(GL_DEPTH_TEST);
	draw_list(lines, ARROW);
	glEnable(GL_DEPTH_TEST);
	return rb_canvas_check("draw lines", err);
}
