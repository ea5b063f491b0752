/* SPDX-License-Identifier: MIT */
/*
 * Lights become defines of the shaders, unrolled, because loops over lights in GLSL would index
 * samplers by variables, which OpenGL 3.3 forbids. Shadow maps are fitted to the casters in each
 * picture: for a sun an orthographic box whose size changes in steps and whose texels stay fixed in
 * the world, so that shadow edges do not crawl when the camera moves; for a lamp one cone.
 */
#include "film/light.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/error.h"
#include "film/appearance.h"
#include "math/quat.h"

/* Empty texels around a map (what lies outside is lit), and its smallest side. */
enum { MARGIN = 4, SIDE_MIN = 64 };
static const double TEXELS_PER_PIXEL = 0.55; /* of shadow maps, at the nearest caster */
/*
 * vec4 varyings used for lights: OpenGL 3.3 guarantees 15, Mesa has 32, bodies need fewer than 10.
 */
enum { CARRIED_MAX = 20 };

/* Linear light from sRGB. */
static void set(double to[3], double r, double g, double b)
{
	to[0] = rb_look_linear(r);
	to[1] = rb_look_linear(g);
	to[2] = rb_look_linear(b);
}

static void scale(double to[3], const double from[3], double by)
{
	for (int k = 0; k < 3; k++)
		to[k] = by * from[k];
}

/* Mean position of the bodies at the start, without infinite planes. */
static rb_vec3 middle(const struct rb_model *model)
{
	rb_vec3 sum = {0, 0, 0};
	int count = 0;

	for (int i = 0; i < model->body_count + model->static_count; i++)
		if (model->shape[i].kind != RB_SHAPE_PLANE) {
			sum = rb_vec3_add(sum, model->position[i]);
			count++;
		}
	return count > 0 ? rb_vec3_scale(1.0 / count, sum) : sum;
}

/* A warm sun and a weak blue fill, relative to up and north. */
static void make_default(struct rb_lights *lights, bool shadows)
{
	const rb_vec3 up = lights->up;
	const rb_vec3 y = fabs(up.y) < 0.9 ? (rb_vec3){0, 1, 0} : (rb_vec3){0, 0, -1};
	const rb_vec3 north = rb_vec3_unit(rb_vec3_add_scaled(y, -rb_vec3_dot(up, y), up), y);
	const rb_vec3 east = rb_vec3_cross(north, up);
	struct rb_light *sun = &lights->of[0], *fill = &lights->of[1];

	/* sun from behind the default camera's left shoulder, fill from its right */
	const rb_vec3 to_sun = rb_vec3_add(
		rb_vec3_add(rb_vec3_scale(-0.32, east), rb_vec3_scale(-0.52, north)), up);
	const rb_vec3 to_fill = rb_vec3_add(
		rb_vec3_add(rb_vec3_scale(0.9, east), rb_vec3_scale(0.15, north)),
		rb_vec3_scale(0.25, up));
	*sun = (struct rb_light){.shadow = shadows, .place = rb_vec3_unit(to_sun, up)};
	*fill = (struct rb_light){.place = rb_vec3_unit(to_fill, up)};
	set(sun->colour, 1.0, 0.965, 0.90);
	scale(sun->colour, sun->colour, 0.80);
	set(fill->colour, 0.75, 0.87, 1.0);
	scale(fill->colour, fill->colour, 0.14);
	lights->count = 2;
}

/* A scene's own ambient light replaces the sky's. */
static void add_ambient(struct rb_lights *lights, const double colour[3], bool more)
{
	for (int c = 0; c < 3; c++) {
		lights->ambient_up[c] = (more ? lights->ambient_up[c] : 0) + colour[c];
		lights->ambient_down[c] = (more ? lights->ambient_down[c] : 0) + colour[c];
	}
}

/* Spot: cosine of its edge, and the rise of its soft border. */
static void make_cone(struct rb_light *light, const struct rb_light_def *def)
{
	light->spot = true;
	light->axis = rb_vec3_unit(rb_vec3_sub(def->position, def->look_at), light->axis);
	light->edge = cos(def->angle);
	/* steepest rise that single precision can tell from a step */
	light->rise = 1 / fmax(cos(def->angle * (1 - def->softness)) - light->edge,
	                       (double)FLT_EPSILON);
}

void rb_lights_make(struct rb_lights *lights, const struct rb_model *model,
                    const struct rb_camera_def *camera)
{
	const rb_vec3 z = {0, 0, 1};
	const rb_vec3 wanted = camera->up.source == RB_CAMERA_FIXED
	                               ? rb_vec3_unit(camera->up.value, z)
	                               : z;

	*lights = (struct rb_lights){.parallel = camera->orthographic};
	lights->up = rb_vec3_unit(rb_vec3_neg(model->scene->world.gravity), wanted);
	lights->plain = !isnan(camera->background[0]);
	set(lights->zenith, 0.36, 0.56, 0.80);
	set(lights->horizon, 0.84, 0.89, 0.94);
	set(lights->nadir, 0.50, 0.53, 0.57);
	if (lights->plain) {
		set(lights->horizon, camera->background[0], camera->background[1],
		    camera->background[2]);
		memcpy(lights->zenith, lights->horizon, sizeof lights->zenith);
		memcpy(lights->nadir, lights->horizon, sizeof lights->nadir);
	}
	const double ambient = camera->light_count < 0 ? 1 : 0.5;
	set(lights->ambient_up, 0.56, 0.61, 0.67);
	set(lights->ambient_down, 0.42, 0.41, 0.40);
	scale(lights->ambient_up, lights->ambient_up, ambient);
	scale(lights->ambient_down, lights->ambient_down, ambient);
	if (camera->light_count < 0) {
		make_default(lights, camera->shadows);
		return;
	}
	const rb_vec3 centre = middle(model);
	bool own_ambient = false;
	for (int k = 0; k < camera->light_count; k++) {
		const struct rb_light_def *def = &camera->lights[k];
		struct rb_light light = {.lamp = def->kind != RB_LIGHT_SUN,
		                         .shadow = camera->shadows,
		                         .place = def->position};
		set(light.colour, def->color[0], def->color[1], def->color[2]);
		scale(light.colour, light.colour, def->intensity);
		if (def->kind == RB_LIGHT_AMBIENT) {
			add_ambient(lights, light.colour, own_ambient);
			own_ambient = true;
			continue;
		}
		if (def->kind == RB_LIGHT_SUN)
			light.place = rb_vec3_unit(def->position, lights->up);
		if (def->kind == RB_LIGHT_SPOT)
			make_cone(&light, def);
		light.reach_m = rb_vec3_length(rb_vec3_sub(def->position, centre));
		lights->of[lights->count++] = light;
	}
	RB_ASSERT(lights->count <= (int)(sizeof lights->of / sizeof lights->of[0]));
}

/* A vec4 of floats. */
static void put(float to[4], rb_vec3 from, double last)
{
	to[0] = (float)from.x;
	to[1] = (float)from.y;
	to[2] = (float)from.z;
	to[3] = (float)last;
}

void rb_lights_tell(const struct rb_lights *lights, const struct rb_view *view, bool from_zero,
                    struct rb_shader_block *block)
{
	double a, b;

	memset(block, 0, sizeof *block);
	rb_view_projection(view, from_zero, block->projection);
	rb_view_depth(view, &a, &b);
	block->window[0] = (float)view->left_slope;
	block->window[1] = (float)view->top_slope;
	block->window[2] = (float)((view->right_slope - view->left_slope) / view->width);
	block->window[3] = (float)((view->bottom_slope - view->top_slope) / view->height);
	block->depth[0] = (float)a;
	block->depth[1] = (float)b;
	block->depth[2] = (float)view->near;
	block->depth[3] = isinf(view->far) ? 3e38F : (float)view->far;
	block->pixel[0] = (float)rb_view_pixel_size(view);
	put(block->axes[0], view->right, 0);
	put(block->axes[1], view->up, 0);
	put(block->axes[2], view->back, 0);
	for (int k = 0; k < lights->count; k++) {
		const struct rb_light *light = &lights->of[k];
		if (light->lamp)
			put(block->place[k], rb_vec3_sub(light->place, view->eye),
			    light->reach_m > 0 ? 1 / (light->reach_m * light->reach_m) : 0);
	}
}

/* ---- in the texts of shaders ---- */

struct text {
	char *at;
	size_t room, used;
};

static void say(struct text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void say(struct text *text, const char *format, ...)
{
	va_list values;

	RB_ASSERT(text->used < text->room);
	va_start(values, format);
	const int length = vsnprintf(text->at + text->used, text->room - text->used, format,
	                             values);
	va_end(values);
	RB_ASSERT(length >= 0 && text->used + (size_t)length < text->room);
	text->used += (size_t)length;
}

/* A colour as a define. */
static void say_colour(struct text *text, const char *name, const double colour[3])
{
	say(text, "#define %s vec3(%.7g, %.7g, %.7g)\n", name, colour[0], colour[1], colour[2]);
}

static void say_vector(struct text *text, rb_vec3 v)
{
	say(text, "vec3(%.9g, %.9g, %.9g)", v.x, v.y, v.z);
}

/* vec4 varyings of a light: rows of its shadow matrix, and a lamp's position. */
static int rows_of(const struct rb_light *light)
{
	return !light->shadow ? 0 : light->lamp ? 4 : 2;
}

static int carried(const struct rb_light *light)
{
	return rows_of(light) + light->lamp;
}

/* Varyings of the first `count` lights, as macros for both stages. */
static void say_carry(struct text *text, const struct rb_lights *lights, int count)
{
	say(text, "#define CARRY(way) ");
	for (int k = 0; k < count; k++) {
		if (lights->of[k].lamp)
			say(text, " flat way vec4 sent_place%d;", k);
		for (int r = 0; r < rows_of(&lights->of[k]); r++)
			say(text, " flat way vec4 sent_row%d;", 4 * k + r);
	}
	say(text, "\n#define SEND ");
	for (int k = 0; k < count; k++) {
		if (lights->of[k].lamp)
			say(text, " sent_place%d = place[%d];", k, k);
		for (int r = 0; r < rows_of(&lights->of[k]); r++)
			say(text, " sent_row%d = shadow[%d];", 4 * k + r, 4 * k + r);
	}
	say(text, "\n");
}

/*
 * Axes across a sun in world coordinates: they do not turn with the camera, so texels stay in
 * place.
 */
static void across(const struct rb_light *sun, rb_vec3 axis[2])
{
	axis[0] = rb_vec3_across(sun->place);
	axis[1] = rb_vec3_cross(sun->place, axis[0]);
}

/* A call of the light's macro. */
static void say_light(struct text *text, const struct rb_light *light, int k, bool is_carried)
{
	const double *c = light->colour;
	rb_vec3 axis[2];

	say(text, "%s%s(vec3(%.7g, %.7g, %.7g), ",
	    light->spot   ? "SPOT"
	    : light->lamp ? "LAMP"
	                  : "SUN",
	    light->shadow ? "_SHADOW" : "", c[0], c[1], c[2]);
	if (light->lamp)
		say(text, is_carried ? "sent_place%d" : "place[%d]", k);
	else
		say_vector(text, light->place);
	if (light->spot) {
		say(text, ", ");
		say_vector(text, light->axis);
		say(text, ", %.9e, %.9e", light->edge, light->rise);
	}
	across(light, axis);
	for (int r = 0; r < 2 && light->shadow && !light->lamp; r++) {
		say(text, ", ");
		say_vector(text, axis[r]);
	}
	if (light->shadow)
		say(text, ", map%d", k);
	for (int r = 0; r < rows_of(light); r++)
		say(text, is_carried ? ", sent_row%d" : ", shadow[%d]", 4 * k + r);
	say(text, ") ");
}

void rb_lights_define(const struct rb_lights *lights, bool all, char *defines, size_t room)
{
	struct text text = {.at = defines, .room = room};
	const int count = all ? lights->count : 0;
	int first = 0, budget = CARRIED_MAX;

	while (first < count && carried(&lights->of[first]) <= budget)
		budget -= carried(&lights->of[first++]);
	say(&text, "%s", lights->parallel ? "#define PARALLEL\n" : "");
	say_colour(&text, "ZENITH", lights->zenith);
	say_colour(&text, "HORIZON", lights->horizon);
	say_colour(&text, "NADIR", lights->nadir);
	say_colour(&text, "AMBIENT_UP", lights->ambient_up);
	say_colour(&text, "AMBIENT_DOWN", lights->ambient_down);
	say(&text, "#define UP ");
	say_vector(&text, lights->up);
	say(&text, "\n");
	say_carry(&text, lights, first);
	say(&text, "#define LIGHTS ");
	for (int k = 0; k < count; k++)
		say_light(&text, &lights->of[k], k, k < first);
	say(&text, "\n");
}

/* ---- shadow maps ---- */

struct box {
	double low[3], high[3];
	bool any;
};

/* Extends the box by a sphere. */
static void grow(struct box *box, rb_vec3 p, double r)
{
	const double c[3] = {p.x, p.y, p.z};

	for (int k = 0; k < 3; k++) {
		box->low[k] = box->any ? fmin(box->low[k], c[k] - r) : c[k] - r;
		box->high[k] = box->any ? fmax(box->high[k], c[k] + r) : c[k] + r;
	}
	box->any = true;
}

struct axes {
	rb_vec3 x, y, z; /* view coordinates; z towards the light */
};

/* Components along the axes. */
static rb_vec3 along(const struct axes *axes, rb_vec3 p)
{
	return (rb_vec3){rb_vec3_dot(axes->x, p), rb_vec3_dot(axes->y, p), rb_vec3_dot(axes->z, p)};
}

/* Right-handed axes with that z. */
static struct axes axes_of(rb_vec3 z)
{
	const rb_vec3 x = rb_vec3_across(z);

	return (struct axes){x, rb_vec3_cross(z, x), z};
}

static rb_vec3 corner_of(const float p[4])
{
	return (rb_vec3){(double)p[0], (double)p[1], (double)p[2]};
}

static void grow_corners(struct box *box, const float (*corner)[4], int count,
                         const struct axes *axes, rb_vec3 origin)
{
	for (int k = 0; k < count; k++)
		grow(box, along(axes, rb_vec3_sub(corner_of(corner[k]), origin)), 0);
}

/* True if a box is smaller than so many pixels. */
static bool is_dot(const struct rb_view *view, const float (*corner)[4], double pixels)
{
	const rb_vec3 one = corner_of(corner[0]), other = corner_of(corner[7]);

	const double distance = rb_vec3_length(rb_vec3_scale(0.5, rb_vec3_add(one, other)));
	return 0.5 * rb_vec3_length(rb_vec3_sub(other, one)) <
	       pixels * rb_view_pixel_at(view, distance);
}

/*
 * Distance of the nearest caster before the eye, for those behind it are not seen closely: of those
 * that move, if there are any. Where lines of sight are parallel, pixels have one size anywhere.
 */
static double nearest_of(const struct rb_view *view, const struct rb_casters *casters)
{
	const bool moving = casters->ball_count > 0 || casters->solid_corner_count > 0;
	double nearest = (double)INFINITY;

	if (view->parallel)
		return 0;
	for (int k = 0; k < casters->ball_count; k++) {
		const float *ball = casters->balls + (size_t)k * (size_t)casters->stride;
		if (ball[2] - ball[3] < 0)
			nearest = fmin(nearest,
			               sqrt((double)(ball[0] * ball[0] + ball[1] * ball[1] +
			                             ball[2] * ball[2])));
	}
	for (int k = 0; k < casters->solid_corner_count; k++)
		if (casters->solids[k][2] < 0)
			nearest = fmin(nearest, rb_vec3_length(corner_of(casters->solids[k])));
	for (int k = 0; k < casters->corner_count && !moving; k++)
		nearest = fmin(nearest, fabs((double)casters->corners[k][2]));
	for (int k = 0; k < casters->still_count && !moving; k++)
		nearest = fmin(nearest, fabs((double)casters->still[k][2]));
	return nearest;
}

/* Side of what a map of so many texels shows, each as fine as the nearest caster asks for, m. */
static double full_side(const struct rb_view *view, const struct rb_casters *casters, int whole)
{
	const double nearest = nearest_of(view, casters);

	return isfinite(nearest)
	               ? (whole - 2 * MARGIN) / TEXELS_PER_PIXEL * rb_view_pixel_at(view, nearest)
	               : 0;
}

/* How far beside the moving ones a map looks for what throws shadows: as far as they are large. */
static double room_of(const struct box *moving)
{
	return fmax(moving->high[0] - moving->low[0], moving->high[1] - moving->low[1]);
}

/* Cuts a box to what is at most so far beside the moving ones. */
static void cut(struct box *box, const struct box *moving, double room)
{
	for (int k = 0; k < 2; k++) {
		box->low[k] = fmax(box->low[k], moving->low[k] - room);
		box->high[k] = fmin(box->high[k], moving->high[k] + room);
	}
}

/*
 * Extends the box by that of a static caster. What is larger than a whole map, like a slab that is
 * the ground, only as far as the moving ones are large: it would leave them no texels.
 */
static void grow_still(struct box *box, struct box one, const struct box *moving, double full)
{
	if (moving->any && room_of(&one) > full)
		cut(&one, moving, room_of(moving));
	for (int c = 0; c < 3; c++) {
		box->low[c] = box->any ? fmin(box->low[c], one.low[c]) : one.low[c];
		box->high[c] = box->any ? fmax(box->high[c], one.high[c]) : one.high[c];
	}
	box->any = true;
}

/* Box of so many corners. */
static struct box box_of(const float (*corner)[4], int count, const struct axes *axes,
                         rb_vec3 origin)
{
	struct box box = {.any = false};

	grow_corners(&box, corner, count, axes, origin);
	return box;
}

/* Box of the casters that are at least a fraction of a pixel large, relative to `origin`. */
static struct box bounds(const struct rb_view *view, const struct rb_casters *casters,
                         const struct axes *axes, rb_vec3 origin, int whole)
{
	const double least = 0.3;
	struct box box = {.any = false};

	for (int k = 0; k < casters->ball_count; k++) {
		const float *ball = casters->balls + (size_t)k * (size_t)casters->stride;
		const rb_vec3 c = {(double)ball[0], (double)ball[1], (double)ball[2]};
		const double r = (double)ball[3];
		if (r < least * rb_view_pixel_at(view, rb_vec3_length(c)))
			continue;
		grow(&box, along(axes, rb_vec3_sub(c, origin)), r);
	}
	for (int k = 0; k + 8 <= casters->solid_corner_count; k += 8)
		if (!is_dot(view, casters->solids + k, least))
			grow_corners(&box, casters->solids + k, 8, axes, origin);
	const struct box moving = box;
	const double full = full_side(view, casters, whole);
	for (int k = 0; k + 4 <= casters->corner_count; k += 4)
		grow_still(&box, box_of(casters->corners + k, 4, axes, origin), &moving, full);
	for (int k = 0; k + 8 <= casters->still_count; k += 8)
		grow_still(&box, box_of(casters->still + k, 8, axes, origin), &moving, full);
	if (moving.any)
		cut(&box, &moving, fmax(room_of(&moving), 0.5 * (full - room_of(&moving))));
	return box;
}

/* Side of the map: texels about two pixels wide at the nearest caster, which is soft and cheap. */
static int side_for(const struct rb_view *view, const struct rb_casters *casters, double size,
                    int whole)
{
	const double texels = size /
	                      rb_view_pixel_at(view, fmax(nearest_of(view, casters), 0.05 * size));
	const double most = whole - 2 * MARGIN;
	return (int)fmax(SIDE_MIN, fmin(most, ceil(TEXELS_PER_PIXEL * texels)));
}

/* Column-major floats from rows. */
static void transpose(float to[16], double rows[4][4])
{
	for (int r = 0; r < 4; r++)
		for (int c = 0; c < 4; c++)
			to[4 * c + r] = (float)rows[r][c];
}

/* Matrix from view coordinates to the corner of the texture that holds the map. */
static void make_lookup(struct rb_shadow_fit *fit, double rows[4][4], int whole)
{
	const double part = 0.5 * fit->side / whole;
	double to[4][4];

	for (int c = 0; c < 4; c++) {
		to[0][c] = part * rows[0][c] + (part + (double)MARGIN / whole) * rows[3][c];
		to[1][c] = part * rows[1][c] + (part + (double)MARGIN / whole) * rows[3][c];
		to[2][c] = 0.5 * rows[2][c] + 0.5 * rows[3][c];
		to[3][c] = rows[3][c];
	}
	transpose(fit->lookup, to);
	transpose(fit->to_map, rows);
}

static void row(double to[4], rb_vec3 axis, double by, double offset)
{
	to[0] = by * axis.x;
	to[1] = by * axis.y;
	to[2] = by * axis.z;
	to[3] = offset;
}

/* Orthographic map along the sun, snapped to texels in the world. */
static void fit_sun(struct rb_shadow_fit *fit, const struct rb_light *light,
                    const struct rb_view *view, const struct rb_casters *casters, int whole)
{
	rb_vec3 axis[2];
	across(light, axis);
	const struct axes axes = {rb_view_direction(view, axis[0]),
	                          rb_view_direction(view, axis[1]),
	                          rb_view_direction(view, light->place)};
	const struct box box = bounds(view, casters, &axes, (rb_vec3){0, 0, 0}, whole);
	if (!box.any)
		return;
	double size = fmax(box.high[0] - box.low[0], box.high[1] - box.low[1]);
	if (!(size > 0))
		return;
	/* in steps of an eighth of an octave, so that texels keep their size */
	size = exp2(ceil(8 * log2(size * 1.02)) / 8);
	fit->side = side_for(view, casters, size, whole);
	const double texel = size / fit->side;
	const double eye[2] = {rb_vec3_dot(axis[0], view->eye), rb_vec3_dot(axis[1], view->eye)};
	double middle_at[2], rows[4][4] = {{0}};
	for (int k = 0; k < 2; k++) {
		middle_at[k] = 0.5 * (box.low[k] + box.high[k]);
		middle_at[k] = rint((middle_at[k] + eye[k]) / texel) * texel - eye[k];
	}
	const double room = 0.01 * (box.high[2] - box.low[2]) + 1e-6 * size;
	const double low = box.low[2] - room, high = box.high[2] + room;
	row(rows[0], axes.x, 2 / size, -2 * middle_at[0] / size);
	row(rows[1], axes.y, 2 / size, -2 * middle_at[1] / size);
	row(rows[2], axes.z, -2 / (high - low), (high + low) / (high - low));
	rows[3][3] = 1;
	put(fit->source, axes.z, 0);
	make_lookup(fit, rows, whole);
}

/* Perspective map of a cone from the lamp that holds all casters. */
static void fit_lamp(struct rb_shadow_fit *fit, const struct rb_light *light,
                     const struct rb_view *view, const struct rb_casters *casters, int whole)
{
	const rb_vec3 lamp = rb_view_point(view, light->place);
	const struct axes plain = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
	const struct box box = bounds(view, casters, &plain, (rb_vec3){0, 0, 0}, whole);

	if (!box.any)
		return;
	const rb_vec3 centre = {0.5 * (box.low[0] + box.high[0]), 0.5 * (box.low[1] + box.high[1]),
	                        0.5 * (box.low[2] + box.high[2])};
	const rb_vec3 half = {0.5 * (box.high[0] - box.low[0]), 0.5 * (box.high[1] - box.low[1]),
	                      0.5 * (box.high[2] - box.low[2])};
	const double radius = rb_vec3_length(half);
	const rb_vec3 away = rb_vec3_sub(lamp, centre);
	const double distance = rb_vec3_length(away);
	if (!(radius > 0))
		return;
	/* a lamp among the bodies gets a cone of 72 degrees either way */
	const double sine = fmin(distance > 0 ? radius / distance : 1, 0.95);
	const double slope = sine / sqrt(1 - sine * sine) * 1.02;
	const double far = distance + radius;
	const double near = fmax(distance - radius, 0.002 * far);
	const struct axes axes = axes_of(rb_vec3_unit(away, rb_view_direction(view, view->up)));
	double rows[4][4];

	fit->side = side_for(view, casters, 2 * radius, whole);
	const rb_vec3 at = along(&axes, lamp);
	row(rows[0], axes.x, 1 / slope, -at.x / slope);
	row(rows[1], axes.y, 1 / slope, -at.y / slope);
	row(rows[3], axes.z, -1, at.z);
	/* z_clip = (far + near)/(far - near) w - 2 far near/(far - near) */
	const double m = (far + near) / (far - near);
	for (int c = 0; c < 4; c++)
		rows[2][c] = m * rows[3][c];
	rows[2][3] -= 2 * far * near / (far - near);
	put(fit->source, lamp, 1);
	make_lookup(fit, rows, whole);
}

void rb_shadow_fit(struct rb_shadow_fit *fit, const struct rb_light *light,
                   const struct rb_view *view, const struct rb_casters *casters, int whole)
{
	*fit = (struct rb_shadow_fit){0};
	if (light->lamp)
		fit_lamp(fit, light, view, casters, whole);
	else
		fit_sun(fit, light, view, casters, whole);
}

void rb_shadow_tell(const struct rb_shadow_fit *fit, const struct rb_light *light,
                    const struct rb_view *view, float rows[4][4])
{
	const float *m = fit->lookup;
	rb_vec3 row[4], axis[2];

	for (int r = 0; r < 4; r++) {
		row[r] = rb_vec3_add_scaled(
			rb_vec3_add_scaled(rb_vec3_scale((double)m[r], view->right),
		                           (double)m[4 + r], view->up),
			(double)m[8 + r], view->back);
		put(rows[r], row[r], (double)m[12 + r]);
	}
	if (fit->side == 0) /* everything is lit */
		rows[3][3] = 1;
	if (light->lamp)
		return;
	across(light, axis);
	const float told[2][4] = {{(float)rb_vec3_dot(row[0], axis[0]), m[12], m[13],
	                           (float)rb_vec3_dot(row[2], light->place)},
	                          {m[14], 0, 0, 0}};
	memcpy(rows, told, sizeof told);
}
