/* SPDX-License-Identifier: MIT */
/*
 * Planes and rectangles as fans of homogeneous corners. An infinite plane is a fan about the foot
 * of the eye with corners at infinity (w = 0), so that it reaches the horizon exactly. Planes seen
 * from behind cut the others: the inside of a room.
 */
#include "film/surfaces.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "math/quat.h"

static void put(float to[4], rb_vec3 from, double last)
{
	to[0] = (float)from.x;
	to[1] = (float)from.y;
	to[2] = (float)from.z;
	to[3] = (float)last;
}

/* Texture axes of a surface; `side` is the size of one texture, m. */
static void lay(struct rb_surface *surface, const struct rb_looks *looks,
                const struct rb_shape *shape, const rb_mat3 *turn, rb_vec3 eye)
{
	const struct rb_look *look = &looks->of[surface->index];
	double side[2] = {looks->cell_m, looks->cell_m}, at[2] = {0, 0};
	const rb_vec3 u = {turn->m[0][0], turn->m[1][0], turn->m[2][0]};
	rb_vec3 v = {turn->m[0][1], turn->m[1][1], turn->m[2][1]};

	if (look->pattern == RB_PATTERN_IMAGE) {
		const struct rb_pixmap *image = &looks->images[look->image];
		side[0] = surface->infinite ? 4 * looks->cell_m : shape->size[0];
		side[1] = surface->infinite ? side[0] * image->height / image->width
		                            : shape->size[1];
		/* The picture's first row is its upper one. */
		v = rb_vec3_neg(v);
		eye.y = -eye.y;
		at[0] = at[1] = 0.5;
	}
	at[0] += eye.x / side[0];
	at[1] += eye.y / side[1];
	/*
	 * Patterns repeat after two squares; far from their origin there would be no digits left.
	 */
	if (surface->infinite)
		for (int k = 0; k < 2; k++)
			at[k] -= 2 * floor(0.5 * at[k]);
	put(surface->axis_u, rb_vec3_scale(1 / side[0], u), at[0]);
	put(surface->axis_v, rb_vec3_scale(1 / side[1], v), at[1]);
}

/* A fan about the eye's foot, with corners at infinity. */
/* The same, as far as a parallel view sees it: about the line of sight through the eye. */
static void reach_edges(struct rb_surface *surface, const struct rb_view *view)
{
	const rb_vec3 n = {(double)surface->normal[0], (double)surface->normal[1],
	                   (double)surface->normal[2]};
	rb_vec3 middle = {0, 0, 0};

	for (int k = 0; k < 5; k++) {
		const rb_vec3 at = rb_view_on_plane(view, n, (double)surface->normal[3], k % 4);
		put(surface->corner[0][k + 1], at, 1);
		if (k < 4)
			middle = rb_vec3_add_scaled(middle, 0.25, at);
	}
	put(surface->corner[0][0], middle, 1);
	surface->corner_count[0] = 6;
}

static void reach_infinity(struct rb_surface *surface, const rb_mat3 *turn, double height)
{
	const rb_vec3 u = {turn->m[0][0], turn->m[1][0], turn->m[2][0]};
	const rb_vec3 v = {turn->m[0][1], turn->m[1][1], turn->m[2][1]};
	const rb_vec3 n = {turn->m[0][2], turn->m[1][2], turn->m[2][2]};

	put(surface->corner[0][0], rb_vec3_scale(-height, n), 1);
	for (int k = 0; k < 5; k++) {
		const double angle = 0.5 * acos(-1) * k;
		put(surface->corner[0][k + 1],
		    rb_vec3_add(rb_vec3_scale(cos(angle), u), rb_vec3_scale(sin(angle), v)), 0);
	}
	surface->corner_count[0] = 6;
}

void rb_surface_see(struct rb_surface *surface, const struct rb_model *model,
                    const struct rb_looks *looks, const struct rb_frame *frame,
                    const struct rb_view *view)
{
	const struct rb_shape *shape = &model->shape[surface->index];
	const rb_pose pose = rb_view_pose(model, frame, model->id_of[surface->index]);
	const rb_mat3 turn = rb_view_turn(view, pose.orientation);
	const rb_vec3 eye = rb_quat_rotate_back(pose.orientation,
	                                        rb_vec3_sub(view->eye, pose.position));
	const rb_vec3 n = {turn.m[0][2], turn.m[1][2], turn.m[2][2]};

	/*
	 * Edge-on there is nothing to see; from behind, an infinite plane is a wall that one looks
	 * through into its room.
	 */
	const bool along = view->parallel ? rb_view_along(n) : eye.z == 0;
	const bool behind = view->parallel ? n.z < 0 && !along : eye.z < 0;
	surface->shown = !along && !(surface->infinite && behind);
	surface->backed = surface->infinite && !surface->shown && !(view->parallel && along);
	put(surface->normal, behind ? rb_vec3_neg(n) : n, behind ? -eye.z : eye.z);
	lay(surface, looks, shape, &turn, eye);
	surface->part_count = 1;
	if (surface->infinite) {
		if (view->parallel && surface->shown)
			reach_edges(surface, view);
		else
			reach_infinity(surface, &turn, eye.z);
		return;
	}
	const rb_vec3 u = {turn.m[0][0], turn.m[1][0], turn.m[2][0]};
	const rb_vec3 v = {turn.m[0][1], turn.m[1][1], turn.m[2][1]};
	const rb_vec3 centre = rb_view_point(view, pose.position);
	for (int k = 0; k < 4; k++) {
		const double x = (k == 0 || k == 3 ? -0.5 : 0.5) * shape->size[0];
		const double y = (k < 2 ? -0.5 : 0.5) * shape->size[1];
		put(surface->corner[0][k],
		    rb_vec3_add(centre, rb_vec3_add(rb_vec3_scale(x, u), rb_vec3_scale(y, v))), 1);
	}
	surface->corner_count[0] = 4;
}

/* ---- rooms ---- */

/*
 * Height above a wall of a homogeneous point, with a margin so that a plane within the wall counts
 * as inside; not negative in the room.
 */
static double height_in(const struct rb_surface *wall, const float p[4])
{
	double height = 0, size = 0;

	for (int k = 0; k < 4; k++) {
		height += (double)wall->normal[k] * (double)p[k];
		size += fabs((double)wall->normal[k] * (double)p[k]);
	}
	return 1e-5 * size + (wall->backed ? -height : height);
}

/*
 * Clips a convex polygon by a wall in homogeneous coordinates (Sutherland, Hodgman, Comm. ACM 17
 * (1974) 32); returns the number of corners.
 */
static int cut_fan(float (*corner)[4], int count, const struct rb_surface *wall)
{
	float kept[RB_SURFACE_CORNERS][4];
	int kept_count = 0;

	for (int k = 0; k < count; k++) {
		const float *a = corner[k], *b = corner[(k + 1) % count];
		const double at_a = height_in(wall, a), at_b = height_in(wall, b);
		if (at_a >= 0)
			memcpy(kept[kept_count++], a, sizeof *kept);
		if ((at_a >= 0) == (at_b >= 0))
			continue;
		const double part = at_a / (at_a - at_b);
		for (int c = 0; c < 4; c++)
			kept[kept_count][c] = (float)((1 - part) * (double)a[c] +
			                              part * (double)b[c]);
		kept_count++;
	}
	RB_ASSERT(kept_count <= RB_SURFACE_CORNERS);
	memcpy(corner, kept, (size_t)kept_count * sizeof *kept);
	return kept_count;
}

/* Splits the fan into triangles: it is not convex about a foot out of view, each triangle is. */
static void part(struct rb_surface *surface)
{
	float all[6][4];

	memcpy(all, surface->corner[0], sizeof all);
	for (int p = 0; p < RB_SURFACE_PARTS; p++) {
		memcpy(surface->corner[p][0], all[0], sizeof all[0]);
		memcpy(surface->corner[p][1], all[p + 1], 2 * sizeof all[0]);
		surface->corner_count[p] = 3;
	}
	surface->part_count = RB_SURFACE_PARTS;
}

/* Clips all parts by a wall. */
static void cut(struct rb_surface *surface, const struct rb_surface *wall)
{
	/* each wall adds a corner at most */
	for (int p = 0; p < surface->part_count; p++)
		if (surface->corner_count[p] < RB_SURFACE_CORNERS)
			surface->corner_count[p] = cut_fan(surface->corner[p],
			                                   surface->corner_count[p], wall);
}

bool rb_surfaces_cut(struct rb_surface *surfaces, int count)
{
	bool outside = false;

	for (int k = 0; k < count; k++)
		outside |= surfaces[k].backed;
	for (int k = 0; k < count && outside; k++) {
		if (!surfaces[k].infinite || !surfaces[k].shown)
			continue;
		part(&surfaces[k]);
		for (int w = 0; w < count; w++)
			if (w != k && surfaces[w].infinite)
				cut(&surfaces[k], &surfaces[w]);
	}
	return outside;
}
