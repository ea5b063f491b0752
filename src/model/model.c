/* SPDX-License-Identifier: MIT */
/*
 * The model holds what a run reads and never writes: columns by body index, moving bodies first,
 * and a table of materials by pair. Order of the work: what can touch decides the features, the
 * features decide which columns exist, and the check of the scene precedes everything that divides
 * by its numbers.
 *
 * Friction of a pair is the geometric mean, so that one frictionless body slides on everything;
 * restitution is the larger one, as Box2D mixes it. A `contact` entry overrides either.
 */
#include <rbsim/model.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "geom/mass.h"
#include "model/descriptor.h"
#include "model/shape.h"
#include "math/quat.h"
#include "math/top.h"
#include "model/scale.h"
#include "model/validate.h"
#include "model/element.h"
#include "model/features.h"
#include "model/joints.h"
#include "model/parts.h"

const char *rb_rollback_name(enum rb_rollback_kind kind)
{
	switch (kind) {
	case RB_ROLLBACK_SELECTIVE:
		return "selective";
	case RB_ROLLBACK_GLOBAL:
		return "global";
	case RB_ROLLBACK_NONE:
		return "none";
	}
	return "unknown";
}

const struct rb_top_body *rb_model_top(const struct rb_model *model, int index)
{
	return &model->top[model->inertia_of[index]];
}

double rb_model_frame_time(const struct rb_model *model, uint64_t k)
{
	bool whole;
	const double intervals = rb_frame_intervals(model->duration_s, model->frame_rate, &whole);

	return (double)k > intervals ? model->duration_s : (double)k / model->frame_rate;
}

/*
 * A zeroed column of the model, counted in model->bytes; NULL if it is not wanted or memory is out.
 */
static void *column(struct rb_model *model, bool wanted, size_t count, size_t size, bool *failed)
{
	if (!wanted)
		return NULL;
	void *block = rb_memory_take(count, size);
	if (!block)
		*failed = true;
	else
		model->bytes += count * size;
	return block;
}

static double geometric_mean(double a, double b)
{
	const double product = a * b;

	/* exact for equal materials */
	if (a == b)
		return a;
	/* the product may over- or underflow where the mean does not */
	return product >= DBL_MIN && product <= DBL_MAX ? sqrt(product) : sqrt(a) * sqrt(b);
}

/* Fills the dense symmetric table of pairs: mixed values, then overrides. */
static void fill_pair_materials(struct rb_model *model)
{
	const struct rb_scene *scene = model->scene;
	const int n = scene->material_count;

	for (int a = 0; a < n; a++) {
		for (int b = 0; b < n; b++) {
			const struct rb_material_def *ma = &scene->materials[a],
						     *mb = &scene->materials[b];

			model->pair_materials[a * n + b] = (struct rb_pair_material){
				.friction = geometric_mean(ma->friction, mb->friction),
				.restitution = fmax(ma->restitution, mb->restitution),
			};
		}
	}
	for (int i = 0; i < scene->contact_pair_count; i++) {
		const struct rb_contact_pair_def *def = &scene->contact_pairs[i];
		RB_ASSERT(def->material_a >= 0 && def->material_a < n);
		RB_ASSERT(def->material_b >= 0 && def->material_b < n);
		struct rb_pair_material *ab =
			&model->pair_materials[def->material_a * n + def->material_b];
		struct rb_pair_material *ba =
			&model->pair_materials[def->material_b * n + def->material_a];

		if (!isnan(def->friction))
			ab->friction = ba->friction = def->friction;
		if (!isnan(def->restitution))
			ab->restitution = ba->restitution = def->restitution;
	}
}

/* True if some body is neither a sphere nor a plane. */
static bool has_other_shapes(const struct rb_scene *scene)
{
	for (int i = 0; i < scene->body_count; i++)
		if (rb_shape_has_parts(scene->bodies[i].shape.kind))
			return true;
	return false;
}

/* Allocates the columns that the features need. */
static void take_columns(struct rb_model *model, bool *failed)
{
	const size_t all = (size_t)model->body_count + (size_t)model->static_count;
	const bool turns = (model->features & RB_FEATURE_ROTATION) != 0;
	const bool filters = (model->features & RB_FEATURE_FILTERS) != 0;
	const bool off_center = (model->features & RB_FEATURE_OFF_CENTER) != 0;

	model->id_of = column(model, true, all, sizeof *model->id_of, failed);
	model->index_of = column(model, true, all, sizeof *model->index_of, failed);
	model->shape = column(model, true, all, sizeof *model->shape, failed);
	model->reach = column(model, has_other_shapes(model->scene), all, sizeof *model->reach,
	                      failed);
	model->material = column(model, true, all, sizeof *model->material, failed);
	model->mass = column(model, true, all, sizeof *model->mass, failed);
	model->inverse_mass = column(model, true, all, sizeof *model->inverse_mass, failed);
	model->driven = column(model, (model->features & RB_FEATURE_DRIVEN) != 0,
	                       (size_t)model->body_count, sizeof *model->driven, failed);
	model->inertia_of = column(model, turns, all, sizeof *model->inertia_of, failed);
	model->inverse_inertia_scalar = column(model, turns, all,
	                                       sizeof *model->inverse_inertia_scalar, failed);
	model->center_of_mass = column(model, off_center, all, sizeof *model->center_of_mass,
	                               failed);
	model->group_bit = column(model, filters, all, sizeof *model->group_bit, failed);
	model->collides = column(model, filters, all, sizeof *model->collides, failed);
	model->attraction = column(model, (model->features & RB_FEATURE_GRAVITATION) != 0, all,
	                           sizeof *model->attraction, failed);
	model->position = column(model, true, all, sizeof *model->position, failed);
	model->orientation = column(model, true, all, sizeof *model->orientation, failed);
}

/* Indices: moving bodies in the order of their ids, then static ones likewise. */
static void number_bodies(struct rb_model *model)
{
	int moving = 0, fixed = model->body_count;

	for (int id = 0; id < model->scene->body_count; id++) {
		const int index = model->scene->bodies[id].is_static ? fixed++ : moving++;

		model->id_of[index] = id;
		model->index_of[id] = index;
	}
	RB_ASSERT(moving == model->body_count && fixed == moving + model->static_count);
}

/* Tensors of the last kinds of bodies that a new one is compared with. */
enum { KINDS_COMPARED = 8 };

/* What is kept of each tensor. */
struct tensor_capacity {
	size_t inertia, inverse, top;
};

/* Room for one more tensor. */
static bool reserve_tensor(struct rb_model *model, struct tensor_capacity *capacity)
{
	const size_t count = (size_t)model->inertia_count + 1;

	return rb_memory_reserve(&model->inertia, &capacity->inertia, count,
	                         sizeof *model->inertia) &&
	       rb_memory_reserve(&model->inverse_inertia, &capacity->inverse, count,
	                         sizeof *model->inverse_inertia) &&
	       rb_memory_reserve(&model->top, &capacity->top, count, sizeof *model->top);
}

/* The place of a tensor among those that there are, of which it may become one; -1: no memory. */
static int place_inertia(struct rb_model *model, struct tensor_capacity *capacity,
                         const rb_mat3 *inertia)
{
	const int count = model->inertia_count;

	for (int k = count; k-- > 0 && count - k <= KINDS_COMPARED;)
		if (memcmp(&model->inertia[k], inertia, sizeof *inertia) == 0)
			return k;
	if (!reserve_tensor(model, capacity))
		return -1;
	model->inertia[count] = *inertia;
	model->top[count] = rb_top_body_of(inertia);
	if (rb_inertia_is_scalar(inertia)) {
		const double inverse = 1 / inertia->m[0][0];

		model->inverse_inertia[count] = rb_mat3_diagonal(inverse, inverse, inverse);
	} else {
		/* rb_scene_check has verified that there is one */
		(void)rb_mat3_inverse(inertia, &model->inverse_inertia[count]);
	}
	return model->inertia_count++;
}

/*
 * Tensors about the centre of mass in body axes. Static and driven bodies have the first, which is
 * zero: nothing turns them.
 */
static bool fill_inertia(struct rb_model *model)
{
	struct tensor_capacity capacity = {0};

	if (!reserve_tensor(model, &capacity))
		return false;
	model->top[0] = rb_top_body_of(&model->inertia[0]);
	model->inertia_count = 1;
	for (int i = 0; i < model->body_count; i++) {
		const struct rb_body_def *body = &model->scene->bodies[model->id_of[i]];

		if (!rb_body_is_free(body))
			continue;
		const rb_mat3 inertia = rb_body_inertia(model->scene, body, model->mass[i]);
		const int at = place_inertia(model, &capacity, &inertia);

		if (at < 0)
			return false;
		model->inertia_of[i] = at;
		model->inverse_inertia_scalar[i] = rb_inertia_is_scalar(&inertia)
		                                           ? model->inverse_inertia[at].m[0][0]
		                                           : (double)NAN;
	}
	model->bytes += (size_t)model->inertia_count *
	                (2 * sizeof *model->inertia + sizeof *model->top);
	return true;
}

/*
 * Fills row `index` of all columns. Static and driven bodies have infinite mass and a zero inverse.
 */
static void fill_body(struct rb_model *model, int index)
{
	const struct rb_body_def *body = &model->scene->bodies[model->id_of[index]];

	model->shape[index] = body->shape;
	if (model->reach)
		model->reach[index] = rb_shape_reach(model->scene->solids, &body->shape);
	model->material[index] = body->material;
	model->position[index] = body->position;
	model->orientation[index] = rb_quat_unit(body->orientation);
	if (model->group_bit) {
		model->group_bit[index] = rb_body_group_bit(body);
		model->collides[index] = rb_body_collides(body);
	}
	if (rb_body_is_driven(body))
		model->driven[index] = 1;
	if (!rb_body_is_free(body)) {
		model->mass[index] = (double)INFINITY;
		return;
	}
	model->mass[index] = rb_body_mass(model->scene, body);
	RB_ASSERT(model->mass[index] > 0 && isfinite(1 / model->mass[index]));
	model->inverse_mass[index] = 1 / model->mass[index];
	if (model->center_of_mass)
		model->center_of_mass[index] = body->center_of_mass;
}

/* Who attracts, and by how much. */
static void fill_attraction(struct rb_model *model)
{
	const struct rb_scene *const scene = model->scene;
	const struct rb_gravitation_def *const def = &scene->world.gravitation;

	model->softening2_m2 = def->softening_m * def->softening_m;
	model->attracts_by_mass = true;
	for (int index = 0; index < scene->body_count; index++) {
		const struct rb_body_def *const body = &scene->bodies[model->id_of[index]];
		const double by = rb_body_attracts_by(scene, body);

		model->attraction[index] = def->constant * by;
		model->attractor_count += by > 0;
		if (rb_body_is_free(body))
			model->attracts_by_mass = model->attracts_by_mass &&
			                          by == model->mass[index];
		else
			model->center_count += by > 0;
	}
}

/*
 * With more bodies the ledger of energy and momentum is off unless asked for: it costs 2 % of the
 * time of a located crowd and 5 % of that of steps.
 */
enum { LEDGER_BODIES_MAX = 64 };

/* Scalars of the world. */
static void fill_numbers(struct rb_model *model)
{
	const struct rb_record_def *record = &model->scene->record;

	const struct rb_world_def *world = &model->scene->world;
	const struct rb_piece_scales sizes = rb_scene_sizes(model->scene);
	bool whole;

	model->duration_s = rb_world_duration(world);
	model->frame_rate = world->frame_rate;
	model->time_step_s = rb_world_time_step(world);
	model->tolerance_m = sizes.tolerance_m;
	model->stepped_tolerance_m = sizes.stepped_tolerance_m;
	model->size_min_m = sizes.size_min_m;
	model->size_mean_m = sizes.size_mean_m;
	model->coordinate_max_m = sizes.coordinate_max_m;
	model->keeps_ledger = record->ledger_given ? record->ledger
	                                           : model->body_count <= LEDGER_BODIES_MAX;
	model->rollback = world->rollback;
	model->method = world->method;
	model->frame_count = (uint64_t)rb_frame_intervals(model->duration_s, model->frame_rate,
	                                                  &whole) +
	                     1;
	/* the last frame is at the end of the duration, on the grid or not */
	if (!whole)
		model->frame_count++;
	RB_ASSERT(model->frame_count >= 1 && model->tolerance_m >= 0);
}

/* Refuses the first feature that the method lacks, where rb_scene_check has not by its call. */
static enum rb_status check_method(const struct rb_model *model, struct rb_error *err)
{
	const struct rb_method *const method = rb_methods[model->scene->world.method];
	int count;
	const struct rb_feature_row *const row = rb_feature_rows(&count);

	for (int k = 0; k < count; k++)
		if (row[k].bit & model->features & method->lacks)
			return RB_FAIL(err, RB_ERR_SCENE,
			               "world: method '%s' has no feature '%s' (%s): use 'located' "
			               "or 'auto'",
			               method->name, row[k].name, row[k].help);
	return RB_OK;
}

/* Everything in its order; a failure leaves a model that rb_model_destroy releases. */
static enum rb_status fill(struct rb_model *model, struct rb_mistakes *mistakes,
                           struct rb_error *err)
{
	const struct rb_scene *scene = model->scene;
	const size_t n = (size_t)scene->material_count;
	bool failed = false;

	for (int i = 0; i < scene->body_count; i++) {
		if (scene->bodies[i].is_static)
			model->static_count++;
		else
			model->body_count++;
	}
	/* materials first: what can touch decides what else there is */
	model->material_count = scene->material_count;
	model->pair_materials = n > 0 && n < INT32_MAX / n
	                                ? column(model, true, n * n, sizeof *model->pair_materials,
	                                         &failed)
	                                : NULL;
	if (!model->pair_materials)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the table of %zu materials",
		               n);
	fill_pair_materials(model);
	model->features = rb_features_of(scene, model->pair_materials);
	const bool turns = (model->features & RB_FEATURE_ROTATION) != 0;
	enum rb_status status = rb_scene_check(scene, turns, mistakes, err);
	if (status == RB_OK)
		status = check_method(model, err);
	if (status != RB_OK)
		return status;

	const enum rb_status made = rb_parts_table_create(&model->parts, scene, err);
	if (made != RB_OK)
		return made;
	take_columns(model, &failed);
	if (failed)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the constants of %d bodies",
		               scene->body_count);
	number_bodies(model);
	for (int i = 0; i < scene->body_count; i++)
		fill_body(model, i);
	if (turns && !fill_inertia(model))
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the inertia of %d bodies",
		               scene->body_count);
	if (model->attraction)
		fill_attraction(model);
	fill_numbers(model);
	const enum rb_status elements = rb_elements_create(model, err);

	return elements == RB_OK ? rb_joints_create(model, err) : elements;
}

enum rb_status rb_model_create(struct rb_model **model, const struct rb_scene *scene,
                               struct rb_mistakes *mistakes, struct rb_error *err)
{
	struct rb_model *made = rb_memory_take(1, sizeof *made);

	*model = NULL;
	if (!made)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory for the model");
	made->scene = scene;
	const enum rb_status status = fill(made, mistakes, err);
	if (status != RB_OK) {
		rb_model_destroy(made);
		return status;
	}
	*model = made;
	return RB_OK;
}

void rb_model_destroy(struct rb_model *model)
{
	if (!model)
		return;
	rb_memory_free(model->id_of);
	rb_memory_free(model->index_of);
	rb_memory_free(model->shape);
	rb_memory_free(model->reach);
	rb_parts_table_destroy(model->parts);
	rb_memory_free(model->material);
	rb_memory_free(model->mass);
	rb_memory_free(model->inverse_mass);
	rb_memory_free(model->driven);
	rb_elements_destroy(model);
	rb_joints_destroy(model);
	rb_memory_free(model->inertia);
	rb_memory_free(model->inverse_inertia);
	rb_memory_free(model->top);
	rb_memory_free(model->inertia_of);
	rb_memory_free(model->inverse_inertia_scalar);
	rb_memory_free(model->center_of_mass);
	rb_memory_free(model->group_bit);
	rb_memory_free(model->collides);
	rb_memory_free(model->attraction);
	rb_memory_free(model->position);
	rb_memory_free(model->orientation);
	rb_memory_free(model->pair_materials);
	rb_memory_free(model);
}
