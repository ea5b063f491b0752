/* SPDX-License-Identifier: MIT */
/*
 * Where a camera stands at one frame and what it sees. Pure mathematics, values, any thread.
 *
 * View coordinates: the eye is the origin, x to the right, y up, the camera looks along -z; m. They
 * are made in double, so that single precision is enough for what comes after, wherever in the
 * world the scene lies.
 *
 * Lines of sight meet in the eye, or are parallel (orthographic): these have no end, so the eye may
 * stand anywhere on the one through the camera, and stands amidst what is seen. What differs
 * between the two is asked here.
 */
#ifndef RB_FILM_VIEW_H
#define RB_FILM_VIEW_H

#include <rbsim/frame.h>
#include <rbsim/model.h>

#include "film/extents.h"

/* Where a body is: p_world = position + orientation p_object. */
typedef struct {
	rb_vec3 position;
	rb_quat orientation;
} rb_pose;

struct rb_view {
	rb_vec3 eye;             /* m, world */
	rb_vec3 right, up, back; /* unit, world */
	bool parallel;
	/* x/-z and y/-z of the edges; of a parallel view x and y, m */
	double left_slope, right_slope, bottom_slope, top_slope;
	/*
	 * m, from the eye along the line of sight; far may be INFINITY, near of a parallel view is
	 * negative mostly
	 */
	double near, far;
	int width, height;
	double aim_m; /* from the eye to what it looks at, along the line of sight */
};

/* Of a body by its id; the model's where it never moves or the frame has no orientations. */
rb_pose rb_view_pose(const struct rb_model *model, const struct rb_frame *frame, int id);
/* Of a part of a body. */
rb_pose rb_view_part(rb_pose body, const struct rb_solid_part *part);

/*
 * `shot` is for what comes from functions (NULL: nothing does). RB_ERR_SCENE with the camera, the
 * time and the body: the eye is in a visible body, look_at is the eye, `up` is along the line of
 * sight.
 */
RB_CHECKED enum rb_status rb_view_make(struct rb_view *view, const struct rb_model *model,
                                       const struct rb_camera_def *camera,
                                       const struct rb_frame *frame,
                                       const struct rb_frame_shot *shot, struct rb_error *err);

rb_vec3 rb_view_point(const struct rb_view *view, rb_vec3 world);     /* relative to the eye */
rb_vec3 rb_view_direction(const struct rb_view *view, rb_vec3 world); /* turned only */
/* Turns object coordinates of a body into view coordinates. */
rb_mat3 rb_view_turn(const struct rb_view *view, rb_quat orientation);
/* From the world's axes to those of the view. */
rb_quat rb_view_quat(const struct rb_view *view);

/* From the eye to a point, or along the line of sight through it: only the direction counts. */
rb_vec3 rb_view_way(const struct rb_view *view, rb_vec3 point);
/* How far away it is, m, not negative: what is nearer hides what is farther. */
double rb_view_distance(const struct rb_view *view, rb_vec3 point);
/*
 * The sine of the angle between the line of sight to the centre of a sphere and one that touches
 * it.
 */
double rb_view_lean(const struct rb_view *view, rb_vec3 centre, double radius);

/* The planes through the edges of the picture. */
struct rb_view_edges {
	rb_vec3 normal[4]; /* inwards, unit */
	double offset[4];  /* m: inside, normal . point + offset is positive */
	double front;      /* m: what lies at a greater z is never seen */
};
struct rb_view_edges rb_view_edges(const struct rb_view *view);
/* No point of a sphere (view coordinates) is in the picture. */
bool rb_view_misses(const struct rb_view_edges *edges, rb_vec3 centre, double radius);

/*
 * Where a plane (unit normal towards the viewer, height of the eye over it) is met by the line of
 * sight through a corner of a picture that is a little larger, k = 0..3 around; of a parallel view
 * that does not see it edge-on.
 */
rb_vec3 rb_view_on_plane(const struct rb_view *view, rb_vec3 normal, double height, int k);

/* Of a parallel view: does it see a plane edge-on, which is to say not at all? */
bool rb_view_along(rb_vec3 normal);

/*
 * Where in the picture a point in view coordinates is: pixels from its upper left corner. z must be
 * negative.
 */
void rb_view_pixel(const struct rb_view *view, rb_vec3 point, double pixel[2]);
/* Size of a pixel at distance 1 m, of a parallel view everywhere, m. */
double rb_view_pixel_size(const struct rb_view *view);
/* Size of a pixel at a distance from the eye, m. */
double rb_view_pixel_at(const struct rb_view *view, double distance);

/*
 * depth = a + b / distance along the line of sight, a + b distance of a parallel view: 1 at `near`,
 * 0 at `far`.
 */
void rb_view_depth(const struct rb_view *view, double *a, double *b);
/*
 * View to clip coordinates, columns first, with y downwards. A point at infinity has w = 0.
 * `from_zero`: clip space reaches from z = 0 to w, else from -w to w.
 */
void rb_view_projection(const struct rb_view *view, bool from_zero, float matrix[16]);

#endif
