/* SPDX-License-Identifier: MIT */
/*
 * External forces by a table of features: each row adds a force and a torque, and tells whether it
 * is constant for a body, which then flies on a parabola; otherwise it needs the integrator. With
 * `parts` the contributions are also kept by cause, for the ledger and for reports.
 */
#include "located/external_force.h"

#include "base/error.h"

#include <stdlib.h>

#include "base/memory.h"

/* Forces on one body at one time. */
struct load {
	struct rb_located *l;
	int i;
	const struct rb_pose *pose;
	const struct rb_force_query *view;
	rb_vec3 force, torque; /* N; N m about the centre of mass: sums */
	rb_vec3 acceleration;  /* m/s^2: contributions that do not depend on the mass */
	enum rb_external_cause cause;
	struct rb_external_parts *parts; /* NULL: not wanted */
};

typedef void load_function(struct load *load);
typedef bool constant_function(const struct rb_located *l, int i, double t);

static void add_torque(struct load *load, rb_vec3 torque)
{
	load->torque = rb_vec3_add(load->torque, torque);
	if (load->parts)
		load->parts->torque[load->cause] = rb_vec3_add(load->parts->torque[load->cause],
		                                               torque);
}

static void add_force(struct load *load, rb_vec3 force)
{
	load->force = rb_vec3_add(load->force, force);
	if (load->parts)
		load->parts->force[load->cause] = rb_vec3_add(load->parts->force[load->cause],
		                                              force);
}

/* A force at an arm from the centre of mass. */
static void add(struct load *load, rb_vec3 force, rb_vec3 arm)
{
	add_force(load, force);
	add_torque(load, rb_vec3_cross(arm, force));
}

static bool always(const struct rb_located *l, int i, double t)
{
	(void)l, (void)i, (void)t;
	return true;
}

static bool never(const struct rb_located *l, int i, double t)
{
	(void)l, (void)i, (void)t;
	return false;
}

static void gravity_force(struct load *load)
{
	add_force(load, load->l->model->scene->world.gravity_force);
}

/* Forces of the scene that act at the time. */
static void scene_forces(struct load *load)
{
	const struct rb_model *model = load->l->model;
	const struct rb_body_def *body = &model->scene->bodies[model->id_of[load->i]];

	for (int f = 0; f < body->force_count; f++) {
		const struct rb_force_def *force = &model->scene->forces[body->force_first + f];
		const rb_quat q = load->pose->orientation;

		if (!rb_force_acts(force, load->view->active_s))
			continue;
		const bool turns = force->frame == RB_FORCE_BODY;
		add(load, turns ? rb_quat_rotate(q, force->vector) : force->vector,
		    rb_element_arm(load->l->model, load->i, q, force->point));
		add_torque(load, turns ? rb_quat_rotate(q, force->torque) : force->torque);
	}
}

/* Constant if in world axes at the centre of mass; anything else depends on the orientation. */
static bool scene_forces_constant(const struct rb_located *l, int i, double t)
{
	const struct rb_scene *scene = l->model->scene;
	const struct rb_body_def *body = &scene->bodies[l->model->id_of[i]];

	for (int f = 0; f < body->force_count; f++) {
		const struct rb_force_def *force = &scene->forces[body->force_first + f];
		const rb_vec3 arm = rb_element_arm(l->model, i, (rb_quat){1, 0, 0, 0},
		                                   force->point);

		if (rb_force_acts(force, t) && l->top &&
		    (force->frame == RB_FORCE_BODY || rb_vec3_max_abs(arm) > 0 ||
		     rb_vec3_max_abs(force->torque) > 0))
			return false;
	}
	return true;
}

static void callback_forces(struct load *load)
{
	const struct rb_world *world = load->l->world;

	if (!world->push)
		return;
	add_force(load, rb_world_row3(world->push, load->i));
	add_torque(load, rb_world_row3(world->twist, load->i));
}

/* Constant unless there is a torque on a body with unequal moments. */
static bool callback_forces_constant(const struct rb_located *l, int i, double t)
{
	(void)t;
	return !l->top || l->top_body[i].kind == RB_TOP_CONSTANT ||
	       rb_vec3_max_abs(rb_world_row3(l->world->state.twist, i)) == 0;
}

/* ---- force elements ---- */

/* Pose of the end of an element: of the query if it has one, else of the arc. */
static struct rb_pose pose_of(const struct rb_element_query *query, int j)
{
	const struct rb_element_view *at = query->user;
	const struct rb_located *l = at->l;

	if (at->view->pose && j < l->n && l->place[j] >= 0)
		return at->view->pose[l->place[j]];
	return rb_arc_pose(l, j, at->view->time_s);
}

struct rb_element_query rb_external_query(const struct rb_element_view *at)
{
	return (struct rb_element_query){
		.model = at->l->model, .time_s = at->view->time_s, .pose = pose_of, .user = at};
}

/*
 * Cause of an element's force. The ledger enters elements with ends, or with a potential,
 * elsewhere.
 */
static enum rb_external_cause cause_of(const struct rb_element_kind *kind)
{
	if (kind->ends)
		return RB_EXTERNAL_SPRINGS;
	if (kind->energy)
		return RB_EXTERNAL_UNIFORM;
	return kind->is_drag ? RB_EXTERNAL_DRAG : RB_EXTERNAL_STATED;
}

/* One element on one body. */
static void add_element(struct load *load, const struct rb_elements *elements, int k,
                        const struct rb_element_query *query)
{
	struct rb_wrench wrench;

	if (!elements->kind->act(query, rb_elements_row(elements, k), load->i, load->pose, &wrench))
		return;
	add_force(load, wrench.force);
	add_torque(load, wrench.torque);
}

static void add_elements(struct load *load)
{
	const struct rb_model *model = load->l->model;
	const struct rb_element_view at = {load->l, load->view};
	const struct rb_element_query query = rb_external_query(&at);

	for (int k = 0; k < model->element_list_count; k++) {
		const struct rb_elements *elements = &model->elements[k];

		load->cause = cause_of(elements->kind);
		if (!elements->end)
			for (int m = 0; m < elements->count; m++)
				add_element(load, elements, m, &query);
		else
			for (int m = elements->first[load->i]; m < elements->first[load->i + 1];
			     m++)
				add_element(load, elements, elements->of[m], &query);
	}
}

/* Constant if no element acts on the body. */
static bool elements_constant(const struct rb_located *l, int i, double t)
{
	(void)t;
	for (int k = 0; k < l->model->element_list_count; k++) {
		const struct rb_elements *elements = &l->model->elements[k];

		if ((l->model->features & elements->kind->feature) &&
		    (!elements->end || elements->first[i] < elements->first[i + 1]))
			return false;
	}
	return true;
}

/* ---- all ---- */

/*
 * The scene's field function: force without and with a potential. False: there is none, or it
 * failed, see l->status.
 */
static bool ask_field(struct rb_located *l, int i, double t, const rb_vec3 at[2], rb_vec3 force[2])
{
	const struct rb_world_hooks *hooks = &l->world->hooks;

	force[0] = force[1] = (rb_vec3){0, 0, 0};
	if (hooks->field && l->status == RB_OK)
		l->status = hooks->field(hooks->user, l->model->id_of[i], t, at, force, l->err);
	return hooks->field && l->status == RB_OK;
}

static void field(struct load *load)
{
	struct rb_located *l = load->l;
	const rb_vec3 at[2] = {load->pose->position, load->pose->velocity};
	rb_vec3 force[2];

	if (!ask_field(l, load->i, load->view->time_s, at, force))
		return;
	l->products += RB_LOCATED_FIELD;
	add_force(load, force[0]);
	if (!l->world->hooks.potential)
		return;
	load->cause = RB_EXTERNAL_UNIFORM;
	add_force(load, force[1]);
}

rb_vec3 rb_external_field(struct rb_located *l, int i, double t, rb_vec3 position, rb_vec3 velocity)
{
	const rb_vec3 at[2] = {position, velocity};
	rb_vec3 force[2];

	if (!ask_field(l, i, t, at, force))
		return (rb_vec3){0, 0, 0};
	return rb_vec3_scale(l->model->inverse_mass[i], rb_vec3_add(force[0], force[1]));
}

void rb_external_attract(struct rb_located *l, const struct rb_force_query *view)
{
	const rb_vec3 none = {0, 0, 0};

	if (!rb_located_gravitates(l))
		return;
	for (int i = 0; i < l->n; i++) {
		if (view->pose && l->place[i] >= 0) {
			const struct rb_pose *const pose = &view->pose[l->place[i]];

			rb_gravitation_place(&l->gravitation, i, pose->position, pose->rest);
		} else if (rb_located_on_piece(l, i)) {
			const rb_vec3 way = rb_arc_piece_vector(&l->piece[i], RB_PIECE_POSITION,
			                                        view->time_s);
			const rb_vec3 at = rb_vec3_add(l->piece[i].base, way);

			rb_gravitation_place(&l->gravitation, i, at,
			                     rb_vec3_lost(l->piece[i].base, way, at));
		} else {
			rb_gravitation_place(&l->gravitation, i,
			                     rb_arc_position(l, i, view->time_s), none);
		}
	}
	rb_gravitation_find_by(&l->gravitation, l->world->team);
}

/* Attraction by all others. */
static void gravitation(struct load *load)
{
	struct rb_located *l = load->l;

	if (!load->view->attracted) /* the force on a single body is wanted */
		rb_external_attract(l, load->view);
	const rb_vec3 a = rb_gravitation_found(&l->gravitation, load->i);

	load->acceleration = rb_vec3_add(load->acceleration, a);
	if (load->parts)
		load->parts->force[load->cause] = rb_vec3_scale(l->model->mass[load->i], a);
}

static bool gravitation_constant(const struct rb_located *l, int i, double t)
{
	(void)t;
	return !rb_gravitation_attracts(l->model, i);
}

static const struct {
	rb_features need;
	enum rb_external_cause cause;
	load_function *act;
	constant_function *is_constant;
} rows[] = {
	{RB_FEATURE_GRAVITY_FORCE, RB_EXTERNAL_UNIFORM, gravity_force, always},
	{RB_FEATURE_FORCES, RB_EXTERNAL_STATED, scene_forces, scene_forces_constant},
	{RB_FEATURE_PUSHES, RB_EXTERNAL_CALLBACKS, callback_forces, callback_forces_constant},
	{RB_FEATURE_SPRINGS | RB_FEATURE_DRAG | RB_FEATURE_ELEMENTS, RB_EXTERNAL_SPRINGS,
         add_elements, elements_constant},
	{RB_FEATURE_FIELD, RB_EXTERNAL_STATED, field, never},
	{RB_FEATURE_GRAVITATION, RB_EXTERNAL_GRAVITATION, gravitation, gravitation_constant},
};
enum { ROWS = sizeof rows / sizeof rows[0] };

rb_vec3 rb_inverse_inertia_apply(const struct rb_located *l, int i, rb_quat orientation,
                                 rb_vec3 torque)
{
	const double scalar = l->model->inverse_inertia_scalar[i];

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	RB_ASSERT_COSTLY(l->top != NULL);
	if (!isnan(scalar))
		return rb_vec3_scale(scalar, torque);
	return rb_quat_rotate(orientation, rb_mat3_apply(rb_model_inverse_inertia(l->model, i),
	                                                 rb_quat_rotate_back(orientation, torque)));
}

void rb_external_force_at(struct rb_located *l, int i, const struct rb_pose *pose,
                          const struct rb_force_query *view, rb_vec3 *linear, rb_vec3 *angular)
{
	struct load load = {.l = l,
	                    .i = i,
	                    .pose = pose,
	                    .view = view,
	                    .acceleration = l->model->scene->world.gravity};

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	if (view->parts) {
		load.parts = &view->parts[l->place[i]];
		*load.parts = (struct rb_external_parts){0};
		load.parts->force[RB_EXTERNAL_UNIFORM] = rb_vec3_scale(
			l->model->mass[i], l->model->scene->world.gravity);
	}
	for (int k = 0; k < ROWS; k++)
		if (l->model->features & rows[k].need) {
			load.cause = rows[k].cause;
			rows[k].act(&load);
		}
	*linear = rb_vec3_add_scaled(load.acceleration, l->model->inverse_mass[i], load.force);
	*angular = (rb_vec3){0, 0, 0};
	if (!l->top)
		return;
	if (load.torque.x != 0 || load.torque.y != 0 || load.torque.z != 0)
		*angular = rb_inverse_inertia_apply(l, i, pose->orientation, load.torque);
	if (l->top_body[i].kind != RB_TOP_CONSTANT)
		*angular = rb_vec3_add(*angular, rb_top_turning(&l->top_body[i],
		                                                rb_model_inertia(l->model, i),
		                                                pose->orientation, pose->spin));
}

/* True if the forces that need these features are constant. */
static bool are_constant(const struct rb_located *l, int i, double t, rb_features features)
{
	for (int k = 0; k < ROWS; k++)
		if ((features & rows[k].need) && !rows[k].is_constant(l, i, t))
			return false;
	return true;
}

bool rb_external_is_constant(const struct rb_located *l, int i, double t)
{
	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	return are_constant(l, i, t, l->model->features);
}

bool rb_external_drag_is_linear(const struct rb_model *model)
{
	if (!(model->features & RB_FEATURE_DRAG))
		return false;
	for (int k = 0; k < model->element_list_count; k++) {
		const struct rb_elements *elements = &model->elements[k];

		for (int m = 0; m < elements->count && elements->kind->is_drag; m++)
			if (!elements->kind->damps ||
			    isnan(elements->kind->damps(rb_elements_row(elements, m))))
				return false;
	}
	return true;
}

double rb_external_decay(const struct rb_located *l, int i, double t)
{
	const rb_features of_elements = RB_FEATURE_SPRINGS | RB_FEATURE_DRAG | RB_FEATURE_ELEMENTS;
	double sum = 0;

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	if (!l->decays)
		return rb_external_is_constant(l, i, t) ? 0 : (double)NAN;
	for (int k = 0; k < l->model->element_list_count; k++) {
		const struct rb_elements *elements = &l->model->elements[k];

		if (elements->end ? elements->first[i] < elements->first[i + 1]
		                  : !elements->kind->damps)
			return (double)NAN;
		for (int m = 0; m < elements->count && !elements->end; m++)
			sum += elements->kind->damps(rb_elements_row(elements, m));
	}
	if (!are_constant(l, i, t, l->model->features & ~of_elements))
		return (double)NAN;
	return sum * l->model->inverse_mass[i];
}

rb_vec3 rb_external_constant(struct rb_located *l, int i, double t, const struct rb_pose *pose)
{
	const struct rb_force_query view = {.time_s = t, .active_s = t};
	struct rb_pose at_rest = *pose;
	rb_vec3 linear, angular;

	at_rest.velocity = (rb_vec3){0, 0, 0};
	rb_external_force_at(l, i, &at_rest, &view, &linear, &angular);
	return linear;
}

/* True if a driven body attracts. */
static bool has_driven_center(const struct rb_model *model)
{
	for (int i = 0; model->driven && i < model->body_count; i++)
		if (model->driven[i] && model->attraction[i] > 0)
			return true;
	return false;
}

bool rb_external_is_constant_at_rest(const struct rb_located *l, int i, double t)
{
	const struct rb_model *const model = l->model;

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	if (!rb_located_gravitates(l))
		return rb_external_is_constant(l, i, t);
	/* the ledger of bodies at rest includes gravitation of fixed centres only */
	if (!model->attracts_by_mass && model->attractor_count > model->center_count)
		return false;
	return !has_driven_center(model) &&
	       are_constant(l, i, t, model->features & ~(rb_features)RB_FEATURE_GRAVITATION);
}

/* True for a point of application off the origin. */
static bool has_arm(rb_vec3 point)
{
	return !isnan(point.x) && rb_vec3_max_abs(point) > 0;
}

/* True if one of the elements exerts a torque on the body. */
static bool element_turns(const struct rb_located *l, const struct rb_elements *elements, int i)
{
	const struct rb_element_kind *kind = elements->kind;
	const int first = elements->end ? elements->first[i] : 0;
	const int end = elements->end ? elements->first[i + 1] : elements->count;

	for (int m = first; kind->turns && m < end; m++)
		if (kind->turns(l->model->scene,
		                rb_elements_row(elements, elements->end ? elements->of[m] : m),
		                l->model->id_of[i]))
			return true;
	return false;
}

bool rb_external_turns_with(const struct rb_located *l, int i)
{
	const struct rb_scene *scene = l->model->scene;
	const int id = l->model->id_of[i];
	const struct rb_body_def *body = &scene->bodies[id];

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	for (int f = 0; f < body->force_count; f++) {
		const struct rb_force_def *force = &scene->forces[body->force_first + f];

		if (force->frame == RB_FORCE_BODY || has_arm(force->point))
			return true;
	}
	for (int k = 0; k < l->model->element_list_count; k++)
		if (element_turns(l, &l->model->elements[k], i))
			return true;
	return false;
}

rb_vec3 rb_external_turning(const struct rb_located *l, int i)
{
	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	if (!l->top || !l->world->state.twist || l->top_body[i].kind != RB_TOP_CONSTANT)
		return (rb_vec3){0, 0, 0};
	return rb_vec3_scale(l->model->inverse_inertia_scalar[i],
	                     rb_world_row3(l->world->state.twist, i));
}

static int by_time(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

bool rb_external_switches(struct rb_located *l)
{
	const struct rb_scene *scene = l->model->scene;
	int count = 0;

	l->switch_s = rb_memory_take(2 * (size_t)scene->force_count + 1, sizeof *l->switch_s);
	if (!l->switch_s)
		return false;
	for (int k = 0; k < scene->force_count; k++) {
		const double end = scene->forces[k].start_s + scene->forces[k].duration_s;

		if (scene->forces[k].start_s > 0)
			l->switch_s[count++] = scene->forces[k].start_s;
		if (isfinite(end))
			l->switch_s[count++] = end;
	}
	qsort(l->switch_s, (size_t)count, sizeof *l->switch_s, by_time);
	for (int k = 0; k < count; k++)
		if (l->switch_count == 0 || l->switch_s[k] > l->switch_s[l->switch_count - 1])
			l->switch_s[l->switch_count++] = l->switch_s[k];
	return true;
}
