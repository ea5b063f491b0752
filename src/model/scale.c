/* SPDX-License-Identifier: MIT */
#include "model/scale.h"

#include "model/descriptor.h"
#include "model/joints.h"
#include "model/shape.h"

double rb_ulp(double x)
{
	return nextafter(fabs(x), (double)INFINITY) - fabs(x);
}

/*
 * Tolerances as given or by default: a ppm of the smallest body, which no picture shows, where
 * events are located; what the error of a step is worth (rb_stepper.tolerance) in steps, but the
 * same ppm where bodies are joined, since joints are solved by factors to rounding, and what a
 * chain of unequal masses leaves open grows along it; and at least the rounding of gaps at the
 * largest coordinate (RB_TOUCHING_ULP in step/gap).
 */
static void choose_tolerances(const struct rb_scene *scene, struct rb_piece_scales *sizes)
{
	static const double located = 1e-6;
	const struct rb_method *const method = rb_methods[scene->world.method];
	const struct rb_world_def *const world = &scene->world;
	const double rounding = 8 * rb_ulp(sizes->coordinate_max_m);
	const double by_steps = scene->joint_count > 0 ? located : method->steps->tolerance;
	const bool given = !isnan(world->tolerance_m);

	sizes->tolerance_m = given ? world->tolerance_m
	                           : fmax((method->locates ? located : by_steps) *
	                                          sizes->size_min_m,
	                                  rounding);
	sizes->stepped_tolerance_m = sizes->tolerance_m;
	if (!isnan(world->stepped_tolerance_m))
		sizes->stepped_tolerance_m = world->stepped_tolerance_m;
	else if (method->changes && !given)
		sizes->stepped_tolerance_m = fmax(by_steps * sizes->size_min_m, rounding);
}

struct rb_piece_scales rb_scene_sizes(const struct rb_scene *scene)
{
	struct rb_piece_scales sizes = {.size_min_m = (double)INFINITY};
	double logs = 0;
	int moving = 0;

	for (int i = 0; i < scene->body_count; i++) {
		const struct rb_body_def *body = &scene->bodies[i];
		double size = rb_shape_reach(scene->solids, &body->shape);

		if (body->shape.kind == RB_SHAPE_RECTANGLE)
			size = fmax(body->shape.size[0], body->shape.size[1]);
		sizes.coordinate_max_m = fmax(sizes.coordinate_max_m,
		                              fmax(size, rb_vec3_max_abs(body->position)));
		if (body->is_static)
			continue;
		const double width = rb_shape_half_width(scene->solids, &body->shape);
		sizes.size_min_m = fmin(sizes.size_min_m, width);
		logs += log(width);
		moving++;
	}
	sizes.size_mean_m = moving > 0 ? exp(logs / moving) : 0;
	if (isinf(sizes.size_min_m))
		sizes.size_min_m = 0;
	choose_tolerances(scene, &sizes);
	return sizes;
}

double rb_frame_intervals(double duration_s, double frame_rate, bool *whole)
{
	const double q = duration_s * frame_rate;
	const double nearest = nearbyint(q);

	/* rates and durations are decimal fractions: their product is off by a few ulp */
	*whole = nearest > 0 && fabs(q - nearest) <= 4 * rb_ulp(q);
	return *whole ? nearest : floor(q);
}

bool rb_scene_has_drive(const struct rb_scene *scene)
{
	const struct rb_world_def *const world = &scene->world;
	bool has = (scene->hooks & ~(unsigned)RB_HOOK_EXPECT_ALWAYS) != 0 ||
	           scene->field_count > 0 || scene->force_count > 0 || world->gravitation.given ||
	           rb_vec3_max_abs(world->gravity_force) > 0 || rb_vec3_max_abs(world->gravity) > 0;

	for (int k = 0; k < RB_ELEMENT_KINDS_MAX; k++)
		has |= scene->elements[k].count > 0;
	for (int k = 0; k < scene->joint_count; k++)
		has |= rb_joint_has_motor(&scene->joints[k]) || scene->joints[k].stiffness > 0;
	for (int i = 0; i < scene->body_count; i++)
		has |= rb_body_is_driven(&scene->bodies[i]);
	return has;
}
